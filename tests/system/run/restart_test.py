#!/usr/bin/env python3
"""Restart files: a run that continues from them ends with the bits of one that never stopped; wrong ones are refused."""
import json
import os
import pathlib
import shutil
import signal
import subprocess

import harness
from harness import SCENES, Case, until

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "launch" / "scenes"
# Loops, stops, error control; bodies in contact by time stepping; a light body; every way to exchange loads.
SOME = [("mbd/squeezer", []), ("mbd/stops", []), ("mbd/governor", []), ("parcels/parcels_preview", []),
        ("chain/chain_preview", []), ("stiff/light_plate", [])] + [
    ("stiff/hydraulic_bucket", ["--scheme", scheme])
    for scheme in ["parallel", "mbd_first", "dem_first", "linear_implicit", "implicit"]]
ADAPTIVE = {"scheme": "implicit", "window": 5e-4, "iteration": {"method": "iqn_ils"},
            "adaptive": {"energy_tolerance": 1e-2, "path_tolerance": 1e-5, "min_window": 1e-5, "max_window": 1e-3}}


class Restart(Case):
    def checkpoints(self, out=None):
        return sorted((out or self.out).glob("checkpoint/*/run.h5"))

    def scene(self, **changes):
        """A copy of hanging_box.json with other values of its first-level keys."""
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        scene.pop("checks")
        for key, value in changes.items():
            scene[key].update(value) if isinstance(value, dict) else scene.update({key: value})
        path = self.folder / "scene.json"
        path.write_text(json.dumps(scene))
        return path

    def hash_of(self, scene, *arguments, out):
        self.run_scene(scene, *arguments, out=self.folder / out)
        summary = self.summary(self.folder / out)
        self.assertIn(summary["status"], ("ok", "suspect"))  # some shipped scenes show what a bad scheme does
        return summary["state_hash"]

    def check_goes_on(self, scene, process_ending, limit):
        """A run is ended by a signal; it goes on to the bits and rows of one that was not."""
        process = self.start(scene, "--end-time", "1000", "--checkpoint-every", "0.004", "--threads", "1")
        self.assertTrue(until(lambda: self.checkpoints() and self.windows() > 120, 40 * harness.options.slack))
        process.send_signal(process_ending)
        self.finish(process, limit)
        self.assertEqual(len(self.checkpoints()), 1, "the newest one stays")
        lines = (self.out / "windows.csv").read_text().splitlines()
        self.assertGreater(int(lines[-1].split(",")[3]), 10, "balls touch")
        end = f"{float(lines[-1].split(',')[1]) + 0.02:.3f}"
        whole = self.hash_of(scene, "--end-time", end, "--threads", "1", out="whole")
        for threads in ["1", "2"]:
            out = f"continued{threads}"
            again = self.hash_of(scene, "--end-time", end, "--threads", threads, "--restart", self.out, out=out)
            self.assertEqual(again, whole, f"{threads} threads")
            for name in ["bodies.csv", "joints.csv", "elements.csv"]:
                self.assertEqual((self.folder / out / name).read_text(), (self.folder / "whole" / name).read_text())
            ours, theirs = self.summary(self.folder / out), self.summary(self.folder / "whole")
            for key in ["windows", "micro_steps", "energy_residual", "impulse_closure", "momentum_balance",
                        "max_overlap_ratio", "windows_rejected", "iterations_per_window", "border", "energy_drift"]:
                self.assertEqual(ours.get(key), theirs.get(key), key)
        print(f"\n  {pathlib.Path(scene).name}: {again} after {ours['restarted_at_s']:.4f} s and at {end} s")

    def test_after_an_interrupt(self):
        self.check_goes_on(self.scene(), signal.SIGINT, 5)

    def test_after_a_kill(self):
        self.check_goes_on(self.scene(coupling={"scheme": "parallel"}), signal.SIGKILL, 5)

    def test_an_interrupt_at_any_moment_leaves_the_last_window(self):
        """Also one that comes while results are being written: the checkpoint is that of the last window."""
        for begun in [-1, 0, 3, 20, 40]:
            shutil.rmtree(self.out, ignore_errors=True)
            process = self.start("hanging_box.json", "--end-time", "1000", "--checkpoint-every", "500", "--threads", "1")
            self.assertTrue(until(lambda: self.windows() >= begun and (self.out / "windows.csv").exists(),
                                  20 * harness.options.slack))
            process.send_signal(signal.SIGINT)
            self.finish(process, 5)
            if self.windows() > 0:
                self.assertEqual([file.parent.name for file in self.checkpoints()], [f"window_{self.windows():06}"])

    def test_with_windows_that_follow_the_error(self):
        self.check_goes_on(self.scene(coupling=ADAPTIVE), signal.SIGINT, 5)

    def test_a_run_is_made_longer(self):
        whole = self.hash_of("falling_balls.json", "--end-time", "0.04", out="whole")
        self.hash_of("falling_balls.json", "--end-time", "0.02", "--checkpoint-every", "1", out="half")
        again = self.hash_of("falling_balls.json", "--end-time", "0.04", "--restart", self.folder / "half", out="again")
        self.assertEqual(again, whole)
        pendulum = self.hash_of("pendulum.json", "--end-time", "0.04", out="pendulum")
        self.hash_of("pendulum.json", "--end-time", "0.02", "--checkpoint-every", "0.005", out="half_pendulum")
        self.assertEqual(self.hash_of("pendulum.json", "--end-time", "0.04", "--restart",
                                      self.folder / "half_pendulum", out="again_pendulum"), pendulum)

    def test_shipped_scenes(self):
        for name, options in SOME:
            with self.subTest(name, options=options):
                scene = SHIPPED / f"{name}.json"
                window = json.loads(scene.read_text())["coupling"]["window"]
                end, half = ([*options, "--end-time", f"{windows * window:.9f}"] for windows in (60, 30))
                whole = self.hash_of(scene, *end, out="whole")
                self.hash_of(scene, *half, "--checkpoint-every", "1", out="half")
                self.assertEqual(self.hash_of(scene, *end, "--restart", self.folder / "half", out="again"), whole)

    def test_checkpoints_change_nothing(self):
        self.assertEqual(self.hash_of("hanging_box.json", out="without"),
                         self.hash_of("hanging_box.json", "--checkpoint-every", "0.0031", out="with"))


class ForgetfulServer(Case):
    def test_a_body_that_is_elsewhere_after_resume_is_named(self):
        """Issue 34: a participant that only pretends to resume."""
        programs = self.folder / "programs"
        programs.mkdir()
        shutil.copy2(harness.options.bin / "tandem", programs)  # it starts the servers that are next to it
        for server, folder in (("mbd_server", harness.options.faulty), ("dem_server", harness.options.bin)):
            (programs / server).symlink_to(folder / server)
        for fault, status in ((0, "ok"), (0.01, "suspect")):
            first, again = self.folder / f"first{fault}", self.folder / f"again{fault}"
            run = [programs / "tandem", "run", SCENES / "hanging_box.json", "--quiet", "--no-picture", "--no-report", "--end-time"]
            environment = os.environ | {"TANDEM_FAULT": json.dumps({"resume": fault})}
            subprocess.run([*run, "0.005", "--out", first, "--checkpoint-every", "1"], env=environment, check=False)
            subprocess.run([*run, "0.008", "--out", again, "--restart", first], env=environment, check=False)
            self.assertEqual(self.summary(first)["verdict"]["status"], "ok")
            verdict = self.summary(again)["verdict"]
            self.assertEqual(verdict["status"], status, verdict)
            lines = {line["rule"]: line["sentence"] for line in verdict["lines"]}
            if fault:
                self.assertIn("body 'box' jumps between windows: at t = 0.005 s it begins 0.01 m", lines["motion_chain"])
                self.assertIn("at t = 0.005 s by 0.01 m", lines["body_frames"])


class RestartRefusals(Case):
    def setUp(self):
        super().setUp()
        self.run_scene("hanging_box.json", "--end-time", "0.005", "--checkpoint-every", "1", out=self.folder / "first")
        [self.checkpoint] = (self.folder / "first" / "checkpoint").iterdir()

    def refusal(self, scene, *arguments, expect=2):
        said = self.run_scene(scene, "--restart", self.folder / "first", *arguments, expect=expect)
        print("\n  " + [line for line in said.splitlines() if "error" in line][0])
        return said

    def test_another_scene(self):
        said = self.refusal("hanging_box.json", "--window", "5e-4")
        self.assertIn("is of another scene: coupling.window is 0.001 there, and 0.0005 here", said)
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        for place in (0, 1):
            scene["mbd"]["bodies"].insert(place, {"name": "lid", "mass": 1, "inertia": [1, 1, 1], "position": [3, 0, 0]})
            (self.folder / "added.json").write_text(json.dumps(scene))
            self.assertIn("is of another scene: mbd.bodies has 'lid' here, and not there",
                          self.refusal(self.folder / "added.json"))
            scene["mbd"]["bodies"].pop(place)
        scene["dem"]["materials"][0]["young"] = 2e7
        (self.folder / "other.json").write_text(json.dumps(scene))
        self.assertIn("dem.materials[0].young", self.refusal(self.folder / "other.json"))

    def test_other_sums_since_the_start(self):
        """The sums of the particle solver belong to the walls, and the outputs, of the run that was saved."""
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        other = self.folder / "other.json"
        for output, difference in [({"wall_fields": ["inside"]}, "output.wall_fields"), ({"dissipation": True}, "output.dissipation")]:
            scene["output"] = output
            other.write_text(json.dumps(scene))
            self.assertRegex(self.refusal(other), f"is of another scene: {difference}.* here")
        scene["output"] = {"fields": ["group"], "contacts": ["box"]}  # of the instants of frames
        other.write_text(json.dumps(scene))
        self.run_scene(other, "--restart", self.folder / "first", "--end-time", "0.01", out=self.folder / "on")

    def test_nothing_left_to_do(self):
        self.assertIn("give a later --end-time", self.refusal("hanging_box.json", "--end-time", "0.005"))

    def test_a_damaged_file(self):
        for name in ["dem.h5", "mbd.h5", "run.h5"]:
            with self.subTest(name):
                file = self.checkpoint / name
                whole = file.read_bytes()
                file.write_bytes(whole[: len(whole) // 2])
                self.assertIn(name, self.refusal("hanging_box.json", expect=5))
                file.unlink()
                self.assertIn("holds no complete checkpoint" if name == "run.h5" else "does not exist",
                              self.refusal("hanging_box.json", expect=2 if name == "run.h5" else 5))
                file.write_bytes(whole)

    def test_rows_that_are_not_those_of_the_run(self):
        rows = self.folder / "first" / "bodies.csv"
        whole = rows.read_bytes()
        for text, said in [(whole.replace(b"box", b"fox"), "bodies.csv: was changed since the checkpoint was written"),
                           (whole[:-1], "bodies.csv: is not there, or shorter than when the checkpoint was written")]:
            rows.write_bytes(text)
            self.assertIn(said, self.refusal("hanging_box.json", expect=5))
        rows.unlink()
        self.assertIn("lacks the rows of its run", self.refusal("hanging_box.json"))
        # A checkpoint elsewhere takes its rows along.
        elsewhere = self.folder / "elsewhere"
        shutil.copytree(self.checkpoint, elsewhere)
        (elsewhere / "bodies.csv").write_bytes(whole + b"a row that came later, and is not part of the checkpoint")
        for name in ["joints.csv", "elements.csv"]:
            shutil.copy(self.folder / "first" / name, elsewhere)
        self.run_scene("hanging_box.json", "--restart", elsewhere)
        self.assertTrue((self.out / "bodies.csv").read_bytes().startswith(whole))
        self.assertEqual((self.out / "bodies.csv").read_bytes().count(b"\n"), 51)

    def test_files_of_two_checkpoints(self):
        other = self.folder / "other"
        self.run_scene("hanging_box.json", "--end-time", "0.004", "--checkpoint-every", "1", out=other)
        for name in ["dem.h5", "mbd.h5"]:
            with self.subTest(name):
                whole = (self.checkpoint / name).read_bytes()
                shutil.copy(next((other / "checkpoint").iterdir()) / name, self.checkpoint / name)
                self.assertIn(f"{name}: is not the file that ", self.refusal("hanging_box.json", expect=5))
                (self.checkpoint / name).write_bytes(whole)

    def test_files_of_another_run_of_the_same_time(self):
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        scene["gravity"] = [0, 0, -9.8]
        (self.folder / "lighter.json").write_text(json.dumps(scene))
        other = self.folder / "lighter"
        self.run_scene(self.folder / "lighter.json", "--end-time", "0.005", "--checkpoint-every", "1", out=other)
        shutil.copy(next((other / "checkpoint").iterdir()) / "dem.h5", self.checkpoint / "dem.h5")
        self.assertIn("dem.h5: is not the file that ", self.refusal("hanging_box.json", expect=5))

    def test_the_folder_that_would_be_emptied(self):
        said = self.run_scene("hanging_box.json", "--restart", self.folder / "first", out=self.folder / "first", expect=2)
        self.assertIn("give another --out", said)
        self.assertTrue((self.checkpoint / "run.h5").exists())

    def test_times_that_the_border_cannot_count(self):
        for time in ["1e-10", "9.3e9", "inf", "nan"]:
            said = self.run_scene("hanging_box.json", "--checkpoint-every", time, expect=2)
            self.assertIn("--checkpoint-every", said)

    def test_a_folder_without_restart_files(self):
        said = self.run_scene("hanging_box.json", "--restart", self.folder, expect=2)
        self.assertIn("holds no complete checkpoint", said)


if __name__ == "__main__":
    harness.main()
