#!/usr/bin/env python3
"""Times a rotating drum, half full, once its bed tumbles steadily.
Usage: drum.py TANDEM SPHERES OUT [--backend cpu|cuda] [--segments N] [--time S] [--record CSV COMMIT] ...
Needs python3-h5py for the last line, the angle by which the bed leans."""
import math

import stages

parser = stages.arguments(__doc__)
parser.add_argument("--segments", type=int, default=0, help="flat faces of the drum's side; 0: round")
given = parser.parse_args()

# The bed fills half of a drum that is twice as wide as long: N VOLUME / BED = pi/2 a^2 a.
a = (2 * given.spheres * stages.VOLUME / (math.pi * stages.BED)) ** (1 / 3)  # its radius, and length [m]
rate = math.sqrt(0.05 * stages.GRAVITY / a)  # Froude number 0.05: a rolling bed with a flat surface [rad/s]
shape = {"type": "cylinder", "radius": a, "height": a}
if given.segments:
    shape |= {"segments": given.segments, "radius": a / math.cos(math.pi / given.segments)}
wall = {"name": "drum", "body": "drum", "material": "glass", "shape": shape,
        "orientation": [math.sqrt(0.5), math.sqrt(0.5), 0, 0]}  # its axis is y
side = 0.68 * a  # half the side of a square inside the circle, for the fill
bound = 1.2 * a
scene = stages.scene(given, "drum", [wall], [-side, -a / 2, -side], [side, a / 2, side],
                     ([-bound, -bound, -bound], [bound, bound, bound]))
scene["mbd"] = {
    "bodies": [{"name": "drum", "mass": 1, "inertia": [1, 1, 1]}],
    "joints": [{"name": "axle", "type": "revolute", "child": "drum", "position": [0, 0, 0], "axis": [0, 1, 0],
                "motion": {"type": "constant", "rate": rate}}]}
scene["output"] = {"camera": {"eye": [0, -6 * a, 0.6 * a], "target": [0, 0, 0], "field_of_view": 36}}

# The spheres fall, and the drum lifts them until they roll.
summary = stages.run(given, scene, 2 * math.sqrt(2 * a / stages.GRAVITY) + 1.5 / rate)

lean = []
for time, frame in (stages.frames(given.out / "timed")[i] for i in (0, -1)):
    x, _, z = frame["position"][:].mean(axis=0)
    lean.append(math.degrees(math.atan2(-x, -z)))
    speed = frame["speed"][:]
    print(f"at {time:.3f} s the bed leans by {lean[-1]:.1f} degrees; speeds: mean {speed.mean():.3f} m/s, largest "
          f"{speed.max():.3f} m/s, of the wall {rate * a:.3f} m/s")
stages.keep(given, summary, lean_at_first_degrees=round(lean[0], 1), lean_degrees=round(lean[1], 1))
