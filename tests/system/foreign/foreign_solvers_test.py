#!/usr/bin/env python3
"""One of the solvers in foreign/, beside tandem's own on the same scenes.

usage: foreign_solvers_test.py SOURCES BIN mujoco|simbody|liggghts
"""
import csv
import ctypes.util
import json
import pathlib
import subprocess
import sys
import tempfile

SOURCES, BIN, SOLVER = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
FOREIGN = SOURCES / "foreign"
COMMAND = {"mujoco": f"{FOREIGN}/mujoco/venv/bin/python {FOREIGN}/mujoco/mujoco_bodies.py",
           "simbody": f"{FOREIGN}/simbody/build/simbody_bodies",
           "liggghts": f"/usr/bin/python3 {FOREIGN}/liggghts/liggghts_spheres.py"}[SOLVER]
INSTALLED = {"mujoco": (FOREIGN / "mujoco/venv/bin/python").exists(), "simbody": (FOREIGN / "simbody/build/simbody_bodies").exists(),
             "liggghts": ctypes.util.find_library("liggghts") is not None}[SOLVER]
SIDE = "dem" if SOLVER == "liggghts" else "mbd"


def run(folder, scene, *arguments, expect=0):
    out = pathlib.Path(folder) / f"out{len(list(pathlib.Path(folder).iterdir()))}"
    said = subprocess.run([BIN / "tandem", "run", scene, "--out", out, "--no-picture", "--no-report", *arguments],
                          capture_output=True, text=True, timeout=250, check=False)
    if said.returncode != expect:
        sys.exit(f"status {said.returncode}, expected {expect}: {' '.join(map(str, arguments))}\n{said.stdout}{said.stderr}")
    return out, said.stdout + said.stderr


def columns(out, file):
    with open(out / file, newline="", encoding="utf-8") as rows:
        table = list(csv.DictReader(rows))
    return {name: [float(row[name]) for row in table] for name in table[0]}


def compare(ours, theirs, file, kinds, tolerance):
    ours, theirs = columns(ours, file), columns(theirs, file)
    for kind in kinds:
        names = [name for name in ours if f".{kind}" in name]
        largest = max(abs(value) for name in names for value in ours[name])
        gap = max(abs(a - b) for name in names for a, b in zip(ours[name], theirs[name])) / largest
        print(f"{kind}: largest difference {gap:.2g} of the largest value, tolerance {tolerance:g}")
        if not gap <= tolerance:
            sys.exit(f"{SOLVER} differs from tandem")


def refused(folder, scene, name, *arguments):
    said = run(folder, scene, f"--{SIDE}-server", COMMAND, *arguments, expect=2)[1]
    print(next(line for line in said.splitlines() if "error" in line))
    if name not in said:
        sys.exit(f"the refusal does not name {name}")


def conform():
    """What the judge of participants says of it: nothing fails."""
    said = subprocess.run([BIN / "tandem", "conform", COMMAND, "--role", SIDE, "--answer-limit", "5"], capture_output=True, text=True,
                          timeout=250, check=False)
    print(said.stdout.splitlines()[-1] if said.stdout else said.stderr)
    if said.returncode != 0:
        sys.exit("\n".join(line for line in said.stdout.splitlines() if not line.startswith("PASS")))


def bodies(folder):
    scene = FOREIGN / "scenes/chain.json"
    ours, theirs = run(folder, scene)[0], run(folder, scene, "--mbd-server", COMMAND)[0]
    compare(ours, theirs, "bodies.csv", ["position", "orientation", "velocity"], 1e-5)
    compare(ours, theirs, "joints.csv", ["q", "rate", "reaction_force", "reaction_torque"], 1e-5)
    box = SOURCES / "launch/scenes/spring_box.json"
    for scheme in ("dem_first", "implicit"):
        shared = ["--scheme", scheme, "--end-time", "0.1"]
        ours, theirs = run(folder, box, *shared)[0], run(folder, box, *shared, "--mbd-server", COMMAND)[0]
        compare(ours, theirs, "joints.csv", ["q", "rate"], 0.01)
    other = json.loads(scene.read_text())
    other["mbd"]["joints"][1]["type"] = "universal"
    other["mbd"]["joints"][1] |= {"axis": [1, 0, 0], "axis2": [0, 1, 0]}
    path = pathlib.Path(folder) / "universal.json"
    path.write_text(json.dumps(other))
    refused(folder, path, "joint:universal")


def particles(folder):
    # Eight spheres fall onto a blade of a wheel that turns under them.
    scene = json.loads((FOREIGN / "scenes/small_waterfall.json").read_text())
    scene["end_time"] = 0.4
    scene["dem"]["walls"] = [wall for wall in scene["dem"]["walls"] if wall["name"] in ("blade_1", "basin")]
    scene["dem"]["particles"][0]["fill"] = {"type": "lattice", "lattice": "cubic", "min": [0.4, -0.05, 0.3],
                                            "max": [0.6, 0.1, 0.7], "spacing": 0.085, "count": 8}
    path = pathlib.Path(folder) / "blade.json"
    path.write_text(json.dumps(scene))
    ours, theirs = run(folder, path)[0], run(folder, path, "--dem-server", COMMAND)[0]
    compare(ours, theirs, "joints.csv", ["q"], 0.02)
    balance = json.loads((theirs / "summary.json").read_text())["momentum_balance"]
    print(f"momentum balance {balance:.2g}")
    if not abs(balance) < 1e-12:
        sys.exit("momentum is not conserved")
    refused(folder, path, "save and restore", "--scheme", "implicit")
    scene["dem"]["contact"] = "hooke"
    for pair in scene["dem"]["pairs"]:
        pair["spring_stiffness"] = 1e6
    path.write_text(json.dumps(scene))
    refused(folder, path, "contact:hooke")


if not INSTALLED:
    print(f"skipped: run foreign/{SOLVER}/install.sh first")
    sys.exit(77)
with tempfile.TemporaryDirectory() as temporary:
    (particles if SIDE == "dem" else bodies)(temporary)
conform()
