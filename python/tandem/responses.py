"""The response of a scene to one or two parameters, as a picture."""
import json
import math
from typing import Dict, Optional

from tandem.end_labels import label_ends
from tandem.plots import COLOURS, figure

DONE = ("ok", "suspect")
AMBER, RED = "#b7791f", "#b03a3a"


def response(sweep, file: Optional[str] = None):
    """One panel for each score: points over one parameter, lines or a map over two; rings mark suspect variants, crosses at the lower edge
    those without a score. With more parameters, each panel has the score over the first, and a line for each combination of the others.
    Axes have the units that the scene gives its parameters, and the results their columns."""
    scores = sweep.scores or ["score"]
    units = units_of(sweep)
    made, axes = figure(len(scores), width=6.5, height=3.4)
    for axis, score in zip(axes[:, 0], scores):
        numeric = [name for name in sweep.names if all(isinstance(row.values[name], (int, float)) for row in sweep.rows)]
        counts = [len({row.values[name] for row in sweep.rows}) for name in sweep.names]
        if len(sweep.names) == 2 and len(numeric) == 2 and min(counts) >= 4:
            _map(made, axis, sweep, score, units)
        else:
            _lines(axis, sweep, score, units)
    if file:
        made.savefig(file, dpi=150)
    return made


def units_of(sweep) -> Dict[str, str]:
    """Units of parameters, where the scene of a variant states them, and of scores, where the results of a run do."""
    units: Dict[str, str] = {}
    for row in sweep.rows:
        scene = row.folder.with_name(row.folder.name + ".json")
        if not units and scene.is_file():
            given = json.loads(scene.read_text()).get("parameters", {})
            units.update({name: entry["unit"] for name, entry in given.items() if isinstance(entry, dict) and "unit" in entry})
        if row.status in DONE:
            units.update({score: _score_unit(row.results, score) for score in sweep.scores})
            break
    return units


def _score_unit(results, of: str) -> str:
    """The unit of "COLUMN:REDUCTION": that of the column, of an integral times s, of a period s; "" where it is not known."""
    column, *rest = of.split(":")
    how = rest[0] if rest else "last"
    if column.startswith("summary.") or column not in results:
        return ""
    unit = getattr(results[column], "unit", "")
    if how == "integral":
        return {"": "", "W": "J", "kg/s": "kg"}.get(unit, f"{unit} s")
    return "s" if how == "period" else unit


def _titled(name: str, units: Dict[str, str]) -> str:
    return f"{name} [{units[name]}]" if units.get(name) else name


def _lines(axis, sweep, score: str, units: Dict[str, str]) -> None:
    first, others = sweep.names[0], sweep.names[1:]
    texts = [str(row.values[first]) for row in sweep.rows]
    is_number = all(isinstance(row.values[first], (int, float)) for row in sweep.rows)
    place = (lambda row: row.values[first]) if is_number else (lambda row: list(dict.fromkeys(texts)).index(str(row.values[first])))
    groups: dict = {}
    for row in sweep.rows:
        groups.setdefault(tuple(row.values[name] for name in others), []).append(row)
    ends = []
    for i, (values, rows) in enumerate(groups.items()):
        good = sorted((row for row in rows if _finite(row, score)), key=place)
        colour = COLOURS[i % len(COLOURS)]
        label = ", ".join(f"{name} {value:g}{' ' + units[name] if units.get(name) else ''}" if isinstance(value, (int, float)) else f"{name} {value}"
                          for name, value in zip(others, values))
        axis.plot([place(row) for row in good], [row.scores[score] for row in good], color=colour, marker="o", markersize=4, linewidth=1.5)
        ends.append((label, [row.scores[score] for row in good], colour))
        marked = [row for row in good if row.status == "suspect"]
        axis.plot([place(row) for row in marked], [row.scores[score] for row in marked], linestyle="none", marker="o", markersize=9,
                  markerfacecolor="none", markeredgecolor=AMBER)
    bad = [row for row in sweep.rows if not _finite(row, score) and row.status != "pending"]
    if bad:
        axis.plot([place(row) for row in bad], [0.02] * len(bad), linestyle="none", marker="x", color=RED, clip_on=False,
                  transform=axis.get_xaxis_transform(), label=f"{len(bad)} without a score")
    if any(row.status == "suspect" for row in sweep.rows):
        axis.plot([], [], linestyle="none", marker="o", markersize=9, markerfacecolor="none", markeredgecolor=AMBER, label="suspect")
    if not is_number:
        axis.set_xticks(range(len(dict.fromkeys(texts))), list(dict.fromkeys(texts)))
    axis.set_xlabel(_titled(first, units))
    axis.set_ylabel(_titled(score, units))
    label_ends(axis, ends, 2.7)
    if axis.get_legend_handles_labels()[1]:
        axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=8, ncols=2, borderaxespad=0.2)


def _map(made, axis, sweep, score: str, units: Dict[str, str]) -> None:
    import numpy as np
    x_name, y_name = sweep.names
    xs, ys = sorted({row.values[x_name] for row in sweep.rows}), sorted({row.values[y_name] for row in sweep.rows})
    values = np.full((len(ys), len(xs)), math.nan)
    for row in sweep.rows:
        if _finite(row, score):
            values[ys.index(row.values[y_name]), xs.index(row.values[x_name])] = row.scores[score]
    axis.grid(False)
    shown = axis.pcolormesh(xs, ys, values, cmap="viridis", shading="nearest")
    made.colorbar(shown, ax=axis, label=_titled(score, units))
    for row in sweep.rows:
        point = (row.values[x_name], row.values[y_name])
        if row.status == "suspect":
            axis.plot(*point, marker="o", markersize=9, markerfacecolor="none", markeredgecolor=AMBER)
        elif not _finite(row, score) and row.status != "pending":
            axis.plot(*point, marker="x", color=RED)
    axis.set_xlabel(_titled(x_name, units))
    axis.set_ylabel(_titled(y_name, units))


def _finite(row, score: str) -> bool:
    return row.status in DONE and math.isfinite(row.scores.get(score, math.nan))
