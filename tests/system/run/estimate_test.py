#!/usr/bin/env python3
"""The error that --estimate richardson states against the true one."""
import csv
import json
import math
import os
import signal
import subprocess

import harness
from harness import Case

POSITION, ENERGY = "mbd_position_error_estimate_m", "mbd_energy_error_estimate_J"


class Estimate(Case):
    def measured(self, name, *arguments, change=lambda scene: None, out="out"):
        """Summary and the last row of bodies.csv of a run of the changed scene."""
        scene = json.loads((harness.SCENES / name).read_text())
        scene.pop("checks", None)
        change(scene)
        path = self.folder / (out + ".json")
        path.write_text(json.dumps(scene))
        folder = self.folder / out
        self.run_scene(path, *arguments, out=folder)
        with open(folder / "bodies.csv", encoding="utf-8") as file:
            row = list(csv.DictReader(file))[-1]
        return self.summary(folder), {name: float(value) for name, value in row.items()}

    def distance(self, body, a, b):
        return math.dist(*[[row[f"{body}.position.{axis}"] for axis in "xyz"] for row in (a, b)])

    def assert_near(self, estimate, error, what):
        print(f"\n  {what}: {estimate:.3g} estimated, {error:.3g} true", end="")
        self.assertGreater(estimate, error / 3, what)
        self.assertLess(estimate, error * 3, what)

    def test_an_interrupt_of_the_second_run_is_said(self):
        scene = json.loads((harness.SCENES / "pendulum.json").read_text())
        scene.pop("checks", None)
        scene["end_time"] = 20
        (self.folder / "long.json").write_text(json.dumps(scene))
        process = subprocess.Popen([harness.options.bin / "tandem", "run", self.folder / "long.json", "--out", self.out, "--estimate", "richardson",
                                    "--no-picture", "--no-report"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(process.kill)
        self.assertTrue(harness.until((self.out / "half_steps" / "bodies.csv").exists, 60))
        servers = harness.children(process.pid).values()
        process.send_signal(signal.SIGTERM)
        said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, said)
        self.assertFalse(any(map(harness.alive, servers)))
        self.assertRegex(said, "this run is complete, but for the estimate of its error")
        summary = self.summary()
        self.assertEqual((summary["status"], summary["exit_status"]), ("ok", 130))
        self.assertEqual(summary[POSITION], "not estimated: the run with half the steps was interrupted")

    def test_pendulum(self):
        def coarse(scene):
            scene["coupling"]["window"] = 5e-3
        summary, end = self.measured("pendulum.json", "--estimate", "richardson", change=coarse)
        # a'' = m g l cos(a) / (m l^2 + I), by the classical method of Runge and Kutta
        angle, rate, h = 0.0, 0.0, 1e-4
        def slope(a):
            return 9.81 * math.cos(a) / 1.001
        for _ in range(2000):
            k1, l1 = rate, slope(angle)
            k2, l2 = rate + h / 2 * l1, slope(angle + h / 2 * k1)
            k3, l3 = rate + h / 2 * l2, slope(angle + h / 2 * k2)
            k4, l4 = rate + h * l3, slope(angle + h * k3)
            angle, rate = angle + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), rate + h / 6 * (l1 + 2 * l2 + 2 * l3 + l4)
        true = {"bob.position.x": math.cos(angle), "bob.position.y": 0, "bob.position.z": -math.sin(angle)}
        self.assert_near(summary[POSITION], self.distance("bob", end, true), "position [m]")
        self.assert_near(summary[ENERGY], abs(summary["mbd_energy_balance_J"]), "energy [J]")
        self.assertEqual(summary["status"], "ok")
        half = self.summary(self.folder / "out/half_steps")
        self.assertEqual((summary["mbd_steps"], half["mbd_steps"]), (40, 80))
        self.assertEqual(summary["mbd_error_estimate_steps"], 80)
        plain, end = self.measured("pendulum.json", change=coarse, out="plain")
        self.assert_near(plain[POSITION], self.distance("bob", end, true), "position [m], by further runs")
        self.assertEqual(plain["mbd_state_hash"], summary["mbd_state_hash"])

    def test_a_run_with_particles(self):
        summary, end = self.measured("hanging_box.json", "--estimate", "richardson")
        def fine(scene):
            scene["mbd"]["integrator"] = {"step": 1e-3 / 32}
        reference, true = self.measured("hanging_box.json", change=fine, out="fine")
        self.assertRegex(reference[POSITION], "loads of particles")
        self.assert_near(summary[POSITION], self.distance("box", end, true), "position [m]")
        self.assert_near(summary[ENERGY], abs(summary["mbd_energy_end_J"] - reference["mbd_energy_end_J"]), "energy [J]")

    def test_error_control_and_stops(self):
        def stops(tolerance):
            def change(scene):
                scene["end_time"] = 1
                scene["coupling"]["window"] = 1e-2
                scene["mbd"]["integrator"] = {"error_tolerance": tolerance}
                scene["mbd"]["joints"][0]["limits"] = {"lower": -9, "upper": 0.5, "stiffness": 1e4, "restitution": 0.8}
            return change
        summary, end = self.measured("pendulum.json", "--estimate", "richardson", change=stops(1e-6))
        self.assertGreater(summary["mbd_stop_contacts"], 0)
        reference, true = self.measured("pendulum.json", change=stops(1e-10), out="fine")
        self.assertRegex(reference[POSITION], "error control")
        self.assert_near(summary[POSITION], self.distance("bob", end, true), "position [m]")

    def test_words(self):
        said = self.run_scene("pendulum.json", "--estimate", "richardsen", expect=2)
        self.assertRegex(said, "there is no estimate 'richardsen'.*did you mean 'richardson'")
        said = self.run_scene("pendulum.json", "--estimate", "richardson", "--attach", expect=2)
        self.assertRegex(said, "leave --attach out")
        said = self.run_scene("falling_balls.json", "--estimate", "richardson", expect=2)
        self.assertRegex(said, "the scene has none")
        self.assertFalse(os.path.exists(self.out))


if __name__ == "__main__":
    harness.main()
