#!/usr/bin/env python3
"""Runs a settled bed with tandem and with Debian's LIGGGHTS (package liggghts), in turn, on one core each. Both have
the same spheres, walls, law (Hertz, Mindlin with history) and step, and start from rest without histories. LIGGGHTS
gets a skin of a quarter of a radius, tandem chooses its own.
Usage: against_liggghts.py TANDEM SETTLED_RUN STEPS [ROUNDS], where SETTLED_RUN is the folder of a finished run of a
scene by packed_bed.py. The bed must be stiff (--young 1e9): a start with overlaps of 1 % of a radius is refused.
Prints one CSV row per run: program, spheres, steps, seconds, sphere-steps per second."""
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py

tandem, settled, steps = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
rounds = int(sys.argv[4]) if len(sys.argv) > 4 else 3
summary = json.loads((settled / "summary.json").read_text())
scene = json.loads(pathlib.Path(summary["scene_file"]).read_text())
dem = scene["dem"]
material, pair, dt = dem["materials"][0], dem["pairs"][0], summary["micro_step_s"]
with h5py.File(settled / "particles.h5") as file:
    position = file[sorted(name for name in file if name.startswith("frame"))[-1]]["position"][:]
radius = dem["particles"][0]["radius"]
count = len(position)
work = pathlib.Path(tempfile.mkdtemp(prefix="bed"))

with open(work / "bed.csv", "w", newline="") as file:
    writer = csv.writer(file)
    writer.writerow(["x", "y", "z"])
    writer.writerows(position.tolist())
dem["particles"][0]["fill"] = {"type": "file", "file": "bed.csv"}
windows = max(1, round(steps * dt / scene["coupling"]["window"]))
scene["end_time"] = windows * scene["coupling"]["window"]
steps = round(scene["end_time"] / dt)
scene["output"] = {"frame_interval": scene["end_time"]}
(work / "bed.json").write_text(json.dumps(scene))

low, high = dem["domain"]["min"], dem["domain"]["max"]
atoms = "\n".join(f"{i + 1} 1 {2 * radius!r} {material['density']} {x!r} {y!r} {z!r}"
                  for i, (x, y, z) in enumerate(position.tolist()))
bounds = "".join(f"{low[k]} {high[k]} {a}lo {a}hi\n" for k, a in enumerate("xyz"))
(work / "bed.data").write_text(f"settled bed\n\n{count} atoms\n1 atom types\n\n{bounds}\nAtoms\n\n{atoms}\n")
walls = ""
for k, wall in enumerate(dem["walls"]):
    axis = next(a for a in range(3) if wall["shape"]["normal"][a] != 0)
    walls += (f"fix wall{k} all wall/gran model hertz tangential history primitive type 1 "
              f"{'xyz'[axis]}plane {wall['shape']['point'][axis]!r}\n")
(work / "bed.in").write_text(f"""
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
read_data bed.data
neighbor {0.25 * radius!r} bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype {material['young']}
fix m2 all property/global poissonsRatio peratomtype {material['poisson']}
fix m3 all property/global coefficientRestitution peratomtypepair 1 {pair['restitution']}
fix m4 all property/global coefficientFriction peratomtypepair 1 {pair['friction']}
pair_style gran model hertz tangential history
pair_coeff * *
timestep {dt!r}
fix gravity all gravity 9.81 vector 0.0 0.0 -1.0
{walls}fix integrate all nve/sphere
thermo 1000000
run {steps}
""")

output = csv.writer(sys.stdout)
output.writerow(["program", "spheres", "steps", "seconds", "sphere_steps_per_s"])
for _ in range(rounds):
    run = subprocess.run(["liggghts", "-in", "bed.in"], cwd=work, capture_output=True, text=True)
    found = re.search(r"Loop time of ([0-9.e+-]+)", run.stdout)
    if not found:
        sys.exit(f"liggghts failed: {run.stdout[-2000:]}{run.stderr}")
    seconds = float(found[1])
    output.writerow(["liggghts", count, steps, f"{seconds:.3f}", f"{count * steps / seconds:.4g}"])
    folder = work / "out"
    subprocess.run([tandem, "run", work / "bed.json", "--backend", "cpu", "--threads", "1", "--no-report",
                    "--no-picture", "--out", folder], check=True, capture_output=True)
    seconds = json.loads((folder / "summary.json").read_text())["dem_solver_seconds"]
    output.writerow(["tandem", count, steps, f"{seconds:.3f}", f"{count * steps / seconds:.4g}"])
    sys.stdout.flush()
