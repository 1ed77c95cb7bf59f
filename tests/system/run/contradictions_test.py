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
        shutil.rmtree(self.out, ignore_errors=True)
        said = subprocess.run([options.bin / "tandem", "run", SCENES / scene, "--out", self.out, "--quiet", "--no-picture", "--no-report",
                               f"--{faulty}-server", options.faulty / f"{faulty}_server"],
                              env=os.environ | {"TANDEM_FAULT": json.dumps(fault)}, capture_output=True, text=True,
                              timeout=60 * options.slack, check=False)
        self.assertEqual(said.returncode, expect, said.stdout + said.stderr)
        return said.stdout + said.stderr

    def lines_of_flap(self, fault):
        """The rules that a run of a hinged flap with this fault violates, with their sentences."""
        scene = json.loads((SCENES / "rules.json").read_text())["scenes"]["flap"]
        (self.folder / "flap.json").write_text(json.dumps(scene))
        self.run_with("mbd", fault, self.folder / "flap.json")
        return {line["rule"]: line["sentence"] for line in self.summary()["verdict"]["lines"]}

    def test_a_joint_that_is_left_out_is_named(self):
        lines = self.lines_of_flap({"no_joints": 1})
        self.assertRegex(lines["joints"], "joint 'hinge' is violated: in the results at t = 0.1 s its two sides are .* m apart")

    def test_a_body_that_never_turns_is_named(self):
        lines = self.lines_of_flap({"frozen": 1})
        self.assertRegex(lines["body_path"], "the orientation of body 'flap' does not follow from its velocity")
        self.assertRegex(lines["joints"], "joint 'hinge' .* the coordinate that the frame gives for it is .* rad off that of the bodies")

    def test_impossible_facts_are_refused(self):
        for fact, value, sentence in (("mbd_energy_scale_J", -1, 'the fact "mbd_energy_scale_J" is -1, not a number from 0 on'),
                                      ("mbd_steps", 0, 'of which it is a part, 0')):
            said = self.run_with("mbd", {"report": {fact: value, "mbd_shortened_steps": 5}}, expect=4)
            self.assertIn(sentence, said)

    def test_a_load_on_a_ground_without_walls_is_refused(self):
        self.assertIn("the ground has a load, and the scene no wall of the ground", self.run_with("dem", {"on_ground": 1}, expect=4))

    def test_a_body_that_starts_elsewhere_is_refused(self):
        said = self.run_with("mbd", {"start": 0.001}, expect=4)
        self.assertIn("mbd_server: body 'box' starts with the position (0, 0, 0.001) m, and the scene gives it (0, 0, 0) m", said)
        self.assertIn("tandem conform --role mbd --check start_state", said)

    def test_particles_that_start_elsewhere_are_refused(self):
        said = self.run_with("dem", {"start": 0.05}, expect=4)
        self.assertRegex(said, r"dem_server: sphere 0 of 'balls' starts at \(.*\) m, and the scene has it at \(.*\) m")
        said = self.run_with("dem", {"gravity": 0.01}, expect=4)
        self.assertRegex(said, r"gravity gives the particles .* N s in the first window .* by the spheres of the scene, whose mass is")

    def test_impossible_accounts_are_refused(self):
        for fault, sentence in (({"energy": 10}, r"account: kinetic_energy is -\S+ J, less than 0"),
                                ({"lost": 65}, "the account has 65 lost particles, and the scene 64 spheres")):
            self.assertRegex(self.run_with("dem", fault, expect=4), sentence)

    def test_a_false_critical_time_switches_no_rule_off(self):
        self.run_with("dem", {"coarse": 3, "report": {"critical_time_s": 1e9, "micro_step_s": 1e-12}})
        self.assertEqual([line["rule"] for line in self.summary()["verdict"]["lines"]], ["critical_step"])

    def test_exchanged_ids_are_named(self):
        self.run_with("dem", {"exchanged": 1})
        (line,) = self.summary()["verdict"]["lines"]
        self.assertEqual((line["rule"], line["of"]), ("particle_frames", "path"))
        self.assertRegex(line["sentence"], r"its spheres have moved by \S+ m, and by at most \S+ m with the kinetic energy of the account")


if __name__ == "__main__":
    harness.main()
