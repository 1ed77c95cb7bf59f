"""A solver for tandem in Python: subclass MotionSolver, LoadSolver or LiquidSolver, and call run().

    from tandem import participant

    class MySolver(participant.MotionSolver):
        features = ["joint:revolute"]
        ...

    participant.run(MySolver(), "my_solver", "1.0")

A motion solver (multibody side, `--mbd-server`) takes loads and returns the motion of the bodies with walls; a load
solver of spheres (`--dem-server`) or of a liquid (`--sph-server`) takes that motion and returns loads. Units, axes and the order of the calls are
those of tandem/participant.h. Records lie on memory of the library without copies, and are valid during the call:

    motion.bodies["end_pose"]["position"][:] = position

What the solver can do follows from the methods that it overrides; a scheme of coupling that needs more is refused.
To refuse a scene, or to end the run, raise Error; any other exception ends the run as a defect of the solver.
"""
import ctypes
import os
import sys
import traceback

import numpy as np

from tandem import layout
from tandem.configuration import GROUND, Configuration  # noqa: F401 (GROUND and the codes are for solvers)
from tandem.library import INTERNAL, NUMERICS, RESOURCE, SCENE, Error, Reported, library  # noqa: F401
from tandem.sets import BodiesFrame, LoadSet, MotionSet, WindowSum, view as _view  # noqa: F401

class Solver:
    # Names of the features of scenes that the solver knows; "joint:*" knows all that begin with "joint:". A scene with
    # any other is refused.
    features = []
    _facts = None

    def report(self):
        """Returns figures and texts for summary.json as a dict, or None. So may configure()."""

    def save(self):
        """Keeps one copy of the whole state."""

    def restore(self):
        """Goes back to it; may be called more than once per save()."""

    def checkpoint(self, path, windows, time):
        """Writes the state after so many windows, at this time [ns], to a file."""

    def resume(self, path, windows, time):
        """Reads that file, after configure()."""

    def warn(self, sentence):
        """A sentence for the warnings of the summary; in configure() and report()."""
        if not self._facts:
            raise Error("was called outside configure() and report()", "warn", "call log()", INTERNAL)
        library().tandem_warn(self._facts, sentence.encode())

    def _capabilities(self, of_methods):
        stated = 0
        for bit, names in of_methods:
            given = [getattr(type(self), name) is not getattr(self._role, name) for name in names]
            if any(given) and not all(given):
                missing = names[given.index(False)]
                raise TypeError(f"{type(self).__name__} has no {missing}(), which belongs to {' and '.join(names)}")
            stated |= bit if all(given) else 0
        return stated


class MotionSolver(Solver):
    observes_elements = False  # observe() fills in the elements of the frame

    def configure(self, configuration, initial):
        """`initial` is a MotionSet with the poses and twists of the scene; a solver whose joints change them, or that
        knows the accelerations, fills those in: begin = end = state at t = 0."""
        raise NotImplementedError

    def advance(self, loads, motion):
        """Integrates the window under these mean loads; bodies that are not in the set have none."""
        raise NotImplementedError

    def observe(self, frame):
        """Fills in a BodiesFrame."""
        raise NotImplementedError

    def predict(self, motion):
        """Fills in the path over motion.window with the velocities held; the state does not change."""

    def extrapolate(self, motion):
        """As predict(), with the accelerations held; advance() then integrates loads that are linear in time."""

    def control(self, values, time):
        """Values of the control inputs from this time [ns] on, in the order of the scene."""


class LoadSolver(Solver):
    follows_path = False  # the walls follow pose and twist inside the window
    window_mean = False   # `mean` is the time mean over the window, not the end value
    responds = False      # linearise() gives added mass and radiation damping as well

    def configure(self, configuration):
        raise NotImplementedError

    def advance(self, motion, loads):
        """Integrates the window along this motion."""
        raise NotImplementedError

    def observe(self):
        """Returns id (ascending), position, velocity, spin and radius of the particles."""
        raise NotImplementedError

    def linearise(self, tangents):
        """Fills in an array of tandem_body_tangent: stiffness and damping (6 x 6) of the contacts of each body. With `responds`
        it returns a list of (body, time, impulse 6 x 6), by body and time, and is also called before the first window."""


class LiquidSolver(LoadSolver):
    observes_liquid = False  # observe() gives pressure and density

    def observe(self):
        """Returns id (ascending), position and velocity of the particles, and with `observes_liquid` pressure [Pa] and
        density [kg/m3]."""
        raise NotImplementedError


MotionSolver._role, LoadSolver._role = MotionSolver, LoadSolver


def log(sentence, warning=False):
    """Writes a line to the log of the run."""
    library().tandem_log(b"w" if warning else b"i", sentence.encode())


def _fail(error, function):
    """tandem_fail() with the sentence of this exception."""
    if isinstance(error, Reported):
        return error.args[0]
    if isinstance(error, Error):
        parts = error.what, error.where or function, error.hint
        code = error.code
    else:
        traceback.print_exc()
        last = traceback.extract_tb(error.__traceback__)[-1]
        parts = (f"{type(error).__name__}: {error}", f"{function}: {last.filename}:{last.lineno}, in {last.name}",
                 "the log of the run has the whole traceback")
        code = INTERNAL
    return library().tandem_fail(code, *(None if part is None else str(part).encode() for part in parts))


def _state_facts(facts, figures):
    for key, value in (figures or {}).items():
        if isinstance(value, str):
            library().tandem_fact_text(facts, key.encode(), value.encode())
        else:
            library().tandem_fact_number(facts, key.encode(), float(value))


class _Calls:
    """The functions of the C tables, which call the solver."""

    def __init__(self, solver):
        self.solver = solver
        self.shown = None  # arrays that the library reads after observe() has returned

    def with_facts(self, facts, function, *arguments):
        self.solver._facts = facts
        _state_facts(facts, function(*arguments))
        self.solver._facts = None

    def report(self, facts):
        self.with_facts(facts, self.solver.report)

    def save(self):
        self.solver.save()

    def restore(self):
        self.solver.restore()

    def checkpoint(self, file):
        self.solver.checkpoint(file.contents.path.decode(), file.contents.windows, file.contents.time)

    def resume(self, file):
        self.solver.resume(file.contents.path.decode(), file.contents.windows, file.contents.time)


class _MotionCalls(_Calls):
    def configure(self, configuration, initial, facts):
        self.with_facts(facts, self.solver.configure, Configuration(configuration.contents), MotionSet(initial, True))

    def advance(self, loads, motion):
        self.solver.advance(LoadSet(loads, False), MotionSet(motion, True))

    def observe(self, frame):
        filled = BodiesFrame(frame)
        self.solver.observe(filled)
        frame.contents.energy = filled.energy

    def predict(self, window, motion):
        self.solver.predict(MotionSet(motion, True))

    def extrapolate(self, window, motion):
        self.solver.extrapolate(MotionSet(motion, True))

    def control(self, inputs):
        c = inputs.contents
        self.solver.control(layout.view(c.values, c.count, np.dtype("f8")), c.time)


class _LoadCalls(_Calls):
    def configure(self, configuration, facts):
        self.with_facts(facts, self.solver.configure, Configuration(configuration.contents))

    def advance(self, motion, loads):
        self.solver.advance(MotionSet(motion, False), LoadSet(loads, True))

    names = ("id", "position", "velocity", "spin", "radius")  # of what observe() returns

    def observe(self, frame):
        observed = self.solver.observe()
        if len(observed) != len(self.names):
            raise Error(f"returned {len(observed)} arrays, not {', '.join(self.names)}", "observe", None, INTERNAL)
        types = {"id": "u4", "position": "f8"}
        shown = [np.ascontiguousarray(array, types.get(name, "f4")) for name, array in zip(self.names, observed)]
        count = frame.contents.count = len(shown[0])
        for name, array in zip(self.names, shown):
            shape = (count, 3) if name in ("position", "velocity", "spin") else (count,)
            if array.shape != shape:
                raise Error(f"{name} has the shape {array.shape}, not {shape}", "observe", None, INTERNAL)
            setattr(frame.contents, name, array.ctypes.data)
        self.shown = shown

    def linearise(self, tangents):
        c = tangents.contents
        points = self.solver.linearise(_view(c.bodies, c.count, layout.BODY_TANGENT, True))
        if self.solver.responds:
            self.points = np.array([(body, 0, time, impulse) for body, time, impulse in points], layout.BODY_RESPONSE)
            c.response_count, c.responses = len(self.points), self.points.ctypes.data


class _LiquidCalls(_LoadCalls):
    def __init__(self, solver):
        super().__init__(solver)
        self.names = ("id", "position", "velocity") + (("pressure", "density") if solver.observes_liquid else ())


def _guarded(call, name):
    def function(_, *arguments):
        try:
            call(*arguments)
            return 0
        except BaseException as error:  # ctypes would drop it and return 0
            return _fail(error, name)
    return function


def _table(solver):
    """The C table of this solver, and what must live as long as it."""
    if isinstance(solver, MotionSolver):
        table, calls = layout.MotionTable(), _MotionCalls(solver)
        bits = solver._capabilities([(1, ["predict"]), (2, ["save", "restore"]), (32, ["extrapolate"]),
                                     (64, ["control"]), (128, ["checkpoint", "resume"])])
        bits |= 256 if solver.observes_elements else 0
    elif isinstance(solver, LoadSolver):
        of_liquid = isinstance(solver, LiquidSolver)
        table, calls = layout.LoadTable(), (_LiquidCalls if of_liquid else _LoadCalls)(solver)
        bits = solver._capabilities([(2, ["save", "restore"]), (16, ["linearise"]), (128, ["checkpoint", "resume"])])
        bits |= (4 if solver.follows_path else 0) | (8 if solver.window_mean else 0)
        bits |= 16384 if solver.responds else 0
        bits |= 8192 if of_liquid and solver.observes_liquid else 0
    else:
        raise TypeError(f"{type(solver).__name__} is neither a MotionSolver nor a LoadSolver or LiquidSolver")
    if isinstance(solver.features, (str, bytes)) or not all(isinstance(name, str) for name in solver.features):
        raise TypeError(f"{type(solver).__name__}.features is {solver.features!r}; write a list of names: [\"joint:*\"]")
    features = (ctypes.c_char_p * (len(solver.features) + 1))(*(name.encode() for name in solver.features), None)
    table.size, table.capabilities, table.features = ctypes.sizeof(table), bits, features
    for name, kind in table._fields_[3:]:
        setattr(table, name, kind(_guarded(getattr(calls, name), name)))
    return table, features


def run(solver, name, version):
    """Takes part in a run as the command line says, and exits with its status."""
    table, kept = _table(solver)
    role = "motion" if isinstance(solver, MotionSolver) else "liquid" if isinstance(solver, LiquidSolver) else "load"
    main = getattr(library(), f"tandem_{role}_main")
    arguments = [os.fsencode(argument) for argument in sys.argv]
    argv = (ctypes.c_char_p * (len(arguments) + 1))(*arguments, None)
    status = main(len(arguments), argv, f"{name} {version}".encode(), ctypes.byref(table), None)
    del kept
    sys.exit(status)
