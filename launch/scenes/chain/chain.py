#!/usr/bin/env python3
"""Writes chain.json (200 links) and chain_preview.json (40) to its folder; --check: says whether they differ.

A chain of round links hangs over a wheel that a motion turns. Every second link lies in a pocket of the wheel between two teeth; the
others stand in its groove. The wheel pulls one strand up and lets the other one down.
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from machine_files import write_scenes  # noqa: E402

G = 9.81  # [m/s2]
PITCH, WIRE, WIDTH = 0.036, 0.008, 0.020  # inner length of a link; wire; between the axes of its sides [m]
DENSITY = 7800  # [kg/m3]
POCKETS = 6  # of the wheel: two links each
STIFFNESS, FRICTION, RESTITUTION = 1e6, 0.2, 0.1
STEP, WINDOW = 5e-4, 2e-3  # [s]
GROOVE = 0.014  # width of the groove [m]
SPEED, START, DURATION = 0.3, 0.3, 0.2  # of the chain [m/s], the begin of its motion, until it has that speed [s]

LENGTH = PITCH + WIRE  # between the axes of the ends of a link [m]
# Links on the wheel are the sides of a polygon; the wires of two links cross at its corners, and touch.
ANGLE = math.pi / POCKETS  # of one link [rad]
CORNER = LENGTH / 2 - WIRE / (1 + math.cos(ANGLE))  # from the middle of a link [m]
RADIUS = CORNER / math.tan(ANGLE / 2)  # from the axle to the middle of a link [m]


def rotated(q, v):
    w, u = q[0], q[1:]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    t = [2 * c for c in cross(u, v)]
    return [v[k] + w * t[k] + cross(u, t)[k] for k in range(3)]


def product(p, q):
    return [p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
            p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]]


def turn(axis, angle):
    return [math.cos(angle / 2)] + [math.sin(angle / 2) * a for a in axis]


def capsule(name, middle, along, length):
    """Along x or y of the link."""
    return {"name": name, "use": "contact", "material": "steel", "position": middle,
            "orientation": turn((0, 1, 0), math.pi / 2) if along == "x" else turn((1, 0, 0), math.pi / 2),
            "shape": {"type": "capsule", "radius": WIRE / 2, "height": length}}


def link(i, position, orientation):
    """In its x-y plane, along x."""
    wire = math.pi * WIRE**2 / 4 * DENSITY
    sides, ends = 2 * LENGTH * wire, 2 * WIDTH * wire
    xx = sides * WIDTH**2 / 4 + ends * WIDTH**2 / 12
    yy = sides * LENGTH**2 / 12 + ends * LENGTH**2 / 4
    thick = (sides + ends) * WIRE**2 / 16
    return {"name": f"link_{i + 1}", "mass": sides + ends, "inertia": [xx + thick, yy + thick, xx + yy + thick],
            "position": position, "orientation": orientation,
            "shapes": [capsule("left", [0, WIDTH / 2, 0], "x", LENGTH), capsule("right", [0, -WIDTH / 2, 0], "x", LENGTH),
                       capsule("front", [LENGTH / 2, 0, 0], "y", WIDTH), capsule("back", [-LENGTH / 2, 0, 0], "y", WIDTH)]}


def chain(count):
    """Half of the wheel, from +x over +z to -x, and two strands. The axle is y; links turn about it."""
    on_wheel = POCKETS + 1  # with the ones at its sides
    up = (count - on_wheel) // 2
    down = count - on_wheel - up
    bodies = []

    def add(x, z, heading, flat):
        """`heading`: angle of the direction of the chain in the x-z plane, from x to z; flat: across the wheel."""
        orientation = turn((0, 1, 0), -heading)
        if not flat:
            orientation = product(orientation, turn((1, 0, 0), math.pi / 2))
        bodies.append(link(len(bodies), [x, 0, z], orientation))

    # Link k of the wheel is at the angle k ANGLE from +x; its middle is RADIUS from the axle.
    for k in range(up):
        add(RADIUS, -PITCH * (up - k), math.pi / 2, (up - k) % 2 == 0)
    for k in range(on_wheel):
        a = k * ANGLE
        add(RADIUS * math.cos(a), RADIUS * math.sin(a), a + math.pi / 2, k % 2 == 0)
    for k in range(down):
        add(-RADIUS, -PITCH * (k + 1), -math.pi / 2, (POCKETS + k + 1) % 2 == 0)
    return bodies


def wheel():
    """Flat links lie on the sides of two polygons beside the groove, with teeth at their corners; the polygons' sides are as far
    from the axle as the underside of the flat links."""
    low = RADIUS - WIRE / 2  # of the flats [m]
    half = low * math.tan(ANGLE)  # of a flat, to the next one's [m]
    shapes = []
    tooth, high = PITCH * 2 - LENGTH - WIRE - 0.004, 0.014  # along the flat at its foot, above it [m]
    for side, sign in (("left", 1), ("right", -1)):
        y0, y1 = sign * GROOVE / 2, sign * (GROOVE / 2 + 0.016)
        for k in range(POCKETS):
            a = 2 * k * ANGLE
            radial, along = (math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))
            place = lambda r, s, y: [r * radial[0] + s * along[0], y, r * radial[1] + s * along[1]]
            shapes.append({"name": f"{side}_flat_{k + 1}", "use": "contact", "material": "steel", "shape": {
                "type": "convex_hull", "points": [place(r, s, y) for y in (y0, y1) for r, s in ((0.3 * low, 0), (low, half), (low, -half))]}})
            # At the corner: its axis is at the angle of the standing link.
            b = a + ANGLE
            radial, along = (math.cos(b), math.sin(b)), (-math.sin(b), math.cos(b))
            foot = low / math.cos(ANGLE) - 0.004
            place = lambda r, s, y: [r * radial[0] + s * along[0], y, r * radial[1] + s * along[1]]
            shapes.append({"name": f"{side}_tooth_{k + 1}", "use": "contact", "material": "steel", "shape": {
                "type": "convex_hull", "points": [place(r, s, y) for y in (y0, y1)
                                                  for r, s in ((foot, tooth / 2), (foot, -tooth / 2), (foot + high, tooth / 4), (foot + high, -tooth / 4))]}})
    return {"name": "wheel", "mass": 2, "inertia": [0.01, 0.01, 0.01], "position": [0, 0, 0], "shapes": shapes}


def scene(name, count, end):
    rate = SPEED / PITCH * ANGLE  # [rad/s]
    last = f"link_{count}"
    return {
        "tandem": "1.1", "name": name,
        "description": f"A chain of {count} round links hangs over a wheel with {POCKETS} pockets, which a motion turns. chain.py wrote this file.",
        "gravity": [0, 0, -G], "end_time": end, "coupling": {"window": WINDOW},
        "mbd": {"integrator": {"step": STEP}, "bodies": [wheel()] + chain(count),
                "joints": [{"name": "axle", "type": "revolute", "child": "wheel", "position": [0, 0, 0], "axis": [0, 1, 0],
                            "motion": {"type": "ramp", "of": "speed", "from": 0, "to": -rate, "start": START, "duration": DURATION}}],
                "contact": {"impacts": "time_stepping",
                            "materials": [{"name": "steel", "stiffness": STIFFNESS, "restitution": RESTITUTION, "friction": FRICTION}]}},
        "output": {"frame_interval": 0.02},
        "checks": [
            {"name": "way of the first link up [m]", "of": "link_1.position.z", "from": START, "reduce": "range",
             "expected": SPEED * (end - START - DURATION / 2), "tolerance": 0.003, "absolute": True, "why": "the chain does not slip: one pitch for each side of the wheel"},
            {"name": "the last link is below [m]", "of": f"{last}.position.x", "expected": -RADIUS, "tolerance": 0.02, "absolute": True,
             "why": "its strand hangs"},
            {"name": "steps whose friction does not fit", "of": "summary.mbd_contact_unsettled_steps", "expected": 0, "tolerance": 5,
             "absolute": True, "why": "friction is mu times the normal force of the same step"},
        ]}


FILES = ("chain", 200, 3), ("chain_preview", 40, 1)


if __name__ == "__main__":
    write_scenes(__doc__, pathlib.Path(__file__).resolve().parent, {name: scene(name, count, end) for name, count, end in FILES})
