#!/usr/bin/env python3
"""Scenes whose spheres are placed before the start: the second start, other runs as a start, what describe says."""
import json
import os
import shutil
import signal
import subprocess
import time

import harness

BED = {
    "tandem": "1.1", "name": "bed", "end_time": 0.02, "output": {"frame_interval": 0.01},
    "dem": {
        "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.3,
                       "friction": 0.5}],
        "walls": [{"name": "drum", "material": "glass", "orientation": [0.7071067811865476, 0.7071067811865476, 0, 0],
                   "shape": {"type": "cylinder", "radius": 0.1, "height": 0.1}}],
        "particles": [{"name": "grains", "material": "glass", "radius": [0.006, 0.009],
                       "fill": {"type": "packing", "region": {"type": "inside", "wall": "drum"}, "mass": 1.5}}],
        "settle": {"kinetic_energy": 2e-8},
        "domain": {"min": [-0.2, -0.2, -0.2], "max": [0.2, 0.2, 0.2]}}}


class Fill(harness.Case):
    def setUp(self):
        super().setUp()
        os.environ["TANDEM_CACHE"] = str(self.folder / "cache")
        self.addCleanup(os.environ.pop, "TANDEM_CACHE")

    def write(self, scene, name="scene.json"):
        path = self.folder / name
        path.write_text(json.dumps(scene))
        return path

    def describe(self, scene):
        return subprocess.run([harness.options.bin / "tandem", "describe", scene], capture_output=True, text=True)

    def test_second_start_comes_from_the_cache_to_the_same_bits(self):
        scene = self.write(BED)
        seconds, summaries = [], []
        for out in ("first", "second"):
            begin = time.monotonic()
            self.run_scene(scene, "--transport", "inproc", out=self.folder / out)
            seconds.append(time.monotonic() - begin)
            summaries.append(self.summary(self.folder / out))
        first, second = summaries
        self.assertEqual([first["settle"]["from_cache"], second["settle"]["from_cache"]], [False, True])
        self.assertEqual(first["state_hash"], second["state_hash"])
        self.assertAlmostEqual(first["fills"]["grains"]["mass_kg"], 1.5, delta=0.005)
        self.assertLess(first["settle"]["kinetic_energy_J"], 2e-8)
        self.assertIn("taken from the cache", (self.folder / "second" / "run.log").read_text())
        print(f"{first['fills']['grains']['spheres']} spheres, first start {seconds[0]:.2f} s, second {seconds[1]:.2f} s")

    def test_damaged_bed_is_named_in_the_log(self):
        scene = self.write(BED)
        self.run_scene(scene, "--transport", "inproc")
        first = self.summary()
        bed, = (self.folder / "cache").glob("settled_*.h5")
        content = bytearray(bed.read_bytes())
        content[len(content) // 2] ^= 1
        bed.write_bytes(content)
        self.run_scene(scene, "--transport", "inproc")
        self.assertIn(bed.name, self.log())
        self.assertIn("made anew", self.log())
        self.assertEqual(self.summary()["state_hash"], first["state_hash"])

    def test_frame_of_another_run_is_a_start(self):
        self.run_scene(self.write(BED), "--transport", "inproc")
        scene = json.loads(json.dumps(BED))
        del scene["dem"]["settle"], scene["dem"]["particles"][0]["radius"]
        scene["dem"]["particles"][0]["fill"] = {"type": "run", "folder": "out", "time": 0.01}
        said = self.describe(self.write(scene, "from_run.json"))
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertIn("run out, t = 0.01 s", said.stdout)
        frames = sorted(self.out.rglob("*"))
        refused = self.run_scene(self.folder / "from_run.json", "--backend", "cpu", out=self.out, expect=2)
        self.assertIn("is an input of this run", refused)
        self.assertEqual(sorted(self.out.rglob("*")), frames, "nothing is deleted")
        # A copy of the bed whose frames are a link into it.
        copy = self.folder / "copy"
        shutil.copytree(self.out, copy, ignore=shutil.ignore_patterns("frames"))
        (copy / "frames").symlink_to("../out/frames")
        scene["dem"]["particles"][0]["fill"]["folder"] = "copy"
        contents = {path: path.read_bytes() for path in frames if path.is_file()}
        refused = self.run_scene(self.write(scene, "from_copy.json"), "--backend", "cpu", out=self.out, expect=2)
        self.assertRegex(refused, r"copy/frames/particles_\d+[.]h5: is an input of this run")
        self.assertEqual({path: path.read_bytes() for path in contents}, contents, "nothing is deleted")
        scene["dem"]["particles"][0]["fill"]["folder"] = "out"
        self.run_scene(self.folder / "from_run.json", "--transport", "inproc", out=self.folder / "next")
        self.assertEqual(self.summary(self.folder / "next")["spheres"], self.summary()["spheres"])
        scene["dem"]["particles"][0]["fill"]["time"] = 0.013
        said = self.describe(self.write(scene, "from_run.json"))
        self.assertEqual(said.returncode, 2)
        self.assertIn("dem.particles[0].fill: that run has no frame at 0.013 s (the nearest of its 3 frames is at "
                      "0.01 s, and the last one at 0.02 s)", said.stderr)
        scene["dem"]["particles"][0]["fill"] = {"type": "run", "folder": "nowhere"}
        said = self.describe(self.write(scene, "from_run.json"))
        self.assertIn("has no frames of particles (give the folder of a run", said.stderr)

    def test_settling_ends_at_once_when_interrupted(self):
        scene = json.loads(json.dumps(BED))
        scene["dem"]["settle"] = {"kinetic_energy": 1e-30, "at_most": 1e4}
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            process = subprocess.Popen([harness.options.bin / "tandem", "run", self.write(scene), "--out", self.out],
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.addCleanup(process.kill)
            while "spheres settle" not in (line := process.stdout.readline()):
                self.assertTrue(line, "it ended by itself")
            time.sleep(0.2)
            begin = time.monotonic()
            process.send_signal(number)
            said, _ = process.communicate(timeout=60)
            print(f"\n  ended {time.monotonic() - begin:.2f} s after signal {number}")
            self.assertEqual(process.returncode, 130, said)
            self.assertLess(time.monotonic() - begin, 1 * harness.options.slack)
            self.assertIn("error: interrupted", said)
            self.assertFalse(self.out.exists())

    def test_describe_says_what_was_placed(self):
        said = self.describe(self.write(BED))
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertIn("packing inside drum", said.stdout)
        self.assertIn("note: the bed settled in ", said.stdout)


if __name__ == "__main__":
    harness.main()
