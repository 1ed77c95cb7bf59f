"""Words for a number of the results, "COLUMN:REDUCTION:FROM:TO", checked before anything runs."""
import math
from typing import List, Optional

from tandem.entries import SceneError, nearest

REDUCTIONS = ("last", "mean", "rms", "mean_abs", "min", "max", "range", "period", "integral")


def expect_reduction(of: str, end_time: Optional[float] = None) -> None:
    """Refuses an unknown reduction, and times that are no numbers or outside the run, whose end is `end_time` [s] where it is known."""
    if of.startswith("summary.") or ":" not in of:
        return
    how, *words = of.split(":")[1:]
    if how not in REDUCTIONS:
        _refuse(of, f"there is no reduction '{how}'" + nearest(how, REDUCTIONS))
    times = _times(of, words)
    if len(times) > 2:
        _refuse(of, "has more than two times", "write COLUMN:REDUCTION:FROM:TO")
    if any(time < 0 for time in times) or times != sorted(times):
        _refuse(of, "has a time before 0 or before the other one", "write COLUMN:REDUCTION:FROM:TO")
    if end_time is not None and times and (times[0] >= end_time or times[-1] > end_time * (1 + 1e-9)):
        _refuse(of, f"has a time outside the run, which ends at {end_time:g} s")


def _times(of: str, words: List[str]) -> List[float]:
    try:
        times = [float(word) for word in words]
    except ValueError:
        times = [math.nan]
    if not all(map(math.isfinite, times)):
        _refuse(of, "has a time that is no number", "write COLUMN:REDUCTION:FROM:TO")
    return times


def _refuse(of: str, what: str, hint: Optional[str] = None) -> None:
    raise SceneError(what, f"--of {of}", hint, made_at="the command line")
