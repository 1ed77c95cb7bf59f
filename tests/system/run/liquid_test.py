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
        for transport in ("shm", "inproc", "stream"):
            self.run_scene(self.scene(checks=[]), "--end-time", "0.05", "--transport", transport)
            hashes[transport] = self.summary()["state_hash"]
        self.assertEqual(len(set(hashes.values())), 1, hashes)
        self.run_scene(self.scene(checks=[]), "--end-time", "0.05", "--scheme", "implicit")
        self.assertEqual(self.summary()["status"], "ok")
        said = self.run_scene(self.scene(checks=[]), "--end-time", "0.05", "--scheme", "linear_implicit", expect=2)
        self.assertIn("which sph_server", said)

    def test_a_restart_has_the_same_bits(self):
        scene = self.scene(checks=[])
        self.run_scene(scene, "--end-time", "0.1", "--checkpoint-every", "0.05")
        begun = self.out.rename(self.folder / "begun")
        self.run_scene(scene, "--end-time", "0.2", "--restart", str(begun))
        restarted = self.summary()
        self.run_scene(scene, "--end-time", "0.2")
        whole = self.summary()
        self.assertEqual(restarted["state_hash"], whole["state_hash"])
        self.assertEqual(restarted["sph"]["momentum_balance"], whole["sph"]["momentum_balance"])

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
