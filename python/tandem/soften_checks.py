"""What `tandem soften` refuses before anything runs."""
import math
import re
from typing import Any, Dict, Sequence

from tandem import soften_scene as changes
from tandem.entries import SceneError
from tandem.reductions import expect_reduction
from tandem.scenes import Scene


def expect_scene(scene: Any, starts: Any) -> None:
    """A scene with grains and random starts, whose window is a number."""
    if not isinstance(scene, Scene):
        raise SceneError(f"{scene!r} is no scene", hint="write td.soften(td.load(\"my_scene.json\"), ...)")
    changes.expect_grains(scene)
    if not isinstance(starts, int) or isinstance(starts, bool) or not 1 <= starts <= 99:
        raise SceneError(f"{starts!r} is no number of random starts", "--starts", "write a whole number from 1 to 99")
    if starts > 1 and not changes.random_fills(scene):
        raise SceneError("the start of the scene has no random numbers, so that its scatter cannot be found", "dem.particles",
                         "give the fill a jitter, or write --starts 1 to judge errors without the scatter")
    for value, what in ((scene.window, "coupling.window"), (scene.end_time, "end_time")):
        if not isinstance(value, (int, float)):
            raise SceneError(f"{what} is the expression '{value}'", scene.name, "write it as a number")


def expect_results(names: Sequence[Any], end_time: float) -> None:
    """Words of --of, apart from the columns that there are."""
    if not names:
        raise SceneError("no result is named whose error is to be kept", "--of", "for instance --of hinge.q")
    for name in names:
        if not isinstance(name, str):
            raise SceneError(f"{name!r} is no name of a result", "--of", "for instance of=[\"hinge.q\"]")
        expect_reduction(name, end_time)


def expect_summary_keys(scene: Scene, names: Sequence[str]) -> None:
    """summary.json of the scene will have these keys; some of them only at the end of a whole run."""
    keys = [name for name in names if name.startswith("summary.")]
    if not keys:
        return
    asked = scene.copy()
    asked.data.pop("checks", None)
    for number, key in enumerate(keys):
        asked.expect(f"key_{number}", key, 0, 1, absolute=True)
    try:
        asked.check(files_only=True)
    except SceneError as error:
        where = re.match(r"checks\[(\d+)\]\.of: (.*)", error.what)
        if not where:
            raise
        raise SceneError(where[2], f"--of {keys[int(where[1])]}", made_at="the command line") from None


def expect_numbers(levels: Dict[str, Any], overlap: Any) -> None:
    """Levels are lists of finite numbers above 0, and the largest overlap is one up to 1."""
    for name, level in levels.items():
        if isinstance(level, (str, bytes)) or not isinstance(level, Sequence) and not hasattr(level, "tolist"):
            raise SceneError(f"{level!r} is no list of numbers", f"--{name}", f"for instance {name}=[{level if isinstance(level, (int, float)) else 1}]")
        for value in level:
            if not _is_number(value) or value <= 0:
                raise SceneError(f"{value!r} is not a finite number above 0", f"--{name}")
    if not _is_number(overlap) or not 0 < overlap <= 1:
        raise SceneError(f"{overlap!r} is no overlap", "--overlap", "write a number above 0 and up to 1, relative to the smaller radius")


def _is_number(value: Any) -> bool:
    try:
        return math.isfinite(value)
    except TypeError:
        return False
