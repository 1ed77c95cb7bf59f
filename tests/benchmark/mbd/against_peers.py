#!/usr/bin/env python3
"""Trees by tandem beside Pinocchio, MuJoCo and Exudyn: processor time at a given error, in one run.

    python3 -m venv peers && peers/bin/pip install numpy pin mujoco exudyn
    peers/bin/python tests/benchmark/mbd/against_peers.py BENCH_TREES --core 1 --csv tests/benchmark/results/mbd_peers.csv

BENCH_TREES is build/release/bin/bench_trees. Each program gets the coarsest setting with which its error is
within the limit; then all of them run in turn, REPETITIONS times, on one core, and the shortest processor time of
each counts. Loops are compiled everywhere: MuJoCo steps by mj_step(nstep), Exudyn's solvers are C++, and
pinocchio_chain.cpp is compiled here with -O3. Start-up is left out: for Exudyn, the time of a run of one step.

  chain     100 rods of 0.1 m and 0.1 kg on revolute joints, let go from the horizontal, 1 s. Error: largest of
            the joint angles at the end against tandem at a tolerance of 1e-12, with which Pinocchio at 8,000
            steps must agree.
  pendulum  A01: 1 kg on a massless bar of 1 m, let go from the horizontal, 10 s. Error of the energy: of tandem the
            largest on the way, of the others that at the end.
"""
import argparse
import csv
import datetime
import os
import pathlib
import platform
import subprocess
import sys
import sysconfig
import tempfile
import time

import exudyn
import mujoco
import numpy as np

LINKS, LENGTH, MASS = 100, 0.1, 0.1
INERTIA = MASS * LENGTH**2 / 12
REPOSITORY = pathlib.Path(__file__).resolve().parents[3]


class Tandem:
    def __init__(self, program, problem, method):
        self.command = [program] + (["chain", str(LINKS), "1"] if problem == "chain" else ["pendulum", "10"])
        self.method = method

    def run(self, setting):
        """Processor time in s, coordinates at the end, energy error in J, number of steps."""
        done = subprocess.run(self.command + [self.method, f"{setting:.17g}", "1"], capture_output=True, text=True)
        if done.returncode != 0:
            return np.inf, np.full(1, np.inf), np.inf, 0
        seconds, counts, state = [line for line in done.stdout.splitlines() if not line.startswith("[")]
        counts = counts.split()
        return float(seconds), np.array(state.split(), float), float(counts[2]), int(counts[0])


class Pinocchio:
    def __init__(self, program):
        self.program = program

    def run(self, steps):
        done = subprocess.run([self.program, str(LINKS), "1", str(steps), "1"], capture_output=True, text=True,
                              check=True)
        seconds, state = done.stdout.splitlines()
        return float(seconds), np.array(state.split(), float), None, steps


class MuJoCo:
    def __init__(self, problem, method):
        self.problem, self.method = problem, method
        self.end = 1 if problem == "chain" else 10

    def model(self, steps):
        chain = self.problem == "chain"
        count = LINKS if chain else 1
        mass, inertia, at = (MASS, INERTIA, LENGTH / 2) if chain else (1, 1e-9, -1)
        text = (f'<mujoco><option gravity="0 -9.81 0" timestep="{self.end / steps:.17g}" integrator="{self.method}">'
                '<flag contact="disable" constraint="disable"/></option><worldbody>')
        for i in range(count):
            text += (f'<body pos="{0 if i == 0 else LENGTH} 0 0"><joint type="hinge" axis="0 0 1"/><inertial '
                     f'pos="{at} 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>')
        return mujoco.MjModel.from_xml_string(text + "</body>" * count + "</worldbody></mujoco>")

    def run(self, steps):
        model = self.model(steps)
        data = mujoco.MjData(model)
        begin = time.process_time()
        mujoco.mj_step(model, data, nstep=steps)
        seconds = time.process_time() - begin
        energy = 0.5 * data.qvel[0] ** 2 - 9.81 * np.sin(data.qpos[0])
        return seconds, np.array(data.qpos), abs(energy), steps


class Exudyn:
    def __init__(self, problem, method):
        self.solver = getattr(exudyn.DynamicSolverType, method)
        self.controlled = method == "DOPRI5"
        self.end = 1.0 if problem == "chain" else 10.0
        chain = problem == "chain"
        n = LINKS if chain else 1
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree
        zeros = [0.0] * n
        self.node = self.system.AddNode(NodeGenericODE2(
            numberOfODE2Coordinates=n, referenceCoordinates=zeros, initialCoordinates=zeros,
            initialCoordinates_t=zeros))
        inertia = INERTIA * np.eye(3) if chain else np.zeros((3, 3))
        self.system.AddObject(ObjectKinematicTree(
            nodeNumber=self.node, jointTypes=[exudyn.JointType.RevoluteZ] * n, linkParents=list(range(-1, n - 1)),
            jointTransformations=exudyn.Matrix3DList([np.eye(3)] * n),
            jointOffsets=exudyn.Vector3DList([[0, 0, 0]] + [[LENGTH, 0, 0]] * (n - 1)),
            linkInertiasCOM=exudyn.Matrix3DList([inertia] * n),
            linkCOMs=exudyn.Vector3DList([[LENGTH / 2 if chain else -1.0, 0, 0]] * n),
            linkMasses=[MASS if chain else 1.0] * n, baseOffset=[0, 0, 0], gravity=[0, -9.81, 0]))
        self.system.Assemble()

    def solve(self, setting, end, steps):
        settings = exudyn.SimulationSettings()
        settings.solution.file.write = False
        integration = settings.timeIntegration
        integration.verboseMode = 0
        integration.endTime = end
        integration.numberOfSteps = steps
        integration.automaticStepSize = self.controlled
        if self.controlled:
            integration.relativeTolerance = integration.absoluteTolerance = setting
        begin = time.process_time()
        self.system.SolveDynamic(settings, solverType=self.solver)
        return time.process_time() - begin

    def run(self, setting):
        # With error control the number of steps gives the longest step.
        steps = 20 if self.controlled else int(setting)
        start = self.solve(setting, self.end * 1e-6, 1)
        seconds = self.solve(setting, self.end, steps) - start
        kind = exudyn.OutputVariableType
        q = np.atleast_1d(self.system.GetNodeOutput(self.node, kind.Coordinates))
        u = np.atleast_1d(self.system.GetNodeOutput(self.node, kind.Coordinates_t))
        energy = 0.5 * u[0] ** 2 - 9.81 * np.sin(q[0])
        return seconds, q, abs(energy), steps if not self.controlled else 0


def compile_pinocchio(folder):
    prefix = pathlib.Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix"
    program = pathlib.Path(folder) / "pinocchio_chain"
    subprocess.run(["g++", "-O3", "-DNDEBUG", "-std=c++17", "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
                    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", f"-I{prefix}/include", "-I/usr/include/eigen3",
                    str(REPOSITORY / "tests/benchmark/mbd/pinocchio_chain.cpp"), "-o", str(program)], check=True)
    return str(program)


def coarsest(error, settings, limit):
    """The first of the settings, coarse to fine, that is within the limit like the next one: no lucky hit."""
    for setting, finer in zip(settings, settings[1:]):
        if error(setting) <= limit and error(finer) <= limit:
            return setting
    return None


def grid(first, last, ratio):
    values, value = [], first
    while value < last * (1 + 1e-9):
        values.append(int(round(value)))
        value *= ratio
    return values


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bench_trees")
    parser.add_argument("--pinocchio", help="pinocchio_chain that was compiled before")
    parser.add_argument("--core", type=int, help="runs on this core only")
    parser.add_argument("--repetitions", type=int, default=15)
    parser.add_argument("--csv")
    parser.add_argument("--device", default=platform.processor() or platform.machine())
    options = parser.parse_args()
    if options.core is not None:
        os.sched_setaffinity(0, {options.core})
    scratch = tempfile.TemporaryDirectory()
    pinocchio = options.pinocchio or compile_pinocchio(scratch.name)

    tolerances = [10 ** (-k / 8) for k in range(8, 72)]
    implicit = Tandem(options.bench_trees, "chain", "generalized_alpha")
    chain = [
        ("tandem", "dormand_prince", Tandem(options.bench_trees, "chain", "dormand_prince"), tolerances),
        ("tandem", "generalized_alpha", implicit, grid(200, 20000, 1.2)),
        ("Pinocchio", "RK4", Pinocchio(pinocchio), grid(100, 3000, 1.08)),
        ("MuJoCo", "RK4", MuJoCo("chain", "RK4"), grid(100, 3000, 1.08)),
        ("MuJoCo", "Euler", MuJoCo("chain", "Euler"), grid(500, 64000, 2)),
        ("Exudyn", "RK44", Exudyn("chain", "RK44"), grid(150, 2500, 1.3)),
        ("Exudyn", "RK67", Exudyn("chain", "RK67"), grid(100, 1500, 1.3)),
    ]
    pendulum = [
        ("tandem", "dormand_prince", Tandem(options.bench_trees, "pendulum", "dormand_prince"), tolerances),
        ("tandem", "generalized_alpha", Tandem(options.bench_trees, "pendulum", "generalized_alpha"),
         grid(1000, 10000, 1.1)),
        ("MuJoCo", "RK4", MuJoCo("pendulum", "RK4"), grid(50, 1000, 1.05)),
        ("MuJoCo", "Euler", MuJoCo("pendulum", "Euler"), grid(1000, 2000000, 2)),
        ("Exudyn", "RK44", Exudyn("pendulum", "RK44"), grid(50, 1000, 1.05)),
        ("Exudyn", "RK67", Exudyn("pendulum", "RK67"), grid(40, 500, 1.05)),
        ("Exudyn", "DOPRI5", Exudyn("pendulum", "DOPRI5"), tolerances),
    ]
    exact = chain[0][2].run(1e-12)[1]
    apart = np.max(np.abs(chain[2][2].run(8000)[1] - exact))
    print(f"references of the chain: tandem and Pinocchio differ by {apart:.2e} rad")
    if not apart < 1e-6:
        sys.exit("the references differ")

    cases = []
    for name, entries, limits in (("chain", chain, (1e-3, 2e-5)), ("pendulum", pendulum, (5e-5,))):
        for program, method, runner, settings in entries:
            errors = {}

            def error(setting):
                if setting not in errors:
                    _, state, energy, _ = runner.run(setting)
                    errors[setting] = energy if name == "pendulum" else float(np.max(np.abs(state - exact)))
                return errors[setting]

            for limit in limits:
                setting = coarsest(error, settings, limit)
                if setting is None:
                    print(f"{name}: {program} {method} has no setting within {limit:g}")
                    continue
                cases.append({"problem": name, "limit": limit, "program": program, "method": method,
                              "setting": setting, "error": error(setting), "runner": runner, "times": []})
    for _ in range(options.repetitions):
        for case in cases:
            seconds, _, _, case["steps"] = case["runner"].run(case["setting"])
            case["times"].append(seconds)

    commit = subprocess.run(["git", "-C", str(REPOSITORY), "rev-parse", "--short", "HEAD"], capture_output=True,
                            text=True).stdout.strip()
    versions = {"tandem": commit, "MuJoCo": mujoco.__version__, "Exudyn": exudyn.__version__, "Pinocchio": ""}
    rows = []
    for case in cases:
        least, median = min(case["times"]), float(np.median(case["times"]))
        print(f"{case['problem']:9} {case['limit']:.0e} {case['program']:10} {case['method']:18} "
              f"{case['setting']:10.4g} error {case['error']:.2e}  least {1e3 * least:9.3f} ms, median "
              f"{1e3 * median:9.3f} ms")
        rows.append({"date": datetime.date.today().isoformat(), "commit": commit, "device": options.device,
                     "command": "against_peers.py", "problem": case["problem"], "limit": f"{case['limit']:g}",
                     "program": case["program"], "version": versions[case["program"]], "method": case["method"],
                     "setting": f"{case['setting']:.4g}", "steps": case["steps"] or "",
                     "error": f"{case['error']:.3g}", "least_ms": f"{1e3 * least:.4g}",
                     "median_ms": f"{1e3 * median:.4g}", "repetitions": options.repetitions})
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
