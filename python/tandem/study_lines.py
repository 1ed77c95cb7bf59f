"""What a panel of a study shows: one line per method, the envelope of its other settings, the order, the floor, and runs without an error."""
import math
import statistics
from typing import List, NamedTuple, Optional, Tuple

from tandem.study_data import DONE, MOST_LINES, Measure, Row, Study, label_of

Point = Tuple[float, float]  # time [s], error


class Line(NamedTuple):
    """A method: its runs, the points of its line from large steps to small ones (or along its front), and the outline of its envelope."""
    label: str
    rank: Tuple[int, int]  # place among the values of the first of its settings, and within these: hue and shade
    rows: List[Row]
    points: List[Row]
    envelope: List[Point]


class Panel(NamedTuple):
    """All that is drawn of one measure."""
    settings: List[str]  # that tell the methods apart
    lines: List[Line]
    others: List[Row]  # of methods beyond the sixth
    bad: List[Tuple[Row, Tuple[int, int]]]  # runs without an error, with the rank of their method
    silent: List[Tuple[str, Tuple[int, int]]]  # methods none of whose runs has an error
    floor: Optional[float]
    order: Optional[int]


def front(rows: List[Row], measure: str) -> List[Row]:
    """Rows that no other one improves in both time and error, the cheapest first."""
    best: List[Row] = []
    for row in sorted(rows, key=lambda row: (row.cpu, row.error(measure))):
        if not best or row.error(measure) < best[-1].error(measure):
            best.append(row)
    return best


def hull(points: List[Point]) -> List[Point]:
    """The convex outline of points on logarithmic axes, which has all runs of a method inside."""
    ordered = sorted({(math.log(x), math.log(y)) for x, y in points})

    def chain(candidates) -> List[Point]:
        kept: List[Point] = []
        for p in candidates:
            while len(kept) > 1 and ((kept[-1][0] - kept[-2][0]) * (p[1] - kept[-2][1]) <= (kept[-1][1] - kept[-2][1]) * (p[0] - kept[-2][0])):
                kept.pop()
            kept.append(p)
        return kept[:-1]

    return [(math.exp(x), math.exp(y)) for x, y in chain(ordered) + chain(ordered[::-1])]


def _line(study: Study, measure: Measure, label: str, rank: Tuple[int, int], rows: List[Row], whole: bool) -> Line:
    """`whole`: no settings but the step are left, so that the line joins all rows in the order of the step."""
    if whole:
        if study.line:
            rows = sorted(rows, key=lambda row: -float(row.settings[study.line]))
        return Line(label, rank, rows, rows, [])
    outline = hull([(row.cpu, row.error(measure.name)) for row in rows])
    return Line(label, rank, rows, front(rows, measure.name), outline if len(outline) > 2 else [])


def order_of(study: Study, measure: Measure, floor: Optional[float]) -> Optional[int]:
    """p where errors fall with the step to the power p, and the time with one over the step, so that a guide of slope -p fits; with a
    tolerance in place of a step, where errors fall with the time to the power -p. None where there is no such law."""
    groups: dict = {}
    for row in study.rows:
        if study.line and row.error(measure.name) and row.error(measure.name) > 3 * (floor or 0):
            groups.setdefault(tuple(row.settings[name] for name in study.others()), []).append(row)
    orders, gains = [], []
    for rows in groups.values():
        rows.sort(key=lambda row: -float(row.settings[study.line]))
        for a, b in zip(rows, rows[1:]):
            gain = math.log(a.error(measure.name) / b.error(measure.name))
            effort = math.log(b.cpu / a.cpu) if study.line.endswith("tolerance") else math.log(
                float(a.settings[study.line]) / float(b.settings[study.line]))
            gains.append(math.log(b.cpu / a.cpu))
            if effort > 0.1:
                orders.append(gain / effort)
    if len(orders) < 3 or statistics.median(gains) < math.log(1.4):
        return None
    order = round(statistics.median(orders))
    return order if order >= 1 and abs(statistics.median(orders) - order) < 0.3 else None


def floor_of(study: Study, measure: Measure, lines: List[Line]) -> Optional[float]:
    """The error below which no finer step helps, where the data show one: after a fall by ten, two more steps that gain nothing, in most
    of the lines, while none goes much below."""
    found = []
    for line in lines:
        errors = [row.error(measure.name) for row in line.points] if study.line and line.points is line.rows else []
        for k in range(1, len(errors) - 2):
            if errors[k] < 0.1 * errors[0] and all(errors[i + 1] > 0.7 * errors[i] for i in (k, k + 1)):
                found.append(min(errors[k:]))
                break
    least = min((row.error(measure.name) for line in lines for row in line.rows), default=0)
    return min(found) if 2 * len(found) > len(lines) and least > min(found) / 3 else None


def panel(study: Study, measure: Measure) -> Panel:
    settings = study.method_settings(measure)
    whole = settings == study.others()
    groups: dict = {}
    for row in study.rows:
        groups.setdefault(tuple(row.settings[name] for name in settings), []).append(row)
    first = study.values(settings[0]) if settings else []
    lines, bad, without, others, seen = [], [], [], [], {}
    for key, members in groups.items():
        hue = first.index(key[0]) if key else 0
        rank = (hue, seen.setdefault(hue, 0))
        seen[hue] += 1
        # A run without any error cannot be on an axis of logarithms; it is exact, and counts where the measure is a sentence.
        rows = [row for row in members if row.error(measure.name)]
        if rows:
            lines.append(_line(study, measure, label_of(members[0], settings), rank, rows, whole))
        elif any(row.status not in DONE for row in members):
            without.append((members, rank))
        bad += [(row, rank) for row in members if row.status not in DONE]
    if len(lines) > MOST_LINES:
        kept = sorted(lines, key=lambda line: statistics.fmean(math.log(row.error(measure.name)) for row in line.points))[:MOST_LINES]
        others = [row for line in lines if line not in kept for row in line.rows]
        lines = [line for line in lines if line in kept]
    floor = floor_of(study, measure, lines)
    silent = [(label_of(members[0], settings), rank) for members, rank in without if not any(line.rank == rank for line in lines)]
    return Panel(settings, lines, others, bad, silent, floor, order_of(study, measure, floor))
