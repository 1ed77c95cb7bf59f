#!/usr/bin/env python3
"""Times contact variants in turn on the same settled bed, since beds that settle with different laws differ in their
contacts. The bed is that of packed_bed.py, settled with hertz_mindlin. Every variant starts from its positions, at
rest, without histories.
Usage: same_bed.py TANDEM SPHERES FOLDER [--backend cpu|cuda] [--threads N] [--settle SECONDS] [--end SECONDS]
       [--rounds N] [--variants A,B] [--record CSV COMMIT]
Prints one line per run, and finally the time of each variant relative to that of the last one (shortest of the
rounds)."""
import argparse
import json
import pathlib
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from record import record  # noqa: E402

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("tandem")
arguments.add_argument("spheres", type=int)
arguments.add_argument("folder", type=pathlib.Path)
arguments.add_argument("--backend", default="cpu", choices=["cpu", "cuda"])
arguments.add_argument("--threads", type=int, default=1)
arguments.add_argument("--settle", type=float, default=0.6, help="simulated time [s]")
arguments.add_argument("--end", type=float, default=0.02, help="simulated time of a timed run [s]")
arguments.add_argument("--rounds", type=int, default=3)
arguments.add_argument("--variants", default="hertz_mindlin,hertz_frictionless")
arguments.add_argument("--record", nargs=2, metavar=("CSV", "COMMIT"))
given = arguments.parse_args()
variants = given.variants.split(",")
command = (f"same_bed.py {given.spheres} --backend {given.backend} --threads {given.threads} --settle {given.settle} "
           f"--end {given.end} --rounds {given.rounds} --variants {given.variants}")


def run(scene, folder):
    """Runs the scene and returns its summary."""
    done = subprocess.run([given.tandem, "run", scene, "--backend", given.backend, "--threads", str(given.threads),
                           "--no-report", "--no-picture", "--out", folder], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{scene} failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return json.loads((folder / "summary.json").read_text())


given.folder.mkdir(parents=True, exist_ok=True)
settling = given.folder / "settling.json"
# The bed is stiff, since a start with overlaps of 1 % of a radius is refused.
subprocess.run([sys.executable, pathlib.Path(__file__).with_name("packed_bed.py"), str(given.spheres), settling,
                "--young", "1e9", "--end", str(given.settle)], check=True)
run(settling, given.folder / "settled")
with h5py.File(given.folder / "settled/particles.h5") as file:
    position = file[sorted(name for name in file if name.startswith("frame"))[-1]]["position"][:]
numpy.savetxt(given.folder / "bed.csv", position, fmt="%.17g", delimiter=",", header="x,y,z", comments="")

shortest = {}
for _ in range(given.rounds):
    for variant in variants:
        scene = json.loads(settling.read_text())
        scene["name"], scene["end_time"] = f"same_bed_{given.spheres}", given.end
        scene["output"] = {"frame_interval": given.end}
        scene["dem"]["contact"] = variant
        scene["dem"]["particles"][0]["fill"] = {"type": "file", "file": "bed.csv"}
        if variant == "hertz_frictionless":
            del scene["dem"]["pairs"][0]["friction"]
        file = given.folder / f"{variant}.json"
        file.write_text(json.dumps(scene))
        summary = run(file, given.folder / variant)
        seconds = summary["dem_solver_seconds"]
        per_step = seconds / summary["micro_steps"]
        shortest[variant] = min(per_step, shortest.get(variant, per_step))
        print(f"{variant:20} {per_step * 1e6:9.2f} us/step {summary['spheres'] / per_step:10.3g} sphere-steps/s, "
              f"{summary['list_rebuilds']} rebuilds, {2 * summary['contacts'] / summary['spheres']:.2f} touching each, "
              f"{summary['dem_memory_MB'] * 1e6 / summary['spheres']:.0f} B per sphere", flush=True)
        if given.record:
            record(given.record[0], summary, given.record[1], command,
                   ["contacts", "list_rebuilds", "dem_memory_MB", "dem_solver_seconds"])
for variant in variants:
    print(f"{variant} takes {shortest[variant] / shortest[variants[-1]]:.3f} times as long as {variants[-1]}")
