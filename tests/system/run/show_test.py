#!/usr/bin/env python3
"""`tandem preview` and `tandem movie`: pictures that exist, move and are refused with what is missing."""
import csv
import json
import os
import signal
import subprocess
import time
import unittest

import harness
from harness import Case, options

PNG = b"\x89PNG\r\n\x1a\n"


class Show(Case):
    def say(self, *arguments, expect=0, path=None):
        result = subprocess.run([options.bin / "tandem", *map(str, arguments)], capture_output=True, text=True, timeout=120 * options.slack,
                                cwd=self.folder, env={**os.environ, **({"PATH": path} if path is not None else {})})
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def run_with_frames(self, end_time=0.05, **output):
        """The folder of a run of hanging_box with three frames. Spheres touch each other and the box at 0.1 s."""
        scene = json.loads((harness.SCENES / "hanging_box.json").read_text())
        scene["end_time"] = end_time
        scene["output"] = {"frame_interval": end_time / 2, **output}
        (self.folder / "box.json").write_text(json.dumps(scene))
        self.say("run", "box.json", "--out", self.out, "--no-picture", "--no-report", "--quiet")
        return self.out

    def test_preview_shows_the_start(self):
        said = self.say("preview", harness.SCENES / "hanging_box.json")
        self.assertEqual(said, "hanging_box_preview.png: the start of hanging_box\n")
        self.assertEqual((self.folder / "hanging_box_preview.png").read_bytes()[:8], PNG)
        for _ in range(2):  # the second one replaces the first
            self.say("preview", harness.SCENES / "pendulum.json", "-o", "a.png")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["a.png", "hanging_box_preview.png"])

    def test_what_does_not_settle_is_drawn_and_named(self):
        scene = {"tandem": "1.1", "name": "cone", "end_time": 0.1, "dem": {
            "materials": [{"name": "glass", "density": 2500, "young": 1e7, "poisson": 0.25, "restitution": 0.3, "friction": 0.4}],
            "walls": [{"name": "cone", "material": "glass", "color": [0.8, 0.2, 0.2],
                       "shape": {"type": "cone", "radius": 0.01, "top_radius": 0.05, "height": 0.06, "segments": 16, "open": ["+z"]}}],
            "particles": [{"name": "beads", "material": "glass", "radius": 0.005,
                           "fill": {"type": "packing", "region": {"type": "above", "wall": "cone"}, "level": 0.02}}],
            "settle": {"kinetic_energy": 1e-7, "at_most": 0.03}, "domain": {"min": [-0.1, -0.1, -0.1], "max": [0.1, 0.1, 0.1]}}}
        (self.folder / "cone.json").write_text(json.dumps(scene))
        words = r"spheres have more than that, from .* the fastest is sphere \d+ of 'beads' at .* m from wall 'cone' of 'ground'. " \
                r"They are drawn in cone_unsettled.png"
        self.assertRegex(self.say("preview", "--unsettled", "cone.json"), words)
        self.assertEqual((self.folder / "cone_unsettled.png").read_bytes()[:8], PNG)
        self.assertRegex(self.say("validate", "cone.json", expect=2, path="/nowhere"),
                         words.replace("drawn", "not drawn") + ": the picture could not be drawn|povray is not there")
        scene["dem"]["settle"]["at_most"] = 5
        (self.folder / "cone.json").write_text(json.dumps(scene))
        self.assertRegex(self.say("preview", "--unsettled", "cone.json", "-o", "rest.png"), "rest.png: all spheres settle, in 0[.]")
        del scene["dem"]["settle"]
        (self.folder / "cone.json").write_text(json.dumps(scene))
        self.assertRegex(self.say("preview", "--unsettled", "cone.json", expect=2), "the scene has no dem.settle")

    def test_preview_ends_within_a_second_when_interrupted(self):
        tools = self.folder / "tools"
        tools.mkdir()
        (tools / "povray").write_text("#!/bin/sh\necho part > ${2#+O}\necho $$ > pid\nexec sleep 100\n")
        (tools / "povray").chmod(0o755)
        picture = self.folder / "picture"
        picture.mkdir()
        for number in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen([options.bin / "tandem", "preview", harness.SCENES / "hanging_box.json"], cwd=picture,
                                       stderr=subprocess.PIPE, text=True, env={**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"},
                                       preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN))  # as a script with `&`
            self.addCleanup(process.kill)
            drawing = harness.until(lambda: (picture / "pid").exists() and (picture / "pid").read_text(), 60)
            begin = time.monotonic()
            process.send_signal(number)
            _, said = process.communicate(timeout=60)
            print(f"\n  ended {time.monotonic() - begin:.2f} s after signal {number}: {said}")
            self.assertEqual(process.returncode, 130, said)
            self.assertLess(time.monotonic() - begin, 1 * options.slack)
            self.assertFalse(harness.alive(int(drawing)))
            (picture / "pid").unlink()
            self.assertEqual(list(picture.iterdir()), [])

    def test_preview_refuses(self):
        scene = harness.SCENES / "pendulum.json"
        self.assertRegex(self.say("preview", scene, "-o", "scene.json", expect=2), "'scene.json' is no name for a picture .*[.]png")
        (self.folder / "photo.png").write_bytes(PNG + b"mine")
        self.assertRegex(self.say("preview", scene, "-o", "photo.png", expect=2), "photo.png: is there, and is not a picture or film of tandem")
        self.assertEqual((self.folder / "photo.png").read_bytes(), PNG + b"mine")
        self.assertRegex(self.say("preview", scene, path="/nowhere", expect=5), "povray is not there: apt-get install povray")

    def frames_of(self, film, width, height):
        raw = subprocess.run(["ffmpeg", "-v", "error", "-i", film, "-f", "rawvideo", "-pix_fmt", "gray", "-"], capture_output=True, check=True).stdout
        self.assertEqual(len(raw) % (width * height), 0)
        return [raw[i:i + width * height] for i in range(0, len(raw), width * height)]

    def test_movie_has_every_frame_and_moves(self):
        out = self.run_with_frames()
        said = self.say("movie", out, "--size", "320x180", "--colour-by", "radius")
        self.assertRegex(said, r"movie.mp4: 3 frames from t = 0 s to 0.05 s in 0.12 s of film")
        self.assertFalse((out / "movie_frames").exists())
        first, _, last = self.frames_of(out / "movie.mp4", 320, 180)
        changed = sum(abs(a - b) > 20 for a, b in zip(first, last)) / len(first)
        # Box and spheres fall by some 12 and 22 mm, a twentieth of the picture: the camera does not follow them.
        self.assertGreater(changed, 0.005)
        self.assertLess(changed, 0.5)
        before = (out / "movie.mp4").read_bytes()
        (self.folder / "box.json").unlink()  # the run's folder has a copy
        out = out.rename(self.folder / "moved")
        (self.folder / "again.mp4").write_bytes(before)  # an earlier film is replaced
        self.say("movie", out, "--size", "320x180", "--colour-by", "radius", "--output", "again.mp4")
        self.assertEqual((self.folder / "again.mp4").read_bytes(), before)

    def test_fields_of_spheres_are_in_frames(self):
        fields = ["group", "material", "contact_count", "mean_stress"]
        out = self.run_with_frames(0.1, fields=fields)
        with_fields = self.summary()["state_hash"]
        script = "import h5py, json, sys; frames = h5py.File(sys.argv[1]); " \
                 "print(json.dumps([{name: data[()].tolist() for name, data in frame.items() if data.ndim == 1} for frame in frames.values()]))"
        # The system's own Python has h5py (launch/packages.txt).
        said = subprocess.run(["/usr/bin/python3", "-c", script, out / "particles.h5"], capture_output=True, text=True, check=True).stdout
        frames = json.loads(said)
        self.assertEqual(len(frames), 3)
        for frame in frames:
            self.assertEqual([len(frame[field]) for field in fields], [64] * 4)
            self.assertEqual(set(frame["group"]) | set(frame["material"]), {0})
            self.assertTrue(all((count > 0) == (stress != 0) for count, stress in zip(frame["contact_count"], frame["mean_stress"])))
        self.assertEqual(sum(frames[0]["contact_count"]), 0, "the spheres start apart")
        self.assertGreater(sum(frames[2]["contact_count"]), 0)
        index = (out / "particles.xdmf").read_text()
        for field in fields:
            self.assertEqual(index.count(f'Name="{field}"'), 3, field)
        self.assertRegex(self.say("movie", out, "--size", "160x90", "--colour-by", "group"), "3 frames")
        self.run_with_frames(0.1)
        self.assertEqual(self.summary()["state_hash"], with_fields)
        self.assertRegex(self.say("movie", out, "--colour-by", "group", expect=2), "the frames of this run have no 'group' .*fields")

    def test_fields_of_walls_add_up_to_the_load(self):
        out = self.run_with_frames(0.1, wall_fields=["inside"], contacts=["box"], dissipation=True)
        summary = self.summary()
        with_fields = summary["state_hash"]
        self.assertGreater(summary["dem_dissipated_J"]["normal_damping"], 0)
        script = "import h5py, json, sys; " \
                 "frames = [[{name: data[()].tolist() for name, data in frame.items() if hasattr(data, 'shape')} for key, frame in " \
                 "h5py.File(name).items() if key.startswith('frame')] for name in sys.argv[1:]]; print(json.dumps(frames))"
        said = subprocess.run(["/usr/bin/python3", "-c", script, out / "bodies.h5", out / "contacts.h5"], capture_output=True, text=True,
                              check=True).stdout
        bodies, contacts = json.loads(said)
        self.assertEqual([len(bodies), len(contacts)], [3, 3])
        with open(out / "bodies.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 100)
        for number, frame in enumerate(bodies[1:]):
            self.assertEqual([len(frame["box.pressure"]), len(frame["box.shear_stress"]), len(frame["box.friction_work"])], [10] * 3)
            for axis, name in enumerate("xyz"):
                load = sum(float(row[f"box.contact_force.{name}"]) for row in rows[50 * number:50 * number + 50]) / 50
                self.assertAlmostEqual(sum(force[axis] for force in frame["box.force"]), load, delta=1e-7 * (1 + abs(load)))
            self.assertNotIn("box.wear_depth", frame, "the material has no hardness")
        self.assertEqual(len(contacts[0]["sphere"]), 0, "the spheres start apart")
        self.assertGreater(len(contacts[2]["sphere"]), 0)
        self.assertEqual(set(contacts[2]["body"]), {0})
        self.assertLess(sum(force[2] for force in contacts[2]["force"]), 0)
        self.assertEqual((out / "bodies.xdmf").read_text().count('Name="pressure" AttributeType="Scalar" Center="Cell"'), 3)
        self.run_with_frames(0.1)
        self.assertEqual(self.summary()["state_hash"], with_fields)
        self.assertFalse((out / "contacts.xdmf").exists(), "of the run before")

    def test_movie_refuses(self):
        self.assertRegex(self.say("movie", self.folder, expect=2), "holds no run")
        out = self.run_with_frames()
        self.assertRegex(self.say("movie", out, "--size", "321x180", expect=2), "'321x180' is no size of a film .*1280x720")
        self.assertRegex(self.say("movie", out, "--fps", "0", expect=2), "--fps")
        self.assertRegex(self.say("movie", out, "--colour-by", "mood", expect=2), "spheres have no 'mood' .*speed, radius, spin")
        self.assertRegex(self.say("movie", out, "-o", "box.json", expect=2), "'box.json' is no name for a film .*[.]mp4")
        (self.folder / "film.mp4").write_text("mine")
        self.assertRegex(self.say("movie", out, "-o", "film.mp4", expect=2), "film.mp4: is there, and is not a picture or film of tandem")
        self.assertEqual((self.folder / "film.mp4").read_text(), "mine")
        self.assertRegex(self.say("movie", out, "--scene", harness.SCENES / "pendulum.json", expect=2), "the run is of the scene '.*', and this is 'pendulum'")
        only_povray = self.folder / "bin"
        only_povray.mkdir()
        (only_povray / "povray").symlink_to("/usr/bin/povray")
        self.assertRegex(self.say("movie", out, path=str(only_povray), expect=5), "the program ffmpeg is not there .*apt-get install ffmpeg")
        (out / "movie_frames").symlink_to(self.folder)
        self.assertRegex(self.say("movie", out, expect=2), "movie_frames: is a link")
        (out / "movie_frames").unlink()
        (self.folder / "box.json").rename(self.folder / "moved.json")
        (out / "scene" / "scene.json").unlink()
        self.assertRegex(self.say("movie", out, expect=2), "the scene of this run is not at '.*box.json' any more .*--scene FILE")
        self.assertEqual([path for path in out.iterdir() if "movie" in path.name], [])


if __name__ == "__main__":
    harness.main()
