#!/usr/bin/env python3
"""What it costs that a run keeps its last windows: two builds in turn on a coupled run of many small windows.

usage: last_windows.py WITHOUT WITH OUT.csv [PAIRS]     folders of programs without and with it; a row for each run
"""
import csv
import datetime
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

SCENE = pathlib.Path(__file__).resolve().parents[2] / "system/scenes/hanging_box.json"
WINDOWS = 20_000


def run(programs, scene, out):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([programs / "tandem", "run", scene, "--out", out, "--threads", "1", "--no-picture", "--no-report", "--quiet"],
                   check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = json.loads((out / "summary.json").read_text())
    return {"windows": summary["windows"], "wall_seconds": summary["wall_s"],
            "exchange_seconds": summary["time_split"]["exchange"],
            "cpu_seconds": round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 3),
            "dem_state_hash": summary["dem_state_hash"]}


def main():
    builds = {"without": pathlib.Path(sys.argv[1]), "with": pathlib.Path(sys.argv[2])}
    scene = json.loads(SCENE.read_text())
    scene["dem"]["particles"][0]["fill"]["count"] = 2
    scene["coupling"]["window"] = 1e-5
    scene["end_time"] = 1e-5 * WINDOWS
    scene["output"] = {"frame_interval": scene["end_time"]}
    scene["checks"] = []
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "scene.json"
        file.write_text(json.dumps(scene))
        for pair in range(int(sys.argv[4]) if len(sys.argv) > 4 else 10):
            order = list(builds) if pair % 2 == 0 else list(builds)[::-1]
            for build in order:
                figures = run(builds[build], file, pathlib.Path(folder) / build)
                rows.append({"date": datetime.date.today().isoformat(), "device": os.environ.get("DEVICE", os.uname().nodename),
                             "build": build, "pair": pair, **figures})
    with open(sys.argv[3], "w", newline="") as table:
        writer = csv.DictWriter(table, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    for figure in ("wall_seconds", "exchange_seconds", "cpu_seconds"):
        values = {build: sorted(row[figure] for row in rows if row["build"] == build) for build in builds}
        middle = {build: found[len(found) // 2] for build, found in values.items()}
        print(f"{figure}: without {middle['without']:.4g}, with {middle['with']:.4g}; least {values['without'][0]:.4g}, {values['with'][0]:.4g}")


if __name__ == "__main__":
    main()
