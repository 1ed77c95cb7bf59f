#!/usr/bin/env python3
"""Times a hopper that empties through a funnel, a mesh, into a bin below it. The number of spheres stays constant.
Usage: hopper.py TANDEM SPHERES OUT [--backend cpu|cuda] [--time S] [--record CSV COMMIT] ...
Needs python3-h5py for the last line, the flow through the orifice compared with Beverloo's law."""
import math

import stages

given = stages.arguments(__doc__).parse_args()

# A bed as high as the hopper is wide: N VOLUME / BED = pi a^2 2a.
bed = given.spheres * stages.VOLUME / stages.BED            # [m3]
a = max((bed / (2 * math.pi)) ** (1 / 3), 16 * stages.RADIUS)  # its radius [m]
orifice = max(0.3 * a, 8 * stages.RADIUS)                   # likewise [m]
top = a - orifice                                           # where the cone of 45 degrees ends; the orifice is at 0 [m]
fill = 1.3 * given.spheres / stages.LATTICE / (1.36 * a) ** 2 + 4 * stages.SPACING  # height of the fill [m]
rim = top + fill                                            # [m]
wide = 1.8 * a                                              # radius of the bin below, so that the fall is short [m]
floor = -(bed / (math.pi * wide**2) + 0.4 * a)              # [m]


def write_funnel(path, sectors=96, rings=8):
    """The mesh of the cone and the cylinder above it."""
    profile = [(orifice + top * i / rings, top * i / rings) for i in range(rings + 1)]
    profile += [(a, top + (rim - top) * i / rings) for i in range(1, rings + 1)]
    with open(path, "w") as file:
        for radius, z in profile:
            for k in range(sectors):
                angle = 2 * math.pi * k / sectors
                file.write(f"v {radius * math.cos(angle):.9g} {radius * math.sin(angle):.9g} {z:.9g}\n")
        for i in range(len(profile) - 1):
            for k in range(sectors):
                p, q = i * sectors + k + 1, i * sectors + (k + 1) % sectors + 1
                file.write(f"f {p} {q} {q + sectors}\nf {p} {q + sectors} {p + sectors}\n")


given.out.mkdir(parents=True, exist_ok=True)
write_funnel(given.out / "funnel.obj")
walls = [{"name": "funnel", "material": "glass", "shape": {"type": "mesh", "file": "funnel.obj"}},
         {"name": "floor", "material": "glass", "shape": {"type": "plane", "point": [0, 0, floor], "normal": [0, 0, 1]}},
         {"name": "bin", "material": "glass", "position": [0, 0, floor / 2],
          "shape": {"type": "cylinder", "radius": wide, "height": -floor, "open": ["+z", "-z"]}}]
side, bound = 0.68 * a, 1.1 * wide
scene = stages.scene(given, "hopper", walls, [-side, -side, top], [side, side, top + fill],
                     ([-bound, -bound, floor - 0.1 * a], [bound, bound, rim + 0.5 * a]))
scene["output"] = {"camera": {"eye": [0, -3.8 * (rim - floor), rim], "target": [0, 0, (rim + floor) / 2],
                              "field_of_view": 36}}

# The column collapses into the funnel.
summary = stages.run(given, scene, 1.5 * math.sqrt(2 * (top + 0.3 * fill) / stages.GRAVITY))

(begin, first), (end, last) = (stages.frames(given.out / "timed")[i] for i in (0, -1))
below = [int((frame["position"][:, 2] < 0).sum()) for frame in (first, last)]
flow = (below[1] - below[0]) * stages.VOLUME * stages.DENSITY / (end - begin)
beverloo = (0.58 * stages.BED * stages.DENSITY * math.sqrt(stages.GRAVITY) *
            (2 * orifice - 1.4 * 2 * stages.RADIUS) ** 2.5)
print(f"{below[0]} of {given.spheres} spheres are below the orifice at {begin:.3f} s, {below[1]} at {end:.3f} s: "
      f"{flow:.2f} kg/s; Beverloo (C = 0.58, k = 1.4): {beverloo:.2f} kg/s")
stages.keep(given, summary, flow_kg_per_s=round(flow, 2), beverloo_kg_per_s=round(beverloo, 2))
