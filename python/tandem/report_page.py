"""report.html, one self-contained page about a finished run, from the files of its folder; the page leaves out what a missing file would show."""
import base64
import html
import json
import pathlib

from tandem.report_charts import charts_of, joint_charts, time_bar, window_charts
from tandem.report_elements import chosen_charts, element_charts, sensor_charts
from tandem.report_input import read_columns, status_now
from tandem.report_tables import (checks_table, error_box, items, key_figures, number, paraview, section, undetermined_reactions, verdict_box,
                                  verdict_note)

# Text and class by `status` of summary.json, and by `reason` where that is more specific (docs/verdict.md).
STATUS = {"ok": ("ok, all checks passed", "good"), "suspect": ("suspect", "warn"),
          "failed": ("failed", "bad"), "failed: checks": ("failed: a check failed", "bad"),
          "failed: interrupted": ("failed: interrupted", "bad"), "running": ("still running", "warn"),
          "died": ("died: its program ended without a word", "bad"),
          "running or died": ("running when this was written; tandem ps says whether it still is", "warn")}

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


def page(folder, tandem):
    summary = json.loads((folder / "summary.json").read_text())
    notes = []
    files = {name: read_columns(folder / f"{name}.csv", notes) for name in ("bodies", "joints", "elements", "sensors", "windows")}
    bodies, joints, elements, sensors, windows = files.values()
    name = html.escape(str(summary.get("scene", folder.resolve().name)))
    word = status_now(summary, folder, tandem)
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


def write(folder: pathlib.Path, tandem: pathlib.Path) -> None:
    """report.html of a folder with summary.json; `tandem` is the program's path."""
    draft = folder / "report.html.new"
    draft.write_text(page(folder, tandem), encoding="utf-8")
    draft.replace(folder / "report.html")
