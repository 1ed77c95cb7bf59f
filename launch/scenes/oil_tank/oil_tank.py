#!/usr/bin/env python3
"""Writes the oil tank on a truck to its folder: baffle.obj, oil_tank.json (a million particles), oil_tank_preview.json and
oil_tank_spheres_preview.json (the oil as spheres).

oil_tank.py --no-baffles -o FILE writes one scene without baffles, --spacing METRES one with other particles, --spheres the one with
spheres. Lengths in m, masses in kg, times in s. x is forward, y left, z up; the front axle is at x = 0, the road at z = 0.
"""
import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from machine_files import Mesh, add_check, eccentric_ring, number, text, vector, write_or_check, write_variant

G = 9.81
SPEED = 60 / 3.6
# The tank: 10 m3, half full.
RADIUS = 0.8
LENGTH = 10 / (math.pi * RADIUS ** 2)
TANK_X, TANK_Z, TANK_MASS = -3.75, 1.95, 1500
OIL_DENSITY, OIL_VISCOSITY = 870, 0.05
OIL_VOLUME = 5.0
# Two baffles, each with a round hole of four spacings of the preview.
BAFFLE_GAP, BAFFLE_GAP_COARSE = 0.004, 0.02   # between the rim of a baffle and the shell, which the solver makes flat faces
HOLE_RADIUS, HOLE_Z = 0.32, 0.36
# The truck: three axles, of which the rear two share the load.
AXLES = {"front": 0.0, "middle": -4.2, "rear": -5.5}
TRACK, TYRE_RADIUS = 2.0, 0.5
TYRE = {"front": 9e5, "middle": 1.8e6, "rear": 1.8e6}      # stiffness of a wheel [N/m]; twin tyres at the rear
WHEEL = {"front": (110, 14), "middle": (200, 25), "rear": (200, 25)}   # mass, and inertia about the axle
CARRIER_MASS, KNUCKLE_MASS = 120, 40
SPRING, DAMPER = 2.4e5, 1.4e4       # of a wheel
FRICTION, SLIP, CORNERING, RELAXATION, ROLLING = 0.8, 12, 7, 0.4, 0.006
MOUNT_X, MOUNT_Y, MOUNT_Z = 1.7, 0.42, 1.10    # the tank rests on four mounts on the rails of the frame
MOUNT_STIFFNESS, MOUNT_DAMPING = 2e7, 1.5e5

# When the commands change.
REST = (0.15, 0.3)
STEER, STEER_TIME, STEER_ANGLE = 0.3, 3.0, math.radians(2.5)
BRAKE, BRAKE_RISE, DECELERATION = 3.3, 0.3, 3.5
END = 8.36

DESCRIPTION = (
    "A truck with three axles carries a round tank of 10 m3, half full of oil, with two baffles. At 60 km/h it changes lane and then brakes "
    "until it stands. Nothing is prescribed but the angle of the front wheels: brakes, springs and tyres do the rest. "
    "oil_tank.py wrote this file.")


def baffle(segments, gap):
    """A sheet across the x axis with a round hole in its lower half, through which alone the oil passes it."""
    outline = [(y, z - HOLE_Z) for y, z in eccentric_ring(RADIUS - gap, HOLE_Z, segments)]
    mesh = Mesh()
    mesh.plate(outline, (0.0, -HOLE_Z), HOLE_RADIUS, lambda y, z: (0.0, y, z))
    return mesh


def box(name, position, size, density):
    return {"name": name, "use": "graphics", "density": density, "position": vector(*position),
            "shape": {"type": "box", "size": vector(*size)}}


CHASSIS = [
    box("rail_left", (-2.65, 0.42, 0.97), (7.3, 0.09, 0.26), 3500), box("rail_right", (-2.65, -0.42, 0.97), (7.3, 0.09, 0.26), 3500),
    box("engine", (0.15, 0, 0.95), (1.2, 0.72, 0.5), 2600),
    box("cab", (0.35, 0, 2.1), (1.7, 2.3, 1.8), 180),
    box("cross_member", (-5.0, 0, 0.85), (0.5, 0.7, 0.2), 3500),
    box("bumper", (-6.2, 0, 0.7), (0.12, 2.3, 0.2), 1200)]


def chassis_mass():
    """Mass, centre of mass and moment of inertia about the vertical axis through it."""
    parts = [(s["density"] * math.prod(s["shape"]["size"]), s["position"], s["shape"]["size"]) for s in CHASSIS]
    mass = sum(m for m, _, _ in parts)
    x = sum(m * p[0] for m, p, _ in parts) / mass
    yaw = sum(m * ((p[0] - x) ** 2 + p[1] ** 2 + (s[0] ** 2 + s[1] ** 2) / 12) for m, p, s in parts)
    return mass, x, yaw


def tank_inertia():
    """Of a shell with a quarter of its mass in its ends and baffles."""
    side, discs = 0.75 * TANK_MASS, 0.25 * TANK_MASS
    about_axis = side * RADIUS ** 2 + discs * RADIUS ** 2 / 2
    across = side * (RADIUS ** 2 / 2 + LENGTH ** 2 / 12) + discs * (RADIUS ** 2 / 4 + (LENGTH / 2) ** 2 * 0.55)
    return vector(about_axis, across, across)


def loads(oil):
    """Force of the springs and load of the tyres of each axle at rest; the springs are set so that the rear axles share their load."""
    mass, x, _ = chassis_mass()
    sprung = mass + TANK_MASS + oil
    moment = mass * x + (TANK_MASS + oil) * TANK_X
    rear = moment / (AXLES["middle"] + AXLES["rear"]) * G
    spring = {"front": sprung * G - 2 * rear, "middle": rear, "rear": rear}
    unsprung = {a: 2 * (CARRIER_MASS + WHEEL[a][0] + (KNUCKLE_MASS if a == "front" else 0)) for a in AXLES}
    return spring, {a: spring[a] + unsprung[a] * G for a in AXLES}


def steering(t):
    s = (t - STEER) / STEER_TIME
    return STEER_ANGLE * math.sin(2 * math.pi * s) if 0 < s < 1 else 0.0


def lane_change(oil):
    """Lateral way of the chassis' centre of mass until the brakes act, by the plane motion of a rigid truck with frozen oil on three
    tyres (brush with relaxation, docs/tyres.md), and its largest lateral acceleration."""
    mass, x, yaw = chassis_mass()
    _, load = loads(oil)
    unsprung = {a: load[a] / G - loads(oil)[0][a] / G for a in AXLES}
    parts = [(mass, x, yaw), (TANK_MASS, TANK_X, tank_inertia()[2]), (oil, TANK_X, oil * LENGTH ** 2 / 12)]
    parts += [(unsprung[a], AXLES[a], unsprung[a] * (TRACK / 2) ** 2) for a in AXLES]
    total = sum(m for m, _, _ in parts)
    centre = sum(m * p for m, p, _ in parts) / total
    inertia = sum(i + m * (p - centre) ** 2 for m, p, i in parts)

    def rates(t, s):
        y, heading, along, across, turn, *tread = s
        ahead = side = moment = 0.0
        result = []
        for a, v in zip(AXLES, tread):
            delta = steering(t) if a == "front" else 0.0
            lever = AXLES[a] - centre
            sliding = (across + lever * turn) * math.cos(delta) - along * math.sin(delta)
            rolling = along * math.cos(delta) + (across + lever * turn) * math.sin(delta)
            slip = CORNERING * v / RELAXATION
            psi = abs(slip) / (3 * FRICTION)
            force = load[a] * slip * (1 - psi + psi ** 2 / 3) if psi < 1 else math.copysign(FRICTION * load[a], slip)
            ahead -= force * math.sin(delta) + ROLLING * load[a]
            side += force * math.cos(delta)
            moment += lever * force * math.cos(delta)
            result.append(-sliding - abs(rolling) * v / RELAXATION)
        return [along * math.sin(heading) + across * math.cos(heading), turn, ahead / total + across * turn,
                side / total - along * turn, moment / inertia, *result], side / total

    state, t, step, largest = [0.0, 0.0, SPEED, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0, 2e-3, 0.0
    for k in range(round(BRAKE / step)):
        t = k * step
        stages = []
        for part in (0, 0.5, 0.5, 1):
            at = [a + part * step * b for a, b in zip(state, stages[-1])] if part else state
            rate, acceleration = rates(t + part * step, at)
            stages.append(rate)
            largest = max(largest, abs(acceleration))
        state = [a + step / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(state, *stages)]
    return state[0] + (x - centre) * math.sin(state[1]), state[2], largest


def truck(oil, walls):
    spring, load = loads(oil)
    bodies = [{"name": "chassis", "mass": "from_shapes", "velocity": [number(SPEED), 0, 0], "shapes": CHASSIS},
              {"name": "tank", "mass": TANK_MASS, "inertia": tank_inertia(), "position": [TANK_X, 0, TANK_Z], "velocity": [number(SPEED), 0, 0],
               "shapes": walls}]
    joints, forces = [], []
    rotating = sum(2 * WHEEL[a][1] / TYRE_RADIUS ** 2 for a in AXLES)
    total = sum(load.values()) / G
    flat = {"axis": [1, 0, 0], "angle_deg": 90}
    for axle, x in AXLES.items():
        stiffness = TYRE[axle]
        loaded = TYRE_RADIUS - load[axle] / 2 / stiffness
        for side, y in (("left", TRACK / 2), ("right", -TRACK / 2)):
            name = f"{axle}_{side}"
            mass, spin = WHEEL[axle]
            width = 0.3 if axle == "front" else 0.5
            across = mass * TYRE_RADIUS ** 2 / 4 + mass * width ** 2 / 12
            bodies.append({"name": f"carrier_{name}", "mass": CARRIER_MASS, "inertia": [4, 2, 4], "position": vector(x, 0.55 * y, loaded),
                           "shapes": [{"name": f"beam_{name}", "use": "graphics", "shape": {"type": "box", "size": [0.12, 0.6, 0.12]}}]})
            joints.append({"name": f"guide_{name}", "type": "prismatic", "parent": "chassis", "child": f"carrier_{name}",
                           "position": vector(x, 0.55 * y, loaded), "axis": [0, 0, 1]})
            parent = f"carrier_{name}"
            if axle == "front":
                bodies.append({"name": f"knuckle_{name}", "mass": KNUCKLE_MASS, "inertia": [1, 1, 1], "position": vector(x, 0.85 * y, loaded),
                               "shapes": [{"name": f"pin_{name}", "use": "graphics", "shape": {"type": "cylinder", "radius": 0.07, "height": 0.24}}]})
                times = [0.0] + [number(STEER + STEER_TIME * k / 24) for k in range(25)]
                joints.append({"name": f"steer_{name}", "type": "revolute", "parent": parent, "child": f"knuckle_{name}",
                               "position": vector(x, y, loaded), "axis": [0, 0, 1],
                               "motion": {"type": "table", "times": times, "values": [number(steering(t)) for t in times]}})
                parent = f"knuckle_{name}"
            bodies.append({"name": f"wheel_{name}", "mass": mass, "inertia": vector(across, spin, across), "position": vector(x, y, loaded),
                           "shapes": [{"name": f"tread_{name}", "use": "graphics", "orientation": flat,
                                       "shape": {"type": "cylinder", "radius": TYRE_RADIUS - 0.05, "height": width}}]})
            joints.append({"name": f"hub_{name}", "type": "revolute", "parent": parent, "child": f"wheel_{name}",
                           "position": vector(x, y, loaded), "axis": [0, 1, 0], "rate": number(SPEED / loaded)})
            lower, upper = 0.0, 0.45
            forces.append({"name": f"spring_{name}", "type": "spring_damper", "body_a": "chassis", "body_b": f"carrier_{name}",
                           "point_a": vector(x, 0.55 * y, loaded + upper), "point_b": vector(x, 0.55 * y, loaded + lower),
                           "stiffness": SPRING, "damping": DAMPER, "length": number(upper - lower + spring[axle] / 2 / SPRING)})
            forces.append({"name": f"tyre_{name}", "type": "tyre", "joint": f"hub_{name}", "radius": TYRE_RADIUS, "stiffness": stiffness,
                           "damping": 3000, "friction": FRICTION, "slip_stiffness": SLIP, "cornering_stiffness": CORNERING,
                           "relaxation_length": RELAXATION, "rolling_resistance": ROLLING})
            torque = DECELERATION * (total + rotating) * load[axle] / sum(load.values()) / 2 * loaded
            forces.append({"name": f"brake_{name}", "type": "motor", "joint": f"hub_{name}", "control": "throttle",
                           "target": {"type": "constant", "value": 0}, "torque_speed": {"arguments": [0, 100], "values": [1, 1]},
                           "brake": {"torque": number(torque), "breakaway": number(1.2 * torque),
                                     "engaged": {"type": "table", "interpolation": "linear", "times": [0, BRAKE, BRAKE + BRAKE_RISE],
                                                 "values": [0, 0, 1]}}})
    for end, x in (("front", MOUNT_X), ("rear", -MOUNT_X)):
        for side, y in (("left", MOUNT_Y), ("right", -MOUNT_Y)):
            # The vertical damping is the same; the tank sinks by its weight over the stiffness at the start.
            forces.append({"name": f"mount_{end}_{side}", "type": "bushing", "body_a": "chassis", "body_b": "tank",
                           "position": vector(TANK_X + x, y, MOUNT_Z), "stiffness": [MOUNT_STIFFNESS] * 3 + [0, 0, 0],
                           "damping": [MOUNT_DAMPING] * 3 + [0, 0, 0]})
    return {"integrator": {"rho_inf": 0.6}, "bodies": bodies, "joints": joints, "forces": forces}


def scene(name, spacing, spheres=False, baffles=True, end=END):
    wall = {"material": "steel"} if spheres else {}
    about_x = {"axis": [0, 1, 0], "angle_deg": 90}
    walls = [{"name": "shell", "use": "wall", "orientation": about_x, **wall,
              "shape": {"type": "cylinder", "radius": RADIUS, "height": number(LENGTH)}}]
    if baffles:
        walls += [{"name": f"baffle_{k}", "use": "wall", "position": vector(x, 0, 0), **wall, "shape": {"type": "mesh", "file": "baffle_coarse.obj" if spacing > 0.05 else "baffle.obj"}}
                  for k, x in ((1, LENGTH / 6), (2, -LENGTH / 6))]
    oil = OIL_DENSITY * OIL_VOLUME
    coarse = spacing > 0.05
    window = 0.001 if not coarse else 0.0022 if spheres else 0.0025    # two steps of the coarse liquid
    mbd = truck(oil, walls)
    if coarse and not spheres:
        mbd["integrator"]["step"] = 0.00125
    regions = [{"name": "oil", "body": "tank", "shape": {"type": "box", "size": vector(LENGTH + 0.2, 2 * RADIUS + 0.2, 2 * RADIUS + 0.2)}}]
    for part, k in (("front", 1), ("middle", 0), ("rear", -1)):
        regions.append({"name": f"{part}_space", "body": "tank", "position": vector(k * (LENGTH / 3 + 0.05), 0, 0),
                        "shape": {"type": "box", "size": vector(LENGTH / 3 + 0.1 * abs(k), 2 * RADIUS + 0.2, 2 * RADIUS + 0.2)}})
    domain = {"min": vector(TANK_X - LENGTH / 2 - 0.6, -RADIUS - 0.6, TANK_Z - RADIUS - 0.6),
              "max": vector(TANK_X + LENGTH / 2 + 0.6, RADIUS + 0.6, TANK_Z + RADIUS + 0.6), "follows": "tank"}
    _, load = loads(oil)
    way, speed, lateral = lane_change(oil)
    result = {"tandem": "1.1", "name": name, "description": DESCRIPTION, "end_time": end, "coupling": {"window": window}, "mbd": mbd}
    plots = ["tyre_*_left.force.z", "tyre_*_right.force.z", "mount_*.force.z", "mount_*.force.y", "mount_*.force.x"]
    if spheres:
        radius = spacing / 2
        share = 0.60     # of the volume of a settled bed in its spheres: those of the oil are heavier by that
        young, poisson, density = 1e7, 0.3, OIL_DENSITY / share
        rayleigh = math.pi * 0.95 * radius * math.sqrt(density * 2 * (1 + poisson) / young) / (0.1631 * poisson + 0.8766)
        # By the fastest collision that is possible at the speed of the truck.
        step = window / math.ceil(window / min(0.25 * rayleigh, 3e-4))
        law = {"restitution": 0.3, "friction": 0.02}
        result["dem"] = {
            "materials": [{"name": "oil", "density": number(density), "young": young, "poisson": poisson, **law},
                          {"name": "steel", "density": 7850, "young": young, "poisson": poisson, **law}],
            "micro_step": number(step), "overlap_limit": 0.1,
            "particles": [{"name": "oil", "material": "oil", "radius": [number(0.95 * radius), number(1.05 * radius)], "velocity": [number(SPEED), 0, 0],
                           "fill": {"type": "packing", "mass": oil, "void_fraction": 0.46, "region": {"type": "inside", "wall": "shell"}}}],
            "sensors": regions, "domain": domain}
        plots += ["*_space.mass"]
    else:
        result["sph"] = {
            "spacing": spacing, "wall_friction": "free_slip", **({"wall_deviation": 0.1} if spacing > 0.05 else {}),
            "liquids": [{"name": "oil", "density": OIL_DENSITY, "viscosity": OIL_VISCOSITY, "artificial_viscosity": 0.02, "expected_speed": 5,
                         "fill": [{"type": "inside", "wall": "shell", "volume": OIL_VOLUME}]}],
            "sensors": [{"type": "load", "name": "sloshing", "body": "tank", "position": [0, 0, 0], "axis": [1, 0, 0]}]
            + [{"type": "load", "name": f"on_baffle_{k}", "wall": f"baffle_{k}"} for k in (1, 2) if baffles]
            + [{"type": "level", "name": f"level_{part}", "body": "tank", "position": vector(k * LENGTH / 3, 0, -RADIUS), "axis": [0, 0, 1]}
               for part, k in (("front", 1), ("middle", 0), ("rear", -1))]
            + [{"type": "region", **r} for r in regions],
            "domain": domain}
        plots += ["sloshing.force.*", "sloshing.torque.*", *["on_baffle_*.force.x"] * baffles, "level_*.level", "*_space.mass"]
    stopping = (speed * BRAKE_RISE - DECELERATION * BRAKE_RISE ** 2 / 6
                + (speed - DECELERATION * BRAKE_RISE / 2) ** 2 / 2 / (DECELERATION + ROLLING * G))
    front = SPEED * BRAKE + stopping      # of the front axle in the end
    result["output"] = {"frame_interval": 0.095 if coarse and not spheres else 0.088, "plots": plots,
                        "camera": {"eye": vector(front + 1.5, way - 11.5, 4.6), "target": vector(front - 2.9, way, 1.35), "field_of_view": 40}}
    checks = []

    def check(*what, **how):
        add_check(checks, *what, **how)

    rest = {"from": REST[0], "to": REST[1]}
    # Spheres cannot settle before the start in a tank that drives: they do so in the first half second.
    near = 0.15 if spheres else 0.02
    check("weight of the oil [N]", "tank.contact_force.z", -oil * G, near, "870 kg/m3 x 5 m3 x 9.81 m/s2", **rest)
    for axle in AXLES:
        check(f"load of a {axle} wheel at rest [N]", f"tyre_{axle}_left.force.z", load[axle] / 2, near, "balance of forces and moments", **rest)
    check("load of a mount at rest [N]", "mount_rear_right.force.z", (TANK_MASS + oil) * G / 4, near, "a quarter of the weight of tank and oil", **rest)
    if end > BRAKE:
        check("lateral way of the lane change [m]", "chassis.position.y", way, 0.1,
              "plane motion of a rigid truck with frozen oil on three tyres with brush and relaxation (oil_tank.py)", "last", to=BRAKE)
    if end >= END:
        check("stopping distance [m]", "chassis.position.x", stopping, 0.03, "speed and torque of the brakes, the oil at rest in the tank in the end",
              "range", **{"from": BRAKE})
        check("impulse of the oil along the way [N]", "tank.contact_force.x", oil * SPEED / END, 0.05,
              "mean: the momentum of the oil over the time, since it comes to rest", "mean")
    check("oil in the tank [kg]", "oil.mass", oil, 1e-3, "it holds all of it", "min")
    if not spheres:
        check("largest moment of the oil about the axis of the tank [N m]", "sloshing.axis_torque", 0, 0.01 * oil * G * RADIUS,
              "pressure on a round shell passes its axis: below 1 % of weight x radius before the brakes act", "max", True, to=min(end, BRAKE))
        check("particles that passed a wall", "summary.sph.passed_walls", 0, 0, "the tank holds them", "last", True)
        check("momentum balance of the oil", "summary.sph.momentum_balance", 0, 1e-5, "round-off", "last", True)
    check("impulse closure", "summary.impulse_closure", 0, 1e-10, "what the particles recorded is what the tank received", "last", True)
    result["checks"] = checks
    return result


# Of a half full round tank across its axis: omega^2 R / g of the first antisymmetric mode [McIver1989].
MCIVER = 1.3557


def rig(spacing):
    """A slice of the tank on the ground, whose oil starts with a velocity across the axis: the period of its sloshing."""
    length = 4 * spacing
    period = 2 * math.pi / math.sqrt(MCIVER * G / RADIUS)
    domain = {"min": [-length, -RADIUS - 0.3, -RADIUS - 0.3], "max": [length, RADIUS + 0.3, RADIUS + 0.3]}
    checks = []
    add_check(checks, "period of sloshing [s]", "oil.momentum.y", period, 0.03,
              "McIver 1989: omega^2 R / g = 1.3557 in a half full circle; the lattice is too stiff by 1 to 2 %", "period", **{"from": 0.3})
    add_check(checks, "weight of the oil [N]", "ground.contact_force.z", -OIL_DENSITY * math.pi * RADIUS ** 2 / 2 * length * G, 0.02,
              "density x half of the cylinder x g; mean")
    return {"tandem": "1.1", "name": "oil_tank_rig", "end_time": 3.2, "coupling": {"window": 0.0025},
            "sph": {"spacing": spacing, "wall_friction": "free_slip", "wall_deviation": 0.1,
                    "walls": [{"name": "shell", "orientation": {"axis": [0, 1, 0], "angle_deg": 90},
                               "shape": {"type": "cylinder", "radius": RADIUS, "height": number(length)}}],
                    "liquids": [{"name": "oil", "density": OIL_DENSITY, "viscosity": 0, "artificial_viscosity": 0.01, "velocity": [0, 0.15, 0],
                                 "fill": [{"type": "inside", "wall": "shell", "level": 0}]}],
                    "sensors": [{"type": "region", "name": "oil", "shape": {"type": "box", "size": [2, 2, 2]}}], "domain": domain},
            "checks": checks}


PREVIEW = 0.16


def files():
    return {"baffle.obj": baffle(48, BAFFLE_GAP).obj("oil_tank.py"),
            "baffle_coarse.obj": baffle(12, BAFFLE_GAP_COARSE).obj("oil_tank.py"),     # of the previews, whose particles feel no more
            "oil_tank.json": text(scene("oil_tank", 0.017)) + "\n",
            "oil_tank_preview.json": text(scene("oil_tank_preview", PREVIEW)) + "\n",
            "oil_tank_spheres_preview.json": text(scene("oil_tank_spheres_preview", PREVIEW, spheres=True)) + "\n"}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--spacing", type=float, help="of the particles; without it that of the preview, and 0.1 of the rig")
    parser.add_argument("--no-baffles", action="store_true")
    parser.add_argument("--spheres", action="store_true")
    parser.add_argument("--rig", action="store_true", help="a slice of the tank alone, for the period of sloshing")
    parser.add_argument("--end", type=float, default=END)
    parser.add_argument("-o", "--output")
    parser.add_argument("--check", action="store_true", help="compare the files with what this program writes")
    given = parser.parse_args()
    folder = pathlib.Path(__file__).parent
    if given.output:
        output = pathlib.Path(given.output)
        if given.rig:
            output.write_text(text(rig(given.spacing or 0.1)) + "\n", encoding="utf-8")
            return
        one = scene(output.stem, given.spacing or PREVIEW, given.spheres, not given.no_baffles, given.end)
        write_variant(one, folder, output)
        return
    write_or_check(folder, files(), given.check)


if __name__ == "__main__":
    main()
