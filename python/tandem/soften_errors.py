"""Errors of a softened scene: results of two runs compared."""
from typing import Any

from tandem.entries import SceneError, nearest


class Measure:
    """One of --of: "hinge.q" compares the course, "mouth.flow:mean:0.4:0.7" and "summary.KEY" a number.

    The error of a course is the rms of the difference over the times that both runs have, relative to the range of the stiff run; of a vector
    the length of the difference, relative to the diagonal of the box that it stays in. That of a number is relative to the stiff one."""

    def __init__(self, of: str):
        self.of = of
        self.of_number = of.startswith("summary.") or ":" in of

    def expect_in(self, results: Any) -> None:
        """Refuses a name that the results do not have."""
        column = self.of.split(":")[0]
        try:
            if column.startswith("summary."):
                return  # keys of the end of a run are not in a first window
            found = results[column]
            if not hasattr(found, "values"):
                raise KeyError(f"'{column}' is no column; it has " + ", ".join(f"'{column}.{c}'" for c in found.channels))
            if self.of_number:
                how, *times = self.of.split(":")[1:]
                known = ("last", "mean", "min", "max", "range", "period", "integral")
                if how not in known:
                    raise KeyError(f"there is no reduction '{how}'" + nearest(how, known))
                [float(time) for time in times]
        except KeyError as error:
            raise SceneError(str(error.args[0]), f"--of {self.of}", made_at="the command line") from None
        except ValueError:
            raise SceneError("has a time that is no number", f"--of {self.of}", "write COLUMN:REDUCTION:FROM:TO", made_at="the command line") from None

    def error(self, run: Any, stiff: Any) -> float:
        """Relative error [-]."""
        if self.of_number:
            here, right = run.reduce(self.of), stiff.reduce(self.of)
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

    def _expect(self, condition: bool, what: str) -> None:
        if not condition:
            raise SceneError(f"{what}: no error relative to it can be stated", f"--of {self.of}", "name another result", made_at="the command line")


def error_of_text(text: str) -> float:
    """"1%" or "0.01"."""
    try:
        value = float(text[:-1]) / 100 if text.endswith("%") else float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < 1:
        raise SceneError(f"'{text}' is no error", "--error", "write a share above 0 and below 1, as in --error 1% or --error 0.01",
                         made_at="the command line")
    return value
