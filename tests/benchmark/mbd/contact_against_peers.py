#!/usr/bin/env python3
"""Contact between bodies against closed forms: tandem beside MuJoCo and, where it has the shapes, Exudyn, in one run.

usage: contact_against_peers.py build/release/bin [--csv FILE --commit COMMIT --device DEVICE] [--quick]

For each case, program and step: the error against the closed form and the processor time of the integration without
start-up, least of REPETITIONS, the programs in turn. Cases, with gravity 9.81 m/s2 unless the case has none:
  bounce    a ball of 1 kg falls 0.5 m and returns without loss: height at the top, over 0.5 m
  collide   a ball of 1 kg meets an equal one at rest at 2 m/s without gravity: velocity of the second one, over 2 m/s
  slide     a box of 1 kg slides at 2 m/s, friction 0.5, to a stop: its way, over v^2 / (2 mu g)
  roll      a ball slides at 2 m/s, friction 0.3, until it rolls: its velocity, over 5/7 of 2 m/s
  slope     a box on a slope at 0.99 of the friction angle for 10 s: its displacement, first settling included, in m
The stiffness is 1e6 N/m (MuJoCo: in impacts the same frequency, by solref and a constant impedance of 0.99; where bodies
stay in contact its defaults; elliptic cones, Newton's solver, impratio 100). Needs mujoco, exudyn and numpy (PyPI).
"""
import argparse
import csv
import datetime
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

import exudyn
import mujoco
from exudyn.utilities import InertiaSphere

G, RADIUS, STIFFNESS = 9.81, 0.1, 1e6
CASES = ["bounce", "collide", "slide", "roll", "slope"]
FRICTION = {"bounce": 0, "collide": 0, "slide": 0.5, "roll": 0.3, "slope": 0.5}
FALL = 2 * math.sqrt(2 * 0.5 / G) + 2 * math.pi / 2 * math.sqrt(1 / STIFFNESS) / 2  # to the top again
END = {"bounce": FALL, "collide": 0.3, "slide": 1.0, "roll": 1.0, "slope": 10.0}
# Depth of the box of 1 kg at rest on its four corners.
SUNK = G / (4 * STIFFNESS)


def error_of(case, value):
    expected = {"bounce": 0.5, "collide": 2.0, "slide": 2.0**2 / (2 * 0.5 * G), "roll": 2.0 * 5 / 7, "slope": 0.0}[case]
    return abs(value - expected) / (expected or 1.0)


def gravity_of(case):
    if case == "collide":
        return [0, 0, 0]
    tilt = 0.99 * math.atan(FRICTION[case]) if case == "slope" else 0.0
    return [G * math.sin(tilt), 0, -G * math.cos(tilt)]


class Tandem:
    name = "tandem"

    def __init__(self, folder, work):
        self.program, self.work = folder / "tandem", work

    def run(self, case, step):
        J = 0.4 * RADIUS**2
        ball = {"name": "a", "mass": 1, "inertia": [J, J, J], "position": [0, 0, RADIUS],
                "shapes": [{"name": "a", "use": "contact", "material": "m", "shape": {"type": "sphere", "radius": RADIUS}}]}
        bodies = [ball]
        if case == "bounce":
            ball["position"] = [0, 0, RADIUS + 0.5]
        elif case == "collide":
            other = json.loads(json.dumps(ball))
            other["name"] = other["shapes"][0]["name"] = "b"
            ball["position"], other["position"] = [0, 0, 1], [2 * RADIUS + 0.1, 0, 1]
            ball["velocity"] = [2, 0, 0]
            bodies.append(other)
        elif case in ("slide", "slope"):
            ball["position"] = [0, 0, 0.1 - SUNK]
            ball["inertia"] = [0.0067, 0.0067, 0.0067]
            ball["shapes"][0]["shape"] = {"type": "box", "size": [0.2, 0.2, 0.2]}
        else:
            ball["position"] = [0, 0, RADIUS - G / STIFFNESS]
        if case in ("slide", "roll"):
            ball["velocity"] = [2, 0, 0]
        windows = math.ceil(END[case] / step - 1e-9)
        window = END[case] / windows
        scene = {"tandem": "1.1", "name": case, "end_time": windows * round(window, 9), "gravity": gravity_of(case),
                 "coupling": {"window": round(window, 9)},
                 "mbd": {"bodies": bodies, "contact": {
                     "materials": [{"name": "m", "stiffness": STIFFNESS, "restitution": 0.5 if case == "slope" else 1,
                                    "friction": FRICTION[case]}],
                     "ground": [{"name": "floor", "material": "m",
                                 "shape": {"type": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}}]}}}
        (self.work / "scene.json").write_text(json.dumps(scene))
        out = self.work / "out"
        subprocess.run(["rm", "-rf", out], check=True)
        done = subprocess.run([self.program, "run", self.work / "scene.json", "--out", out, "--no-picture", "--no-report",
                               "--quiet"], capture_output=True, text=True, check=False)
        summary = json.loads((out / "summary.json").read_text())
        if summary["status"] == "failed":
            sys.exit(done.stdout + done.stderr)
        last = {}
        for row in csv.DictReader((out / "bodies.csv").open()):
            last = row
        value = {"bounce": lambda: float(last["a.position.z"]) - RADIUS, "collide": lambda: float(last["b.velocity.x"]),
                 "slide": lambda: float(last["a.position.x"]), "roll": lambda: float(last["a.velocity.x"]),
                 "slope": lambda: float(last["a.position.x"])}[case]()
        return value, summary["mbd_solver_cpu_seconds"]


class MuJoCo:
    name = f"MuJoCo {mujoco.__version__}"

    def run(self, case, step):
        J = 0.4 * RADIUS**2
        gravity = " ".join(map(str, gravity_of(case)))
        box = case in ("slide", "slope")
        # Where bodies stay in contact, its own defaults. Impacts have a spring without damping: MuJoCo divides by the
        # mass that a point feels, 1 kg, and half of it between two balls, and reaches the share d of -k r.
        d = 0.99
        spring = f'solref="{-STIFFNESS / (0.5 if case == "collide" else 1.0) / d} 0" solimp="{d} {d} 0.001"'
        contact = "" if FRICTION[case] else spring
        shape = 'type="box" size="0.1 0.1 0.1"' if box else f'type="sphere" size="{RADIUS}"'
        inertia = "0.0067 0.0067 0.0067" if box else f"{J} {J} {J}"
        height = {"bounce": RADIUS + 0.5, "collide": 1}.get(case, RADIUS)

        def body(name, x):
            return (f'<body name="{name}" pos="{x} 0 {height}"><freejoint/><inertial pos="0 0 0" mass="1" '
                    f'diaginertia="{inertia}"/><geom {shape}/></body>')
        text = (f'<mujoco><option timestep="{step}" gravity="{gravity}" cone="elliptic" solver="Newton" impratio="100" '
                f'tolerance="1e-12" iterations="100"/><default><geom {contact} '
                f'friction="{max(FRICTION[case], 1e-5)} 0 0" condim="{3 if FRICTION[case] else 1}"/></default>'
                f'<worldbody><geom type="plane" size="10 10 1"/>{body("a", 0)}'
                f'{body("b", 2 * RADIUS + 0.1) if case == "collide" else ""}</worldbody></mujoco>')
        model = mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(model)
        if case in ("collide", "slide", "roll"):
            data.qvel[0] = 2
        steps = math.ceil(END[case] / step - 1e-9)
        begin = time.process_time()
        mujoco.mj_step(model, data, steps)
        taken = time.process_time() - begin
        value = {"bounce": data.qpos[2] - RADIUS, "collide": data.qvel[6] if case == "collide" else 0,
                 "slide": data.qpos[0], "roll": data.qvel[0], "slope": data.qpos[0]}[case]
        return float(value), taken


class Exudyn:
    name = "Exudyn " + exudyn.config.Version()

    def run(self, case, step):
        if case in ("slide", "slope"):
            return None  # it has contacts of spheres with spheres and triangles
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        ground = system.CreateGround(referencePosition=[0, 0, 0])
        height = {"bounce": RADIUS + 0.5, "collide": 1, "roll": RADIUS - G / STIFFNESS}[case]
        add = lambda x, v: system.CreateRigidBody(referencePosition=[x, 0, height], initialVelocity=[v, 0, 0],
                                                  inertia=InertiaSphere(1, RADIUS), gravity=gravity_of(case),
                                                  nodeType=exudyn.NodeType.RotationRotationVector)
        first = add(0, 0 if case == "bounce" else 2)
        second = add(2 * RADIUS + 0.1, 0) if case == "collide" else None
        common = {"dynamicFriction": FRICTION[case], "frictionProportionalZone": 1e-4, "contactStiffness": STIFFNESS}
        if case == "collide":
            system.CreateSphereSphereContact(itemNumbers=[first, second], spheresRadii=[RADIUS, RADIUS], **common)
        else:
            wide = 5
            system.CreateSphereQuadContact(
                itemNumbers=[first, ground], sphereRadius=RADIUS, includeEdges=0,
                quadPoints=[[-wide, -wide, 0], [wide, -wide, 0], [wide, wide, 0], [-wide, wide, 0]], **common)
        kind = exudyn.OutputVariableType
        system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.endTime = END[case]
        settings.timeIntegration.numberOfSteps = math.ceil(END[case] / step - 1e-9)
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
        settings.timeIntegration.verboseMode = 0
        settings.solution.file.write = False
        begin = time.process_time()
        try:
            system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.GeneralizedAlpha)
        except Exception:  # Newton's method or the contact's iteration does not converge with such a step
            return float("nan"), time.process_time() - begin
        taken = time.process_time() - begin
        value = {"bounce": lambda: system.GetObjectOutputBody(first, kind.Position)[2] - RADIUS,
                 "collide": lambda: system.GetObjectOutputBody(second, kind.Velocity)[0] if second else 0,
                 "roll": lambda: system.GetObjectOutputBody(first, kind.Velocity)[0]}[case]()
        return float(value), taken


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", type=pathlib.Path, help="folder of the programs of tandem")
    parser.add_argument("--csv", type=pathlib.Path)
    parser.add_argument("--commit", default="")
    parser.add_argument("--device", default="")
    parser.add_argument("--quick", action="store_true", help="one repetition and three steps")
    given = parser.parse_args()
    steps = [1e-2, 1e-3, 1e-4] if given.quick else [1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5]
    rows = []
    with tempfile.TemporaryDirectory() as work:
        programs = [Tandem(given.bin, pathlib.Path(work)), MuJoCo(), Exudyn()]
        for case in CASES:
            for step in steps:
                if case == "slope" and step < 1e-4:
                    continue
                best = {}
                for _ in range(1 if given.quick else 3):
                    for program in programs:
                        if program.name == "tandem" and step < 1e-4:
                            continue  # its steps in a contact are shorter already
                        result = program.run(case, step)
                        if result:
                            value, seconds = result
                            best[program.name] = (value, min(seconds, best.get(program.name, (0, math.inf))[1]))
                for name, (value, seconds) in best.items():
                    rows.append([case, name, step, error_of(case, value), 1e3 * seconds])
                    print(f"{case:8} {name:14} step {step:7.0e} s: error {rows[-1][3]:9.2e}, {rows[-1][4]:9.3f} ms", flush=True)
    if given.csv:
        new = not given.csv.exists()
        with given.csv.open("a", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            if new:
                writer.writerow("date,commit,device,command,case,program,step_s,error,cpu_ms".split(","))
            for case, name, step, error, ms in rows:
                writer.writerow([datetime.date.today(), given.commit, given.device, "contact_against_peers.py (least of 3, in turn)",
                                 case, name, f"{step:.0e}", f"{error:.3e}", f"{ms:.3f}"])


if __name__ == "__main__":
    main()
