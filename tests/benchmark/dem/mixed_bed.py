#!/usr/bin/env python3
"""Writes the scene of a bed of two sizes in a box of planes. Coarse spheres start in a lattice, fine ones in a denser
lattice in the room between them. Usage: mixed_bed.py SPHERES RATIO FILE [--end SECONDS] [--contact VARIANT]
[--share VOLUME]. Also writes the spheres next to FILE, one CSV for each size."""
import argparse
import json
import math
import pathlib

import numpy

arguments = argparse.ArgumentParser(description=__doc__)
arguments.add_argument("spheres", type=int, help="fine ones that would fill what the coarse ones leave, gaps included")
arguments.add_argument("ratio", type=float, help="of the diameters")
arguments.add_argument("file", type=pathlib.Path)
arguments.add_argument("--end", type=float, default=0.1, help="simulated time [s]")
arguments.add_argument("--contact", default="hertz_mindlin")
arguments.add_argument("--share", type=float, default=0.3, help="of the box's volume that is coarse spheres'")
given = arguments.parse_args()

FINE, DENSITY, POISSON, YOUNG = 0.01, 2500.0, 0.25, 1e8  # [m], [kg/m3], [-], [Pa]
coarse = FINE * given.ratio
spacing = 2.02 * FINE
fine_volume = given.spheres * spacing**3  # of their lattice
box = fine_volume / (1 - given.share)
pitch = (4 / 3 * math.pi / given.share) ** (1 / 3) * coarse  # of the coarse lattice
cells = max(1, round(box ** (1 / 3) / pitch))
side = cells * pitch if given.ratio > 1 else box ** (1 / 3)
random = numpy.random.default_rng(1)


def lattice(step, count, jitter):
    at = (numpy.indices((count, count, count)).reshape(3, -1).T + 0.5) * step
    return at + random.uniform(-jitter, jitter, at.shape)


large = lattice(pitch, cells, 0.02 * coarse) if given.ratio > 1 else numpy.empty((0, 3))
small = lattice(spacing, int(side / spacing), 0.009 * FINE)
if len(large):
    for offset in numpy.indices((3, 3, 3)).reshape(3, -1).T - 1:
        near = (numpy.floor(small / pitch).astype(int) + offset).clip(0, cells - 1) @ [cells * cells, cells, 1]
        small = small[numpy.linalg.norm(small - large[near], axis=1) > coarse + FINE]

groups = []
for name, radius, at in (("fine", FINE, small), ("coarse", coarse, large)):
    if not len(at):
        continue
    table = given.file.with_name(f"{given.file.stem}_{name}.csv")
    numpy.savetxt(table, at, fmt="%.9g", delimiter=",", header="x,y,z", comments="")
    groups.append({"name": name, "material": "glass", "radius": radius, "fill": {"type": "file", "file": table.name}})


def plane(name, point, normal):
    return {"name": name, "material": "glass", "shape": {"type": "plane", "point": point, "normal": normal}}


rayleigh = math.pi * FINE * math.sqrt(DENSITY * 2 * (1 + POISSON) / YOUNG) / (0.1631 * POISSON + 0.8766)
scene = {
    "tandem": "1.0",
    "name": "mixed_bed",
    "end_time": given.end,
    "coupling": {"window": 1e-3},
    "dem": {
        "materials": [{"name": "glass", "density": DENSITY, "young": YOUNG, "poisson": POISSON}],
        "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5,
                   **({} if given.contact == "hertz_frictionless" else {"friction": 0.4})}],
        "contact": given.contact,
        "micro_step": 1e-3 / math.ceil(1e-3 / (0.15 * rayleigh)),
        "particles": groups,
        "walls": [plane("floor", [0, 0, 0], [0, 0, 1]),
                  plane("left", [0, 0, 0], [1, 0, 0]), plane("right", [side, 0, 0], [-1, 0, 0]),
                  plane("front", [0, 0, 0], [0, 1, 0]), plane("back", [0, side, 0], [0, -1, 0])],
        "domain": {"min": [-0.1, -0.1, -0.1], "max": [side + 0.1, side + 0.1, side + 0.1]},
    },
    "output": {"frame_interval": given.end},
}
given.file.write_text(json.dumps(scene, indent=1))
print(f"{len(small)} fine and {len(large)} coarse spheres in a box of {side:.3g} m")
