#!/usr/bin/env python3
"""Participants of protocol 1.3 with the programs of today: one that is written down in participant_of_1_3.py, and, where the
environment's TANDEM_OLD_BIN names the folder of a build of that time, its own servers."""
import json
import os
import pathlib
import subprocess
import sys

import harness
from harness import SCENES, Case, options

OLD = f"{sys.executable} {pathlib.Path(__file__).resolve().parent}/participant_of_1_3.py"
SCHEMES = "parallel", "mbd_first", "dem_first", "linear_implicit", "implicit"


class OldCase(Case):
    def falling_box(self):
        """The box without its spring, which the participant does not know: box and balls fall together."""
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        del scene["mbd"]["joints"], scene["mbd"]["forces"]
        path = self.folder / "falling_box.json"
        path.write_text(json.dumps(scene))
        return path

    def last_height(self):
        lines = (self.out / "bodies.csv").read_text().splitlines()
        return float(lines[-1].split(",")[lines[0].split(",").index("box.position.z")])


class OldParticipant(OldCase):
    def test_it_runs_with_each_scheme(self):
        scene = self.falling_box()
        for scheme in SCHEMES:
            with self.subTest(scheme):
                self.run_scene(scene, "--scheme", scheme)
                ours = self.last_height()
                said = self.run_scene(scene, "--scheme", scheme, "--mbd-server", OLD)
                self.assertIn("old_bodies 1.3", said)
                self.assertAlmostEqual(self.last_height(), ours, delta=1e-5)
                self.assertTrue(all(check["passed"] for check in self.summary()["checks"]), said)

    def test_what_it_cannot_do_is_refused_by_name(self):
        scene = self.falling_box()
        said = self.run_scene(scene, "--mbd-server", OLD, "--checkpoint-every", "0.01", expect=2)
        self.assertRegex(said, r"--checkpoint-every needs restart files .*old_bodies 1\.3")

    def test_it_is_judged_in_its_dialect(self):
        judged = subprocess.run([options.bin / "tandem", "conform", OLD, "--role", "mbd", "--answer-limit", str(options.slack)],
                                capture_output=True, text=True, timeout=120 * options.slack, check=False)
        for check in "hello", "finish", "free_fall", "force_impulse", "predict_state", "motion_rollback":
            self.assertRegex(judged.stdout, rf"(?m)^PASS +{check} ")


class OldServers(OldCase):
    def setUp(self):
        super().setUp()
        if not os.environ.get("TANDEM_OLD_BIN"):
            self.skipTest("TANDEM_OLD_BIN names no folder with servers of protocol 1.3")
        self.old = pathlib.Path(os.environ["TANDEM_OLD_BIN"])

    def test_they_run_with_each_scheme(self):
        for role in "mbd", "dem":
            server = self.old / f"{role}_server"
            if not server.exists():
                print(f"there is no {server}")
                continue
            for scheme in SCHEMES:
                with self.subTest(f"{role} {scheme}"):
                    self.run_scene("hanging_box.json", "--scheme", scheme, f"--{role}-server", str(server))
                    self.assertTrue(all(check["passed"] for check in self.summary()["checks"]))

    def test_an_option_that_they_do_not_know_is_named(self):
        said = self.run_scene("hanging_box.json", "--mbd-server", str(self.old / "mbd_server"), "--checkpoint-every", "0.01", expect=4)
        self.assertRegex(said, r"mbd_server '.*' \(pid \d+\) exited with status 2 .*its last line in run.log: .*--state-folder")


if __name__ == "__main__":
    harness.main()
