"""The scene: built, loaded, changed, checked and run."""
import copy
import json
import os
import pathlib
from typing import Any, Dict, Iterator, List, Optional, Sequence

from tandem.entries import Entry, NoSuchName, SceneError, calling_line, nearest, plain, text_of
from tandem.execution import Execution
from tandem.grains import Grains
from tandem.machine import Machine
from tandem.parts import Body, Drive, Joint, Part, Wall
from tandem.schema import expect_keys
from tandem.values import Expression

# Lists of named things: where they are in the file, their definition in the schema, and how Python sees them.
LISTS = {
    "mbd.bodies": ("body", Body), "mbd.joints": ("joint", Joint), "mbd.forces": ("force", Drive), "mbd.couplers": ("coupler", Part),
    "mbd.contact.materials": ("contact_material", Part), "mbd.contact.pairs": ("contact_pair", Part),
    "mbd.contact.ground": ("ground_shape", Part), "mbd.contact.outputs": ("contact_output", Part),
    "dem.materials": ("material", Part), "dem.pairs": ("pair", Part), "dem.particles": ("particle_group", Part),
    "dem.walls": ("wall", Wall), "dem.outlets": ("outlet", Part), "dem.sensors": ("sensor", Part),
    "sph.walls": ("liquid_wall", Part), "sph.inlets": ("liquid_inlet", Part), "sph.outlets": ("outlet", Part),
    "sph.sensors": ("liquid_sensor", Part), "checks": ("check", Part),
}
# Things that refer to others by name look there first.
ORDER = ["mbd.bodies", "mbd.joints", "mbd.forces", "mbd.couplers", "dem.walls", "dem.particles", "dem.materials", "dem.sensors", "dem.outlets",
         "mbd.contact.ground", "mbd.contact.materials", "mbd.contact.outputs", "sph.walls", "sph.inlets", "sph.outlets", "sph.sensors", "checks"]


class Scene(Machine, Grains, Execution):
    """A scene: a machine, particles and walls, and how they are coupled. It prints as the JSON file that it is.

        s = td.Scene("excavator", end_time=4)
        steel = s.material("steel", density=7850, young=1e9, friction=0.4, restitution=0.3)
        boom = s.body("boom", mesh="boom.stl", scale=1e-3, density=7850)
        s.revolute("pivot", "ground", boom, at=(0, 0, .7), axis="y")
        r = s.run(progress=True)

    Build it with body(), the joints (revolute(), prismatic(), ...), cylinder(), motor(), material(), box(), wall(), fill(), sensor(), and
    expect() for checks; add() makes anything else of docs/scene_format.md. s["boom"] is the object of that name, s.data the JSON itself.
    Units are SI, angles in rad: td.deg(30). Methods return objects that print as their JSON, and refer to each other by object or name.

    end_time       simulated time [s], a whole number of windows
    window         [s] after which machine and particles exchange motion and load, and results get a row; 1e-3 by default
    gravity        [m/s2], (0, 0, -9.81) by default
    scheme         of the coupling (docs/coupling.md), "dem_first" by default
    frame_interval [s] between frames for films and r.frames; by default a thirtieth of a second, but between a three-hundredth and a tenth of
                   end_time, in whole windows; 0: the first and the last frame only
    """

    _source: Optional[pathlib.Path] = None  # the file that it was loaded from

    def __init__(self, name: str, end_time: Any, *, window: Optional[Any] = None, gravity: Optional[Sequence[Any]] = None,
                 scheme: Optional[str] = None, frame_interval: Optional[Any] = None, description: Optional[str] = None):
        if not isinstance(name, str):
            raise SceneError(f"the name of the scene is {name!r}", hint='give a word, as td.Scene("hopper", end_time=1)')
        coupling = {key: plain(value) for key, value in (("scheme", scheme), ("window", window)) if value is not None}
        data = {"tandem": "1.1", "name": name, "description": description, "end_time": plain(end_time), "gravity": plain(gravity),
                "coupling": coupling or None}
        self.data = Entry({key: value for key, value in data.items() if value is not None}, made_at=calling_line())
        if frame_interval is None and isinstance(end_time, (int, float)) and isinstance(window or 1e-3, (int, float)):
            step = window or 1e-3
            windows = max(1, round(min(max(1 / 30, end_time / 300), end_time / 10) / step))
            frame_interval = float(f"{windows * step:.12g}")
        if frame_interval is not None:
            self.section("output")["frame_interval"] = plain(frame_interval)

    # ---- access

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.data["name"]

    @name.setter
    def name(self, value: str) -> None:
        self.data["name"] = value

    def __getattr__(self, key: str) -> Any:
        if key.startswith("_") or key == "data":
            raise AttributeError(key)
        raise AttributeError(f"a scene has no '{key}'" + nearest(key, [name for name in dir(type(self)) if not name.startswith("_")]))

    def __setattr__(self, key: str, value: Any) -> None:
        if key == "data" or isinstance(getattr(type(self), key, None), property):
            object.__setattr__(self, key, value)
            return
        known = ["end_time", "gravity", "window", "scheme", "name", "description"]
        raise SceneError(f"a scene has no '{key}'" + nearest(key, known), hint="other keys: s.section(\"output\")[\"fields\"] = [...]")

    @property
    def gravity(self) -> Any:
        """Acceleration of gravity [m/s2], three numbers."""
        return self.data.get("gravity", [0, 0, -9.81])

    @gravity.setter
    def gravity(self, value: Any) -> None:
        self.data["gravity"] = plain(value)

    @property
    def window(self) -> Any:
        """Length of a window [s]."""
        return self.data.get("coupling", {}).get("window", 1e-3)

    @window.setter
    def window(self, value: Any) -> None:
        self.section("coupling")["window"] = plain(value)

    @property
    def scheme(self) -> str:
        """Coupling scheme."""
        return self.data.get("coupling", {}).get("scheme", "dem_first")

    @scheme.setter
    def scheme(self, value: str) -> None:
        self.section("coupling")["scheme"] = value

    @property
    def description(self) -> str:
        """Free text."""
        return self.data.get("description", "")

    @description.setter
    def description(self, value: str) -> None:
        self.data["description"] = value

    @property
    def end_time(self) -> Any:
        """Simulated time [s]."""
        return self.data["end_time"]

    @end_time.setter
    def end_time(self, value: Any) -> None:
        self.data["end_time"] = plain(value)

    def section(self, path: str) -> Entry:
        """The JSON object at a path, made if it is not there: s.section("mbd.integrator")["rho_inf"] = 1."""
        here = self.data
        for key in path.split("."):
            here = here.setdefault(key, Entry(made_at=calling_line()))
        return here

    def entries(self, path: str) -> List[Entry]:
        """The list of JSON objects at a path, empty if there is none."""
        here: Any = self.data
        for key in path.split("."):
            here = here.get(key, {}) if isinstance(here, dict) else {}
        if not isinstance(here, list):
            return []
        # What is no object is wrong, which the program says.
        return here if all(isinstance(entry, dict) for entry in here) else [entry for entry in here if isinstance(entry, dict)]

    def add(self, where: str, **keys: Any) -> Any:
        """Adds an object to a list of the scene by its keys of docs/scene_format.md, and returns it:
        s.add("mbd.forces", name="tie", type="rope", points=[...], length=2, axial_stiffness=1e6)."""
        if where not in LISTS:
            raise SceneError(f"there is no list '{where}'" + nearest(where, LISTS))
        kind, view = LISTS[where]
        entry = Entry({key: copy.deepcopy(plain(value)) for key, value in keys.items() if value is not None}, made_at=calling_line())
        expect_keys(kind, entry, f"{where}: '{entry.get('name', '')}'", entry.made_at)
        section, _, key = where.rpartition(".")
        holder = self.section(section) if section else self.data
        same = [e for e in holder.setdefault(key, []) if "name" in entry and e.get("name") == entry["name"]]
        if same:
            raise SceneError(f"there is already one of the name '{entry['name']}'" + (f", made at {same[0].made_at}" if same[0].made_at else ""),
                             where, "give another name")
        holder[key].append(entry)
        return view(self, entry, kind)

    def parts(self) -> Iterator[Part]:
        """All named objects."""
        for path in ORDER:
            kind, view = LISTS[path]
            for entry in self.entries(path):
                yield view(self, entry, kind)

    def __getitem__(self, name: Any) -> Any:
        """The object of this name: s["boom"], or s["mbd.bodies", "boom"] where two lists have the name."""
        where, name = name if isinstance(name, tuple) else (None, name)
        found = [(path, entry) for path in ORDER if where in (None, path) for entry in self.entries(path) if entry.get("name") == name]
        if len(found) > 1:
            raise NoSuchName(f"'{name}' is in " + " and ".join(path for path, _ in found) + f"; write s[\"{found[0][0]}\", \"{name}\"]")
        if found:
            kind, view = LISTS[found[0][0]]
            return view(self, found[0][1], kind)
        raise NoSuchName(f"the scene '{self.name}' has no '{name}'" + nearest(name, [part.name for part in self.parts()]))

    def __contains__(self, name: str) -> bool:
        return any(part.name == name for part in self.parts())

    def remove(self, part: Any) -> None:
        """Takes an object, or the object of that name, out of the scene."""
        entry = (part if isinstance(part, Part) else self[part]).entry
        for path in ORDER + ["dem.pairs", "mbd.contact.pairs"]:
            found = self.entries(path)
            found[:] = [other for other in found if other is not entry]

    def shape_names(self) -> List[str]:
        """Names of all walls and shapes."""
        names = [w.get("name") for w in self.entries("dem.walls") + self.entries("sph.walls") + self.entries("mbd.contact.ground")]
        return [n for n in names + [s.get("name") for b in self.entries("mbd.bodies") for s in b.get("shapes", [])] if n]

    def copy(self) -> "Scene":
        """An independent copy."""
        return copy.deepcopy(self)

    # ---- parameters, checks, output

    def parameter(self, name: str, value: Any, *, unit: Optional[str] = None, min: Optional[float] = None, max: Optional[float] = None) -> Expression:
        """A named number that can be changed for a run: s.run(mouth=0.08), td.sweep(s, mouth=[...]). Use what it returns in formulas,
        mouth/2, or write them as texts: "=mouth/2 - 0.01*cos(pitch)". An angle has the unit "deg" or "rad"."""
        if not isinstance(name, str):
            raise SceneError(f"the name of a parameter is {name!r}", hint='give a word and a value, as s.parameter("mouth", 0.06)')
        keys = {"value": plain(value), "unit": unit, "min": min, "max": max}
        given = {key: v for key, v in keys.items() if v is not None}
        self.section("parameters")[name] = Entry(given, made_at=calling_line())
        return Expression(name)

    def set(self, **values: Any) -> "Scene":
        """Changes parameters, in their own units; returns the scene."""
        known = self.data.get("parameters", {})
        for name, value in values.items():
            if name not in known:
                own = isinstance(getattr(type(self), name, None), property)
                raise SceneError(f"the scene has no parameter '{name}'" + ("" if own else nearest(name, known)), "parameters",
                                 f"write s.{name} = {value!r}" if own else None)
            if isinstance(known[name], dict):
                known[name]["value"] = plain(value)
            else:
                known[name] = plain(value)
        return self

    def expect(self, name: str, of: str, expected: Any, tolerance: float, *, reduce: Optional[str] = None, start: Optional[float] = None,
               stop: Optional[float] = None, absolute: Optional[bool] = None, why: Optional[str] = None) -> Part:
        """A check that the run evaluates itself, and fails: `of` is a column ("hinge.q") or "summary.KEY", `reduce` one of "last", "mean",
        "rms", "mean_abs", "min", "max", "range", "period", from `start` to `stop` [s]."""
        keys: Dict[str, Any] = {"from": start, "to": stop}
        return self.add("checks", name=name, of=of, expected=expected, tolerance=tolerance, reduce=reduce, absolute=absolute, why=why, **keys)

    def camera(self, eye: Sequence[float], target: Sequence[float], *, up: Optional[Sequence[float]] = None,
               field_of_view: Optional[float] = None) -> None:
        """Where pictures and films look from; without it, a view that shows all."""
        keys = {"eye": plain(eye), "target": plain(target), "up": plain(up), "field_of_view": field_of_view}
        self.section("output")["camera"] = {key: value for key, value in keys.items() if value is not None}

    # ---- JSON

    def complete(self) -> dict:
        """The JSON as a run gets it, with the domain that was not given."""
        order = ["tandem", "name", "description", "parameters", "gravity", "end_time", "coupling", "mbd", "dem", "sph", "output", "checks"]
        keys = sorted(self.data, key=lambda key: order.index(key) if key in order else len(order))
        data = Entry({key: self.data[key] for key in keys}, made_at=self.data.made_at)
        dem = data.get("dem")
        if isinstance(dem, dict) and "domain" not in dem and ("particles" in dem or "walls" in dem):
            data["dem"] = Entry(dem, domain=self._automatic_domain())
        return data

    def json(self, folder: Optional[str] = None) -> str:
        """The scene as the text of a file; names of mesh files are relative to `folder` where they are inside of it, full elsewhere."""
        data = copy.deepcopy(self.complete())
        root = os.path.abspath(folder) if folder is not None else None
        for entry, key in files_of(data):
            entry[key] = os.path.abspath(entry[key])  # names of Python start at the current folder
            if root is not None and not os.path.relpath(entry[key], root).startswith(".."):
                entry[key] = os.path.relpath(entry[key], root)
        return text_of(data)

    def __str__(self) -> str:
        return self.json(os.getcwd())

    def __repr__(self) -> str:
        bodies, groups = len(self.entries("mbd.bodies")), len(self.entries("dem.particles"))
        return f"<Scene {self.name}: {bodies} bod{'y' if bodies == 1 else 'ies'}, {groups} group{'' if groups == 1 else 's'} of spheres>"

    def save(self, file: str) -> None:
        """Writes the scene as a file for the command `tandem`."""
        path = pathlib.Path(file)
        text = self.json(str(path.resolve().parent)) + "\n"
        try:
            path.write_text(text)
        except OSError as error:
            raise SceneError(f"cannot be written: {error.strerror}", str(file), "give the name of a file in a folder that exists") from None

    def _repr_html_(self) -> str:
        import html

        from tandem.notebook import text_html
        return f"<details open><summary>{html.escape(repr(self))}</summary>{text_html(str(self))}</details>"


def files_of(value: Any):
    """(object, key) of all names of files in a scene."""
    if isinstance(value, dict):
        for key, part in value.items():
            if isinstance(part, str) and not part.startswith("=") and (
                    key == "file" or (key == "folder" and value.get("type") == "run")):
                yield value, key
            else:
                yield from files_of(part)
    elif isinstance(value, list):
        for part in value:
            yield from files_of(part)


def load(file: str, **parameters: float) -> Scene:
    """Reads a scene file: td.load("hopper.json", mouth=0.06) with other values of its parameters. s["gate"] is an object of it, which can be
    changed, and s.run() runs it."""
    if not isinstance(file, (str, os.PathLike)):
        raise SceneError(f"file is {file!r}", hint='give the name of a scene file, as td.load("hopper.json")')
    path = pathlib.Path(file)
    try:
        data = json.loads(path.read_text(), object_pairs_hook=Entry)
    except OSError as error:
        raise SceneError(f"cannot be read: {error.strerror}", str(file)) from None
    except ValueError as error:
        raise SceneError(f"is no JSON: {error}", str(file)) from None
    if not isinstance(data, dict) or "tandem" not in data:
        raise SceneError("is no scene: it has no key 'tandem'", str(file))
    for entry, key in files_of(data):
        entry[key] = os.path.abspath(path.resolve().parent / entry[key])
    for solver in ("mbd", "dem", "sph"):
        command = data.get(solver, {}).get("server") if isinstance(data.get(solver), dict) else None
        if isinstance(command, str) and "/" in command.split()[0] and not command.startswith("/"):
            data[solver]["server"] = str(path.resolve().parent / command)
    scene = Scene.__new__(Scene)
    scene.data = data
    object.__setattr__(scene, "_source", path.resolve())
    return scene.set(**parameters)
