#!/usr/bin/python3
"""Draws a picture of docs/gallery.md: a film's frame beside two charts of its run.

    tandem movie RUN && ffmpeg -ss SECONDS -i RUN/movie.mp4 -frames:v 1 FRAME.png
    draw.py RUN FRAME.png OUT.png COLUMN[,COLUMN...]:UNIT COLUMN[,COLUMN...]:UNIT
"""
import importlib.util
import io
import pathlib
import sys

SOURCE = pathlib.Path(__file__).parents[2]
spec = importlib.util.spec_from_file_location("report", SOURCE / "launch/report/report.py")
report = importlib.util.module_from_spec(spec)
spec.loader.exec_module(report)

import matplotlib.pyplot as plt  # noqa: E402, after report.py has chosen its back end
from PIL import Image  # noqa: E402

HEIGHT, CHARTS = 400, 420  # [pixels]
QUALITY = 70  # the installed documentation has these pictures


def drawn(columns, units, names):
    figure, axes = plt.subplots(figsize=(CHARTS / 100, HEIGHT / 200), dpi=100, layout="constrained")
    for name in names:
        time, values = report.thinned(columns["time"], columns[name])
        axes.plot(time, values, label=name, linewidth=1)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(units)
    axes.margins(x=0.01)
    axes.legend(fontsize=8, loc="best")
    data = io.BytesIO()
    figure.savefig(data, format="png")
    plt.close(figure)
    return Image.open(data).convert("RGB")


def main():
    run, frame, out = map(pathlib.Path, sys.argv[1:4])
    columns = {}
    for file in ("bodies.csv", "joints.csv", "elements.csv", "sensors.csv"):
        if (run / file).exists():
            columns.update(report.read_columns(run / file))
    picture = Image.open(frame).convert("RGB")
    picture = picture.resize((round(picture.width * HEIGHT / picture.height), HEIGHT), Image.Resampling.LANCZOS)
    sheet = Image.new("RGB", (picture.width + CHARTS, HEIGHT), "white")
    sheet.paste(picture, (0, 0))
    for row, argument in enumerate(sys.argv[4:6]):
        names, _, unit = argument.partition(":")
        sheet.paste(drawn(columns, unit, names.split(",")), (picture.width, row * HEIGHT // 2))
    sheet.save(out, quality=QUALITY, optimize=True)
    print(f"{out}: {out.stat().st_size} bytes")


main()
