#!/usr/bin/env python3
"""Participants that contradict the scene or themselves (issue 34): a run refuses them, or its verdict names them."""
import json
import os
import shutil
import subprocess

import harness
from harness import SCENES, Case, options


class Contradictions(Case):
    def run_with(self, faulty, fault, scene="hanging_box.json", expect=0):
        """A run with one faulty server (tests/doubles); returns what it says."""
        programs = self.folder / f"faulty_{faulty}"
        if not programs.exists():
            programs.mkdir()
            shutil.copy2(options.bin / "tandem", programs)  # it starts the servers that are next to it
            for side in ("mbd", "dem"):
                (programs / f"{side}_server").symlink_to((options.faulty if side == faulty else options.bin) / f"{side}_server")
        shutil.rmtree(self.out, ignore_errors=True)
        said = subprocess.run([programs / "tandem", "run", SCENES / scene, "--out", self.out, "--quiet", "--no-picture", "--no-report"],
                              env=os.environ | {"TANDEM_FAULT": json.dumps(fault)}, capture_output=True, text=True,
                              timeout=60 * options.slack, check=False)
        self.assertEqual(said.returncode, expect, said.stdout + said.stderr)
        return said.stdout + said.stderr

    def test_a_body_that_starts_elsewhere_is_refused(self):
        said = self.run_with("mbd", {"start": 0.001}, expect=4)
        self.assertIn("mbd_server: body 'box' starts with the position (0, 0, 0.001) m, and the scene gives it (0, 0, 0) m", said)
        self.assertIn("tandem conform --role mbd --check start_state", said)


if __name__ == "__main__":
    harness.main()
