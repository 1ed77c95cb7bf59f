#!/usr/bin/env python3
"""Writes a scene whose spheres are not all present at once: a step should only cost the time of the present ones.
Usage: inlets.py few|through|gone SPHERES FILE [--end SECONDS]
few      an inlet has brought in only the first of its SPHERES
through  spheres come in, fall and go out again
gone     an outlet removes the SPHERES of the start in the first window, and few come in"""
import argparse
import json

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("which", choices=["few", "through", "gone"])
arguments.add_argument("spheres", type=int)
arguments.add_argument("file")
arguments.add_argument("--end", type=float, default=0.1, help="simulated time [s]")
given = arguments.parse_args()


def group(name, fill):
    return {"name": name, "material": "glass", "radius": 0.003, "velocity": [0, 0, -1], "fill": fill}


rain = {"type": "inlet", "min": [-0.1, -0.1, 0.3], "max": [0.1, 0.1, 0.5],
        "rate": 4000 if given.which == "through" else 500, "count": given.spheres}
groups, outlets = [group("rain", rain)], []
far = 0.2
if given.which == "through":
    outlets = [{"name": "drain", "region": {"type": "box", "min": [-0.2, -0.2, -0.1], "max": [0.2, 0.2, 0.1]}}]
if given.which == "gone":
    rain["count"] = 1000
    side = 0.007 * (given.spheres ** (1 / 3) + 1)
    far += side
    box = {"min": [0.2, 0, 0], "max": [far, side, side]}
    groups.append(group("gone", {"type": "lattice", **box, "spacing": 0.007, "count": given.spheres}))
    outlets = [{"name": "door", "region": {"type": "box", **box}}]
scene = {
    "tandem": "1.0",
    "name": given.which,
    "end_time": given.end,
    "coupling": {"window": 0.001},
    "dem": {
        "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.5,
                       "friction": 0.4}],
        "particles": groups,
        "walls": [{"name": "floor", "material": "glass", "position": [0, 0, 0.25],
                   "shape": {"type": "box", "size": [0.3, 0.3, 0.5], "open": ["+z"]}}],
        "outlets": outlets,
        "domain": {"min": [-0.2, -0.2, -0.1], "max": [far, far, max(0.6, far)]},
    },
}
with open(given.file, "w") as file:
    json.dump(scene, file, indent=1)
