"""The response of a scene to one or two parameters, as a picture."""
import math
from typing import Optional

from tandem.plots import COLOURS, figure

DONE = ("ok", "suspect")


def response(sweep, file: Optional[str] = None):
    """One panel for each score: points over one parameter, lines or a map over two; rings mark suspect variants, crosses at the lower edge
    those without a score. With more parameters, each panel has the score over the first, and a line for each combination of the others."""
    scores = sweep.scores or ["score"]
    made, axes = figure(len(scores), width=6.5, height=3.4)
    for axis, score in zip(axes[:, 0], scores):
        numeric = [name for name in sweep.names if all(isinstance(row.values[name], (int, float)) for row in sweep.rows)]
        counts = [len({row.values[name] for row in sweep.rows}) for name in sweep.names]
        if len(sweep.names) == 2 and len(numeric) == 2 and min(counts) >= 4:
            _map(made, axis, sweep, score)
        else:
            _lines(axis, sweep, score)
        axis.set_title(score if score != "score" else "")
    if file:
        made.savefig(file, dpi=150)
    return made


def _lines(axis, sweep, score: str) -> None:
    first, others = sweep.names[0], sweep.names[1:]
    texts = [str(row.values[first]) for row in sweep.rows]
    is_number = all(isinstance(row.values[first], (int, float)) for row in sweep.rows)
    place = (lambda row: row.values[first]) if is_number else (lambda row: list(dict.fromkeys(texts)).index(str(row.values[first])))
    groups: dict = {}
    for row in sweep.rows:
        groups.setdefault(tuple(row.values[name] for name in others), []).append(row)
    for i, (values, rows) in enumerate(groups.items()):
        good = sorted((row for row in rows if _finite(row, score)), key=place)
        colour = COLOURS[i % len(COLOURS)]
        label = ", ".join(f"{name} = {value:g}" if isinstance(value, (int, float)) else f"{name} = {value}" for name, value in zip(others, values))
        axis.plot([place(row) for row in good], [row.scores[score] for row in good], color=colour, marker="o", markersize=4, linewidth=1.3,
                  label=label or None)
        marked = [row for row in good if row.status == "suspect"]
        axis.plot([place(row) for row in marked], [row.scores[score] for row in marked], linestyle="none", marker="o", markersize=9,
                  markerfacecolor="none", markeredgecolor="#b7791f")
    bad = [row for row in sweep.rows if not _finite(row, score) and row.status != "pending"]
    if bad:
        axis.plot([place(row) for row in bad], [0.02] * len(bad), linestyle="none", marker="x", color="#b03a3a", clip_on=False,
                  transform=axis.get_xaxis_transform(), label=f"{len(bad)} without a score")
    if any(row.status == "suspect" for row in sweep.rows):
        axis.plot([], [], linestyle="none", marker="o", markersize=9, markerfacecolor="none", markeredgecolor="#b7791f", label="suspect")
    if not is_number:
        axis.set_xticks(range(len(dict.fromkeys(texts))), list(dict.fromkeys(texts)))
    axis.set_xlabel(first)
    if axis.get_legend_handles_labels()[1]:
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8)


def _map(made, axis, sweep, score: str) -> None:
    import numpy as np
    x_name, y_name = sweep.names
    xs, ys = sorted({row.values[x_name] for row in sweep.rows}), sorted({row.values[y_name] for row in sweep.rows})
    values = np.full((len(ys), len(xs)), math.nan)
    for row in sweep.rows:
        if _finite(row, score):
            values[ys.index(row.values[y_name]), xs.index(row.values[x_name])] = row.scores[score]
    axis.grid(False)
    shown = axis.pcolormesh(xs, ys, values, cmap="viridis", shading="nearest")
    made.colorbar(shown, ax=axis, label=score)
    for row in sweep.rows:
        point = (row.values[x_name], row.values[y_name])
        if row.status == "suspect":
            axis.plot(*point, marker="o", markersize=9, markerfacecolor="none", markeredgecolor="#b7791f")
        elif not _finite(row, score) and row.status != "pending":
            axis.plot(*point, marker="x", color="#b03a3a")
    axis.set_xlabel(x_name)
    axis.set_ylabel(y_name)


def _finite(row, score: str) -> bool:
    return row.status in DONE and math.isfinite(row.scores.get(score, math.nan))
