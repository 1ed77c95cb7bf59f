"""Charts of results."""
import io
from typing import List, Optional

from tandem.end_labels import label_ends
from tandem.signals import Signal

COLOURS = ["#2f5d8a", "#d9822b", "#3f8f5f", "#a4508b", "#7a6a4f", "#b03a3a", "#4f8f9f", "#8a8a2f"]
HUES = ["#0072b2", "#d55e00", "#009e73", "#a4508b", "#7a6a4f", "#4f8f9f"]  # that readers who are colour-blind can tell apart [OkabeIto2008]
INK, GREY = "#4a525b", "#8a929b"  # of words and thin lines
STYLE = {"font.family": "sans-serif", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#9aa3ad",
         "axes.labelcolor": "#4a525b", "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.grid": True,
         "grid.color": "#e6e9ed", "grid.linewidth": 0.8, "xtick.color": "#6a737d", "ytick.color": "#6a737d", "legend.frameon": False,
         "lines.linewidth": 1.3}


def figure(rows: int, width: float = 7.5, height: float = 2.4, columns: int = 1):
    """A figure with subplots, without a window, that notebooks show."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    class Chart(Figure):
        """A figure that notebooks show without %matplotlib."""

        def _repr_png_(self) -> bytes:
            return png(self)

    with matplotlib.rc_context(STYLE):
        made = Chart(figsize=(width * columns, 0.6 + height * rows), layout="constrained")
        FigureCanvasAgg(made)
        axes = made.subplots(rows, columns, squeeze=False)
    return made, axes


def chart(signals: List[Signal], file: Optional[str] = None, title: str = "", status: str = ""):
    """One chart for each unit, with a line for each signal or component."""
    groups: dict = {}
    for signal in signals:
        groups.setdefault(signal.unit, []).append(signal)
    made, axes = figure(len(groups))
    for axis, (unit, members) in zip(axes[:, 0], groups.items()):
        lines = []
        for signal in members:
            lines += [(signal.name, signal.time, signal.values)] if signal.values.ndim == 1 else [
                (f"{signal.name}.{name}", signal.time, signal.values[:, i]) for i, name in enumerate(signal.axes)]
        for i, (name, time, values) in enumerate(lines):
            axis.plot(time, values, color=COLOURS[i % len(COLOURS)], linestyle="-" if i < len(COLOURS) else "--", label=name, linewidth=1.3)
        axis.set_ylabel(f"[{unit}]" if unit else "")
        axis.margins(x=0)
        label_ends(axis, [(name, values, COLOURS[i % len(COLOURS)]) for i, (name, _, values) in enumerate(lines)], 1.9)
        if axis is not axes[-1, 0]:
            axis.tick_params(labelbottom=False)
    axes[-1, 0].set_xlabel("time [s]")
    if title:
        axes[0, 0].set_title(title + (f" ({status})" if status not in ("", "ok") else ""), loc="left", fontsize=10, fontweight="bold")
    if file:
        made.savefig(file, dpi=150)
    return made


def png(made) -> bytes:
    """A figure as PNG."""
    held = io.BytesIO()
    made.savefig(held, format="png", dpi=110)
    return held.getvalue()
