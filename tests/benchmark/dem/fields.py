#!/usr/bin/env python3
"""Measures what fields of spheres and walls, contacts of bodies and dissipated energy cost.

usage: fields.py FOLDER [--edge N] [--backend cpu|cuda] [--repeats N] [--threads N] [--commit C] [--csv FILE]
FOLDER is an installation, a build tree, or the folder of the programs. A close packing of N x N x N spheres lies on a floor of 512
triangles, with a frame in every window; the sets of outputs take turns. Prints one CSV row per set, or appends the rows to FILE: wall
time of output per frame [ms], wall time of a micro step [us], bytes of a frame of the spheres and of the bodies. Every run must have the
same state_hash.
"""
import argparse
import csv
import datetime
import json
import pathlib
import subprocess
import sys
import tempfile

CONTACTS = ["contact_count", "mean_stress"]
# Name, keys of `output`, variant of the contact law. The generic variant runs where sums of walls or energies are asked for, so that
# their own cost is the difference from "none, generic".
SETS = [
    ("none", {}, None),
    ("group material", {"fields": ["group", "material"]}, None),
    ("contact_count mean_stress", {"fields": CONTACTS}, None),
    ("contacts of the ground", {"contacts": ["ground"]}, None),
    ("none, generic", {}, "generic"),
    ("wall_fields", {"wall_fields": ["floor"]}, None),
    ("dissipation", {"dissipation": True}, None),
    ("all", {"fields": ["group", "material", *CONTACTS], "contacts": ["ground"], "wall_fields": ["floor"], "dissipation": True}, None),
]
FRAMES = 20
WINDOW = 1e-3  # [s]
RADIUS = 0.01  # [m]
FLOOR = 16  # squares along each edge


def floor_mesh(side):
    """The floor as an OBJ file."""
    step = (side + 0.2) / FLOOR
    lines = [f"v {-0.1 + i * step:.9g} {-0.1 + k * step:.9g} 0" for k in range(FLOOR + 1) for i in range(FLOOR + 1)]
    for k in range(FLOOR):
        for i in range(FLOOR):
            a = 1 + k * (FLOOR + 1) + i
            b, c, d = a + 1, a + FLOOR + 2, a + FLOOR + 1
            lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    return "\n".join(lines) + "\n"


def scene(edge, output, variant):
    side = 2 * RADIUS * (edge + 1)
    dem = {
        "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "hardness": 1e9}],
        "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.4, "wear_coefficient": 1e-3}],
        # Nearly touching, so that the weight closes all contacts in the first windows.
        "particles": [{"name": "spheres", "material": "glass", "radius": [RADIUS * (1 - 1e-5), RADIUS],
                       "fill": {"type": "lattice", "lattice": "hexagonal", "min": [0, 0, 0], "max": [side, side, side],
                                "spacing": 2 * RADIUS, "count": edge ** 3}}],
        "walls": [{"name": "floor", "material": "glass", "shape": {"type": "mesh", "file": "floor.obj"}}],
        "domain": {"min": [-0.1, -0.1, -0.1], "max": [side + 0.1] * 3}}
    if variant:
        dem["variant"] = variant
    return {"tandem": "1.0", "name": "fields", "end_time": FRAMES * WINDOW, "coupling": {"window": WINDOW}, "dem": dem,
            "output": {"frame_interval": WINDOW, **output}}


def programs(folder):
    for place in (folder / "bin", folder):
        if (place / "tandem").is_file():
            return place
    sys.exit(f"fields.py: no program 'tandem' in {folder} or {folder / 'bin'}")


def run(given, bin_folder, output, variant, folder):
    (folder / "floor.obj").write_text(floor_mesh(2 * RADIUS * (given.edge + 1)))
    (folder / "scene.json").write_text(json.dumps(scene(given.edge, output, variant)))
    out = folder / "out"
    done = subprocess.run([bin_folder / "tandem", "run", folder / "scene.json", "--out", out, "--backend", given.backend, "--threads",
                           str(given.threads), "--no-picture", "--no-report", "--quiet"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"fields.py: tandem ended with status {done.returncode}\n{done.stdout}{done.stderr}")
    sizes = [(out / f"frames/{series}_{FRAMES:06}.h5").stat().st_size for series in ("particles", "bodies")]
    return json.loads((out / "summary.json").read_text()), sizes


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--csv", type=pathlib.Path)
    parser.add_argument("--commit", default="")
    parser.add_argument("--edge", type=int, default=37)
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--threads", type=int, default=1)
    given = parser.parse_args()
    bin_folder = programs(given.folder.resolve())
    frames, steps = {name: [] for name, _, _ in SETS}, {name: [] for name, _, _ in SETS}
    facts, sizes, hashes = {}, {}, set()
    for _ in range(given.repeats):
        for name, output, variant in SETS:
            with tempfile.TemporaryDirectory(prefix="tandem_fields_") as folder:
                facts[name], sizes[name] = run(given, bin_folder, output, variant, pathlib.Path(folder))
            split = facts[name]["time_split"]
            frames[name].append(1e3 * split["output"] / (FRAMES + 1))
            steps[name].append(1e6 * split["dem"] / facts[name]["micro_steps"])
            hashes.add(facts[name]["state_hash"])
    if len(hashes) != 1:
        sys.exit(f"fields.py: outputs changed the results: {hashes}")
    numbers = range(1, given.repeats + 1)
    header = ["date", "commit", "device", "command", "backend", "variant", "spheres", "contacts", "outputs", "bytes_per_frame_of_spheres",
              "bytes_per_frame_of_bodies", *(f"output_ms_per_frame_run_{k}" for k in numbers), *(f"us_per_micro_step_run_{k}" for k in numbers),
              "state_hash"]
    rows = [[datetime.date.today().isoformat(), given.commit, facts[name].get("device", ""), f"fields.py --edge {given.edge} --backend {given.backend}",
             facts[name]["backend"], facts[name]["variant"], facts[name]["spheres"], facts[name]["contacts"], name, *sizes[name],
             *(f"{ms:.3f}" for ms in frames[name]), *(f"{us:.2f}" for us in steps[name]), *hashes] for name, _, _ in SETS]
    file = open(given.csv, "a", newline="") if given.csv else sys.stdout
    writer = csv.writer(file, lineterminator="\n")
    if not given.csv or given.csv.stat().st_size == 0:
        writer.writerow(header)
    writer.writerows(rows)
    if given.csv:
        file.close()


if __name__ == "__main__":
    main()
