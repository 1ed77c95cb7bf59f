#!/usr/bin/env python3
"""Runs the begin of every shipped scene with grains on 1, 2, 3 and 4 ranks and compares the hashes of their states. Ends with 1 where two
differ.

    tests/benchmark/dem/rank_hashes.py TANDEM [SCENE ...] [--budget SPHERE_STEPS] [--ranks 1,2,3,4] [--backend cpu|cuda]
                                       [--record FILE COMMIT]

With --backend cuda each rank has a device.
"""
import argparse
import csv
import datetime
import json
import pathlib
import platform
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("tandem", type=pathlib.Path)
parser.add_argument("scenes", nargs="*", type=pathlib.Path)
parser.add_argument("--budget", type=float, default=2e7, help="spheres times micro steps of a run, about")
parser.add_argument("--ranks", default="1,2,3,4")
parser.add_argument("--backend", default="cpu", choices=["cpu", "cuda"])
parser.add_argument("--record", nargs=2, metavar=("FILE", "COMMIT"))
given = parser.parse_args()
ranks = [int(word) for word in given.ranks.split(",")]


def has_grains(path):
    scene = json.loads(path.read_text())
    return isinstance(scene, dict) and bool(scene.get("dem", {}).get("particles"))


def run(scene, end, count, out):
    """The summary, or the last line of what was said."""
    done = subprocess.run([given.tandem, "run", scene, "--out", out, "--end-time", f"{end:.9f}", "--ranks", str(count), "--threads", "1",
                           "--backend", given.backend, "--no-picture", "--no-report", "--quiet"], capture_output=True, text=True, check=False)
    summary = pathlib.Path(out) / "summary.json"
    if done.returncode not in (0, 1) or not summary.exists():
        return (done.stdout + done.stderr).strip().splitlines()[-1]
    return json.loads(summary.read_text())


def device():
    if given.backend == "cuda":
        return subprocess.run(["nvidia-smi", "-L"], capture_output=True, text=True, check=True).stdout.split(":")[1].split("(")[0].strip()
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":")[1].strip()
    return platform.machine()


def record(row):
    """Adds the row at once, so that what is measured stays where the machine goes away."""
    if not given.record:
        return
    file, commit = given.record
    columns = ["scene", "spheres", "windows", "micro_steps", "contacts", "list_rebuilds", *(f"hash_{count}" for count in ranks), "equal"]
    begins = not pathlib.Path(file).exists()
    with open(file, "a", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        if begins:
            writer.writerow(["date", "commit", "device", "command", *columns])
        writer.writerow([datetime.date.today().isoformat(), commit, device(), f"rank_hashes.py tandem --budget {given.budget:g} --ranks {given.ranks} --backend {given.backend}",
                         *(row.get(key, "") for key in columns)])


differ = False
for scene in given.scenes or sorted(path for path in (ROOT / "launch" / "scenes").rglob("*.json") if has_grains(path)):
    name = scene.stem
    with tempfile.TemporaryDirectory() as folder:
        window = json.loads(scene.read_text())["coupling"]["window"]
        first = run(scene, 2 * window, 1, f"{folder}/first")
        if isinstance(first, str):
            print(f"{name}: {first}", flush=True)
            continue
        per_window = first["spheres"] * first["micro_steps"] / first["windows"]
        last = json.loads(scene.read_text())["end_time"]
        end = min(last, max(2, int(given.budget / per_window)) * window)
        row = {"scene": name, "spheres": first["spheres"]}
        for count in ranks:
            summary = run(scene, end, count, f"{folder}/{count}")
            if isinstance(summary, str):
                row[f"hash_{count}"] = "refused" if "too few for" in summary else summary
                continue
            row.update({key: summary[key] for key in ("spheres", "windows", "micro_steps", "contacts", "list_rebuilds")})
            row[f"hash_{count}"] = summary["state_hash"]
        hashes = {row[f"hash_{count}"] for count in ranks} - {"refused"}
        runs = sum(row[f"hash_{count}"] != "refused" for count in ranks)
        row["equal"] = "NO" if len(hashes) != 1 else "yes" if runs > 1 else "one only"
        differ |= len(hashes) != 1
        print(", ".join(f"{key} {value}" for key, value in row.items()), flush=True)
        record(row)

sys.exit(differ)
