"""Draws soften.png: error against wall time of the settings that `tandem soften` ran, with a panel for each result."""
import math
from typing import Optional

from tandem.axis_ticks import log_ticks, written
from tandem.plots import GREY, HUES, INK, figure

RED, STAR = "#b03a3a", "#d9822b"
MARKERS = "os"  # of moduli with the same colour


def draw(found, file: Optional[str] = None):
    """Points of one colour have one modulus; a ring is the stiff run, at its scatter; a star the setting that was chosen; crosses have a fault.
    Grey is the scatter, dotted the wanted error."""
    made, axes = figure(len(found.measures), width=7.2, height=3.4)
    divisors = sorted({each.setting.divisor for each in found.candidates})
    colour = {divisor: HUES[i % len(HUES)] for i, divisor in enumerate(divisors)}
    for axis, measure in zip(axes[:, 0], found.measures):
        _panel(axis, found, measure.of, colour)
    handles, names = axes[0, 0].get_legend_handles_labels()
    if handles:
        axes[0, 0].legend(handles, names, loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8, borderaxespad=0.6, frameon=False)
    if file:
        made.savefig(file, dpi=150)
    return made


def _panel(axis, found, name: str, colour) -> None:
    axis.set_xscale("log")
    axis.set_yscale("log")
    scatter = found.scatter[name]
    shown = [each for each in found.candidates if each.times and each.errors.get(name, 0) > 0]
    errors = [each.errors[name] for each in shown] + [found.wanted] + ([scatter] if scatter > 0 else [])
    times = [t for each in shown + [found.stiff] for t in each.times]
    for values, limit, ticked in ((times, axis.set_xlim, axis.xaxis), ([100 * e for e in errors], axis.set_ylim, axis.yaxis)):
        decades = max(math.log10(max(values) / min(values)), 0.3)
        low, high = min(values) / 10**(0.10 * decades), max(values) * 10**(0.14 * decades)
        limit(low, high)
        ticks, minor = log_ticks(low, high)
        ticked.set_ticks(ticks, [written(tick) for tick in ticks])
        ticked.set_ticks(minor, [""] * len(minor), minor=True)
    if scatter > 0:
        axis.axhspan(axis.get_ylim()[0], 100 * scatter, color="#eceff2", zorder=0)
        axis.plot(found.stiff.wall_s, 100 * scatter, linestyle="none", marker="o", markersize=7, markerfacecolor="white", markeredgecolor=INK,
                  label="stiff, at its scatter")
    axis.axhline(100 * found.wanted, color=GREY, linestyle=":", linewidth=1.2)
    axis.annotate(f"wanted {100 * found.wanted:.2g} %", (1, 100 * found.wanted), xycoords=("axes fraction", "data"), xytext=(-2, 2),
                  textcoords="offset points", ha="right", va="bottom", fontsize=8, color=GREY)
    for divisor, shade in colour.items():
        mine = [each for each in shown if each.setting.divisor == divisor]
        for faulty, marker in ((False, MARKERS[list(colour).index(divisor) // len(HUES) % len(MARKERS)]), (True, "x")):
            points = [(each.wall_s, 100 * each.errors[name]) for each in mine if bool(each.fault) == faulty]
            if points:
                axis.plot(*zip(*points), linestyle="none", marker=marker, markersize=5, color=RED if faulty else shade,
                          label=None if faulty else f"modulus / {divisor:g}", zorder=3)
        for each in mine:
            if len(each.times) > 1:
                axis.plot([min(each.times), max(each.times)], [100 * each.errors[name]] * 2, color=shade, linewidth=1, alpha=0.7, zorder=2)
    if found.chosen:
        x, y = found.chosen.wall_s, 100 * found.chosen.errors[name]
        if y > 0:
            axis.plot(x, y, linestyle="none", marker="*", markersize=15, color=STAR, markeredgecolor="white", zorder=5)
            axis.annotate(f"step {found.chosen.share:.2g}, {1e3 * found.chosen.setting.window:g} ms", (x, y), xytext=(8, -11),
                          textcoords="offset points", fontsize=8, color=INK, zorder=6,
                          bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8})
    if any(each.fault for each in shown):
        axis.plot([], [], linestyle="none", marker="x", markersize=5, color=RED, label="fault")
    axis.set_title(name)
    axis.set_xlabel("wall time [s]")
    axis.set_ylabel("error [%]")
