#!/usr/bin/env python3
"""Draws docs/images/study_NAME.png from tests/benchmark/results/study_NAME.csv and its file in launch/studies: study_pictures.py [NAME...]

Needs no run. `--out DIR` puts the pictures elsewhere. 160 colours keep the installed folder small. After a run of the study,

    study_pictures.py NAME --record FOLDER --commit HASH --device WORDS

makes the CSV file anew from FOLDER, the --out of `tandem study`, and then draws.
"""
import argparse
import csv
import datetime
import io
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))

from PIL import Image  # noqa: E402 (matplotlib brings it)

from tandem.study_data import Study  # noqa: E402
from tandem.study_picture import figure_of  # noqa: E402

WANTED = {"pendulum": {"energy": 5e-5}, "spring_box": {"position": 1e-4}, "waterfall": {"energy": 0.01}, "mbd_four_bars": {"multipliers": 1e-3},
          "mbd_squeezer": {"angles": 1e-5}, "mbd_heavy_top": {"position": 1e-5}}


def study(name: str) -> Study:
    file = ROOT / "launch/studies" / (name.replace("mbd_", "mbd/") + ".json")
    described = json.loads(file.read_text())
    with open(ROOT / f"tests/benchmark/results/study_{name}.csv", newline="") as lines:
        rows = list(csv.DictReader(lines))
    measures = [{**measure, "want": WANTED.get(name, {}).get(measure["name"])} for measure in described["measures"]]
    return Study({"name": described["name"], "measures": measures, "settings": [sweep["of"] for sweep in described["sweep"]],
                  "line": described.get("order_in", ""), "repeat": int(rows[0].get("timings") or 1)}, rows)


# Columns of results.csv that are kept, besides settings, errors and times.
KEPT = ("mbd_cpu_s", "dem_cpu_s", "wall_s", "mbd_s", "dem_s", "exchange_s", "output_s", "simulated_s", "windows", "micro_steps", "mbd_steps",
        "energy_residual", "impulse_closure", "constraint_violation", "max_overlap_ratio", "state_hash", "problem")


def record(name: str, folder: pathlib.Path, commit: str, device: str) -> None:
    """study_NAME.csv from results.csv of the folder; columns without any value are left out."""
    with open(folder / "results.csv", newline="") as lines:
        rows = list(csv.DictReader(lines))
    columns = list(rows[0])
    first = columns[:columns.index("front")] + ["cpu_s", "cpu_low_s", "cpu_high_s"]
    used = first + [column for column in KEPT if any(row[column] for row in rows)]
    file = f"launch/studies/{name.replace('mbd_', 'mbd/')}.json"
    about = {"date": datetime.date.today().isoformat(), "commit": commit, "device": device, "command": f"tandem study {file} --jobs 1",
             "timings": json.loads((folder / "plot.json").read_text())["repeat"]}
    with open(ROOT / f"tests/benchmark/results/study_{name}.csv", "w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow([*about, *used])
        writer.writerows([*about.values(), *(row[column] for column in used)] for row in rows)


def main() -> None:
    known = sorted(path.stem.partition("_")[2] for path in (ROOT / "tests/benchmark/results").glob("study_*.csv"))
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=known, metavar="NAME")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs/images")
    parser.add_argument("--record", type=pathlib.Path)
    parser.add_argument("--commit")
    parser.add_argument("--device")
    options = parser.parse_args()
    if options.record:
        if len(options.names) != 1 or not options.commit or not options.device:
            parser.error("--record needs one NAME, --commit and --device")
        record(options.names[0], options.record, options.commit, options.device)
    for name in options.names:
        drawn, picture = io.BytesIO(), options.out / f"study_{name}.png"
        figure_of(study(name))[0].savefig(drawn, format="png", metadata={"Software": None})
        Image.open(drawn).convert("RGB").quantize(160, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(picture, optimize=True)
        print(picture)


if __name__ == "__main__":
    main()
