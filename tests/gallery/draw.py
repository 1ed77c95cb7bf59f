#!/usr/bin/python3
"""Draws a picture of docs/gallery.md: a film's frame beside two charts of its run.

    tandem movie RUN --size 960x720 && ffmpeg -ss SECONDS -i RUN/movie.mp4 -frames:v 1 FRAME.png
    draw.py RUN FRAME.png OUT.png COLUMN[,COLUMN...]:UNIT COLUMN[,COLUMN...]:UNIT
"""
import io
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "python"))

from PIL import Image  # noqa: E402 (matplotlib brings it)

from tandem.end_labels import label_ends  # noqa: E402 (of the folder above)
from tandem.report_charts import COLOURS, plt, thinned  # noqa: E402
from tandem.report_input import read_columns  # noqa: E402

HEIGHT, CHARTS = 400, 420  # [pixels]
QUALITY = 70  # the installed documentation has these pictures


def shortened(names):
    """The words that all columns begin or end with, as a title, and the columns without them."""
    words, title = [name.split(".") for name in names], ""
    for end in (0, -1):
        while all(len(parts) > 1 for parts in words) and len({parts[end] for parts in words}) == 1:
            title += (" " if title else "") + words[0][end]
            words = [parts[1:] if end == 0 else parts[:-1] for parts in words]
    return title, [".".join(parts) for parts in words]


def drawn(columns, units, names):
    figure, axes = plt.subplots(figsize=(CHARTS / 100, HEIGHT / 200), dpi=100, layout="constrained")
    for name in names:
        time, values = thinned(columns["time"], columns[name])
        axes.plot(time, values, label=name, linewidth=1)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(units)
    axes.margins(x=0.01)
    title, shorts = shortened(names) if len(names) > 1 else (names[0], [])
    axes.set_title(title, fontsize=9)
    label_ends(axes, [(short, columns[name], COLOURS[i % len(COLOURS)]) for i, (short, name) in enumerate(zip(shorts, names))], 1.4)
    data = io.BytesIO()
    figure.savefig(data, format="png")
    plt.close(figure)
    return Image.open(data).convert("RGB")


def main():
    run, frame, out = map(pathlib.Path, sys.argv[1:4])
    columns = {}
    for file in ("bodies.csv", "joints.csv", "elements.csv", "sensors.csv"):
        if (run / file).exists():
            columns.update(read_columns(run / file))
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
