#!/usr/bin/env python3
"""A block that floats across a slice of a tank, guided upright (docs/experiments/2026-11-floating-block.md).

floating_block.py --density RATIO -o SCENE.json writes a scene: the block starts --raised metres above its draft, or moves as
--forced HERTZ says. floating_block.py --added-mass HERTZ FOLDER prints the added mass of such a run, and the period of heave by it.
"""
import argparse
import csv
import json
import math
import pathlib

WIDTH, ACROSS, ROWS = 0.12, 8, 5       # of the block [m], and spacings across it and across the slice
HEIGHT = WIDTH / 2
SPACING = WIDTH / ACROSS
TANK, DEPTH = 3 * WIDTH, 1.5 * WIDTH
BREADTH = ROWS * SPACING
AMPLITUDE = 0.003                      # of the forced motion [m]
G, RHO = 9.81, 1000


def scene(density, raised, forced, scheme, end):
    mass = density * RHO * WIDTH * HEIGHT * BREADTH
    height = DEPTH - density * HEIGHT + HEIGHT / 2 + raised
    guide = {"name": "guide", "type": "prismatic", "parent": "ground", "child": "block", "position": [0, 0, 0], "axis": [0, 0, 1]}
    if forced:
        guide["motion"] = {"type": "harmonic", "amplitude": AMPLITUDE, "frequency": forced}

    def box(name, position, size, **more):
        return {"name": name, "position": position, "shape": {"type": "box", "size": size, **more.pop("shape", {})}, **more}
    return {"tandem": "1.1", "name": "floating_block", "end_time": end, "coupling": {"scheme": scheme, "window": 0.004},
            "mbd": {"bodies": [{"name": "block", "mass": mass, "inertia": [mass * WIDTH ** 2] * 3, "position": [0, 0, height]}],
                    "joints": [guide]},
            "sph": {"spacing": SPACING, "wall_friction": "free_slip",
                    "liquids": [{"name": "water", "density": RHO, "viscosity": 0.001, "artificial_viscosity": 0.05,
                                 "fill": [{"type": "inside", "wall": "tank", "level": DEPTH}]}],
                    "walls": [box("tank", [0, 0, DEPTH], [TANK, BREADTH, 2 * DEPTH], shape={"open": ["+z"]}),
                              box("hull", [0, 0, 0], [WIDTH, BREADTH, HEIGHT], body="block")],
                    "domain": {"min": [-TANK, -TANK, -DEPTH], "max": [TANK, TANK, 4 * DEPTH]}},
            "output": {"frame_interval": 0.5}}


def added_mass(folder, hertz):
    """By the load in phase with the motion over the last two periods: F = -(k - m_a w^2) z."""
    with open(pathlib.Path(folder) / "bodies.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    w, window = 2 * math.pi * hertz, 0.004
    end = float(rows[-1]["time"])
    last = [r for r in rows if float(r["time"]) > end - 2 / hertz - 1e-9]
    loads = [(float(r["time"]) - window / 2, float(r["block.contact_force.z"])) for r in last]   # means over windows
    in_phase = 2 * sum(f * math.sin(w * t) for t, f in loads) / len(loads)
    # In a tank of that width the level sinks where the block rises.
    stiffness = RHO * G * WIDTH * BREADTH / (1 - WIDTH / TANK)
    added = (stiffness + in_phase / AMPLITUDE) / w ** 2
    mass = 0.5 * RHO * WIDTH * HEIGHT * BREADTH
    print(f"mean load {sum(f for _, f in loads) / len(loads):.4g} N, weight {mass * G:.4g} N; added mass {added:.4g} kg, "
          f"period of a block of half the density {2 * math.pi * math.sqrt((mass + added) / stiffness):.4g} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--density", type=float, default=0.5, help="over that of the water")
    parser.add_argument("--raised", type=float, default=0.0)
    parser.add_argument("--forced", type=float, default=0.0)
    parser.add_argument("--scheme", default="implicit")
    parser.add_argument("--end", type=float, default=2.0)
    parser.add_argument("--added-mass", type=float)
    parser.add_argument("-o", "--output")
    parser.add_argument("folder", nargs="?")
    given = parser.parse_args()
    if given.added_mass:
        added_mass(given.folder, given.added_mass)
    else:
        text = json.dumps(scene(given.density, given.raised, given.forced, given.scheme, given.end), indent=1)
        pathlib.Path(given.output).write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
