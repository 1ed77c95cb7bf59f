"""Where the program `tandem` is."""
import os
import pathlib
import shutil


def find_tandem() -> str:
    """Path of the program `tandem`: from the environment variable TANDEM (the program or its folder), from the installed folder
    or the build that this package is in, from build/release, build/cuda or build/dev next to the sources, or from PATH."""
    given = os.environ.get("TANDEM")
    if given:
        path = pathlib.Path(given)
        for candidate in (path, path / "tandem", path / "bin" / "tandem"):
            if candidate.is_file():
                return str(candidate.resolve())
        raise RuntimeError(f"TANDEM is '{given}', where there is no program tandem; set it to the path of the program")
    # PREFIX/share/tandem/python/tandem/program.py, where `python` may be a link to the sources.
    here = pathlib.Path(os.path.abspath(__file__))
    sources = here.resolve().parents[2]
    places = [here.parents[min(4, len(here.parents) - 1)] / "bin" / "tandem"]
    places += [sources / "build" / preset / "bin" / "tandem" for preset in ("release", "cuda", "dev")]
    for place in places:
        if place.is_file():
            return str(place)
    found = shutil.which("tandem")
    if found:
        return found
    raise RuntimeError("the program tandem is not found in " + ", ".join(str(place.parent) for place in places) +
                       " and PATH; set the environment variable TANDEM to its path, or build it: ./launch/build release")


def data_folder() -> str:
    """The folder of what comes with tandem: scenes, schema, documentation."""
    folder = pathlib.Path(find_tandem()).resolve().parents[1] / "share" / "tandem"
    if not folder.is_dir():
        raise RuntimeError(f"there is no {folder} next to the program tandem; install it as a whole")
    return str(folder)
