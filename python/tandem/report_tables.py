"""Texts and tables of report.html."""
import html
import math

import numpy as np

from tandem.report_input import groups


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
    title = "What makes this run suspect" if summary.get("status") == "suspect" else "Other findings"
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
        objects = "" if verdict.get("lines") else " All of them passed."
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
