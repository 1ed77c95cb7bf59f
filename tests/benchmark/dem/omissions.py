#!/usr/bin/env python3
"""Measures the cost of each feature of the solver: a packed bed at rest, first with all features, then with one feature
less in each case.
Usage: omissions.py TANDEM SPHERES CSV COMMIT [--backend cpu|cuda] [--threads N] [--end SECONDS] [--rounds N]
Adds one row per case to CSV: bytes per sphere, and the shortest time per micro step of all rounds. Each round runs all
cases. On the CPU it is the processor time of all threads, so that other programs on the machine hardly matter."""
import argparse
import csv
import datetime
import json
import math
import pathlib
import subprocess
import tempfile

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("tandem")
arguments.add_argument("spheres", type=int)
arguments.add_argument("csv", type=pathlib.Path)
arguments.add_argument("commit")
arguments.add_argument("--backend", default="cpu", choices=["cpu", "cuda"])
arguments.add_argument("--threads", type=int, default=1)
arguments.add_argument("--end", type=float, default=0.04, help="simulated time [s]")
arguments.add_argument("--rounds", type=int, default=3)
given = arguments.parse_args()

RADIUS, DENSITY, YOUNG, POISSON = 0.01, 2500.0, 1e8, 0.25  # [m], [kg/m3], [Pa], [-]
SPACING = 2 * RADIUS  # a close packing that touches: at rest but for the weight, with friction and without
across = max(2, round((given.spheres / 2) ** (1 / 3)))
rows = math.floor(across / (math.sqrt(3) / 2))
layers = math.ceil(given.spheres / (across * rows))
size = [(across + 0.5) * SPACING, ((rows - 1) * math.sqrt(3) / 2 + 1 + math.sqrt(3) / 6) * SPACING,
        ((layers - 1) * math.sqrt(2 / 3) + 1) * SPACING]
rayleigh = math.pi * RADIUS * math.sqrt(DENSITY * 2 * (1 + POISSON) / YOUNG) / (0.1631 * POISSON + 0.8766)


def plane(name, point, normal):
    return {"name": name, "material": "glass", "shape": {"type": "plane", "point": point, "normal": normal}}


PLANES = [plane("floor", [0, 0, 0], [0, 0, 1]), plane("left", [0, 0, 0], [1, 0, 0]),
          plane("right", [size[0], 0, 0], [-1, 0, 0]), plane("front", [0, 0, 0], [0, 1, 0]),
          plane("back", [0, size[1], 0], [0, -1, 0])]
BOX = [{"name": "box", "material": "glass", "position": [size[0] / 2, size[1] / 2, size[2]],
        "shape": {"type": "box", "size": [size[0], size[1], 2 * size[2]], "open": ["+z"]}}]


def scene():
    """The scene with all features: double precision, rolling, twisting, friction, many sizes, facets."""
    return {
        "tandem": "1.0", "name": "omissions", "end_time": given.end, "coupling": {"window": 1e-3},
        "dem": {
            "materials": [{"name": "glass", "density": DENSITY, "young": YOUNG, "poisson": POISSON}],
            "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.4, "rolling_friction": 0.05,
                       "rolling_damping": 0.3}],
            "contact": "hertz_mindlin", "precision": "double", "rolling": "elastic_plastic",
            "twisting": "elastic_plastic", "variant": "auto",
            "micro_step": 1e-3 / math.ceil(1e-3 / (0.15 * rayleigh)),
            # These sizes differ, but hardly change the bed.
            "particles": [{"name": "spheres", "material": "glass", "radius": [RADIUS * (1 - 1e-4), RADIUS],
                           "fill": {"type": "lattice", "lattice": "hexagonal", "min": [0, 0, 0],
                                    "max": [x + 1e-9 for x in size], "spacing": SPACING,
                                    "count": given.spheres}}],
            "walls": BOX,
            "domain": {"min": [-0.1, -0.1, -0.1], "max": [x + 0.1 for x in size]},
        },
        "output": {"frame_interval": given.end},
    }


# Each case leaves out one more feature than the case before it.
CASES = [("nothing left out", {}),
         ("double precision", {"precision": "mixed"}),
         ("rolling and twisting", {"rolling": "none", "twisting": "none", "variant": "generic"}),
         ("laws of other scenes (generic variant)", {"variant": "auto"}),
         ("facets: planes instead", {"walls": PLANES}),
         ("sizes: their mean instead of many", {"radius": RADIUS * (1 - 5e-5)}),
         ("friction, history and spin", {"contact": "hertz_frictionless"})]
COLUMNS = ["date", "commit", "device", "backend", "threads", "left_out_too", "variant", "precision", "spheres",
           "micro_steps", "contacts", "list_rebuilds", "bytes_per_sphere", "us_per_micro_step", "ns_per_sphere_step"]

best = {}
with tempfile.TemporaryDirectory(prefix="omissions") as folder:
    work = pathlib.Path(folder)
    for _ in range(given.rounds):
        text = scene()
        for name, change in CASES:
            for key, value in change.items():
                if key == "radius":
                    text["dem"]["particles"][0][key] = value
                else:
                    text["dem"][key] = value
            (work / "scene.json").write_text(json.dumps(text))
            subprocess.run([given.tandem, "run", work / "scene.json", "--backend", given.backend, "--threads",
                            str(given.threads), "--no-report", "--no-picture", "--quiet", "--out", work / "out"],
                           check=True)
            summary = json.loads((work / "out" / "summary.json").read_text())
            seconds = summary["dem_solver_cpu_seconds" if given.backend == "cpu" else "dem_solver_seconds"]
            step = 1e6 * seconds / summary["micro_steps"]
            if name in best and best[name]["us_per_micro_step"] <= step:
                continue
            best[name] = {
                "date": datetime.date.today().isoformat(), "commit": given.commit, "device": summary["device"],
                "backend": given.backend, "threads": given.threads, "left_out_too": name,
                **{key: summary[key] for key in ("variant", "precision", "spheres", "micro_steps", "contacts",
                                                 "list_rebuilds")},
                "bytes_per_sphere": round(1e6 * summary["dem_memory_MB"] / summary["spheres"]),
                "us_per_micro_step": round(step, 1), "ns_per_sphere_step": round(1e3 * step / summary["spheres"], 1)}

fresh = not given.csv.exists()
with open(given.csv, "a", newline="") as file:
    writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
    if fresh:
        writer.writeheader()
    for name, _ in CASES:
        writer.writerow(best[name])
        row = best[name]
        print(f"{name:42s} {row['variant']:20s} {row['contacts']:8d} contacts {row['list_rebuilds']:4d} rebuilds "
              f"{row['bytes_per_sphere']:6d} B/sphere {row['us_per_micro_step']:10.1f} us/step "
              f"{row['ns_per_sphere_step']:7.1f} ns/sphere")
