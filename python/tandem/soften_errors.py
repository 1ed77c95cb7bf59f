"""Errors of a softened scene: results of two runs compared."""
import math
from typing import Any, List, Sequence, Tuple

from tandem.entries import NoSuchName, SceneError


class Measure:
    """One of --of: "hinge.q" compares the course, "mouth.flow:mean:0.4:0.7" and "summary.KEY" a number.

    The error of a course is the rms of the difference over the times that both runs have, relative to the range of the stiff run; of a vector
    the length of the difference, relative to the diagonal of the box that it stays in. That of a number is relative to the stiff one."""

    def __init__(self, of: str):
        self.of = of
        self.of_number = of.startswith("summary.") or ":" in of

    def expect_in(self, results: Any) -> None:
        """Refuses a name that the results of a first window do not have."""
        column = self.of.split(":")[0]
        try:
            if column.startswith("summary."):
                if column[8:].split(".")[0] in results.summary:  # some keys are of a whole run
                    results.reduce(self.of)
                return
            found = results[column]
            if not hasattr(found, "values"):
                raise NoSuchName(f"'{column}' is no column; it has " + ", ".join(f"'{column}.{c}'" for c in found.channels))
        except KeyError as error:
            self._expect(False, str(error.args[0]), "")
        except ValueError:
            pass  # null in a first window

    def expect_to_change(self, stiff: Sequence[Any]) -> None:
        """Refuses a result to which no error can be relative: `stiff` are the results of the scene as it is, from each start."""
        if self.of_number:
            values = [self._number(each) for each in stiff]
            self._expect(all(values), "is 0 in the stiff run")
            if self.of.startswith("summary."):
                self._expect(len(values) == 1 or min(values) < max(values), "is the same from all starts of the stiff scene")
                return
        for each in stiff:
            low, high = _box(each[self.of.split(":")[0]])
            self._expect(all(map(math.isfinite, [*low, *high])), "has values that are no finite numbers in the stiff run")
            self._expect(any(a < b for a, b in zip(low, high)), "does not change in the stiff run")

    def _number(self, run: Any) -> float:
        try:
            value = float(run.reduce(self.of))
        except KeyError as error:
            self._expect(False, str(error.args[0]), "")
        except ValueError as error:
            self._expect(False, str(error), "")
        self._expect(math.isfinite(value), f"is {value:g} in the stiff run")
        return value

    def error(self, run: Any, stiff: Any) -> float:
        """Relative error [-]."""
        if self.of_number:
            try:
                here, right = run.reduce(self.of), stiff.reduce(self.of)
            except (KeyError, ValueError):  # null where the stiff run has a number
                return math.nan
            self._expect(right != 0 or here == 0, "is 0 in the stiff run")
            return abs(here - right) / abs(right) if right else 0.0
        import numpy as np
        here, right = run[self.of], stiff[self.of]
        times = [np.rint(signal.time * 1e9).astype(np.int64) for signal in (here, right)]
        _, mine, theirs = np.intersect1d(*times, return_indices=True)
        self._expect(len(mine) > 0, "has no time that both runs have")
        a, b = (np.asarray(signal.values, float)[rows].reshape(len(rows), -1) for signal, rows in ((here, mine), (right, theirs)))
        extent = float(np.linalg.norm(b.max(axis=0) - b.min(axis=0)))
        distance = float(np.sqrt(np.mean(np.sum((a - b)**2, axis=1))))
        self._expect(extent > 0 or distance == 0, "does not change in the stiff run")
        return distance / extent if extent else 0.0

    def _expect(self, condition: bool, what: str, why: str = ": no error relative to it can be stated") -> None:
        if not condition:
            raise SceneError(what + why, f"--of {self.of}", "name another result", made_at="the command line")


def _box(signal: Any) -> Tuple[List[float], List[float]]:
    """Least and largest value of each component."""
    values = signal.values.reshape(len(signal.values), -1)
    return list(values.min(axis=0)), list(values.max(axis=0))


def error_of_text(text: str) -> float:
    """"1%" or "0.01"."""
    try:
        if "_" in text:  # which Python would skip
            raise ValueError
        value = float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1:
        raise SceneError(f"'{text}' is no error", "--error", "write a share above 0 and below 1, as in --error 1% or --error 0.01",
                         made_at="the command line")
    return value
