"""The shared library of the participant kit, and the errors that it hands on."""
import ctypes
import functools
import os
import pathlib

# Codes for Error.
INTERNAL = 1  # a defect of the solver
SCENE = 3     # the scene is wrong, or asks for what this solver does not know
NUMERICS = 7  # the solver cannot continue
RESOURCE = 8  # memory, device, disk


class Error(Exception):
    """Ends the run on all sides: what is wrong with its value, where (a key of the scene, a function), and what to
    write instead."""

    def __init__(self, what, where=None, hint=None, code=SCENE):
        super().__init__(what)
        self.what, self.where, self.hint, self.code = what, where, hint, code


class Reported(Exception):
    """The library already knows the error."""


def _library_file():
    name = "libtandem_participant.so.1"
    given = os.environ.get("TANDEM_PARTICIPANT_LIBRARY")
    if given:
        return given
    # PREFIX/share/tandem/python/tandem/library.py; in a build tree `python` is a link to the sources.
    installed = pathlib.Path(os.path.abspath(__file__)).parents[4] / "lib" / name
    if installed.exists():
        return str(installed)
    built = pathlib.Path(__file__).resolve().parents[2].glob(f"build/*/lib/{name}")
    return str(max(built, key=os.path.getmtime, default=name))


@functools.lru_cache(maxsize=None)
def library():
    """libtandem_participant, from the environment's TANDEM_PARTICIPANT_LIBRARY, from the folder that this package is
    installed in, from a build next to its sources, or from the system's folders."""
    file = _library_file()
    try:
        loaded = ctypes.CDLL(file)
    except OSError as error:
        raise ImportError(f"cannot load {file}: {error}; set TANDEM_PARTICIPANT_LIBRARY to the path of "
                          "libtandem_participant.so.1, which lies in lib/ of an installed tandem") from None
    text, pointer = ctypes.c_char_p, ctypes.c_void_p
    for name, arguments in (
            ("tandem_fail", [ctypes.c_int, text, text, text]), ("tandem_log", [ctypes.c_char, text]),
            ("tandem_fact_number", [pointer, text, ctypes.c_double]), ("tandem_fact_text", [pointer, text, text]),
            ("tandem_warn", [pointer, text]), ("tandem_pose_at", [pointer, pointer, ctypes.c_double, pointer, pointer])):
        getattr(loaded, name).argtypes = arguments
    return loaded
