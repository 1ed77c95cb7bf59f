#!/usr/bin/env python3
"""Writes parcels.json (100 parcels) and parcels_preview.json (18) to its folder; --check: says whether they differ.

Parcels of five sizes stand on a belt, three beside each other. The belt takes them along, and drops them on a chute into a bin.
The bin takes half of 100: the others jam on the chute, back to the belt, which slides under them.
"""
import math
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from machine_files import write_scenes  # noqa: E402

G = 9.81  # [m/s2]
SPEED, FRICTION, SLIPPERY = 1.2, 0.4, 0.15  # of the belt [m/s]; of cardboard, and of it on steel
SIZES = (0.40, 0.30, 0.25), (0.30, 0.30, 0.20), (0.25, 0.20, 0.20), (0.45, 0.25, 0.15), (0.20, 0.20, 0.20)  # [m]
DENSITY = 200  # [kg/m3]
STIFFNESS = 2e5  # of a point [N/m]
HEIGHT, WIDTH = 2.0, 1.6  # of the belt, and between the guides [m]
SLOPE, CHUTE = math.radians(33), 3.0  # of the chute [rad], its length [m]
BIN = 3.0  # length of the bin [m]
ABREAST, DISTANCE = 3, 0.55  # parcels in a row; of two rows [m]
STEP, WINDOW = 2e-3, 1e-2  # [s]


def parcels(count):
    """From the front to the back, turned a little as people place them."""
    chance = random.Random(7)
    bodies = []
    for i in range(count):
        size = SIZES[i % len(SIZES)]
        mass = DENSITY * size[0] * size[1] * size[2]
        inertia = [mass / 12 * (size[(k + 1) % 3]**2 + size[(k + 2) % 3]**2) for k in range(3)]
        turn = chance.uniform(-0.3, 0.3)
        depth = mass * G / (4 * STIFFNESS)
        bodies.append({
            "name": f"parcel_{i + 1}", "mass": mass, "inertia": inertia,
            "position": [-0.4 - DISTANCE * (i // ABREAST), 0.5 * (i % ABREAST - 1), HEIGHT + size[2] / 2 - depth],
            "orientation": [math.cos(turn / 2), 0, 0, math.sin(turn / 2)],
            "shapes": [{"name": "box", "use": "contact", "material": "cardboard", "shape": {"type": "box", "size": list(size)}}]})
    return bodies


def box(name, low, high, material="steel", **more):
    return {"name": name, "material": material, "position": [(a + b) / 2 for a, b in zip(low, high)], **more,
            "shape": {"type": "box", "size": [b - a for a, b in zip(low, high)]}}


def ground(length):
    """The belt ends at x = 0; all plates are 0.1 m thick."""
    y, end = WIDTH / 2, CHUTE * math.cos(SLOPE)
    low = HEIGHT - 0.05 - CHUTE * math.sin(SLOPE)  # of the chute's end

    def tilted(name, across, above, width):
        """A plate of the chute, from 0.1 m below its surface to some way above it."""
        up = above / 2 - 0.05
        return {"name": name, "material": "steel",
                "position": [end / 2 + up * math.sin(SLOPE), across, (HEIGHT - 0.05 + low) / 2 + up * math.cos(SLOPE)],
                "orientation": [math.cos(SLOPE / 2), 0, math.sin(SLOPE / 2), 0],
                "shape": {"type": "box", "size": [CHUTE, width, 0.1 + above]}}

    return [
        box("belt", [-length, -y, HEIGHT - 0.1], [0, y, HEIGHT], "cardboard", surface_velocity=[SPEED, 0, 0]),
        tilted("chute", 0, 0, WIDTH), tilted("left_side", y + 0.05, 0.45, 0.1), tilted("right_side", -y - 0.05, 0.45, 0.1),
        box("left_guide", [-length, y, HEIGHT - 0.1], [0, y + 0.1, HEIGHT + 0.3]),
        box("right_guide", [-length, -y - 0.1, HEIGHT - 0.1], [0, -y, HEIGHT + 0.3]),
        box("left_wall", [end - 1, y, 0], [end + BIN, y + 0.1, 1.2]),
        box("right_wall", [end - 1, -y - 0.1, 0], [end + BIN, -y, 1.2]),
        box("end_wall", [end + BIN, -y - 0.1, 0], [end + BIN + 0.1, y + 0.1, 1.2]),
        box("floor", [end - 1, -y - 0.1, -0.1], [end + BIN + 0.1, y + 0.1, 0])]


def scene(name, count, end):
    rows = -(-count // ABREAST)
    way = SPEED**2 / (2 * FRICTION * G)  # in which a parcel slides until it has the speed of the belt
    checks = [
        {"name": "way of the last parcel after 1 s [m]", "of": f"parcel_{count}.position.x", "to": 1, "reduce": "max",
         "expected": -0.4 - DISTANCE * (rows - 1) + SPEED * 1 - way, "tolerance": 0.003, "absolute": True,
         "why": "v t - v^2 / (2 mu g), less v h / 2 for the length h of the step"},
        {"name": "speed of the last parcel on the belt [m/s]", "of": f"parcel_{count}.velocity.x", "from": 1, "to": 1.2,
         "reduce": "mean", "expected": SPEED, "tolerance": 1e-6, "absolute": True, "why": "it stands on the belt"},
        {"name": "rate of the last parcel at the end [m/s]", "of": f"parcel_{count}.velocity.x", "from": end - 1, "reduce": "mean",
         "expected": 0, "tolerance": 0.01, "absolute": True, "why": "it lies in the bin, or stands in the jam"},
        {"name": "place of the last parcel at the end [m]", "of": f"parcel_{count}.position.x",
         "expected": 0 if count > 50 else 4, "tolerance": 2.5 if count > 50 else 1.5, "absolute": True,
         "why": "in the jam, on the chute or the end of the belt: round-off decides where it ends" if count > 50 else "in the bin"},
        {"name": "no parcel is lost [m]", "of": "parcel_1.position.z", "reduce": "min", "expected": 0.5, "tolerance": 0.5,
         "absolute": True, "why": "above the floor"},
        {"name": "steps whose friction does not fit", "of": "summary.mbd_contact_unsettled_steps", "expected": 0, "tolerance": 5,
         "absolute": True, "why": "friction is mu times the normal force of the same step"}]
    camera = {"eye": [5.2, -4.6, 5.2], "target": [0.3, 0, 1.3], "field_of_view": 45}  # of the jam
    if count <= 50:
        camera = {"eye": [0.6, -4.4, 6.4], "target": [3.2, 0, 0.6], "field_of_view": 45}  # of the bin
    return {
        "tandem": "1.1", "name": name,
        "description": f"{count} parcels of five sizes on a belt, which drops them on a chute into a bin. "
                       "parcels.py wrote this file.",
        "gravity": [0, 0, -G], "end_time": end, "coupling": {"window": WINDOW},
        "mbd": {"integrator": {"step": STEP}, "bodies": parcels(count),
                "contact": {"impacts": "time_stepping",
                            "materials": [{"name": name, "stiffness": STIFFNESS, "restitution": 0.1, "friction": FRICTION}
                                          for name in ("cardboard", "steel")],
                            "pairs": [{"a": "cardboard", "b": "steel", "friction": SLIPPERY}],
                            "ground": ground(0.8 + DISTANCE * rows)}},
        "output": {"frame_interval": 0.1, "camera": camera}, "checks": checks}


FILES = ("parcels", 100, 22), ("parcels_preview", 18, 7)


if __name__ == "__main__":
    write_scenes(__doc__, pathlib.Path(__file__).resolve().parent, {name: scene(name, count, end) for name, count, end in FILES})
