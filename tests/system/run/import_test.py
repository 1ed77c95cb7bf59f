#!/usr/bin/env python3
"""`tandem import`: an imported model runs, and moves as the same model written by hand."""
import csv
import json
import math
import os
import subprocess

import harness
from harness import Case, options


class Import(Case):
    def say(self, *arguments, expect=0):
        result = subprocess.run([options.bin / "tandem", "import", *arguments], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        return result.stdout, result.stderr

    def last_row(self, out):
        with open(out / "bodies.csv", newline="") as bodies, open(out / "joints.csv", newline="") as joints:
            return {**list(csv.DictReader(bodies))[-1], **list(csv.DictReader(joints))[-1]}

    def test_two_links_move_as_those_written_by_hand(self):
        scene = self.folder / "imported.json"
        self.say(harness.SCENES / "two_links.urdf", "-o", scene)
        self.run_scene(scene, out=self.folder / "imported")
        self.run_scene("two_links.json", out=self.folder / "by_hand")
        imported, by_hand = self.last_row(self.folder / "imported"), self.last_row(self.folder / "by_hand")
        worst = 0
        for body in ["upper", "lower"]:
            for name in ["position", "velocity", "angular_velocity"]:
                for axis in "xyz":
                    column = f"{body}.{name}.{axis}"
                    worst = max(worst, abs(float(imported[column]) - float(by_hand[column])))
        for column in ["shoulder.q", "hinge.q", "shoulder.reaction_force.z", "hinge.reaction_torque.x"]:
            worst = max(worst, abs(float(imported[column]) - float(by_hand[column])))
        print(f"\n  turned by {float(by_hand['shoulder.q']):.3f} and {float(by_hand['hinge.q']):.3f} rad; "
              f"largest difference {worst:.1e} (limit 1e-9)")
        self.assertGreater(abs(float(by_hand["hinge.q"])), 0.5)
        self.assertLess(worst, 1e-9)

    def test_slider_crank_of_a_step_file_turns(self):
        if not (options.bin / "tandem_step").exists():
            self.skipTest("this build reads no STEP files: OpenCASCADE was not found")
        # The commands of docs/cad_import.md, word for word.
        source = harness.SCENES.parents[2]
        page = (source / "docs" / "cad_import.md").read_text()
        commands = [line[4:] for line in page[page.index("## 1."):page.index("## Options")].splitlines() if line.startswith("    ")]
        (self.folder / "tests").symlink_to(source / "tests")
        said = subprocess.run(["bash", "-euc", "\n".join(commands)], capture_output=True, text=True, timeout=120, cwd=self.folder,
                              env={**os.environ, "PATH": f"{options.bin.resolve()}:{os.environ['PATH']}"})
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        for words in ("8 parts of 7 shapes, 5 bodies", "proposed joints", "slider_crank: ok"):
            self.assertIn(words, said.stdout)
        described = subprocess.run([options.bin / "tandem", "describe", self.folder / "crank.json", "--files-only"], capture_output=True, text=True)
        self.assertIn("\nassemblies\n  slider_crank\n    - frame, 33.74", described.stdout)
        with open(self.folder / "crank" / "bodies.csv", newline="") as bodies:
            rows = list(csv.DictReader(bodies))
        # From 60 degrees the crank turns about y, from z to x, by 10 rad/s.
        slider = lambda angle: 0.05 * math.cos(angle) + math.sqrt(0.2**2 - (0.05 * math.sin(angle))**2)
        at = lambda row: slider(math.pi / 3 - 10 * float(row["time"]))
        moved = float(rows[-1]["slider.position.x"]) - float(rows[0]["slider.position.x"])
        expected = at(rows[-1]) - at(rows[0])
        print(f"\n  slider moved by {moved:.9f} m, expected {expected:.9f} (tolerance 1e-8)")
        self.assertAlmostEqual(moved, expected, delta=1e-8)

    def test_scene_goes_to_standard_output(self):
        scene, notes = self.say(harness.SCENES / "two_links.urdf")
        self.assertIn('"name": "two_links"', scene)
        self.assertEqual(notes, "")

    def test_a_file_that_is_there_is_replaced_when_asked_only(self):
        scene = self.folder / "scene.json"
        scene.write_text("mine")
        _, said = self.say(harness.SCENES / "two_links.urdf", "-o", scene, expect=2)
        self.assertIn("scene.json: is there: it would be overwritten (give another --output, or --replace)", said)
        self.assertEqual(scene.read_text(), "mine")
        self.say(harness.SCENES / "two_links.urdf", "-o", scene, "--replace")
        self.assertIn('"name": "two_links"', scene.read_text())

    def test_wrong_model_is_exit_status_2(self):
        path = self.folder / "wrong.urdf"
        path.write_text((harness.SCENES / "two_links.urdf").read_text().replace('mass value="2"', 'mass value="heavy"'))
        _, said = self.say(path, expect=2)
        self.assertIn("wrong.urdf: link 'upper': Inertial: mass [heavy] is not a float", said)


if __name__ == "__main__":
    harness.main()
