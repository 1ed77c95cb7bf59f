#!/usr/bin/python3
"""Writes report.html, one self-contained page about a finished run: report.py FOLDER.

Reads summary.json, bodies.csv, joints.csv, elements.csv, sensors.csv, windows.csv and picture.png of the folder; the page leaves out what a missing
file would show.
"""
import base64
import csv
import fnmatch
import html
import io
import itertools
import json
import math
import pathlib
import re
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

# Text and class by `status` of summary.json, and by `reason` where that is more specific (docs/verdict.md).
STATUS = {"ok": ("ok, all checks passed", "good"), "suspect": ("suspect", "warn"),
          "failed": ("failed", "bad"), "failed: checks": ("failed: a check failed", "bad"),
          "failed: interrupted": ("failed: interrupted", "bad"), "running": ("still running", "warn"),
          "died": ("died: its program ended without a word", "bad"),
          "running or died": ("running when this was written; tandem ps says whether it still is", "warn")}
COLOURS = ["#2f5d8a", "#d9822b", "#3f8f5f", "#a4508b", "#7a6a4f", "#b03a3a", "#4f8f9f", "#8a8a2f"]
MOST_CHARTS = 8  # of one kind; bodies and joints that move most are first
MOST_LINES = 8  # in one chart
MOST_POINTS = 1500  # of one line
MOST_ROWS = 100_000  # that are read of a file; of a longer file as many in all, at STRETCHES places
STRETCHES = 1000

plt.rcParams.update({
    "font.family": "sans-serif", "font.size": 9, "svg.fonttype": "none", "svg.hashsalt": "tandem",
    "axes.prop_cycle": plt.cycler(color=COLOURS), "axes.spines.top": False, "axes.spines.right": False,
    "axes.edgecolor": "#9aa3ad", "axes.labelcolor": "#4a525b", "axes.titlesize": 10, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.grid": True, "grid.color": "#e6e9ed", "grid.linewidth": 0.8,
    "xtick.color": "#6a737d", "ytick.color": "#6a737d", "legend.frameon": False, "lines.linewidth": 1.4,
    "axes.formatter.limits": (-3, 6), "axes.formatter.useoffset": False, "figure.facecolor": "none",
    "axes.facecolor": "none"})


# ---- input

def read_columns(file, notes=None):
    """Columns of a CSV file by name; a last line truncated by a crash is dropped. Empty without file or rows.

    Of a long file only stretches are read, so that any run has a report: `notes` gets a sentence about that.
    """
    if not file.exists():
        return {}
    with open(file, "rb") as lines:
        names = next(csv.reader([lines.readline().decode()]), [])
        begin, size = lines.tell(), file.stat().st_size
        if size <= begin:
            return {}
        many = (size - begin) / max(len(lines.readline()), 1)
        if many <= MOST_ROWS:
            places, each = [begin], None
        else:
            places, each = np.linspace(begin, size, STRETCHES, endpoint=False).astype(int), MOST_ROWS // STRETCHES
        rows, length = [], 0
        for place in places:
            lines.seek(place - 1)
            lines.readline()  # to the begin of the next row
            for line in itertools.islice(lines, each):
                cells = line.split(b",")
                if not line.endswith(b"\n") or len(cells) != len(names):
                    break
                rows.append(np.array(cells, dtype=float))
                length += len(line)
    if each and rows and notes is not None:
        notes.append(f"{file.name} has about {(size - begin) * len(rows) / length:.2g} rows: the charts show {each} in a row at each "
                     f"of {STRETCHES} places; what peaks in between is not in them.")
    return dict(zip(names, np.array(rows).T)) if rows else {}


def status_now(summary, folder):
    """The present `status`: `tandem ps` determines whether a run with the status `running` is still in progress."""
    if summary.get("status") != "running":
        return summary.get("status")
    tandem = pathlib.Path(__file__).parent / "../../bin/tandem"
    if not tandem.exists():
        return "running or died"
    said = subprocess.run([tandem, "ps", "--status", folder], capture_output=True, text=True, timeout=60)
    return said.stdout.strip() if said.returncode == 0 else "running or died"


def groups(columns, suffix):
    """The NAMEs of all columns NAME.suffix, in file order."""
    return [name[: -len(suffix) - 1] for name in columns if name.endswith("." + suffix)]


# ---- charts

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
    if lines[0][0]:
        axes.legend(ncols=len(lines), loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0.1,
                    handlelength=1, columnspacing=1, fontsize=8)
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


# ---- machine elements and driven joints

# Panels of an element, from left to right: title, and the channels that share its axis.
PANELS = [("torque", ("torque", "brake_torque")), ("force", ("force",)), ("tension", ("tension",)),
          ("speed", ("speed", "target_speed")), ("velocity", ("velocity",)), ("stroke", ("stroke", "target_stroke")),
          ("length and slack", ("length", "slack")), ("pressure", ("pressure_a", "pressure_b")), ("flow", ("flow_a", "flow_b")),
          ("friction", ("friction",)), ("normal force", ("normal_force",)), ("depth", ("depth",)), ("points", ("points",)),
          ("centre of pressure", ("centre",)),
          ("power", ("power", "supply_power", "loss_power")),
          ("energy", ("energy", "supply_energy", "stored_energy", "loss_energy")),
          ("mass", ("mass", "passed")), ("mass flow", ("flow",)), ("solid fraction", ("solid_fraction",)),
          ("momentum", ("momentum",)), ("kinetic energy", ("kinetic_energy",))]
# The first ones get charts first.
DRIVEN = ("motor", "actuator", "cylinder", "joint", "contact")
PANELS_IN_A_ROW = 4


def channels_of(listed, elements):
    """[(element, type, {channel with its part: (unit, values)})]; `listed`: elements or sensors of summary.json, in its order."""
    found = []
    for name, entry in (listed or {}).items():
        channels = {}
        for key, value in entry.items():
            for part, leaf in ({"": value} if "unit" in value else value).items() if isinstance(value, dict) else ():
                column = ".".join(filter(None, (name, key, part)))
                if column in elements:
                    channels[".".join(filter(None, (key, part)))] = (leaf["unit"], elements[column])
        if channels:
            found.append((name, entry.get("type", ""), channels))
    return found


def element_chart(name, kind, channels, time):
    """The channels of one element, each kind of quantity in a panel of its own."""
    panels = []
    for title, wanted in PANELS:
        lines = [(channel, *channels[channel]) for channel in channels if channel.partition(".")[0] in wanted]
        lines = [line for line in lines if np.any(line[2])] or lines[:1]
        if lines:
            panels.append((title, lines[:MOST_LINES]))
    rows = -(-len(panels) // PANELS_IN_A_ROW)
    figure, axes = plt.subplots(rows, PANELS_IN_A_ROW, figsize=(11, 2.35 * rows), layout="constrained", squeeze=False)
    for panel, (title, lines) in zip(axes.flat, panels):
        for channel, _, values in lines:
            panel.plot(*thinned(time, values), label=channel)
        panel.set_title(title, fontsize=9)
        panel.set_ylabel(f"[{lines[0][1]}]")
        panel.set_xlabel("time [s]")
        panel.margins(x=0.01)
        widen(panel, [values for _, _, values in lines])
        if len(lines) > 1:
            panel.legend(fontsize=7, loc="best", handlelength=1, labelspacing=0.2)
    for panel in list(axes.flat)[len(panels):]:
        panel.axis("off")
    kind = "" if kind == name else html.escape(kind.replace("_", " "))
    return f"<h3>{html.escape(name)} <span class=note>{kind}</span></h3>{svg(figure)}"


def element_charts(summary, elements):
    """Charts of the elements with the largest powers, driven ones first."""
    found = channels_of(summary.get("elements"), elements)
    # A joint that only loses energy says little about the machine.
    found = [entry for entry in found if entry[1] != "joint" or "power" in entry[2]] or found

    def rank(entry):
        _, kind, channels = entry
        powers = [np.abs(values).max() for channel, (_, values) in channels.items() if channel.endswith("power")]
        return kind not in DRIVEN, -max(powers, default=0)

    found.sort(key=rank)
    out = [element_chart(*entry, elements["time"]) for entry in found[:MOST_CHARTS]]
    if len(found) > len(out):
        out.append(f"<p class=note>{len(found) - len(out)} more are in elements.csv; output.plots of the scene chooses.</p>")
    return out


def sensor_charts(summary, sensors):
    found = channels_of(summary.get("sensors"), sensors)
    out = [element_chart(*entry, sensors["time"]) for entry in found[:MOST_CHARTS]]
    if len(found) > len(out):
        out.append(f"<p class=note>{len(found) - len(out)} more are in sensors.csv; output.plots of the scene chooses.</p>")
    return out


def chosen_charts(summary, files):
    """The charts of output.plots: one for each entry and unit."""
    units = {}
    for listed in ("elements", "sensors"):
        for name, _, channels in channels_of(summary.get(listed), files[listed]):
            units.update({f"{name}.{channel}": f"[{unit}]" for channel, (unit, _) in channels.items()})
    units.update({f"{name}.q": f"[{unit}]" for name, unit in (summary.get("joint_units") or {}).items()})
    units.update({f"{name}.rate": f"[{unit}/s]" for name, unit in (summary.get("joint_units") or {}).items()})
    by_quantity = {"position": "[m]", "orientation": "", "velocity": "[m/s]", "angular_velocity": "[rad/s]", "contact_force": "[N]",
                   "contact_torque": "[N m]", "reaction_force": "[N]", "reaction_torque": "[N m]"}
    out = []
    for pattern in summary.get("plots") or []:
        lines = {}
        for columns in files.values():
            for column in fnmatch.filter(columns, pattern):
                unit = units.get(column, by_quantity.get(column.split(".")[1], "") if "." in column else "")
                lines.setdefault(unit, []).append((column, columns["time"], columns[column]))
        for unit, all_of_them in lines.items():
            out.append(lines_chart(pattern, unit, all_of_them[:MOST_LINES]))
            if len(all_of_them) > MOST_LINES:
                out.append(f"<p class=note>{len(all_of_them) - MOST_LINES} more columns match {html.escape(pattern)}.</p>")
    return out


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
        axes.legend(fontsize=7, loc="best", handlelength=1, labelspacing=0.2)
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


# ---- page

def number(value, digits=6):
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}".replace(",", "\u202f")
    if not isinstance(value, float):
        return str(value)
    if 1e5 <= abs(value) < 1e15:
        return number(round(value, digits - 1 - math.floor(math.log10(abs(value)))).__int__())
    return f"{value:.{digits}g}"


def table(head, rows, classes=None, kind=""):
    out = f"<table class='{kind}'>"
    if head:
        out += "<tr>" + "".join(f"<th>{cell}</th>" for cell in head) + "</tr>"
    for i, row in enumerate(rows):
        style = f" class={classes[i]}" if classes else ""
        out += f"<tr{style}>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>"
    return out + "</table>"


def key_figures(summary):
    def text(key, unit=""):
        value = summary.get(key)
        return None if value is None or value == "" else html.escape(number(value, 4)) + unit

    def joined(*keys):
        return ", ".join(filter(None, map(text, keys))) or None

    def estimate(key, unit):
        return "not estimated" if isinstance(summary.get(key), str) else text(key, unit)

    rows = [("Spheres", text("spheres") if summary.get("spheres") else None), ("Bodies", text("bodies")),
            ("Particles computed on", joined("backend", "device")), ("Variant", joined("variant", "precision")),
            ("Scheme, window", ", ".join(filter(None, (text("scheme"), text("window_s", " s"))))),
            ("Transport, protocol", joined("transport", "protocol")),
            ("Simulated", text("simulated_s", " s")), ("Windows", text("windows")), ("Micro steps", text("micro_steps") if summary.get("micro_steps") else None),
            ("Wall time", text("wall_s", " s")), ("Per micro step", text("us_per_micro_step", " µs")),
            ("Sphere steps", text("sphere_steps_per_s", " /s")),
            ("Impulse closure", text("impulse_closure")),
            ("Impulse outstanding", text("impulse_outstanding") if summary.get("impulse_outstanding") else None),
            ("Momentum balance of the particles", text("momentum_balance")),
            ("Energy residual of the coupling", text("energy_residual")), ("Degrees of freedom", text("dof")),
            ("Constraint violation", text("constraint_violation")),
            ("Error of positions (estimate)", estimate("mbd_position_error_estimate", " of the size")),
            ("Error of energy (estimate)", estimate("mbd_energy_error_estimate_J", " J")),
            ("Largest overlap", text("max_overlap_ratio", " of the radius")), ("Lost particles", text("lost_particles") if summary.get("spheres") else None),
            *liquid_rows(summary.get("sph") or {}),
            ("State hash", text("state_hash")), ("Program", text("version"))]
    return table(None, [row for row in rows if row[1]])


def liquid_rows(sph):
    def text(key, unit=""):
        return None if sph.get(key) is None else (number(sph[key]) if isinstance(sph[key], (int, float)) else str(sph[key])) + unit

    return [("Particles of the liquid", text("particles")), ("Speed of sound", text("sound_speed_m_per_s", " m/s")),
            ("Density error of the liquid", text("density_error")), ("Mach number of the liquid", text("mach")),
            ("Momentum balance of the liquid", text("momentum_balance")),
            ("Residual of the energy of the liquid", text("energy_residual_J", " J"))]


def checks_table(summary):
    checks = summary.get("checks")
    if summary.get("status") in ("failed", "running") and summary.get("reason") != "checks":
        return "<p class=note>Checks are about a whole run; this one did not reach its end.</p>"
    if not checks:
        return "<p class=note>No checks were evaluated.</p>"
    rows = []
    for check in checks:
        relative = "" if check.get("absolute") else " relative"
        signal = html.escape(str(check.get("of", "")))
        if not signal.startswith("summary."):
            signal = f"{html.escape(str(check.get('reduce', '')))} of {signal}"
        rows.append((f"{html.escape(check['name'])}<div class=note>{signal}<br>{html.escape(check.get('why') or '')}</div>",
                     number(check["value"]), number(check["expected"]), number(check["error"]) + relative,
                     number(check["tolerance"]) + relative, "passed" if check["passed"] else "FAILED"))
    return table(("check", "value", "expected", "error", "tolerance", ""), rows,
                 ["good" if check["passed"] else "bad" for check in checks], "checks")


def items(title, texts):
    if not texts:
        return ""
    return f"<h2>{title}</h2><ul>" + "".join(f"<li>{html.escape(str(text))}</li>" for text in texts) + "</ul>"


def section(title, pieces, kind=""):
    if not pieces:
        return ""
    return f"<h2>{title}</h2><div class='charts {kind}'>" + "".join(f"<div>{piece}</div>" for piece in pieces) + "</div>"


def error_box(summary):
    """The error that ended the run, and the time that it had reached."""
    error = summary.get("error")
    if not error:
        return ""
    where = f"<div>in {html.escape(error['where'])}</div>" if error.get("where") else ""
    hint = f"<div>What to do: {html.escape(error['hint'])}</div>" if error.get("hint") else ""
    return (f"<div class=error><b>{html.escape(error.get('what', ''))}</b>{where}{hint}"
            f"<div class=note>kind of error: {html.escape(str(error.get('code', '')))}; what follows ends at t = "
            f"{number(summary.get('simulated_s') or 0)} s of {number(summary.get('end_time_s'))} s</div></div>")


def verdict_box(summary):
    """The rules that object, with the value to use instead."""
    lines = (summary.get("verdict") or {}).get("lines")
    if not lines:
        return ""
    rows = "".join(f"<li><b>{html.escape(line['rule'])}</b>: {html.escape(line['sentence'])}</li>" for line in lines)
    title = "What makes this run suspect" if summary.get("status") == "suspect" else "What the verdict objects to besides"
    return f"<div class=suspect><b>{title}</b><ul>{rows}</ul></div>"


def undetermined_reactions(summary, joints):
    """Joints whose reactions rigid mechanics determines only in part: at the start, or at any instant of joints.csv."""
    names = [f"{kind}.{axis}" for kind in ("force", "torque") for axis in "xyz"]
    found = {entry["joint"]: set(entry["components"]) for entry in summary.get("mbd_undetermined_reactions") or []}
    for joint in groups(joints, "undetermined"):
        bits = int(np.bitwise_or.reduce(joints[joint + ".undetermined"].astype(int)))
        if bits:
            found.setdefault(joint, set()).update(name for i, name in enumerate(names) if bits >> i & 1)
    if not found:
        return ""
    rows = [(html.escape(joint), ", ".join(name for name in names if name in parts)) for joint, parts in found.items()]
    most = 40
    more = f"<p class=note>{len(rows) - most} more are in summary.json.</p>" if len(rows) > most else ""
    return ("<h2>Reactions that rigid mechanics does not determine</h2><p class=note>These joints share loads with others, and only their "
            "elasticity tells which one bears what. Their components below are one choice of many, the smallest; do not "
            "size a bearing by them. All other components are determined. Columns NAME.undetermined of joints.csv mark them "
            "at each instant.</p>" + table(("joint", "components (world axes)"), rows[:most], kind="joints") + more)


def verdict_note(summary):
    """The rules that were judged, and what was not judged."""
    verdict = summary.get("verdict") or {}
    if not verdict.get("judged") and not verdict.get("not_judged"):
        return ""
    judged = "No rule was judged."
    if verdict.get("judged"):
        objects = "" if verdict.get("lines") else " None of them objects."
        judged = f"Rules that were judged: {', '.join(verdict['judged'])}.{objects}"
    others = "".join(f"<li>{html.escape(text)}</li>" for text in verdict.get("not_judged") or [])
    return (f"<h2>Verdict</h2><p class=note>{html.escape(judged)}</p>" +
            (f"<p class=note>Not judged:</p><ul class=note>{others}</ul>" if others else ""))


def paraview(folder):
    files = [name for name in ("particles.xdmf", "liquid.xdmf", "bodies.xdmf") if (folder / name).exists()]
    if not files:
        return ""
    commands = "\n".join(f"paraview {html.escape(str((folder / name).resolve()))}" for name in files)
    particles = "Show particles as Point Gaussian with the scale array “radius”, coloured by “speed”."
    return (f"<h2>Look around in ParaView</h2><pre>{commands}</pre><p class=note>Choose “Xdmf3 Reader S”. "
            f"{particles if {'particles.xdmf', 'liquid.xdmf'} & set(files) else ''}</p>")


STYLE = """
body{font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;color:#22272e;background:#f4f6f8;margin:0}
main{max-width:1120px;margin:0 auto;padding:28px 32px 60px;background:#fff;box-shadow:0 0 24px #0001;min-height:100vh;box-sizing:border-box}
h1{font-size:27px;margin:0}h2{font-size:17px;margin:34px 0 10px;padding-bottom:4px;border-bottom:1px solid #e3e7eb}
header{display:flex;align-items:center;gap:16px;margin-bottom:20px}
.status{padding:3px 12px;border-radius:14px;font-weight:600;font-size:14px;color:#fff}
.status.good{background:#2f855a}.status.bad{background:#b83232}.status.warn{background:#b7791f}
.top{display:grid;grid-template-columns:minmax(0,1.35fr) minmax(0,1fr);gap:26px;align-items:start}
.top.plain{grid-template-columns:1fr}
.top img{width:100%;border-radius:8px;display:block}
table{border-collapse:collapse;width:100%;font-size:14px}
td,th{text-align:left;padding:3px 12px 3px 0;border-bottom:1px solid #edf0f3;vertical-align:top;overflow-wrap:break-word}
th{color:#6a737d;font-weight:600}td+td{font-variant-numeric:tabular-nums}
.checks td+td,.checks th{white-space:nowrap}.joints td:first-child{white-space:nowrap;width:1%}
.figures td:first-child{color:#6a737d;white-space:nowrap}
tr.good td:last-child{color:#2f855a;font-weight:600}tr.bad td:last-child{color:#b83232;font-weight:700}
.suspect{background:#fdf6e3;border-left:4px solid #b7791f;padding:12px 16px;margin:0 0 22px}.suspect ul{margin:6px 0 0;padding-left:20px}
.note{color:#6a737d;font-size:13px}.error{background:#fdecec;border-left:4px solid #b83232;padding:12px 16px;margin:0 0 22px}.error b{font-size:16px}
.charts{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:18px 26px}svg{width:100%;height:auto;display:block}
h3{font-size:14px;margin:0 0 4px}.charts.wide{grid-template-columns:1fr}
pre{background:#f4f6f8;padding:10px 14px;border-radius:6px;overflow-x:auto;font-size:13px}summary{cursor:pointer;color:#6a737d}
li{margin:2px 0}@media(max-width:800px){.top,.charts{grid-template-columns:1fr}}
@media print{.top{display:block}.top img{max-width:60%}table{font-size:11px;margin-bottom:18px}.note{font-size:10px}.checks td+td,.checks th{white-space:normal}body{background:#fff;font-size:12px}main{box-shadow:none;max-width:none;padding:0}.charts>div,tr,.suspect,.error{break-inside:avoid}
h2,h3{break-after:avoid}details,.screen{display:none}}@page{size:A4;margin:14mm}
"""


def page(folder):
    summary = json.loads((folder / "summary.json").read_text())
    notes = []
    files = {name: read_columns(folder / f"{name}.csv", notes) for name in ("bodies", "joints", "elements", "sensors", "windows")}
    bodies, joints, elements, sensors, windows = files.values()
    name = html.escape(str(summary.get("scene", folder.resolve().name)))
    word = status_now(summary, folder)
    fallback = STATUS.get(word, (str(word), "warn"))
    status, colour = STATUS.get(f"{word}: {summary.get('reason')}", fallback)
    if word == "ok" and not summary.get("checks"):
        status = "ok"
    picture = folder / "picture.png"
    image = ""
    if picture.exists():
        data = base64.b64encode(picture.read_bytes()).decode()
        image = f'<img alt="last frame" src="data:image/png;base64,{data}">'
    time = summary.get("simulated_s")
    colours = "; spheres coloured by speed" if any((folder / name).exists() for name in ("particles.xdmf", "liquid.xdmf")) else ""
    caption = f"<p class=note>Last frame, t = {number(time)} s{colours}.</p>" if image else ""
    checks = f"<h2>Checks</h2>{checks_table(summary)}"
    description = f"<p>{html.escape(summary['description'])}</p>" if summary.get("description") else ""
    return "".join((
        f"<!doctype html><html lang=en><meta charset=utf-8><title>{name}: {html.escape(status)}</title>",
        f"<style>{STYLE}</style><main>",
        f'<header><h1>{name}</h1><span class="status {colour}">{html.escape(status)}</span></header>',
        error_box(summary), verdict_box(summary), description,
        f'<div class="top{"" if image else " plain"}">',
        f"<div>{image}{caption}{checks}</div>" if image else "",
        f"<div class=figures>{key_figures(summary)}</div></div>",
        "" if image else checks,
        items("Warnings", summary.get("warnings")), verdict_note(summary), *(f"<p class=note>{html.escape(note)}</p>" for note in notes),
        section("Plots of the scene", chosen_charts(summary, {name: files[name] for name in ("bodies", "joints", "elements", "sensors")})),
        *((section("Machine elements and driven joints", element_charts(summary, elements), "wide"),
           section("Sensors of the particles", sensor_charts(summary, sensors), "wide"),
           section("Positions", charts_of(bodies, "position", "[m]", "position")),
           section("Joints", joint_charts(joints, summary.get("joint_units") or {}))) if not summary.get("plots") else ()),
        undetermined_reactions(summary, joints),
        section("Contact forces", charts_of(bodies, "contact_force", "[N]", "contact force")),
        section("Particles, and the balances of both solvers", window_charts(windows)),
        time_bar(summary),
        items("Left out, because this scene does not need it", summary.get("left_out")),
        paraview(folder),
        "<h2 class=screen>summary.json</h2><details><summary>all keys</summary>",
        f"<pre>{html.escape(json.dumps(summary, indent=2, ensure_ascii=False))}</pre></details></main></html>\n"))


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    if not (folder / "summary.json").exists():
        sys.exit(f"{folder}: no summary.json; give the folder of a finished run")
    draft = folder / "report.html.new"
    draft.write_text(page(folder), encoding="utf-8")
    draft.replace(folder / "report.html")


if __name__ == "__main__":
    main()
