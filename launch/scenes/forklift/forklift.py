#!/usr/bin/env python3
"""Writes forklift.json (200,000 spheres) and forklift_preview.json (5,000) to its folder.

forklift.py --load none|solid|sand --end SECONDS -o FILE writes one scene with another load, or a shorter one.
Lengths in m, masses in kg, times in s. x is forward, z up; the front axle is at x = 0.
"""
import argparse
import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from machine_files import text

G = 9.81
FRONT_RADIUS, REAR_RADIUS, WHEELBASE, TRACK = 0.30, 0.25, 1.5, 0.98
TYRE_STIFFNESS = 1.2e6      # of a solid tyre, radial [N/m]
MAST_X, PIVOT = 0.40, (0.36, 0, 0.30)
FORK_ROOT, FORK_LENGTH, FORK_THICKNESS, FORK_Y = 0.54, 1.29, 0.04, 0.22
FORK_TOP = 0.13             # lowered
HOOK = (0.03, 0.12, 0.07)   # at the tip of a fork; it keeps the pallet on the forks while they are tilted
CHAIN_STIFFNESS = 1e7       # of each of two [N]
LIFT = 0.85                 # stroke of the lift cylinder; the forks rise by twice that
TILT = math.radians(45)
PALLET = (1.15, 0.80)       # deck
FLOOR = 0.90                # of the box on it; the slope begins there, above the front of the deck
RUNNER, DECK = 0.24, 0.04   # heights
SLOPE, SLOPE_LENGTH = math.radians(30), 0.55
PLATE, SIDE = 0.01, 0.50    # of the box on the pallet: thickness, height
DENSITY, SAND = 2600, 330   # of the grains, and their mass
SAND_X = 0.470              # of its centre, from the rear of the box: measured after it has settled
APPROACH, CARRY = 2.6, 0.9  # ways of the truck
BUMP_X, BUMP_HEIGHT, BUMP_RADIUS = 0.55, 0.025, 0.06

# When the commands change: each phase begins after the one before.
DRIVE, DRIVE_END = 0.4, 3.4
RAISE, RAISE_END = 3.6, 5.6
HOLD = 5.8, 6.2     # the load hangs still
CARRY_BEGIN, CARRY_END = 6.3, 8.1
TIP, TIP_END = 8.5, 10.7
END = 12.5
END_OF_FINE_GRAINS = 14.0   # they run out of the box more slowly
WINDOW = 0.0008

DESCRIPTION = (
    "A fork lifter drives over a bump to a box of sand on a pallet, lifts it, carries it, brakes and tips it out. Its wheels "
    "roll on the floor by contact; motors, brakes and cylinders get commands, nothing is prescribed. forklift.py wrote this file.")


def box(name, use, position, size, density, **more):
    return {"name": name, "use": use, "density": density, "position": [round(x, 6) for x in position],
            "shape": {"type": "box", "size": [round(x, 6) for x in size]}, **more}


def contact_box(name, position, size, density):
    return box(name, "contact", position, size, density, material="steel")


def solid(name, shapes, **more):
    return {"name": name, "mass": "from_shapes", "shapes": shapes, **more}


def volume(shape):
    s = shape["shape"]
    if s["type"] == "box":
        return math.prod(s["size"])
    if s["type"] == "cylinder":
        return math.pi * s["radius"] ** 2 * s["height"]
    return 4 / 3 * math.pi * s["radius"] ** 3


def mass_and_x(bodies):
    """Mass of the bodies together, and x of their centre of mass."""
    parts = [(shape["density"] * volume(shape), body.get("position", [0])[0] + shape["position"][0])
             for body in bodies for shape in body["shapes"]]
    mass = sum(m for m, _ in parts)
    return mass, sum(m * x for m, x in parts) / mass


def wheel(name, x, y, radius):
    flat = [math.sqrt(0.5), math.sqrt(0.5), 0, 0]
    return solid(name, [
        {"name": f"{name}_tyre", "use": "contact", "material": "rubber", "density": 0, "position": [0, 0, 0],
         "shape": {"type": "sphere", "radius": radius}},
        {"name": f"{name}_rim", "use": "graphics", "density": 1800, "position": [0, 0, 0], "orientation": flat,
         "shape": {"type": "cylinder", "radius": radius, "height": 0.16}}], position=[x, y, radius])


def trapezoid(start, end, way):
    """Times and ways of a drive: a quarter of the time each to speed up and to brake. A monotone cubic has the
    slope zero where a neighbouring point has the same value."""
    quarter = (end - start) / 4
    return [(start - 0.1, 0), (start, 0), (start + quarter, way / 6), (end - quarter, way * 5 / 6), (end, way),
            (end + 0.1, way)]


def scene(spheres, load="sand", end=END):
    dump = []   # shapes of all bodies that the truck carries
    chassis = solid("chassis", [
        box("counterweight", "graphics", [-1.35, 0, 0.70], [0.70, 1.00, 0.70], 3900),
        box("frame", "graphics", [-0.40, 0, 0.50], [1.20, 0.66, 0.40], 2400),
        box("hood", "graphics", [-0.75, 0, 0.90], [0.50, 0.90, 0.36], 400),
        box("post_left", "graphics", [-0.05, 0.44, 1.45], [0.06, 0.06, 1.30], 900),
        box("post_right", "graphics", [-0.05, -0.44, 1.45], [0.06, 0.06, 1.30], 900),
        box("rear_post_left", "graphics", [-1.00, 0.44, 1.60], [0.06, 0.06, 1.00], 900),
        box("rear_post_right", "graphics", [-1.00, -0.44, 1.60], [0.06, 0.06, 1.00], 900),
        box("roof", "graphics", [-0.52, 0, 2.12], [1.02, 0.96, 0.04], 900)])
    rear_axle = solid("rear_axle", [
        box("beam", "graphics", [-WHEELBASE, 0, REAR_RADIUS], [0.12, 0.70, 0.12], 7850)])
    half = TRACK / 2
    wheels = [wheel("front_left", 0, half, FRONT_RADIUS), wheel("front_right", 0, -half, FRONT_RADIUS),
              wheel("rear_left", -WHEELBASE, half, REAR_RADIUS), wheel("rear_right", -WHEELBASE, -half, REAR_RADIUS)]
    outer_mast = solid("outer_mast", [
        box("outer_left", "graphics", [MAST_X, 0.35, 1.15], [0.14, 0.05, 2.10], 3000),
        box("outer_right", "graphics", [MAST_X, -0.35, 1.15], [0.14, 0.05, 2.10], 3000),
        box("outer_foot", "graphics", [MAST_X, 0, 0.14], [0.10, 0.65, 0.06], 3000)])
    inner_mast = solid("inner_mast", [
        box("inner_left", "graphics", [MAST_X, 0.29, 1.18], [0.14, 0.05, 2.00], 3000),
        box("inner_right", "graphics", [MAST_X, -0.29, 1.18], [0.14, 0.05, 2.00], 3000),
        box("inner_head", "graphics", [MAST_X, 0, 2.13], [0.10, 0.53, 0.08], 3000)])
    carriage_shapes = [box("plate", "graphics", [FORK_ROOT - 0.03, 0, 0.33], [0.06, 0.80, 0.46], 5000)]
    for side, y in (("left", FORK_Y), ("right", -FORK_Y)):
        carriage_shapes += [
            contact_box(f"fork_{side}", [FORK_ROOT + FORK_LENGTH / 2, y, FORK_TOP - FORK_THICKNESS / 2],
                        [FORK_LENGTH, HOOK[1], FORK_THICKNESS], 7850),
            contact_box(f"hook_{side}", [FORK_ROOT + FORK_LENGTH - HOOK[0] / 2, y, FORK_TOP + HOOK[2] / 2], HOOK, 7850)]
    carriage = solid("carriage", carriage_shapes)
    bodies = [chassis, rear_axle, *wheels, outer_mast, inner_mast, carriage]

    lifted, _ = mass_and_x([carriage])
    truck, truck_x = mass_and_x(bodies)
    rear = -truck_x * truck * G / WHEELBASE
    front = truck * G - rear
    # The truck starts on tyres that its weight has pressed in; the chassis tilts with them.
    for name, axle in (("front", front), ("rear", rear)):
        for body in wheels:
            if body["name"].startswith(name):
                body["position"][2] = round(body["position"][2] - axle / 2 / TYRE_STIFFNESS, 7)

    joints = [
        {"name": "rear_swing", "type": "revolute", "parent": "chassis", "child": "rear_axle",
         "position": [-WHEELBASE, 0, REAR_RADIUS + 0.10], "axis": [1, 0, 0], "damping": 500},
        {"name": "mast_foot", "type": "revolute", "parent": "chassis", "child": "outer_mast",
         "position": PIVOT, "axis": [0, 1, 0], "damping": 200},
        {"name": "mast_guide", "type": "prismatic", "parent": "outer_mast", "child": "inner_mast",
         "position": [MAST_X, 0, 1.2], "axis": [0, 0, 1], "damping": 100},
        {"name": "carriage_guide", "type": "prismatic", "parent": "inner_mast", "child": "carriage",
         "position": [MAST_X, 0, 0.4], "axis": [0, 0, 1], "damping": 100}]
    for body in wheels:
        name = body["name"]
        joints.append({"name": f"{name}_hub", "type": "revolute",
                       "parent": "chassis" if name.startswith("front") else "rear_axle", "child": name,
                       "position": body["position"], "axis": [0, 1, 0]} | (
                           {} if name.startswith("front") else {"damping": 0.5}))

    front_rolling = FRONT_RADIUS - front / 2 / TYRE_STIFFNESS
    drive = trapezoid(DRIVE, DRIVE_END, APPROACH) + [
        (t, APPROACH + x) for t, x in trapezoid(CARRY_BEGIN, CARRY_END, CARRY)]
    forces = []
    for side in ("left", "right"):
        forces.append({
            "name": f"drive_{side}", "type": "motor", "joint": f"front_{side}_hub", "control": "position",
            "target": {"type": "table", "times": [round(t, 4) for t, _ in drive],
                       "values": [round(v / front_rolling, 6) for _, v in drive]},
            "gains": {"proportional": 2e4, "derivative": 4000}, "max_torque": 140, "gear_ratio": 18,
            "rotor_inertia": 0.01,
            "brake": {"torque": 2500, "breakaway": 2800,
                      "engaged": {"type": "table", "interpolation": "linear",
                                  "times": [0, DRIVE - 0.1, DRIVE, DRIVE_END - 0.1, DRIVE_END + 0.2, CARRY_BEGIN - 0.1,
                                            CARRY_BEGIN, CARRY_END - 0.1, CARRY_END + 0.2],
                                  "values": [1, 1, 0, 0, 1, 1, 0, 0, 1]}}})
    tilt_a, tilt_b = (-0.60, 0, 0.95), (MAST_X, 0, 1.10)
    arm = (tilt_b[0] - PIVOT[0], tilt_b[2] - PIVOT[2])
    end_x = PIVOT[0] + arm[0] * math.cos(TILT) + arm[1] * math.sin(TILT)
    end_z = PIVOT[2] - arm[0] * math.sin(TILT) + arm[1] * math.cos(TILT)
    stroke = math.hypot(end_x - tilt_a[0], end_z - tilt_a[2]) - math.dist(tilt_a, tilt_b)
    forces.append({
        "name": "tilt", "type": "cylinder", "body_a": "chassis", "point_a": tilt_a, "body_b": "outer_mast", "point_b": tilt_b,
        "control": "stroke", "target": {"type": "ramp", "to": round(stroke, 6), "start": TIP, "duration": TIP_END - TIP},
        "gains": {"proportional": 4e6, "derivative": 2e5}, "max_force": 8e4})
    forces.append({
        "name": "lift", "type": "cylinder", "body_a": "outer_mast", "point_a": [MAST_X, 0, 0.17], "body_b": "inner_mast",
        "point_b": [MAST_X, 0, 2.09], "control": "stroke",
        "target": {"type": "table", "times": [
            0, RAISE, round(RAISE + 0.25 * (RAISE_END - RAISE), 4), round(RAISE + 0.75 * (RAISE_END - RAISE), 4), RAISE_END,
            END], "values": [0, 0, round(0.4 * (RUNNER - FORK_TOP), 6), round(0.85 * LIFT, 6), LIFT, LIFT]},
        "gains": {"proportional": 4e6, "derivative": 1e5}, "max_force": 6e4})
    for side, y in (("left", 0.15), ("right", -0.15)):
        points = [(MAST_X - 0.05, 1.20), (MAST_X - 0.05, 2.20), (MAST_X + 0.05, 2.20), (MAST_X + 0.05, 0.40)]
        # The width of the pulley is counted, as the rope is straight between its points.
        way = sum(math.dist(p, q) for p, q in zip(points, points[1:]))
        tension = lifted * G / 2
        forces.append({
            "name": f"chain_{side}", "type": "rope",
            "points": [{"body": body, "point": [x, y, z]} for body, (x, z) in
                       zip(("outer_mast", "inner_mast", "inner_mast", "carriage"), points)],
            "length": round(way / (1 + tension / CHAIN_STIFFNESS), 7), "axial_stiffness": CHAIN_STIFFNESS, "damping": 0.5})

    contact = {
        "materials": [
            {"name": "rubber", "stiffness": TYRE_STIFFNESS, "restitution": 0.2, "friction": 0.8},
            {"name": "steel", "stiffness": 2e6, "restitution": 0.1, "friction": 0.4},
            {"name": "concrete", "stiffness": 2e6, "restitution": 0.1, "friction": 0.8}],
        "pairs": [{"a": "rubber", "b": "concrete", "stiffness": TYRE_STIFFNESS, "restitution": 0.2, "friction": 0.8}],
        "ground": [
            {"name": "floor", "material": "concrete", "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}},
            {"name": "bump", "material": "concrete", "position": [BUMP_X, 0, round(BUMP_HEIGHT - BUMP_RADIUS, 6)],
             "orientation": [math.sqrt(0.5), math.sqrt(0.5), 0, 0],
             "shape": {"type": "capsule", "radius": BUMP_RADIUS, "height": 1.6}}],
        "outputs": [{"name": f"{name}_wheels", "on": [f"{name}_left", f"{name}_right"], "from": ["ground"]} for name in ("front", "rear")]}

    result = {
        "tandem": "1.1", "name": "forklift" if spheres > 50000 else "forklift_preview", "description": DESCRIPTION,
        "end_time": end, "coupling": {"window": WINDOW},
        "mbd": {"integrator": {"step": WINDOW, "rho_inf": 0.6}, "bodies": bodies, "joints": joints, "forces": forces,
                "contact": contact}}
    inner = mass_and_x([inner_mast])[0]
    checks = []

    def check(name, of, expected, tolerance, why, reduce="mean", absolute=False, **times):
        checks.append({"name": name, "of": of, "reduce": reduce, **times, "expected": round(expected, 4),
                       "tolerance": tolerance, **({"absolute": True} if absolute else {}), "why": why})

    before = {"from": 0.1, "to": 0.3}
    check("front wheels at rest [N]", "front_wheels.force.z", front, 0.002,
          "balance of moments of the truck about the rear axle", **before)
    check("rear wheels at rest [N]", "rear_wheels.force.z", rear, 0.002,
          "balance of moments about the front axle", **before)
    check("lift cylinder without a load [N]", "lift.force", (2 * lifted + inner) * G, 0.005,
          "twice the weight of the carriage, by the chains, and that of the inner mast", **before)
    check("bump under the front wheels [m]", "front_left.position.z", BUMP_HEIGHT, 0.3,
          "its height; the wheel springs up behind it", "range", to=2.3)
    check("bump under the rear wheels [m]", "rear_left.position.z", BUMP_HEIGHT, 0.3, "its height", "range", to=DRIVE_END)
    check("way to the pallet [m]", "chassis.position.x", APPROACH, 0.02,
          "the angle of the wheels times the radius of the loaded tyre; the bump is longer than the plane", "range",
          to=DRIVE_END + 0.1)
    if load != "none":
        left = FORK_ROOT + APPROACH + 0.05      # rear end of the deck
        middle, length, width = left + PALLET[0] / 2, *PALLET
        bottom = RUNNER + DECK                   # top of the deck
        shapes = [contact_box("deck", [middle, 0, RUNNER + DECK / 2], [length, width, DECK], 700)]
        for side, y in (("left", width / 2 - 0.04), ("right", -width / 2 + 0.04)):
            shapes.append(contact_box(f"runner_{side}", [middle, y, RUNNER / 2], [length, 0.08, RUNNER], 500))
        if load == "solid":
            shapes.append(box("block", "graphics", [middle, 0, bottom + 0.15], [length, width, 0.30], 1600))
        else:
            run = SLOPE_LENGTH * math.cos(SLOPE)
            side_length = PLATE + FLOOR + run
            flat = {"material": "steel"}
            shapes += [
                box("bottom", "wall", [left + FLOOR / 2, 0, bottom + PLATE / 2], [FLOOR, width, PLATE], 2700, **flat),
                box("rear", "wall", [left - PLATE / 2, 0, bottom + SIDE / 2], [PLATE, width, SIDE], 2700, **flat),
                box("side_left", "wall", [left - PLATE + side_length / 2, width / 2 + PLATE / 2, bottom + SIDE / 2],
                    [side_length, PLATE, SIDE], 1350, **flat),
                box("side_right", "wall", [left - PLATE + side_length / 2, -width / 2 - PLATE / 2, bottom + SIDE / 2],
                    [side_length, PLATE, SIDE], 1350, **flat),
                box("slope", "wall",
                    [left + FLOOR + run / 2 + PLATE / 2 * math.sin(SLOPE), 0,
                     bottom + PLATE + SLOPE_LENGTH / 2 * math.sin(SLOPE) - PLATE / 2 * math.cos(SLOPE)],
                    [SLOPE_LENGTH, width, PLATE], 2700, orientation={"axis": [0, 1, 0], "angle": -SLOPE}, **flat)]
            start = bottom + PLATE
            radius = (SAND / (spheres * DENSITY * 4 / 3 * math.pi * 1.01)) ** (1 / 3)
            young, poisson = 1e8, 0.25
            rayleigh = math.pi * 0.9 * radius * math.sqrt(DENSITY * 2 * (1 + poisson) / young) / (0.1631 * poisson + 0.8766)
            result["dem"] = {
                "materials": [
                    {"name": "sand", "density": DENSITY, "young": young, "poisson": poisson, "restitution": 0.3, "friction": 0.4,
                     "rolling_friction": 0.06, "rolling_damping": 0.3},
                    {"name": "steel", "density": 7850, "young": young, "poisson": 0.3, "restitution": 0.3, "friction": 0.3,
                     "rolling_friction": 0.06, "rolling_damping": 0.3},
                    {"name": "concrete", "density": 2400, "young": young, "poisson": 0.2, "restitution": 0.3, "friction": 0.6,
                     "rolling_friction": 0.3, "rolling_damping": 0.3}],
                "rolling": "elastic_plastic", "micro_step": float(f"{0.3 * rayleigh:.2g}"), "overlap_limit": 0.1,
                "particles": [{
                    "name": "sand", "material": "sand", "radius": [round(0.9 * radius, 6), round(1.1 * radius, 6)],
                    "fill": {"type": "packing", "count": spheres, "void_fraction": 0.5, "region": {
                        "type": "box", "min": [round(left, 6), round(-width / 2, 6), round(start, 6)],
                        "max": [round(left + FLOOR, 6), round(width / 2, 6), round(start + 1, 6)]}}}],
                "settle": {"kinetic_energy": float(f"{1e-3 * SAND / spheres * G * radius:.2g}"), "at_most": 4},
                "walls": [{"name": "ground", "material": "concrete",
                           "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}],
                "sensors": [
                    {"name": "payload", "body": "pallet",
                     "position": [round(left + side_length / 2 - PLATE, 6), 0, bottom + 0.5],
                     "shape": {"type": "box", "size": [round(side_length + PLATE, 6), width + 0.04, 1.04]}},
                    {"name": "heap", "position": [6.8, 0, 0.29], "shape": {"type": "box", "size": [6, 6, 0.6]}}],
                "domain": {"min": [0, -4, -0.1], "max": [16, 4, 4]}}
            result["output"] = {
                "frame_interval": 0.12 if spheres < 50000 else 0.24,
                "camera": {"eye": [5.2, -11.5, 4.2], "target": [3.6, 0, 0.8], "field_of_view": 44},
                "plots": ["*_wheels.force.z", "*_wheels.force.x", "load_on_forks.force.z", "lift.force", "tilt.force", "lift.power",
                          "drive_left.power", "tilt.power", "payload.mass", "heap.mass"]}
        bodies.append(solid("pallet", shapes))
        contact["outputs"].append({"name": "load_on_forks", "on": ["pallet"], "from": ["carriage"]})
        pallet, pallet_x = mass_and_x([bodies[-1]])
        sand = SAND if load == "sand" else 0
        load_mass = pallet + sand
        load_x = (pallet * pallet_x + sand * (left + SAND_X)) / load_mass
        held = {"from": HOLD[0], "to": HOLD[1]}
        check("lift cylinder with the load [N]", "lift.force", (2 * (lifted + load_mass) + inner) * G, 0.02,
              "twice the weight of carriage and load, and that of the inner mast", **held)
        check("work of the lift cylinder [J]", "lift.energy",
              ((2 * lifted + inner) * LIFT + load_mass * (2 * LIFT - (RUNNER - FORK_TOP))) * G, 0.03,
              "the weights times their heights: the forks rise to the deck first", **held)
        loaded_rear = -(truck_x * truck + load_mass * (load_x - APPROACH)) * G / WHEELBASE
        check("load on the forks [N]", "load_on_forks.force.z", load_mass * G, 0.005, "its weight", **held)
        check("front wheels with the load [N]", "front_wheels.force.z", (truck + load_mass) * G - loaded_rear, 0.02,
              "balance of moments about the rear axle, with the load on the forks", **held)
        check("rear wheels with the load [N]", "rear_wheels.force.z", loaded_rear, 0.03,
              "balance of moments about the front axle, with the load on the forks", **held)
        if load == "sand":
            check("no grain is spilled on the way [kg]", "payload.mass", SAND, 1e-3, "the box holds all of them", "min",
                  to=TIP)
            check("sand that stays in the box [kg]", "payload.mass", 0, 0.03 * SAND,
                  "the slope of the box is inclined by 15 degrees, its floor by 45", "last", True)
            check("sand in the heap [kg]", "heap.mass", SAND, 0.03, "what was lifted", "last")
            check("no grain is lost", "summary.lost_particles", 0, 0, "they stay in the domain", "last", True)
            check("energy of the coupling", "summary.energy_residual", 0, 1e-3, "relative to the energy exchanged", "last", True)
    check("energy balance of the machine [J]", "summary.mbd_largest_energy_balance_J", 0, 100,
          "of some 15 kJ of work", "last", True)
    result["checks"] = checks
    return result


FILES = ("forklift", 200000, END_OF_FINE_GRAINS), ("forklift_preview", 5000, END)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--load", choices=["none", "solid", "sand"], default="sand")
    parser.add_argument("--spheres", type=int, default=5000)
    parser.add_argument("--end", type=float, default=END)
    parser.add_argument("-o", "--output")
    parser.add_argument("--check", action="store_true", help="compare the files with what this program writes")
    given = parser.parse_args()
    folder = pathlib.Path(__file__).parent
    if given.check:
        for name, spheres, end in FILES:
            if (folder / f"{name}.json").read_text(encoding="utf-8") != text(scene(spheres, end=end)) + "\n":
                sys.exit(f"{name}.json is not what forklift.py writes: run it")
        return
    if given.output:
        pathlib.Path(given.output).write_text(text(scene(given.spheres, given.load, given.end)) + "\n", encoding="utf-8")
        return
    for name, spheres, end in FILES:
        (folder / f"{name}.json").write_text(text(scene(spheres, end=end)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
