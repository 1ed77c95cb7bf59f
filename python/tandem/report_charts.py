"""The charts of report.html, as SVG."""
import io
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402 (of the back end above)
import numpy as np  # noqa: E402

from tandem.end_labels import label_ends  # noqa: E402
from tandem.plots import COLOURS, STYLE  # noqa: E402
from tandem.report_input import groups  # noqa: E402

MOST_CHARTS = 8  # of one kind; bodies and joints that move most are first
MOST_LINES = 8  # in one chart
MOST_POINTS = 1500  # of one line
AXES_HEIGHT = 1.9  # of a chart that is 2.6 high [inch]

plt.rcParams.update({
    **STYLE, "svg.fonttype": "none", "svg.hashsalt": "tandem", "axes.prop_cycle": plt.cycler(color=COLOURS), "lines.linewidth": 1.4,
    "axes.formatter.limits": (-3, 6), "axes.formatter.useoffset": False, "figure.facecolor": "none", "axes.facecolor": "none"})


def thinned(time, values):
    """Lowest and highest value of each of MOST_POINTS/2 intervals, so that peaks remain visible."""
    if len(time) <= MOST_POINTS:
        return time, values
    keep = set()
    for part in np.array_split(np.arange(len(time)), MOST_POINTS // 2):
        keep.update((part[np.argmin(values[part])], part[np.argmax(values[part])]))
    keep = sorted(keep)
    return time[keep], values[keep]


def svg(figure):
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    plt.close(figure)
    # Printing programs do not all know the short form "font: 700 9px ...".
    spelt = re.sub(r"font: (?:(\d+) )?([\d.]+px) ([^;\"]*)",
                   lambda m: f"font-weight: {m[1] or 400}; font-size: {m[2]}; font-family: {m[3]}", text.getvalue())
    return spelt[spelt.index("<svg"):]


def widen(axes, lines):
    """Constant values get an axis that has 0: a line in the middle of a magnified axis would look like a change."""
    low, high = min(np.min(values) for values in lines), max(np.max(values) for values in lines)
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        axes.set_ylim(min(0, 1.3 * low), max(0, 1.3 * high) or 1)


def chart(title, unit, time, lines, log=False):
    """One chart; lines: (label, values)."""
    figure, axes = plt.subplots(figsize=(5.4, 2.6), layout="constrained")
    for label, values in lines:
        noisy = np.abs(np.diff(values)).sum() > 20 * max(np.ptp(values), 1e-300)
        axes.plot(*thinned(time, values), label=label, linewidth=0.6 if noisy else None)
    if log:
        axes.set_yscale("log")
    axes.set_title(title)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(unit)
    axes.margins(x=0.01)
    if len(lines) > 1 or lines[0][0]:
        label_ends(axes, [(label, values, COLOURS[i % len(COLOURS)]) for i, (label, values) in enumerate(lines)], AXES_HEIGHT)
    return svg(figure)


def charts_of(columns, suffix, unit, title):
    """A chart with x, y, z for each owner of NAME.suffix whose signal is not constant; and a note on what is not shown."""
    time = columns.get("time")
    found = []
    for name in groups(columns, suffix + ".x"):
        lines = [(axis, columns[f"{name}.{suffix}.{axis}"]) for axis in "xyz"]
        span = max(np.ptp(values) for _, values in lines)
        if span > 0:
            found.append((span, name, lines))
    return shown(found, lambda name, lines: chart(f"{name}: {title}", unit, time, lines))


def shown(found, draw):
    kept = sorted(found, key=lambda entry: -entry[0])[:MOST_CHARTS]
    out = [draw(*entry[1:]) for entry in kept]
    if len(found) > len(kept):
        out.append(f"<p class=note>{len(found) - len(kept)} more with smaller signals are in the CSV file.</p>")
    return out


def joint_charts(joints, units):
    """Coordinates of the joints that have one; units: by joint."""
    found = [(np.ptp(joints[name + ".q"]), name, joints[name + ".q"]) for name in groups(joints, "q")
             if np.ptp(joints[name + ".q"]) > 0]
    return shown(found, lambda name, q: chart(f"{name}: coordinate", f"[{units.get(name, 'rad or m')}]", joints["time"], [("", q)]))


def lines_chart(title, unit, lines):
    """One chart; lines: (column, time, values)."""
    figure, axes = plt.subplots(figsize=(5.4, 2.6), layout="constrained")
    for column, time, values in lines:
        axes.plot(*thinned(time, values), label=column)
    axes.set_title(lines[0][0] if len(lines) == 1 else title)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(unit)
    axes.margins(x=0.01)
    widen(axes, [values for _, _, values in lines])
    if len(lines) > 1:
        label_ends(axes, [(column, values, COLOURS[i % len(COLOURS)]) for i, (column, _, values) in enumerate(lines)], AXES_HEIGHT, 7.5)
    return svg(figure)


def window_charts(windows):
    time = windows.get("time")
    kinds = [("Kinetic energy of the particles", "[J]", {"kinetic_energy": "", "liquid_kinetic_energy": "liquid"}, False),
             ("Contacts between spheres", "", {"contacts": ""}, False),
             ("Largest overlap so far", "of the radius", {"max_overlap_ratio": ""}, False),
             ("Micro steps per window", "", {"micro_steps": ""}, False),
             ("Work on the bodies", "[J]", {"energy_exchanged": "exchanged", "energy_created": "created"}, False),
             ("Residuals of impulse and momentum", "relative", {"impulse_closure": "impulse", "momentum_balance": "momentum"}, True),
             ("Particles lost", "", {"lost_particles": ""}, False)]
    out = []
    for title, unit, names, log in kinds:
        lines = []
        for name, label in names.items():
            values = windows.get(name)
            if values is None or not np.isfinite(values).any() or not np.any(values):
                continue
            if any(np.array_equal(values, other) for _, other in lines):  # the liquid is all that there is
                continue
            lines.append((label, np.where(values > 0, values, np.nan) if log else values))
        if lines and (len(lines) > 1 or log or np.ptp(lines[0][1]) > 0):
            out.append(chart(title, unit, time, lines, log))
    return out


def time_bar(summary):
    split = {name: seconds for name, seconds in summary.get("time_split", {}).items() if seconds and seconds > 0}
    wall = summary.get("wall_s") or 0
    rest = wall - sum(split.values())
    if rest > 0.005 * wall:
        split["rest"] = rest
    total = sum(split.values())
    if total <= 0:
        return ""
    figure, axes = plt.subplots(figsize=(11, 1.0), layout="constrained")
    left = 0
    for (name, seconds), colour in zip(split.items(), COLOURS[:len(split) - ("rest" in split)] + ["#c6ccd2"]):
        axes.barh(0, seconds, left=left, color=colour, height=0.8, label=f"{name} {seconds:.3g} s ({seconds / total:.1%})")
        left += seconds
    axes.set_xlim(0, total)
    axes.axis("off")
    axes.legend(ncols=len(split), loc="upper left", bbox_to_anchor=(0, -0.05), handlelength=1, borderaxespad=0)
    return f"<h2>Where the wall time went</h2>{svg(figure)}"
