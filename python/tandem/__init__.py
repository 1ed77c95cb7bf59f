"""tandem in Python: build a scene, change it, run it, watch it, sweep it, and read its results.

    import tandem as td

    s = td.Scene("pendulum", end_time=2)
    bob = s.body("bob", mass=1, inertia=(.01, .01, .01), at=(1, 0, 0))
    s.revolute("hinge", "ground", bob, at=(0, 0, 0), axis="y")
    r = s.run()
    print(r.verdict, r["hinge.q"].max())

Start with help(td.Scene), help(td.Results), help(td.sweep) and help(td.templates). Solvers in Python are another matter: see tandem.participant.
Nothing of this is loaded before it is used, and `import tandem` loads neither numpy nor anything else.
"""
import importlib

_HOMES = {
    "scenes": ("Scene", "load"),
    "entries": ("SceneError",),
    "parts": ("Part", "Body", "Joint", "Drive", "Wall"),
    "values": ("table", "ramp", "harmonic", "constant", "normal", "log_normal", "sieve", "deg", "Expression"),
    "runs": ("Run", "RunError"),
    "results": ("Results", "Signal"),
    "sweeps": ("sweep", "Sweep"),
    "softening": ("soften", "Softening"),
    "program": ("find_tandem",),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}
__all__ = sorted(_HOME)


def __getattr__(name):
    if name == "templates":
        return importlib.import_module("tandem.templates")
    if name in _HOME:
        value = getattr(importlib.import_module("tandem." + _HOME[name]), name)
        globals()[name] = value
        return value
    if name.startswith("_"):
        raise AttributeError(name)
    from tandem.entries import nearest
    raise AttributeError(f"tandem has no '{name}'" + nearest(name, __all__))


def __dir__():
    return sorted(list(globals()) + __all__)
