#!/usr/bin/env python3
"""Measures what output.fields cost: a close packing on a floor with a frame in every window, without fields and with them in turn.

usage: fields.py BIN CSV COMMIT DEVICE [--edge N] [--backend cpu|cuda] [--repeats N]
The packing has N x N x N spheres. A row has the wall time of output per frame [ms] and the bytes of a frame of the spheres; every run must have the same state_hash.
"""
import argparse
import csv
import datetime
import json
import pathlib
import subprocess
import sys
import tempfile

SETS = [[], ["group", "material"], ["contact_count", "mean_stress"], ["group", "material", "contact_count", "mean_stress"]]
FRAMES = 20
WINDOW = 1e-3  # [s]
RADIUS = 0.01  # [m]


def scene(edge, fields):
    side = 2 * RADIUS * (edge + 1)
    return {
        "tandem": "1.0", "name": "fields", "end_time": FRAMES * WINDOW, "coupling": {"window": WINDOW},
        "dem": {
            "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25}],
            "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.4}],
            # Nearly touching, so that the weight closes all contacts in the first windows.
            "particles": [{"name": "spheres", "material": "glass", "radius": [RADIUS * (1 - 1e-5), RADIUS],
                           "fill": {"type": "lattice", "lattice": "hexagonal", "min": [0, 0, 0], "max": [side, side, side],
                                    "spacing": 2 * RADIUS, "count": edge ** 3}}],
            "walls": [{"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
            "domain": {"min": [-0.1, -0.1, -0.1], "max": [side + 0.1] * 3}},
        "output": {"frame_interval": WINDOW, "fields": fields}}


def run(given, fields, folder):
    path = folder.parent / "scene.json"
    path.write_text(json.dumps(scene(given.edge, fields)))
    subprocess.run([given.bin / "tandem", "run", path, "--out", folder, "--backend", given.backend, "--threads", "1", "--no-picture",
                    "--no-report", "--quiet"], check=True)
    return json.loads((folder / "summary.json").read_text()), (folder / f"frames/particles_{FRAMES:06}.h5").stat().st_size


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("csv", type=pathlib.Path)
    parser.add_argument("commit")
    parser.add_argument("device")
    parser.add_argument("--edge", type=int, default=37)
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    times = {index: [] for index in range(len(SETS))}
    facts, sizes, hashes = {}, {}, set()
    for repeat in range(given.repeats):
        for index, fields in enumerate(SETS):
            with tempfile.TemporaryDirectory(prefix="tandem_fields_") as folder:
                summary, sizes[index] = run(given, fields, pathlib.Path(folder) / f"{index}_{repeat}")
            times[index].append(1e3 * summary["time_split"]["output"] / (FRAMES + 1))
            facts[index] = summary
            hashes.add(summary["state_hash"])
    if len(hashes) != 1:
        sys.exit(f"fields changed the results: {hashes}")
    fresh = not given.csv.exists()
    with open(given.csv, "a", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        if fresh:
            writer.writerow(["date", "commit", "device", "command", "backend", "spheres", "contacts", "fields", "bytes_per_frame",
                             *(f"output_ms_per_frame_run_{k + 1}" for k in range(given.repeats)), "state_hash"])
        for index, fields in enumerate(SETS):
            writer.writerow([datetime.date.today().isoformat(), given.commit, given.device, f"fields.py --edge {given.edge}",
                             facts[index]["backend"], facts[index]["spheres"], facts[index]["contacts"], " ".join(fields) or "none", sizes[index],
                             *(f"{ms:.3f}" for ms in times[index]), hashes.copy().pop()])


if __name__ == "__main__":
    main()
