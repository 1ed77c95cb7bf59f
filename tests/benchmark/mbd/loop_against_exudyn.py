#!/usr/bin/env python3
"""A pendulum whose hinge is a constraint (A01 of the IFToMM benchmark): tandem's cut joint beside Exudyn's constraint.

usage: loop_against_exudyn.py build/release/bin/bench_trees [--csv FILE --commit COMMIT --device DEVICE]

For each program and method: the fewest steps, of a grid by 5 %, with which the energy stays within 5e-5 J over 10 s, and
the processor time of such a run, least of 9, the programs in turn. Exudyn: point mass and distance constraint in two
dimensions, the smallest model that it has of this machine; the time is that of its solver, without sensors. Needs
exudyn and numpy (PyPI).
"""
import argparse
import csv
import datetime
import subprocess
import sys
import time

import exudyn
import numpy as np
from exudyn import itemInterface as item

END, LIMIT, REPETITIONS = 10.0, 5e-5, 9


class Tandem:
    def __init__(self, program, method):
        self.name = f"tandem, cut hinge, {method} 0.9"
        self.program = program
        self.method = method

    def run(self, steps, repetitions=1):
        said = subprocess.run([self.program, "simple_pendulum_cut", str(END), self.method, str(steps), str(repetitions)],
                              capture_output=True, text=True, check=False).stdout.splitlines()
        figures = [line for line in said if not line.startswith("[")]  # without the lines of the log
        if len(figures) < repetitions + 2:  # refused: the loop comes apart with steps as long as these
            return float("inf"), float("inf")
        return min(float(line) for line in figures[:repetitions]), float(figures[repetitions].split()[-1])

    def error(self, steps):
        return self.run(steps)[1]

    def seconds(self, steps):
        return self.run(steps)[0]


class Exudyn:
    def __init__(self, method):
        self.name = f"Exudyn, distance constraint, {method}"
        self.method = method

    def solve(self, steps, sensors):
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        ground = system.AddObject(item.ObjectGround())
        node = system.AddNode(item.NodePoint2D(referenceCoordinates=[-1, 0]))
        mass = system.AddObject(item.MassPoint2D(physicsMass=1, nodeNumber=node))
        ends = [system.AddMarker(item.MarkerBodyPosition(bodyNumber=body)) for body in (ground, mass)]
        system.AddObject(item.DistanceConstraint(markerNumbers=ends, distance=1))
        system.AddLoad(item.Force(markerNumber=ends[1], loadVector=[0, -9.81, 0]))
        kinds = (exudyn.OutputVariableType.Position, exudyn.OutputVariableType.Velocity)
        seen = [system.AddSensor(item.SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind))
                for kind in kinds] if sensors else []
        system.Assemble()
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.endTime = END
        settings.timeIntegration.numberOfSteps = steps
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
        settings.solutionSettings.writeSolutionToFile = False
        settings.solutionSettings.sensorsWritePeriod = END / steps
        settings.timeIntegration.verboseMode = 0
        begin = time.process_time()
        system.SolveDynamic(settings, solverType=getattr(exudyn.DynamicSolverType, self.method))
        return time.process_time() - begin, [np.array(system.GetSensorStoredData(s))[:, 1:] for s in seen]

    def error(self, steps):
        _, (x, v) = self.solve(steps, True)
        energy = 0.5 * (v**2).sum(axis=1) + 9.81 * x[:, 1]
        return float(np.abs(energy - energy[0]).max())

    def seconds(self, steps):
        return self.solve(steps, False)[0]


def fewest_steps(program):
    steps = 500
    while steps < 300_000:
        if program.error(steps) <= LIMIT:
            return steps
        steps = int(steps * 1.05) + 1
    return None


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    options.add_argument("bench_trees")
    for name in ("csv", "commit", "device"):
        options.add_argument(f"--{name}")
    options = options.parse_args()
    exudyn.config.suppressWarnings = True
    programs = [Tandem(options.bench_trees, "generalized_alpha"), Tandem(options.bench_trees, "extrapolate"),
                Exudyn("TrapezoidalIndex2"), Exudyn("GeneralizedAlpha")]
    steps = {program: fewest_steps(program) for program in programs}
    met = [program for program in programs if steps[program]]
    least = dict.fromkeys(met, float("inf"))
    for _ in range(REPETITIONS):
        for program in met:
            least[program] = min(least[program], program.seconds(steps[program]))
    rows = []
    for program in programs:
        if program in met:
            error = program.error(steps[program])
            print(f"{program.name:45} {steps[program]:7} steps  {1e3 * least[program]:8.2f} ms  {error:.2e} J")
            rows.append([program.name, steps[program], f"{1e3 * least[program]:.3f}", f"{error:.3e}"])
        else:
            print(f"{program.name:45} more than 300,000 steps")
            rows.append([program.name, "", "", ""])
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["date", "commit", "device", "command", "exudyn", "program", "steps", "cpu_ms", "energy_error_J"])
            for row in rows:
                writer.writerow([datetime.date.today().isoformat(), options.commit, options.device,
                                 "loop_against_exudyn.py (least of 9, in turn)", exudyn.__version__, *row])


if __name__ == "__main__":
    sys.exit(main())
