#!/usr/bin/env python3
"""Scenes with a liquid: a tank that moves, grains and liquid in one run, restart, a killed sph_server."""
import json
import os
import shutil
import signal
import subprocess
import unittest

import harness
from harness import Case, children, until

TANK = harness.SCENES.parents[2] / "launch/scenes/tank.json"


class Liquid(Case):
    def scene(self, **changes):
        """The tank with coarse particles, which runs in a few seconds."""
        scene = json.loads(TANK.read_text())
        scene["sph"]["spacing"] = 0.04
        scene["sph"]["micro_step"] = 4e-4  # closes the balance of energy
        scene["output"]["frame_interval"] = 0.1
        scene.update(changes)
        path = self.folder / "tank.json"
        path.write_text(json.dumps(scene))
        return path

    def with_grains(self):
        scene = json.loads(self.scene(end_time=0.4, checks=[]).read_text())
        scene["mbd"]["bodies"][0]["shapes"][0]["material"] = "glass"
        scene["dem"] = {
            "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25}],
            "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5, "friction": 0.3}],
            "particles": [{"name": "beads", "material": "glass", "radius": 0.01,
                           "fill": {"type": "lattice", "min": [-0.1, -0.05, 0.01], "max": [0.1, 0.05, 0.1], "spacing": 0.03}}],
            "domain": scene["sph"]["domain"]}
        path = self.folder / "both.json"
        path.write_text(json.dumps(scene))
        return path

    def test_a_tank(self):
        self.run_scene(self.scene(checks=[]), "--end-time", "0.3")
        summary = self.summary()
        self.assertEqual((summary["status"], summary["spheres"]), ("ok", 0))
        self.assertEqual(summary["sph"]["particles"], 10 * 5 * 4)
        self.assertEqual(summary["sph"]["passed_walls"], 0)
        self.assertLess(summary["impulse_closure"], 1e-12)
        self.assertLess(summary["sph"]["momentum_balance"], 1e-6)
        self.assertIn("momentum_liquid", summary["verdict"]["judged"])
        self.assertTrue((self.out / "liquid.xdmf").is_file() and (self.out / "frames/liquid_000003.h5").is_file())
        self.assertFalse((self.out / "particles.h5").exists())
        self.assertRegex((self.out / "bodies.csv").read_text().splitlines()[0], "tank.contact_force.z")

    def test_every_transport_and_scheme_has_its_bits(self):
        hashes = {}
        for transport in ("shm", "inproc", "stream", *(["dds"] if self.has_dds() else [])):
            more = ["--insecure"] if transport == "dds" else []
            self.run_scene(self.scene(checks=[]), "--end-time", "0.05", "--transport", transport, *more)
            hashes[transport] = self.summary()["state_hash"]
        self.assertEqual(len(set(hashes.values())), 1, hashes)
        self.run_scene(self.scene(checks=[]), "--end-time", "0.05", "--scheme", "implicit")
        self.assertEqual(self.summary()["status"], "ok")
        # The impulse that the body receives before its liquid records it is not received twice.
        self.run_scene(self.scene(checks=[]), "--end-time", "0.05", "--scheme", "linear_implicit")
        summary = self.summary()
        self.assertEqual((summary["windows"], summary["status"]), (25, "ok"))
        self.assertLess(abs(summary["energy_residual"]), 0.02)
        self.assertLess(summary["impulse_outstanding"], 0.01)

    def sensed(self):
        """The tank with sensors of each kind, checks of them, and a controller's view of one."""
        scene = json.loads(self.scene(end_time=0.3, checks=[]).read_text())
        scene["sph"]["sensors"] = [
            {"type": "level", "name": "gauge", "body": "tank", "position": [0.05, 0.01, -0.14]},
            {"type": "pressure", "name": "bottom", "body": "tank", "position": [0, 0, -0.14]},
            {"type": "load", "name": "sloshing", "body": "tank", "position": [0, 0, -0.14], "axis": [0, 1, 0]},
            {"type": "load", "name": "on_case", "wall": "case"},
            {"type": "region", "name": "right", "body": "tank", "position": [0.1, 0, 0],
             "shape": {"type": "box", "size": [0.2, 1, 1]}, "flow": "x"}]
        scene["checks"] = [
            {"name": "level [m]", "of": "gauge.level", "reduce": "mean", "expected": 0.16, "tolerance": 0.05, "why": "the fill"},
            {"name": "pressure [Pa]", "of": "bottom.pressure", "reduce": "mean", "expected": 1569.6, "tolerance": 0.06,
             "why": "1000 kg/m3 x 9.81 m/s2 x 0.16 m"},
            {"name": "load [N]", "of": "sloshing.force.z", "reduce": "last", "expected": {"of": "tank.contact_force.z", "times": 1},
             "tolerance": 1e-9, "why": "the liquid is all that loads the tank"}]
        scene["output"]["plots"] = ["gauge.level", "sloshing.axis_torque"]
        path = self.folder / "sensed.json"
        path.write_text(json.dumps(scene))
        return path

    def test_starts_at_rest_under_its_liquid(self):
        """A tank on a spring: (m + m_f) g / k below where the spring has no force."""
        stiffness = 4000.0
        scene = json.loads(self.scene(end_time=0.1, checks=[]).read_text())
        scene["mbd"]["start"] = "equilibrium"
        scene["mbd"]["joints"][0].update(axis=[0, 0, 1])
        del scene["mbd"]["joints"][0]["rate"], scene["sph"]["liquids"][0]["velocity"]
        scene["mbd"]["forces"][0].update(point_a=[0, 0, -1], point_b=[0, 0, 0.14], length=1.14, stiffness=stiffness)
        path = self.folder / "spring.json"
        path.write_text(json.dumps(scene))
        self.run_scene(path)
        summary = self.summary()
        self.assertEqual(summary["status"], "ok")
        rows = [line.split(",") for line in (self.out / "bodies.csv").read_text().splitlines()]
        height = [float(row[rows[0].index("tank.position.z")]) for row in rows[1:]]
        deflection = (10 + 1000 * 0.4 * 0.2 * 0.16) * 9.81 / stiffness
        print(f"deflection, expected {deflection:.6f} m, at the start {0.14 - height[0]:.6f} m")
        self.assertAlmostEqual(0.14 - height[0], deflection, delta=1e-6)
        for z in height:
            self.assertAlmostEqual(z, height[0], delta=2e-4)
        scene["sph"]["liquids"][0]["velocity"] = [0.1, 0, 0]
        path.write_text(json.dumps(scene))
        self.assertIn("an equilibrium is at rest", self.run_scene(path, expect=2))

    def test_sensors(self):
        self.run_scene(self.sensed())
        rows = [line.split(",") for line in (self.out / "sensors.csv").read_text().splitlines()]
        last = dict(zip(rows[0], map(float, rows[-1])))
        self.assertIn("right.passed", last)
        print(f"\n  level [m]: expected 0.16, measured {last['gauge.level']:.4g}; pressure [Pa]: expected 1570, "
              f"measured {last['bottom.pressure']:.4g}")
        for axis in "xyz":
            self.assertEqual(last[f"on_case.force.{axis}"], last[f"sloshing.force.{axis}"])
        self.assertAlmostEqual(last["sloshing.axis_torque"], last["sloshing.torque.y"], delta=1e-9 * 125)
        sensors = self.summary()["sensors"]
        self.assertEqual(sensors["gauge"]["level"]["unit"], "m")
        self.assertEqual([check["passed"] for check in self.summary()["checks"]], [True] * 3)

    def test_a_restart_has_the_same_bits(self):
        """State, balance and sensors."""
        scene = self.sensed()
        self.run_scene(scene, "--end-time", "0.1", "--checkpoint-every", "0.05")
        begun = self.out.rename(self.folder / "begun")

        def results():
            summary = self.summary()
            return summary["state_hash"], summary["sph"]["momentum_balance"], (self.out / "sensors.csv").read_text()

        self.run_scene(scene, "--end-time", "0.2", "--restart", str(begun))
        restarted = results()
        self.run_scene(scene, "--end-time", "0.2")
        self.assertEqual(restarted, results())

    def test_windows_and_summary_have_the_liquid(self):
        self.run_scene(self.with_grains(), "--end-time", "0.05")
        rows = [line.split(",") for line in (self.out / "windows.csv").read_text().splitlines()]
        last = dict(zip(rows[0], map(float, rows[-1])))
        self.assertGreater(last["liquid_micro_steps"], 0)
        self.assertGreater(last["liquid_kinetic_energy"], 0)
        self.assertNotEqual(last["liquid_kinetic_energy"], last["kinetic_energy"])
        self.assertLess(last["liquid_momentum_balance"], 1e-6)
        error = self.summary()["sph"]["volume_error"]
        print(f"\n  volume error: {error:.3g}; half of the compression at the bottom, 0.005, and waves")
        self.assertTrue(0 < error < 0.02)

    def test_errors_at_the_start_name_the_mistake(self):
        scene = json.loads(self.scene(checks=[]).read_text())
        path = self.folder / "wrong.json"

        def said(**liquid):
            wrong = json.loads(json.dumps(scene))
            wrong["sph"]["liquids"][0].update(liquid)
            path.write_text(json.dumps(wrong))
            return self.run_scene(path, expect=2)
        through = said(fill=[{"type": "box", "min": [-0.2, -0.1, 0], "max": [0.24, 0.1, 0.16]}])
        self.assertIn("wall 'case' passes through the box", through)
        self.assertNotIn("while the servers started", through)
        self.assertIn("1 g/cm3 is 1000 kg/m3: give 1000", said(density=1))
        self.assertIn("is compressed by", said(sound_speed=2))

    def test_a_liquid_that_is_too_fast_says_so(self):
        """The bed falls much faster than its speed of sound bears, and leaves the domain at last."""
        scene = json.loads(self.scene(checks=[], end_time=2).read_text())
        del scene["sph"]["micro_step"]
        scene["sph"]["liquids"][0] |= {"sound_speed": 1, "pressure": "zero", "velocity": [0, 0, 0], "artificial_viscosity": 0}
        path = self.folder / "fast.json"
        path.write_text(json.dumps(scene))
        _, status, said = self.finish(self.start(path), 60)
        if status == 0:
            self.assertEqual(self.summary()["status"], "suspect")
            self.assertIn("sound_speed", said)
        else:
            self.assertRegex(said, "before, the density of the liquid was off by|the liquid flies apart")
            self.assertIn("larger sound_speed", said)

    def channel(self):
        """Liquid comes in at one end of a channel that is empty at the start, and goes out farther on."""
        scene = {
            "tandem": "1.1", "name": "channel", "end_time": 0.3, "coupling": {"window": 0.005},
            "sph": {
                "spacing": 0.01,
                "liquids": [{"name": "water", "density": 1000, "viscosity": 0.001, "artificial_viscosity": 0.1, "expected_speed": 1.2,
                             "fill": []}],
                "wall_friction": "free_slip",
                "walls": [{"name": "channel", "position": [0.1, 0, 0.02],
                           "shape": {"type": "box", "size": [0.2, 0.04, 0.04], "open": ["+x", "-x"]}}],
                "inlets": [{"name": "pipe", "position": [0, 0, 0.02], "orientation": {"axis": [0, 1, 0], "angle_deg": 90},
                            "shape": {"type": "rectangle", "size": [0.04, 0.04]}, "flow": 8e-4}],
                "outlets": [{"name": "drain", "region": {"type": "plane", "point": [0.06, 0, 0], "normal": [1, 0, 0]}}],
                "sensors": [{"type": "region", "name": "gate", "position": [0.03, 0, 0.02],
                             "shape": {"type": "box", "size": [0.02, 0.04, 0.06]}, "flow": "x"}],
                "domain": {"min": [-0.05, -0.1, -0.1], "max": [0.4, 0.1, 0.1]}},
            "output": {"frame_interval": 0.1},
            "checks": [{"name": "mass that came in [kg]", "of": "summary.sph.inlets.pipe.mass_kg", "expected": 0.24, "tolerance": 0.07,
                        "why": "0.8 kg/s over 0.3 s, in layers of 0.016 kg"}]}
        path = self.folder / "channel.json"
        path.write_text(json.dumps(scene))
        return path

    def test_liquid_comes_in_and_goes_out(self):
        scene = self.channel()
        self.run_scene(scene, "--threads", "1")
        whole = self.summary()
        sph = whole["sph"]
        self.assertEqual((whole["status"], sph["particles"], sph["passed_walls"]), ("ok", 0, 0))
        self.assertEqual(sph["inlets"]["pipe"]["particles"], sph["came_in"])
        self.assertEqual(sph["outlets"]["drain"]["particles"], sph["went_out"])
        self.assertGreater(sph["went_out"], 0)
        rows = [line.split(",") for line in (self.out / "sensors.csv").read_text().splitlines()]
        last = dict(zip(rows[0], map(float, rows[-1])))
        print(f"\n  mass [kg]: came in {sph['inlets']['pipe']['mass_kg']:.4g}, passed the gate {last['gate.passed']:.4g}, "
              f"went out {sph['outlets']['drain']['mass_kg']:.4g}; momentum {sph['momentum_balance']:.2g}")
        self.assertLess(sph["momentum_balance"], 1e-12)
        # The gate is half way between inlet and outlet.
        middle = 0.5 * (sph["inlets"]["pipe"]["mass_kg"] + sph["outlets"]["drain"]["mass_kg"])
        self.assertAlmostEqual(last["gate.passed"], middle, delta=0.02)
        self.run_scene(scene, "--threads", "1", "--end-time", "0.2", "--checkpoint-every", "0.1")
        begun = self.out.rename(self.folder / "begun")
        self.run_scene(scene, "--threads", "1", "--restart", str(begun))
        self.assertEqual(self.summary()["state_hash"], whole["state_hash"])
        self.assertEqual(self.summary()["sph"]["outlets"], sph["outlets"])

    def test_grains_and_liquid(self):
        scene = self.with_grains()
        said = subprocess.run([harness.options.bin / "tandem", "validate", scene], capture_output=True, text=True)
        self.assertIn("grains and liquid do not feel each other", said.stdout + said.stderr)
        self.run_scene(scene, "--threads", "1")
        both = self.summary()
        self.assertGreater(both["spheres"], 0)
        self.assertEqual(both["sph"]["particles"], 200)
        self.assertLess(both["impulse_closure"], 1e-12)
        self.assertLess(both["momentum_balance"], 1e-6)
        self.assertLess(both["sph"]["momentum_balance"], 1e-6)
        self.assertTrue((self.out / "particles.h5").is_file() and (self.out / "liquid.h5").is_file())
        # Both load the tank: at rest its load is the sum of the weights.
        rows = [dict(zip(lines[0], map(float, line))) for lines in [[line.split(",") for line in
                (self.out / "bodies.csv").read_text().splitlines()]] for line in lines[1:]]
        mean = sum(row["tank.contact_force.z"] for row in rows[100:]) / len(rows[100:])
        weight = -9.81 * (1000 * 0.4 * 0.2 * 0.16 + both["spheres"] * 2500 * 4 / 3 * 3.14159265 * 0.01 ** 3)
        print(f"\n  load [N]: expected {weight:.4g}, measured {mean:.4g}, tolerance 3 %")
        self.assertAlmostEqual(mean / weight, 1, delta=0.03)
        # A restart of both.
        self.run_scene(scene, "--end-time", "0.1", "--checkpoint-every", "0.05", "--threads", "1")
        begun = self.out.rename(self.folder / "begun")
        self.run_scene(scene, "--restart", str(begun), "--threads", "1")
        self.assertEqual(self.summary()["state_hash"], both["state_hash"])

    def test_a_killed_sph_server_is_one_sentence(self):
        process = self.start(self.scene(checks=[], end_time=1000.0))
        self.assertTrue(until(lambda: self.windows() > 3, 20 * harness.options.slack), "the run does not begin")
        servers = children(process.pid)
        self.assertEqual(set(servers), {"mbd_server", "sph_server"})
        os.kill(servers["sph_server"], signal.SIGKILL)
        seconds, status, said = self.finish(process)
        self.assertEqual(status, 4, said)
        self.assertRegex(said, rf"sph_server \(pid {servers['sph_server']}\) was killed by signal 9 \(Killed\) in window \d+")
        self.assert_gone(servers.values())
        print(f"\n  sph_server: coordinator left after {seconds:.3f} s")

    def test_other_servers(self):
        said = self.run_scene(self.scene(checks=[]), "--sph-server", "dem_server", expect=2)
        self.assertIn("'dem_server' computes the particles, and the server of the liquid is wanted here", said)
        said = self.run_scene("hanging_box.json", "--sph-server", "./mine", expect=2)
        self.assertIn("the scene has no liquid, so that no such server runs", said)
        sph_server = harness.options.bin / "sph_server"
        self.run_scene(self.scene(checks=[]), "--end-time", "0.05", "--sph-server", str(sph_server))
        self.assertEqual(self.summary()["sph_server"]["command"], str(sph_server))

    def test_looking_at_it(self):
        bin_folder = harness.options.bin
        said = subprocess.run([bin_folder / "tandem", "describe", self.scene()], capture_output=True, text=True, check=True)
        self.assertIn("200 particles", said.stdout)
        self.assertIn("water", said.stdout)
        if shutil.which("povray"):
            picture = self.folder / "start.png"
            subprocess.run([bin_folder / "tandem", "preview", self.scene(), "-o", picture], check=True, capture_output=True)
            self.assertTrue(picture.is_file())


class JudgedLiquid(Case):
    def test_our_server_passes(self):
        said = subprocess.run([harness.options.bin / "tandem", "conform", "sph_server", "--role", "sph"],
                              capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        self.assertNotIn("FAIL", said.stdout)


if __name__ == "__main__":
    harness.main()
