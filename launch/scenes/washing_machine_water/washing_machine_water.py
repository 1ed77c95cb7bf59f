#!/usr/bin/env python3
"""Writes the washing machine with water to its folder: meshes, washing_machine_water.json (a million particles),
washing_machine_water_preview.json and washing_machine_water_spheres_preview.json (the water as spheres).

washing_machine_water.py -o FILE writes one scene: --spheres with spheres, --dry without water, --end to shorten it.
Lengths in m, masses in kg, times in s. The drum turns about y; its axis is at x = 0, z = 0.5. The front is at -y.
"""
import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from machine_files import Mesh, add_check, eccentric_ring, number, text, vector, write_or_check, write_variant

G = 9.81
AXIS_Z = 0.5
TUB_RADIUS, TUB_LENGTH, TUB_MASS, TUB_Y = 0.28, 0.34, 28, 0.02   # y of the tub's centre of mass
DRUM_RADIUS, DRUM_LENGTH, DRUM_MASS = 0.235, 0.26, 8
HOLE = 0.1                        # edge of the square holes of the preview: four spacings
LIFTERS, LIFTER_WIDTH, LIFTER_HEIGHT = 3, 0.08, 0.05
GAP, SEAM = 0.003, 0.0005     # between drum and lifters; between tub, back and valve
DRAIN_RADIUS, DRAIN_Z = 0.05, -0.21     # round hole in the back of the tub
WATER = 12.0
BALLS, BALL_RADIUS, BALL_DENSITY = 8, 0.06, 600   # laundry
SPEED = 45 * 2 * math.pi / 60
SPRINGS = [(0.28, -0.15, 0.86), (-0.28, -0.15, 0.86), (0.28, 0.18, 0.86), (-0.28, 0.18, 0.86)]
SPRING, SPRING_DAMPING = 3800, 30

# When the commands change.
START, RUNNING, STEADY = 0.2, 0.5, 1.0
REVOLUTION = 2 * math.pi / SPEED
DRAIN, DRAIN_TIME = STEADY + REVOLUTION, 0.25
END = 3.0

DESCRIPTION = (
    "A washing machine with 12 litres of water and eight balls of wet laundry. The drum has holes and three lifters and turns at 45 rpm in a "
    "tub on springs; then a valve in the back of the tub opens and the water runs out. The balls are grains: they and the water load the "
    "same drum, but do not feel each other. washing_machine_water.py wrote this file.")


def drum(panels, rows, fine):
    """A sheet of flat panels with a hole in each cell, but for those below the lifters; closed at both ends. Holes are octagons where
    `fine`, else squares, which have half of the triangles."""
    mesh = Mesh()
    angle = 2 * math.pi / panels
    inner = DRUM_RADIUS * math.cos(angle / 2)
    half, cell = DRUM_RADIUS * math.sin(angle / 2), DRUM_LENGTH / rows
    covered = math.ceil(LIFTER_WIDTH / 2 / (2 * half) - 0.5)     # panels to each side of the one in the middle of a lifter
    spacing = panels // LIFTERS
    for k in range(panels):
        turn = k * angle
        normal, along = (math.cos(turn), math.sin(turn)), (-math.sin(turn), math.cos(turn))

        def place(s, y):
            return (inner * normal[0] + s * along[0], y, inner * normal[1] + s * along[1])
        for row in range(rows):
            low, high = -DRUM_LENGTH / 2 + row * cell, -DRUM_LENGTH / 2 + (row + 1) * cell
            middle = (low + high) / 2
            outline = [(-half, low), (half, low), (half, high), (-half, high)]
            if fine:
                outline = [(-half, low), (0, low), (half, low), (half, middle), (half, high), (0, high), (-half, high), (-half, middle)]
            if min(k % spacing, -k % spacing) <= covered:
                corners = [place(*p) for p in outline]
                mesh.fan(place(0, middle), corners) if fine else mesh.face(*corners)
            elif fine:
                mesh.plate(outline, (0, middle), 0.375 * min(2 * half, cell), place)
            else:
                hole = HOLE / 2
                for (sa, ya), (sb, yb) in zip(outline, outline[1:] + outline[:1]):
                    def corner(s, y):
                        return place(math.copysign(hole, s), middle + math.copysign(hole, y - middle))
                    mesh.face(place(sa, ya), place(sb, yb), corner(sb, yb), corner(sa, ya))
    for y in (-DRUM_LENGTH / 2, DRUM_LENGTH / 2):
        rim = [(DRUM_RADIUS * math.cos((k + 0.5) * angle), y, DRUM_RADIUS * math.sin((k + 0.5) * angle)) for k in range(panels)]
        if fine:     # with the middles of the edges, as the cells have them
            rim = [q for k in range(panels) for q in ((inner * math.cos(k * angle), y, inner * math.sin(k * angle)), rim[k])]
            mesh.fan((0.0, y, 0.0), rim)
        else:
            mesh.face(*rim)
    return mesh


def lifters(panels, corners):
    """Three closed ribs along the drum, with `corners` points along the base."""
    mesh = Mesh()
    radius = DRUM_RADIUS * math.cos(math.pi / panels) - GAP
    half = LIFTER_WIDTH / 2 / radius
    length = DRUM_LENGTH / 2 - GAP
    for k in range(LIFTERS):
        turn = 2 * math.pi * k / LIFTERS
        base = [turn - half + 2 * half * n / (corners - 1) for n in range(corners)]
        outline = [(radius * math.cos(a), radius * math.sin(a)) for a in base]
        for side in (0.012, -0.012) if corners > 2 else (0.0,):
            outline.append(((radius - LIFTER_HEIGHT) * math.cos(turn) - side * math.sin(turn),
                            (radius - LIFTER_HEIGHT) * math.sin(turn) + side * math.cos(turn)))
        mesh.prism(outline, -length, length, lambda x, z, y: (x, -y, z))
    return mesh


def back(segments):
    """The back of the tub, a little larger than it, with the round hole of the drain."""
    mesh = Mesh()
    outline = [(x, z + DRAIN_Z) for x, z in eccentric_ring(TUB_RADIUS + 0.05, -DRAIN_Z, segments)]
    mesh.plate(outline, (0.0, DRAIN_Z), DRAIN_RADIUS, lambda x, z: (x, 0.0, z))
    return mesh


def box(name, position, size, density):
    return {"name": name, "use": "graphics", "density": density, "position": vector(*position),
            "shape": {"type": "box", "size": vector(*size)}}


def springs(load):
    """The springs, with the free lengths that hold the load (mass, y of its centre) at rest where it starts."""
    forces = []
    mass, centre = load
    front, rear = SPRINGS[0][1], SPRINGS[2][1]
    for k, (x, y, z) in enumerate(SPRINGS):
        a, b = (x, y, z), (math.copysign(0.2, x), y, 0.7)
        share = (rear - centre) / (rear - front) if y == front else (centre - front) / (rear - front)
        length = math.dist(a, b)
        pull = mass * G * share / 2 * length / (a[2] - b[2])
        forces.append({"name": f"spring_{k + 1}", "type": "spring_damper", "body_a": "cabinet", "body_b": "tub", "point_a": vector(*a),
                       "point_b": vector(*b), "stiffness": SPRING, "damping": SPRING_DAMPING, "length": number(length - pull / SPRING)})
    for k, (side, low) in enumerate([(1, -1), (-1, -1), (1, 1), (-1, 1)]):
        forces.append({"name": f"damper_{k + 1}", "type": "spring_damper", "body_a": "cabinet", "body_b": "tub",
                       "point_a": vector(0.28 * side, 0.04 * low, 0.06), "point_b": vector(0.2 * side, 0.16 * low, 0.28),
                       "stiffness": 0, "damping": 70, "length": 0.28})
    return forces


def drained(time):
    """Mass that runs out of the tub through the hole in a time, from a level surface: by Torricelli along its height, contraction 0.62."""
    def width(radius, z):
        return 2 * math.sqrt(max(radius ** 2 - z ** 2, 0.0))

    def sum_over(low, high, of, parts=200):
        step = max(high - low, 0.0) / parts
        return step * sum(of(low + (k + 0.5) * step) for k in range(parts))
    low, high = -TUB_RADIUS, 0.0
    for _ in range(50):      # level of the water, over the axis
        level = (low + high) / 2
        full = sum_over(-TUB_RADIUS, level, lambda z: width(TUB_RADIUS, z)) * TUB_LENGTH * 1000
        low, high = (level, high) if full < WATER else (low, level)
    out, step = 0.0, 0.005
    for _ in range(round(time / step)):
        flow = 0.62 * sum_over(DRAIN_Z - DRAIN_RADIUS, min(level, DRAIN_Z + DRAIN_RADIUS),
                               lambda z: width(DRAIN_RADIUS, z - DRAIN_Z) * math.sqrt(2 * G * (level - z)))
        out += 1000 * flow * step
        level -= flow * step / (width(TUB_RADIUS, level) * TUB_LENGTH)
    return out


def scene(name, spacing, spheres=False, water=WATER, end=END):
    coarse = spacing > 0.01
    which = "_coarse" if coarse else ""
    about_y = {"axis": [1, 0, 0], "angle_deg": 90}      # z of a cylinder becomes -y
    wall = {"use": "wall", "material": "steel"}
    laundry = BALLS * BALL_DENSITY * 4 / 3 * math.pi * BALL_RADIUS ** 3
    cabinet = [box("base", (0, 0, 0.02), (0.64, 0.6, 0.04), 300)]
    for k, (x, y) in enumerate([(0.3, 0.28), (0.3, -0.28), (-0.3, 0.28), (-0.3, -0.28)]):
        cabinet.append(box(f"post_{k + 1}", (x, y, 0.46), (0.04, 0.04, 0.84), 300))
    cabinet += [box(f"rail_{k + 1}", (x, 0, 0.86), (0.04, 0.52, 0.04), 300) for k, x in enumerate((0.3, -0.3))]
    cabinet_mass = sum(s["density"] * math.prod(s["shape"]["size"]) for s in cabinet)
    gate_y = TUB_LENGTH / 2 - SEAM - 0.005     # in the tub, in front of the hole
    gate_mass = 1.0
    bodies = [
        {"name": "cabinet", "mass": "from_shapes", "shapes": cabinet},
        {"name": "tub", "mass": TUB_MASS, "inertia": [1.2, 1.4, 1.3], "position": [0, TUB_Y, AXIS_Z], "shapes": [
            {"name": "tub_shell", **wall, "position": [0, -TUB_Y, 0], "orientation": about_y,
             "shape": {"type": "cylinder", "radius": TUB_RADIUS, "height": TUB_LENGTH, "open": ["-z"]}},
            {"name": "tub_back", **wall, "position": vector(0, TUB_LENGTH / 2 + SEAM - TUB_Y, 0), "shape": {"type": "mesh", "file": f"back{which}.obj"}}]},
        {"name": "drum", "mass": DRUM_MASS, "inertia": [0.3, 0.42, 0.3], "position": [0, 0, AXIS_Z], "shapes": [
            {"name": "drum_shell", **wall, "shape": {"type": "mesh", "file": f"drum{which}.obj"}},
            {"name": "lifters", **wall, "shape": {"type": "mesh", "file": f"lifters{which}.obj"}}]},
        {"name": "valve", "mass": gate_mass, "inertia": [1e-3, 1e-3, 1e-3], "position": vector(0, gate_y, AXIS_Z + DRAIN_Z), "shapes": [
            {"name": "valve_plate", **wall, "shape": {"type": "box", "size": [0.12, 0.01, 0.116]}}]}]
    joints = [
        {"name": "feet", "type": "fixed", "child": "cabinet", "position": [0, 0, 0]},
        {"name": "shaft", "type": "revolute", "parent": "tub", "child": "drum", "position": [0, 0, AXIS_Z], "axis": [0, 1, 0], "damping": 0.02},
        {"name": "slide", "type": "prismatic", "parent": "tub", "child": "valve", "position": vector(0, gate_y, AXIS_Z + DRAIN_Z),
         "axis": [0, 0, 1], "motion": {"type": "ramp", "to": 0.12, "start": number(DRAIN), "duration": DRAIN_TIME}}]
    hanging = TUB_MASS + DRUM_MASS + gate_mass + water + laundry
    centre = (TUB_MASS * TUB_Y + gate_mass * gate_y) / hanging
    forces = springs((hanging, centre))
    forces.append({"name": "motor", "type": "motor", "joint": "shaft", "control": "speed", "gains": {"proportional": 50, "integral": 200},
                   "gear_ratio": 10, "max_torque": 3, "rotor_inertia": 2e-4,
                   "target": {"type": "ramp", "to": number(SPEED), "start": START, "duration": RUNNING - START}})
    outlet = {"name": "drain", "region": {"type": "plane", "point": vector(0, TUB_LENGTH / 2 + 0.01, 0), "normal": [0, 1, 0]}}
    domain = {"min": [-0.4, -0.3, 0.1], "max": [0.4, 0.4, 0.9]}
    everywhere = {"name": "water", "body": "tub", "position": [0, -TUB_Y, 0], "orientation": about_y,
                  "shape": {"type": "cylinder", "radius": TUB_RADIUS + 0.05, "height": number(TUB_LENGTH)}}
    in_drum = {"name": "in_drum", "body": "drum", "orientation": about_y, "shape": {"type": "cylinder", "radius": DRUM_RADIUS, "height": DRUM_LENGTH}}
    window = 0.0005 if not coarse else 0.0008 if spheres else 0.001    # two steps of the coarse water
    result = {"tandem": "1.1", "name": name, "description": DESCRIPTION, "end_time": end, "coupling": {"window": window},
              "mbd": {"integrator": {"rho_inf": 0.9}, "bodies": bodies, "joints": joints, "forces": forces}}
    young, poisson = (1e8 if spheres else 8e6), 0.3

    def critical(radius, density):
        return math.pi * radius * math.sqrt(density * 2 * (1 + poisson) / young) / (0.1631 * poisson + 0.8766)

    steel = {"name": "steel", "density": 7850, "young": young, "poisson": poisson, "restitution": 0.3, "friction": 0.4,
             "rolling_friction": 0.1, "rolling_damping": 0.3}
    cloth = {"name": "cloth", "density": BALL_DENSITY, "young": young, "poisson": poisson, "restitution": 0.2, "friction": 0.5,
             "rolling_friction": 0.1, "rolling_damping": 0.3}
    balls = {"name": "laundry", "material": "cloth", "radius": BALL_RADIUS,
             "fill": {"type": "lattice", "min": [-0.122, -0.122, number(AXIS_Z - 0.14)], "max": [0.122, 0.122, number(AXIS_Z + 0.104)],
                      "spacing": 0.122, "count": BALLS}}
    dem = {"rolling": "elastic_plastic", "materials": [steel, cloth], "particles": [balls],
           "settle": {"kinetic_energy": 1e-3, "at_most": 4}, "overlap_limit": 0.1, "domain": domain,
           "micro_step": number(min(window, 0.2 * critical(BALL_RADIUS, BALL_DENSITY))),
           "sensors": [{**everywhere, "name": "laundry_in_tub"}]}
    result["dem"] = dem
    plots = ["motor.torque", "motor.speed", "shaft.rate", "feet.reaction_force.z", "tub.position.*", "water.mass", "in_drum.mass",
             "drum.contact_torque.y", "tub.contact_torque.y"]
    if spheres:
        radius, density = spacing / 2, 1000 / 0.6
        dem["materials"].append({"name": "water", "density": number(density), "young": young, "poisson": poisson, "restitution": 0.3, "friction": 0.02,
                                 "rolling_friction": 0, "rolling_damping": 0})
        dem["pairs"] = [{"a": "water", "b": other, "restitution": 0.3, "friction": 0.02, "rolling_friction": 0, "rolling_damping": 0} for other in ("water", "steel", "cloth")]
        dem["particles"].append({"name": "water", "material": "water", "radius": [number(0.95 * radius), number(1.05 * radius)],
                                 "fill": {"type": "packing", "mass": water, "void_fraction": 0.48, "region": {"type": "inside", "wall": "tub_shell"}}})
        dem["micro_step"] = number(0.25 * critical(0.95 * radius, density))
        dem["settle"] = {"kinetic_energy": number(1e-3 * density * 4 / 3 * math.pi * radius ** 3 * G * radius), "at_most": 4}
        dem["outlets"] = [outlet]
        dem["sensors"] = [everywhere, in_drum]
    elif water:
        result["sph"] = {
            "spacing": spacing, **({"wall_deviation": 0.1} if coarse else {}),
            "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "artificial_viscosity": 0.05, "expected_speed": 1.95 if coarse else 2,
                         "fill": [{"type": "inside", "wall": "tub_shell", "volume": number(water / 1000)}]}],
            # Pressure on the round tub passes the axis: without friction its torque is that of its shape in faces.
            "pairs": [{"liquid": "water", "body": "tub", "wall_friction": "free_slip"}],
            "sensors": [{"type": "load", "name": "drum_load", "body": "drum", "axis": [0, 1, 0]},
                        {"type": "load", "name": "tub_load", "body": "tub", "position": [0, -TUB_Y, 0], "axis": [0, 1, 0]},
                        {"type": "level", "name": "level", "body": "tub", "position": vector(0.0, -TUB_LENGTH / 2 + 0.02 - TUB_Y, -TUB_RADIUS), "axis": [0, 0, 1]},
                        {"type": "region", **everywhere}, {"type": "region", **in_drum}],
            "outlets": [outlet], "domain": domain}
        plots += ["drum_load.axis_torque", "tub_load.axis_torque", "level.level"]
    else:
        plots = [p for p in plots if not p.startswith(("water", "in_drum"))]
    result["output"] = {"frame_interval": 0.048, "plots": plots,
                        "camera": {"eye": [0.75, -1.75, 0.95], "target": [0, 0, 0.44], "field_of_view": 40}}
    checks = []

    def check(*what, **how):
        add_check(checks, *what, **how)

    steady = {"from": number(STEADY), "to": number(DRAIN)}
    check("force on the floor at rest [N]", "feet.reaction_force.z", (cabinet_mass + hanging) * G, 0.01, "weight of machine, laundry and water",
          **{"from": 0.08, "to": START})
    if end > DRAIN:
        check("speed of the wash [rad/s]", "shaft.rate", SPEED, 0.02, "45 rpm", **steady)
    if spheres or water:
        check("water in the tub during the wash [kg]", "water.mass", water + (laundry if spheres else 0), 3e-3,
              "the valve is tight" + ("; with the laundry" if spheres else ""), "min", to=number(min(end, DRAIN)))
    if end > DRAIN and water and not spheres:
        check("torque of the water on the drum [N m]", "drum_load.axis_torque", {"of": "water.moment.x", "times": G}, 0.2,
              "mean over a revolution: weight x offset of the water's centre of mass; pressure on the round tub has no torque", **steady)
    if end >= END and water and not spheres:
        check("water that has run out [kg]", "summary.sph.outlets.drain.mass_kg", drained(END - DRAIN - DRAIN_TIME / 2), 0.35,
              "Torricelli along the height of the hole, contraction 0.62, from a level surface", "last")
        check("water lost [kg]", "summary.sph.lost_kg", 0, 0, "all of it goes through the outlet", "last", True)
    if water and not spheres:
        check("particles that passed a wall", "summary.sph.passed_walls", 0, 0, "no wall is passed", "last", True)
        check("momentum balance of the water", "summary.sph.momentum_balance", 0, 1e-5, "round-off", "last", True)
    check("impulse closure", "summary.impulse_closure", 0, 1e-10, "what the particles recorded is what the bodies received", "last", True)
    result["checks"] = checks
    return result


PREVIEW = 0.025


def files():
    name = "washing_machine_water"
    return {"drum.obj": drum(48, 9, True).obj(f"{name}.py"), "drum_coarse.obj": drum(9, 2, False).obj(f"{name}.py"),
            "lifters.obj": lifters(48, 9).obj(f"{name}.py"), "lifters_coarse.obj": lifters(9, 2).obj(f"{name}.py"),
            "back.obj": back(48).obj(f"{name}.py"), "back_coarse.obj": back(10).obj(f"{name}.py"),
            f"{name}.json": text(scene(name, 0.00228)) + "\n",
            f"{name}_preview.json": text(scene(f"{name}_preview", PREVIEW)) + "\n",
            f"{name}_spheres_preview.json": text(scene(f"{name}_spheres_preview", PREVIEW, spheres=True)) + "\n"}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--spacing", type=float, default=PREVIEW)
    parser.add_argument("--spheres", action="store_true")
    parser.add_argument("--dry", action="store_true")
    parser.add_argument("--end", type=float, default=END)
    parser.add_argument("-o", "--output")
    parser.add_argument("--check", action="store_true", help="compare the files with what this program writes")
    given = parser.parse_args()
    folder = pathlib.Path(__file__).parent
    if given.output:
        output = pathlib.Path(given.output)
        one = scene(output.stem, given.spacing, given.spheres, 0.0 if given.dry else WATER, given.end)
        write_variant(one, folder, output)
        return
    write_or_check(folder, files(), given.check)


if __name__ == "__main__":
    main()
