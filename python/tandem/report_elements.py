"""The charts of report.html for machine elements, driven joints and sensors, and those that output.plots chooses."""
import fnmatch
import html

import numpy as np

from tandem.end_labels import label_ends
from tandem.report_charts import COLOURS, MOST_CHARTS, MOST_LINES, lines_chart, plt, svg, thinned, widen

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
PANELS_IN_A_ROW = 3


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


def short(channel, title):
    """'supply' for supply_power in the panel 'power', 'a' for flow_a in 'flow'; 'power' itself stays."""
    words = [word for word in channel.split("_") if word not in title.split()]
    return " ".join(words) or channel


def element_chart(name, kind, channels, time):
    """The channels of one element, each kind of quantity in a panel of its own."""
    panels = []
    for title, wanted in PANELS:
        lines = [(channel, *channels[channel]) for channel in channels if channel.partition(".")[0] in wanted]
        lines = [line for line in lines if np.any(line[2])] or lines[:1]
        if lines:
            panels.append((title, lines[:MOST_LINES]))
    columns = 2 if len(panels) in (2, 4) else PANELS_IN_A_ROW
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(11, 2.4 * rows), layout="constrained", squeeze=False)
    for panel, (title, lines) in zip(axes.flat, panels):
        for channel, _, values in lines:
            panel.plot(*thinned(time, values), label=channel)
        panel.set_title(title, fontsize=9)
        panel.set_ylabel(f"[{lines[0][1]}]")
        panel.set_xlabel("time [s]")
        panel.margins(x=0.01)
        widen(panel, [values for _, _, values in lines])
        if len(lines) > 1:
            label_ends(panel, [(short(channel, title), values, COLOURS[i % len(COLOURS)]) for i, (channel, _, values) in enumerate(lines)], 1.6, 7)
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
