#!/usr/bin/python3
"""Draws study.png, error against processor time: study.py FOLDER.

Reads results.csv and plot.json of the folder. One panel per measure: a line joins the runs that differ in the step only;
the grey staircase is the front of runs that no other run improves, and its points are labelled; a ring marks a suspect run;
runs that diverged or ran out of time are at the upper edge, and at its left end if no time was recorded.
"""
import csv
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

COLOURS = ["#2f5d8a", "#d9822b", "#3f8f5f", "#a4508b", "#7a6a4f", "#b03a3a", "#4f8f9f", "#8a8a2f"]
MARKERS = "osD^vP*X"
DONE = ("ok", "suspect")  # statuses of completed runs

plt.rcParams.update({
    "font.family": "sans-serif", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
    "axes.edgecolor": "#9aa3ad", "axes.labelcolor": "#4a525b", "axes.titlesize": 10, "axes.titleweight": "bold",
    "axes.titlelocation": "left", "axes.grid": True, "grid.color": "#e6e9ed", "grid.linewidth": 0.8,
    "xtick.color": "#6a737d", "ytick.color": "#6a737d", "legend.frameon": False, "lines.linewidth": 1.2})


def short(row, settings):
    """'dem_first 0.001 5e-05': values only, in the order of the settings."""
    return " ".join(row[name] for name in settings)


def panel(axes, rows, plot, measure):
    column = "error_" + measure["name"]
    lines = [name for name in plot["settings"] if name != plot["line"]]
    first = list(dict.fromkeys(row[lines[0]] for row in rows)) if lines else []
    rest = list(dict.fromkeys(short(row, lines[1:]) for row in rows))

    def look(row):
        return {"color": COLOURS[first.index(row[lines[0]]) % len(COLOURS)] if lines else COLOURS[0],
                "marker": MARKERS[rest.index(short(row, lines[1:])) % len(MARKERS)], "markersize": 4.5}

    good = [row for row in rows if row["status"] in DONE and row[column] and float(row[column]) > 0]
    axes.set_xscale("log")
    axes.set_yscale("log")
    for label in dict.fromkeys(short(row, lines) for row in rows):
        series = [row for row in good if short(row, lines) == label]
        if series:
            if plot["line"]:
                series.sort(key=lambda row: float(row[plot["line"]]))
            axes.plot([float(row["cpu_s"]) for row in series], [float(row[column]) for row in series], alpha=0.85,
                      linestyle="-" if plot["line"] else "none", label=label or measure["name"], **look(series[0]))

    suspect = [row for row in good if row["status"] == "suspect"]
    if suspect:
        axes.plot([float(row["cpu_s"]) for row in suspect], [float(row[column]) for row in suspect], linestyle="none",
                  marker="o", markersize=9, markerfacecolor="none", markeredgecolor="#b7791f", label="suspect", zorder=1)

    front = sorted((row for row in good if measure["name"] in row["front"].split()), key=lambda row: float(row["cpu_s"]))
    if front:
        x, y = [float(row["cpu_s"]) for row in front], [float(row[column]) for row in front]
        axes.step(x, y, where="post", color="#9aa3ad", linewidth=5, alpha=0.35, zorder=0, label="front")
        for i, row in enumerate(front):
            # Of neighbours with nearly the same cost the best is named.
            if i + 1 == len(front) or x[i + 1] > 1.2 * x[i]:
                axes.annotate(short(row, plot["settings"]), (x[i], y[i]), xytext=(5, 4), color="#4a525b",
                              textcoords="offset points", fontsize=6.5)

    bad = [row for row in rows if row["status"] not in DONE]
    for row in bad:
        # The height has no meaning: the run has no error.
        time = float(row["cpu_s"] or 0)
        axes.plot(time if time > 0 else 0, 0.985, linestyle="none", clip_on=False,
                  transform=axes.get_xaxis_transform() if time > 0 else axes.transAxes,
                  **{**look(row), "marker": "x", "markersize": 6})
    if bad:
        kinds = list(dict.fromkeys(row["status"].replace("_", " ") for row in bad))
        axes.plot([], [], "x", color="#4a525b", label=f"{len(bad)} {' or '.join(kinds)}")
    axes.set_title(measure["name"])
    axes.set_xlabel("processor time of the solvers [s]")
    axes.set_ylabel("error" + (f" [{measure['unit']}]" if measure["unit"] else ""))


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    plot = json.loads((folder / "plot.json").read_text())
    with open(folder / "results.csv", newline="") as lines:
        rows = list(csv.DictReader(lines))
    count = len(plot["measures"])
    columns = min(count, 2)
    height = (count + columns - 1) // columns
    figure = plt.figure(figsize=(6.2 * columns + 2.4, 4.4 * height), layout="constrained")
    grid = figure.add_gridspec(height, columns + 1, width_ratios=[6.2] * columns + [2.4])
    entries = {}
    for i, measure in enumerate(plot["measures"]):
        axes = figure.add_subplot(grid[i // columns, i % columns])
        panel(axes, rows, plot, measure)
        entries.update({label: handle for handle, label in zip(*axes.get_legend_handles_labels())})
    legend = figure.add_subplot(grid[:, columns])
    legend.axis("off")
    names = [name for name in plot["settings"] if name != plot["line"]]
    legend.legend(entries.values(), entries.keys(), loc="upper left", fontsize=7, borderaxespad=0, alignment="left",
                  title="lines: " + (", ".join(names) or "one") + "\npoints: " + ", ".join(plot["settings"]),
                  title_fontsize=7)
    figure.suptitle(f"{plot['name']}: error against run time" +
                    (f"; lines vary {plot['line']}" if plot["line"] else ""), x=0.01, ha="left", fontsize=12, fontweight="bold")
    draft = folder / "study.png.new"
    figure.savefig(draft, format="png", dpi=130, metadata={"Software": None})
    draft.replace(folder / "study.png")


if __name__ == "__main__":
    main()
