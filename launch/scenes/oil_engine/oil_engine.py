#!/usr/bin/env python3
"""Writes the engine with oil to its folder: tray.obj, oil_engine.json (a million particles, 3000 rpm), oil_engine_preview.json (800 rpm)
and oil_engine_spheres_preview.json (the oil as spheres). The moving parts are those of launch/scenes/engine.json.

oil_engine.py -o FILE writes one scene: --rpm, --level, --spacing, --revolutions, --spheres.
Lengths in m, masses in kg, times in s. The crank turns about x at z = 0, cylinders are along z.
"""
import argparse
import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from machine_files import Mesh, add_check, number, text, vector, write_or_check, write_variant

CASE = (0.39, 0.20)                   # inside along x and y
BOTTOM, TOP, DECK = -0.13, 0.25, 0.09   # of the case, and the lower end of the cylinders
LEVEL = -0.065                        # the webs reach down to -0.070, the big ends to -0.077
TRAY_Z, TRAY_GAP, SLOTS, SLOT = -0.0975, 0.001, 5, (0.062, 0.14)
PISTON, BIG_END, CRANK = 0.0428, 0.032, 0.045
DENSITY, VISCOSITY = 870, 0.05
CYLINDERS = (-0.1425, -0.0475, 0.0475, 0.1425)

DESCRIPTION = (
    "The engine of launch/scenes/engine.json with its crankcase half open to the eye: the sump holds oil up to the big ends and webs, which dip "
    "and splash it under the pistons; a windage tray with slots lies below the level. The crank turns at a prescribed speed, without gas. "
    "Shanks, pins and main bearings do not touch the oil. oil_engine.py wrote this file.")


def tray():
    """A sheet with rectangular slots across the engine."""
    mesh = Mesh()
    length, width = CASE[0] - 2 * TRAY_GAP, CASE[1] - 2 * TRAY_GAP
    cell = length / SLOTS
    for k in range(SLOTS):
        x = -length / 2 + (k + 0.5) * cell
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        outer = [(x + a * cell / 2, b * width / 2, 0.0) for a, b in corners]
        inner = [(x + a * SLOT[0] / 2, b * SLOT[1] / 2, 0.0) for a, b in corners]
        for n in range(4):
            mesh.face(outer[n - 1], outer[n], inner[n], inner[n - 1])
    return mesh


def machine(speed, spheres):
    """Bodies and joints of the engine; webs, big ends and pistons are walls for the oil."""
    engine = json.loads((pathlib.Path(__file__).parents[1] / "engine.json").read_text(encoding="utf-8"))["mbd"]
    for body in engine["bodies"]:
        for shape in body["shapes"]:
            if shape["name"].startswith(("web", "big_eye", "crown")):
                shape["use"] = "wall"
            if spheres and shape["use"] == "wall":
                shape["material"] = "steel"
    for joint in engine["joints"]:
        if joint["name"] == "crank":
            del joint["rate_deg"]
            joint["motion"] = {"type": "constant", "rate": number(speed)}
    return {"integrator": {"rho_inf": 0.9}, "bodies": engine["bodies"], "joints": engine["joints"]}


def scene(name, spacing, rpm, revolutions, level=LEVEL, spheres=False):
    speed = rpm * 2 * math.pi / 60
    tip = speed * (CRANK + BIG_END)
    volume = CASE[0] * CASE[1] * (level - BOTTOM)
    turn = 60 / rpm
    # Windows are whole parts of a revolution, and hold four steps of the liquid.
    sound = 10 * 1.3 * tip
    step = 0.3 * 1.5 * spacing / (sound + tip)
    window = 2 / 1.2 * step if spheres else 4 * step
    nanoseconds, windows = round(turn * 1e9), math.ceil(turn / window)
    while nanoseconds % windows:
        windows += 1
    window = nanoseconds // windows / 1e9
    end = windows * revolutions * (nanoseconds // windows) / 1e9
    wall = {"material": "steel"} if spheres else {}
    liner = PISTON + max(5e-4, 0.2 * spacing)
    walls = [{"name": "case", "position": vector(0, 0, (TOP + BOTTOM) / 2), **wall,
              "shape": {"type": "box", "size": vector(*CASE, TOP - BOTTOM)}},
             {"name": "tray", "position": vector(0, 0, TRAY_Z), **wall, "shape": {"type": "mesh", "file": "tray.obj"}}]
    walls += [{"name": f"cylinder_{k + 1}", "position": vector(x, 0, (TOP + DECK) / 2 - 0.001), **wall,
               "shape": {"type": "cylinder", "radius": number(liner), "height": number(TOP - DECK - 0.002), "open": ["+z", "-z"]}}
              for k, x in enumerate(CYLINDERS)]
    spaces = [("below_tray", BOTTOM, TRAY_Z), ("around_crank", TRAY_Z, DECK), ("under_pistons", DECK, TOP)]
    regions = [{"name": n, "position": vector(0, 0, (a + b) / 2), "shape": {"type": "box", "size": vector(CASE[0] + 0.02, CASE[1] + 0.02, b - a)}}
               for n, a, b in [("oil", BOTTOM - 0.01, TOP + 0.01)] + spaces]
    domain = {"min": vector(-CASE[0] / 2 - 0.02, -CASE[1] / 2 - 0.02, BOTTOM - 0.02), "max": vector(CASE[0] / 2 + 0.02, CASE[1] / 2 + 0.02, TOP + 0.02)}
    oil = DENSITY * volume
    result = {"tandem": "1.1", "name": name, "description": DESCRIPTION, "end_time": end, "coupling": {"window": window},
              "mbd": machine(speed, spheres)}
    plots = ["crank.torque", "crank.energy", "below_tray.mass", "around_crank.mass", "under_pistons.mass", "oil.kinetic_energy"]
    if spheres:
        young, poisson, radius, density = 5e8, 0.3, spacing / 2, DENSITY / 0.6
        rayleigh = math.pi * 0.95 * radius * math.sqrt(density * 2 * (1 + poisson) / young) / (0.1631 * poisson + 0.8766)
        law = {"restitution": 0.3, "friction": 0.02}
        result["dem"] = {
            "materials": [{"name": "oil", "density": number(density), "young": young, "poisson": poisson, **law},
                          {"name": "steel", "density": 7850, "young": young, "poisson": poisson, **law}],
            "micro_step": number(window / math.ceil(window / (0.25 * rayleigh))), "overlap_limit": 0.1,
            "particles": [{"name": "oil", "material": "oil", "radius": [number(0.95 * radius), number(1.05 * radius)],
                           "fill": {"type": "packing", "mass": number(oil), "void_fraction": 0.5, "region": {"type": "inside", "wall": "case"}}}],
            "walls": walls, "sensors": regions, "domain": domain}
    else:
        result["sph"] = {
            "spacing": spacing,
            "liquids": [{"name": "oil", "density": DENSITY, "viscosity": VISCOSITY, "expected_speed": number(1.3 * tip),
                         "fill": [{"type": "inside", "wall": "case", "level": level}]}],
            "walls": walls,
            "sensors": [{"type": "load", "name": "on_crank", "body": "crankshaft", "position": [0, 0, 0], "axis": [1, 0, 0]}]
            + [{"type": "load", "name": f"on_rod_{k}", "body": f"rod_{k}"} for k in (1, 2)]
            + [{"type": "region", **r} for r in regions],
            "domain": domain}
        plots += ["on_crank.axis_torque", "on_rod_*.force.*"]
    frame = round(windows / 25)
    result["output"] = {"frame_interval": round(frame * window, 9), "plots": plots,
                        "camera": {"eye": [-0.62, -0.95, 0.28], "target": [0.02, 0, 0.05], "field_of_view": 38}}
    checks = []
    if spheres:
        add_check(checks, "oil in the case [kg]", "oil.mass", oil, 5e-3, "it holds all of it", "min")
    else:
        add_check(checks, "energy that the oil got [J]", "summary.sph.work_J.walls", {"of": "crank.energy", "times": 1}, 0.02,
                  "churning power = what drives the crank: over whole revolutions the parts of the engine keep their energy", "last")
        add_check(checks, "oil in the case [kg]", "oil.mass", 0, 1e-3, "it holds all of it", "range", True)
        add_check(checks, "particles that passed a wall", "summary.sph.passed_walls", 0, 0, "no wall is passed", "last", True)
        add_check(checks, "momentum balance of the oil", "summary.sph.momentum_balance", 0, 1e-5, "round-off", "last", True)
    add_check(checks, "speed of the crank [rad/s]", "crank.rate", speed, 1e-6, "prescribed")
    add_check(checks, "impulse closure", "summary.impulse_closure", 0, 1e-10, "what the particles recorded is what the bodies received", "last", True)
    result["checks"] = checks
    return result


PREVIEW, RPM, REVOLUTIONS = 0.0155, 800, 2


def files():
    return {"tray.obj": tray().obj("oil_engine.py"),
            "oil_engine.json": text(scene("oil_engine", 0.0017, 3000, 6)) + "\n",
            "oil_engine_preview.json": text(scene("oil_engine_preview", PREVIEW, RPM, REVOLUTIONS)) + "\n",
            "oil_engine_spheres_preview.json": text(scene("oil_engine_spheres_preview", PREVIEW, RPM, REVOLUTIONS, spheres=True)) + "\n"}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--spacing", type=float, default=PREVIEW)
    parser.add_argument("--rpm", type=float, default=RPM)
    parser.add_argument("--revolutions", type=int, default=REVOLUTIONS)
    parser.add_argument("--level", type=float, default=LEVEL)
    parser.add_argument("--spheres", action="store_true")
    parser.add_argument("-o", "--output")
    parser.add_argument("--check", action="store_true", help="compare the files with what this program writes")
    given = parser.parse_args()
    folder = pathlib.Path(__file__).parent
    if given.output:
        output = pathlib.Path(given.output)
        one = scene(output.stem, given.spacing, given.rpm, given.revolutions, given.level, given.spheres)
        write_variant(one, folder, output)
        return
    write_or_check(folder, files(), given.check)


if __name__ == "__main__":
    main()
