#!/usr/bin/env python3
"""What a window costs with a particle solver in Python: whole runs of one scene with one boundary body, in turn with
tandem's own solver (one sphere), an idle one in C and an idle one in Python.

usage: python_window.py SOURCES BIN CSV COMMIT DEVICE [PAIRS [WINDOWS]]

wall_us is the wall time of the window loop over the windows: both solvers, exchange, scheme, balances and output.
dem_us is the part in which the coordinator waits for the particle solver, its exchange included. Each is the median
over the pairs; least is the smallest.
"""
import csv
import datetime
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile


def scene(windows, step=1e-4):
    return {
        "tandem": "1.0", "name": "window", "end_time": windows * step, "coupling": {"scheme": "dem_first", "window": step},
        "mbd": {"bodies": [{"name": "plate", "mass": 1, "inertia": [1, 1, 1]}],
                "joints": [{"name": "slide", "type": "prismatic", "child": "plate", "position": [0, 0, 0], "axis": [1, 0, 0]}]},
        "dem": {"materials": [{"name": "m", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5, "friction": 0,
                               "spring_stiffness": 1000}],
                "contact": "hooke", "micro_step": step, "walls": [{"name": "w", "body": "plate", "material": "m", "shape": {
                    "type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
                "particles": [{"name": "p", "material": "m", "radius": 0.01, "fill": {
                    "type": "lattice", "lattice": "cubic", "min": [0, 0, 0.0099], "max": [0.02, 0.02, 0.03], "spacing": 0.02,
                    "count": 1}}],
                "domain": {"min": [-1, -1, -1], "max": [1, 1, 1]}},
        "output": {"frame_interval": windows * step}}


def main():
    if len(sys.argv) < 6:
        sys.exit(__doc__)
    sources, bin_, table, commit, device = sys.argv[1:6]
    pairs, windows = int(sys.argv[6]) if len(sys.argv) > 6 else 7, int(sys.argv[7]) if len(sys.argv) > 7 else 20000
    here = pathlib.Path(__file__).parent
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "scene.json").write_text(json.dumps(scene(windows)))
        library = pathlib.Path(bin_).resolve().parent / "lib"
        subprocess.run(["cc", "-O2", "-I", f"{sources}/participant/include", here / "idle_particles.c", "-o", folder / "idle_c",
                        f"-L{library}", "-ltandem_participant", f"-Wl,-rpath,{library}"], check=True)
        servers = {"dem_server": [], "c": ["--dem-server", str(folder / "idle_c")],
                   "python": ["--dem-server", f"/usr/bin/python3 {here / 'idle_particles.py'}"]}
        wall, dem = {name: [] for name in servers}, {name: [] for name in servers}
        for _ in range(pairs):
            for name, server in servers.items():
                out = folder / "out"
                subprocess.run([f"{bin_}/tandem", "run", folder / "scene.json", "--out", out, "--threads", "1", "--no-picture",
                                "--no-report", "--quiet", *server], check=True, capture_output=True)
                summary = json.loads((out / "summary.json").read_text())
                wall[name].append(1e6 * summary["wall_s"] / windows)
                dem[name].append(1e6 * (summary["time_split"]["dem"] + summary["time_split"]["exchange"]) / windows)
                subprocess.run(["rm", "-r", out], check=True)
    fresh = not os.path.exists(table)
    with open(table, "a", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if fresh:
            writer.writerow(["date", "commit", "device", "command", "solver", "windows", "pairs", "wall_us", "wall_us_least",
                             "dem_us", "dem_us_least", "wall_ratio_to_dem_server"])
        for name in servers:
            ratio = statistics.median(a / b for a, b in zip(wall[name], wall["dem_server"]))
            row = [datetime.date.today().isoformat(), commit, device, f"python_window.py {pairs} {windows}", name, windows, pairs,
                   *(f"{f(values[name]):.2f}" for values in (wall, dem) for f in (statistics.median, min)), f"{ratio:.3f}"]
            writer.writerow(row)
            print(name, *row[5:])


if __name__ == "__main__":
    main()
