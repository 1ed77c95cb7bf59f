"""The rows of a study (docs/study.md), and which of its settings tell its methods apart."""
import csv
import json
import math
import pathlib
from typing import Any, Dict, List, Optional, Sequence, Tuple

DONE = ("ok", "suspect")  # statuses of completed runs
MOST_LINES = 6  # in one panel
MATTERS = 1.5  # a setting that changes the error by less than this factor makes no lines of its own


class Row:
    """One run: `settings` by name as text, `status`, `errors` by measure (absent where unknown), `cpu` with `low` and `high` of repeated
    timings [s] (None where no time was recorded)."""

    def __init__(self, cells: Dict[str, str], settings: Sequence[str], measures: Sequence[str]):
        self.settings = {name: cells[name] for name in settings}
        self.status = cells["status"]
        self.errors = {name: float(cells["error_" + name]) for name in measures if cells.get("error_" + name)}
        self.cpu = _time(cells.get("cpu_s"))
        self.low, self.high = _time(cells.get("cpu_low_s")) or self.cpu, _time(cells.get("cpu_high_s")) or self.cpu

    def error(self, measure: str) -> Optional[float]:
        """The error of a completed run whose time is known."""
        return self.errors.get(measure) if self.status in DONE and self.cpu else None


class Measure:
    """What a panel shows: `name`, `unit`, `want` (the wanted error or None), `scale` (size of what is compared, for its round-off)."""

    def __init__(self, entry: Dict[str, Any]):
        self.name, self.unit = entry["name"], entry.get("unit", "")
        self.want: Optional[float] = entry.get("want")
        self.scale: float = entry.get("scale") or 1.0


class Study:
    """A finished study: `name`, `settings` (names of the sweeps), `line` (the step that order_in names, or ""), `measures`, `rows`,
    `repeat` (timings of each run)."""

    def __init__(self, plot: Dict[str, Any], cells: List[Dict[str, str]]):
        self.name, self.settings, self.line = plot["name"], list(plot["settings"]), plot.get("line", "")
        self.repeat: int = plot.get("repeat", 1)
        self.measures = [Measure(entry) for entry in plot["measures"]]
        self.rows = [Row(row, self.settings, [measure.name for measure in self.measures]) for row in cells]

    def others(self) -> List[str]:
        """The settings but for the step."""
        return [name for name in self.settings if name != self.line]

    def method_settings(self, measure: Measure) -> List[str]:
        """Settings whose combinations are the lines of a panel: the first one, and further ones that matter there, while there are at most six
        lines."""
        others = self.others()
        chosen, count = others[:1], len(self.values(others[0])) if others else 1
        for name in others[1:]:
            if count * len(self.values(name)) <= MOST_LINES and self.effect(name, measure) > MATTERS:
                chosen.append(name)
                count *= len(self.values(name))
        return chosen

    def values(self, name: str) -> List[str]:
        """Values of a setting, in the order of the study."""
        return list(dict.fromkeys(row.settings[name] for row in self.rows))

    def effect(self, name: str, measure: Measure) -> float:
        """By which factor a setting changes the error, all other settings being equal: that of the upper quartile of these."""
        groups: Dict[Tuple[str, ...], List[float]] = {}
        for row in self.rows:
            if row.error(measure.name):
                groups.setdefault(tuple(value for key, value in row.settings.items() if key != name), []).append(row.errors[measure.name])
        factors = [max(errors) / min(errors) for errors in groups.values() if len(errors) > 1]
        return sorted(factors)[3 * (len(factors) - 1) // 4] if factors else 1.0


def is_round_off(study: Study, measure: Measure) -> bool:
    """Whether all errors are so small that double precision explains them: some hundred roundings of numbers of its size."""
    errors = [error for row in study.rows if (error := row.error(measure.name)) is not None]
    return bool(errors) and max(errors) < 100 * 2.0**-53 * measure.scale


def recommended(study: Study, measure: Measure) -> Optional[Row]:
    """The cheapest run with at most the wanted error, of those that are not suspect if there is one."""
    for status in DONE:
        good = [row for row in study.rows if row.status == status and (error := row.error(measure.name)) is not None and
                measure.want is not None and error <= measure.want]
        if good:
            return min(good, key=lambda row: row.cpu or math.inf)
    return None


def spoken(name: str, value: str) -> str:
    """'index2', but 'rho_inf 0.9': a word speaks for itself, a number needs its setting."""
    try:
        float(value)
    except ValueError:
        return value
    return f"{name.rpartition('/')[2]} {float(value):g}"


def label_of(row: Row, settings: Sequence[str]) -> str:
    return ", ".join(spoken(name, row.settings[name]) for name in settings)


def read(folder: pathlib.Path) -> Study:
    """From results.csv and plot.json of a folder of `tandem study`."""
    with open(folder / "results.csv", newline="") as lines:
        return Study(json.loads((folder / "plot.json").read_text()), list(csv.DictReader(lines)))


def _time(cell: Optional[str]) -> Optional[float]:
    value = float(cell) if cell else 0.0
    return value if value > 0 and math.isfinite(value) else None
