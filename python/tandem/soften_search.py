"""The search of `tandem soften`: the cheapest modulus, micro step and window within a wanted error.

A setting is a level on each of three axes; level 0 is the stiff scene. With each level errors grow and costs fall, apart from scatter."""
import math
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

Point = Tuple[int, int, int]  # levels of modulus, micro step, window
MODULUS, STEP, WINDOW = range(3)
GAIN = 0.97  # a setting is cheaper if it takes at most this share of the time


class Outcome(NamedTuple):
    """What was measured of a setting."""
    shares: Sequence[float]  # error of each result over the wanted one; empty where there is none
    per_step: float = 0.0  # time that goes with the number of micro steps [s]
    per_window: float = 0.0  # with the number of windows [s]
    rest: float = 0.0  # with neither [s]
    fault: str = ""  # why the setting cannot be taken, whatever its errors

    @property
    def cost(self) -> float:
        """Wall time [s]."""
        return self.per_step + self.per_window + self.rest

    @property
    def passes(self) -> bool:
        """Whether the setting keeps the wanted errors."""
        return not self.fault and bool(self.shares) and all(share <= 1 for share in self.shares)


class Search:
    """Finds the cheapest setting that passes.

    lengths    number of levels on each axis
    evaluate   measures a setting, which takes long
    work       numbers of micro steps and of windows of a setting
    scatter    error over the wanted one that every change of the scene causes, as another random start does
    most       settings that are measured at most

    Levels of the micro step with the same number of steps in the same window are the same setting, which the lowest of them stands for."""

    def __init__(self, lengths: Point, evaluate: Callable[[Point], Outcome], work: Callable[[Point], Tuple[float, float]], scatter: float = 0.0,
                 most: int = 30):
        self.lengths, self.evaluate, self.work, self.scatter, self.most = lengths, evaluate, work, scatter, most
        self.tried: Dict[Point, Outcome] = {}
        self.foot: Point = (0, 0, 0)  # where the other two axes were climbed from

    def run(self) -> Point:
        """The cheapest setting found; (0, 0, 0) where none is cheaper than the stiff scene."""
        self.measure((0, 0, 0))
        self._climb((0, 0, 0), MODULUS, stride=2)
        self.foot = self._with_room_for_the_others()
        self._climb(self.foot, STEP, stride=2)
        self._climb(self.foot, WINDOW)
        while len(self.tried) < self.most:
            point = self._promising() or self._next_to_best()
            if point is None:
                break
            self.measure(point)
        return self.best()

    def measure(self, point: Point) -> Outcome:
        """Measured once."""
        if point not in self.tried:
            self.tried[point] = self.evaluate(point)
        return self.tried[point]

    def best(self) -> Point:
        """The cheapest of the measured settings that pass."""
        passing = [point for point, outcome in self.tried.items() if outcome.passes]
        return min(passing, key=lambda point: self.tried[point].cost, default=(0, 0, 0))

    def limit(self, axis: int) -> Tuple[Optional[Point], str]:
        """What keeps the best setting from the next level of an axis: the setting that shows it, and "error", "fault", "cost" or "last"."""
        above = self._above(self.best(), axis)
        if above is None:
            return None, "last"
        shown = above if above in self.tried else self._failed_below(above)
        if shown is None:
            return above, "untried"
        outcome = self.tried[shown]
        return shown, "fault" if outcome.fault else "cost" if outcome.passes else "error"

    # ---- steps of the search

    def _climb(self, point: Point, axis: int, stride: int = 1) -> None:
        """Goes up one axis while settings pass and become cheaper."""
        while len(self.tried) < self.most:
            above = self._above(point, axis, stride)
            if above is None:
                return
            before, outcome = self.measure(point), self.measure(above)
            if not outcome.passes or outcome.cost > GAIN * before.cost:
                return
            point = above

    def _with_room_for_the_others(self) -> Point:
        """The softest modulus that leaves three quarters of what the scatter leaves, in squares, to micro step and window."""
        most = math.sqrt(self.scatter**2 + 0.25 * (1 - self.scatter**2))
        fit = [p for p, o in self.tried.items() if p[1:] == (0, 0) and o.passes and max(o.shares) <= most]
        return max(fit, default=(0, 0, 0))

    def _promising(self) -> Optional[Point]:
        """The untried setting of the lowest predicted time among those that are predicted to pass."""
        best = self.tried[self.best()].cost
        found = [(self._predicted_cost(p), p) for p in self._untried() if max(self._predicted_shares(p)) <= 1]
        cost, point = min(found, default=(math.inf, None))
        return point if cost <= GAIN * best else None

    def _next_to_best(self) -> Optional[Point]:
        """A neighbour of the best setting that has not been measured: after the last of them the best one is so on each axis."""
        untried = set(self._untried())
        around = [self._above(self.best(), axis) for axis in (MODULUS, STEP, WINDOW)]
        return next((point for point in around if point in untried), None)

    # ---- what is known of a setting

    def _above(self, point: Point, axis: int, stride: int = 1) -> Optional[Point]:
        """The setting so many levels higher, or the first beyond that is another one."""
        last = self.lengths[axis] - 1
        for level in range(min(point[axis] + stride, last), last + 1):
            above = self._lowest((*point[:axis], level, *point[axis + 1:]))  # type: ignore[arg-type]
            if above != point:
                return above
        return None

    def _lowest(self, point: Point) -> Point:
        """The same setting at the lowest level of the micro step."""
        below = (point[MODULUS], point[STEP] - 1, point[WINDOW])
        return self._lowest(below) if point[STEP] > 0 and self.work(below) == self.work(point) else point

    def _untried(self) -> List[Point]:
        d, s, w = self.lengths
        every = ((i, j, k) for i in range(d) for j in range(s) for k in range(w))
        return [p for p in every if p not in self.tried and p == self._lowest(p) and self._failed_below(p) is None]

    def _failed_below(self, point: Point) -> Optional[Point]:
        """A setting that failed, of which this one has no lower level: it fails as well."""
        return next((p for p, o in self.tried.items() if not o.passes and all(a <= b for a, b in zip(p, point))), None)

    def _predicted_cost(self, point: Point) -> float:
        """From the best setting, whose parts go with the numbers of steps and windows."""
        best = self.best()
        outcome, (steps, windows), (of_steps, of_windows) = self.tried[best], self.work(point), self.work(best)
        return outcome.per_step * steps / of_steps + outcome.per_window * windows / of_windows + outcome.rest

    def _predicted_shares(self, point: Point) -> List[float]:
        """Errors of the three axes are independent: their squares add up. Infinite where an axis has not been measured that far, or has a fault."""
        squares = self._squares(MODULUS, point[MODULUS], (0, 0, 0))
        foot = self.tried[self.foot]
        for axis in (STEP, WINDOW):
            added = self._squares(axis, point[axis], self.foot)
            squares = [here + max(0.0, there - share**2) for here, there, share in zip(squares, added, foot.shares)]
        return [math.sqrt(square) for square in squares]

    def _squares(self, axis: int, level: int, foot: Point) -> List[float]:
        """Squares of the errors at a level of an axis above `foot`. Between measured levels they are powers of the modulus, step or window;
        from 0 on they are linear."""
        known = {p[axis]: o for p, o in self.tried.items() if o.shares and all(p[i] == foot[i] for i in range(3) if i != axis)}
        if level in known:
            return [math.inf if known[level].fault else share**2 for share in known[level].shares]
        below, above = [i for i in known if i < level], [i for i in known if i > level]
        if not below or not above:
            return [math.inf] * len(self.tried[foot].shares)
        low, high = max(below), min(above)
        part = (level - low) / (high - low)
        return [(a**(1 - part) * b**part if a > 0 else part * b)**2 for a, b in zip(known[low].shares, known[high].shares)]
