#!/usr/bin/env python3
"""Writes the scene of a packed bed: spheres of one size, close-packed with gaps of 1 % of a diameter, that settle in a
box of planes. Usage: packed_bed.py SPHERES FILE [--contact VARIANT] [--precision P] [--end SECONDS] [--young PA]
[--no-frames]"""
import argparse
import json
import math

arguments = argparse.ArgumentParser(description=__doc__)
arguments.add_argument("spheres", type=int)
arguments.add_argument("file")
arguments.add_argument("--contact", default="hertz_mindlin")
arguments.add_argument("--precision", default="mixed", choices=["mixed", "double"])
arguments.add_argument("--end", type=float, default=0.3, help="simulated time [s]")
arguments.add_argument("--young", type=float, default=1e8, help="Young's modulus [Pa]")
arguments.add_argument("--no-frames", action="store_true", help="frames without spheres, required where a message cannot hold all of them")
given = arguments.parse_args()

RADIUS, DENSITY, POISSON = 0.01, 2500.0, 0.25  # [m], [kg/m3], [-]
SPACING = 2.02 * RADIUS
across = max(2, round((given.spheres / 2) ** (1 / 3)))  # twice as high as wide
rows = math.floor(across / (math.sqrt(3) / 2))
layers = math.ceil(given.spheres / (across * rows))
width = (across + 0.5) * SPACING
depth = (rows * math.sqrt(3) / 2 + 0.5) * SPACING
height = (layers * math.sqrt(2 / 3) + 1) * SPACING
rayleigh = math.pi * RADIUS * math.sqrt(DENSITY * 2 * (1 + POISSON) / given.young) / (0.1631 * POISSON + 0.8766)

def plane(name, point, normal):
    return {"name": name, "material": "glass", "shape": {"type": "plane", "point": point, "normal": normal}}

scene = {
    "tandem": "1.0",
    "name": f"packed_bed_{given.spheres}",
    "end_time": given.end,
    "coupling": {"window": 1e-3},
    "dem": {
        "materials": [{"name": "glass", "density": DENSITY, "young": given.young, "poisson": POISSON}],
        "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5,
                   **({} if given.contact == "hertz_frictionless" else {"friction": 0.4})}],
        "contact": given.contact,
        "precision": given.precision,
        "micro_step": 1e-3 / math.ceil(1e-3 / (0.15 * rayleigh)),
        "particles": [{"name": "spheres", "material": "glass", "radius": RADIUS,
                       "fill": {"type": "lattice", "lattice": "hexagonal", "min": [0, 0, 0],
                                "max": [width, depth, height], "spacing": SPACING, "jitter": 0.9,
                                "count": given.spheres}}],
        "walls": [plane("floor", [0, 0, 0], [0, 0, 1]),
                  plane("left", [0, 0, 0], [1, 0, 0]), plane("right", [width, 0, 0], [-1, 0, 0]),
                  plane("front", [0, 0, 0], [0, 1, 0]), plane("back", [0, depth, 0], [0, -1, 0])],
        "domain": {"min": [-0.1, -0.1, -0.1], "max": [width + 0.1, depth + 0.1, height + 0.1]},
    },
    "output": {"frame_interval": given.end, "particles": not given.no_frames},
}
with open(given.file, "w") as file:
    json.dump(scene, file, indent=1)
