#!/usr/bin/env python3
"""The verdict of whole runs: inside a limit and outside it, and what the value to use instead is worth."""
import json
import re
import signal

import harness
from harness import Case


class Verdict(Case):
    def scene(self, name, change):
        scene = json.loads((harness.SCENES / name).read_text())
        change(scene)
        path = self.folder / name
        path.write_text(json.dumps(scene))
        return path

    def judged(self, path, *arguments, expect=0):
        """Summary of the run, and what it said."""
        said = self.run_scene(path, *arguments, expect=expect)
        return self.summary(), said

    def lines(self, summary):
        return {line["rule"]: line for line in summary["verdict"]["lines"]}

    def test_a_good_run_is_ok_and_says_what_was_judged(self):
        summary, _ = self.judged("hanging_box.json", "--strict")
        self.assertEqual((summary["status"], summary["verdict"]["status"]), ("ok", "ok"))
        self.assertEqual(summary["verdict"]["lines"], [])
        for rule in ["impulse_closure", "energy_coupling", "overlap", "lost", "momentum", "critical_step"]:
            self.assertIn(rule, summary["verdict"]["judged"])

    def test_the_modulus_to_use_brings_the_overlap_below_the_limit(self):
        def soft(scene, young=1e6):
            scene["dem"]["materials"][0]["young"] = young
            scene["dem"]["particles"][0]["velocity"] = [0, 0, -2]
        summary, said = self.judged(self.scene("falling_balls.json", soft))
        line = self.lines(summary)["overlap"]
        self.assertEqual(summary["status"], "suspect")
        self.assertGreater(line["value"], line["limit"])
        self.assertRegex(said, r"falling_balls: SUSPECT\n  SUSPECT +the largest overlap")
        self.assertIn("suspect: " + line["sentence"], self.log())
        young = float(re.search(r"young = (\S+) Pa", line["sentence"]).group(1))
        summary, _ = self.judged(self.scene("falling_balls.json", lambda scene: soft(scene, young)))
        print(f"\n  overlap {line['value']:.3f} -> {summary['max_overlap_ratio']:.3f} with {young:.2g} Pa (limit 0.05)")
        self.assertEqual(summary["status"], "ok")
        self.assertGreater(summary["max_overlap_ratio"], 0.03, "and not stiffer than needed")

    def test_a_stiff_rope_at_a_long_step(self):
        """A bead on a rope: the angle of the end is 0.6 rad wrong with a step that does not resolve the rope's pulls."""
        def bead(step, stiffness):
            slide = {"type": "prismatic", "position": [0.9, 0, -0.4], "damping": 3}
            path = self.folder / "bead.json"
            path.write_text(json.dumps({
                "tandem": "1.1", "name": "bead", "end_time": 20, "coupling": {"window": step},
                "mbd": {"bodies": [{"name": name, "mass": 1, "inertia": [1, 1, 1], "position": [0.9, 0, -0.4]}
                                   for name in ("carrier", "bead")],
                        "joints": [{"name": "x", "child": "carrier", "axis": [1, 0, 0], **slide},
                                   {"name": "z", "parent": "carrier", "child": "bead", "axis": [0, 0, 1], **slide}],
                        "forces": [{"name": "rope", "type": "rope", "length": 1.8, "axial_stiffness": stiffness, "damping": 0.001,
                                    "points": [{"point": [0, 0, 0]}, {"body": "bead", "point": [0.9, 0, -0.4]},
                                               {"point": [1.2, 0, 0.3]}]}]}}))
            return self.judged(path)
        summary, said = bead(1e-3, 1e4)
        self.assertEqual(summary["status"], "ok", said)
        summary, said = bead(5e-3, 1e6)
        self.assertEqual(summary["status"], "suspect", said)
        self.assertIn("energy_mbd", self.lines(summary))
        self.assertRegex(said, r"use mbd\.integrator\.step = ")

    def test_lost_spheres(self):
        def bottomless(scene):
            scene["dem"]["walls"] = [dict(scene["dem"]["walls"][0], name="side",
                                          shape={"type": "plane", "point": [-1, 0, 0], "normal": [1, 0, 0]})]
            scene["dem"]["domain"]["min"][2] = 0
            scene["dem"]["particles"][0]["velocity"] = [0, 0, -2]
        path = self.scene("falling_balls.json", bottomless)
        summary, _ = self.judged(path)
        self.assertGreater(summary["lost_particles"], 0)
        self.assertEqual((summary["status"], summary["exit_status"]), ("suspect", 0))
        self.assertIn("dem.domain", self.lines(summary)["lost"]["sentence"])
        summary, _ = self.judged(path, "--strict", expect=1)
        self.assertEqual((summary["status"], summary["exit_status"]), ("suspect", 1))

    def test_a_wheel_that_falls_through_the_floor(self):
        def with_wheel(scene):
            scene["mbd"] = {"bodies": [{"name": "wheel", "mass": 1, "inertia": [1, 1, 1], "position": [0.5, 0.5, 0.21]},
                                       {"name": "load", "mass": 1, "inertia": [1, 1, 1], "position": [0.5, 0.5, 0.5]}]}
            scene["dem"]["walls"].append({"name": "tyre", "body": "wheel", "material": "glass",
                                          "shape": {"type": "sphere", "radius": 0.2}})
        path = self.scene("falling_balls.json", with_wheel)
        # It comes down by 0.01 m in 0.045 s, and the tyre may reach into the floor by 0.004 m.
        summary, _ = self.judged(path, "--end-time", "0.045")
        self.assertEqual(summary["status"], "ok")
        self.assertIn("body_contact", summary["verdict"]["judged"])
        self.assertRegex(summary["verdict"]["not_judged"][0], r"1 body without walls \('load'\)")
        summary, _ = self.judged(path, "--end-time", "0.1")
        line = self.lines(summary)["body_contact"]
        self.assertRegex(line["sentence"], r"wall 'tyre' of 'wheel' and wall 'floor' of 'ground'.*limits")
        print(f"\n  seen at {summary['wall_crossings'][0]['time_s']} s, depth {summary['wall_crossings'][0]['depth_m']:.4f} m")
        self.assertAlmostEqual(summary["wall_crossings"][0]["depth_m"], 9.81 / 2 * 0.1 ** 2 - 0.01, delta=0.005)

    def test_a_window_that_contacts_do_not_bear(self):
        summary, _ = self.judged(harness.SCENES.parents[2] / "launch/scenes/stiff/window_too_large.json")
        self.assertEqual(summary["status"], "suspect")
        line = self.lines(summary)["window_stability"]
        self.assertRegex(line["sentence"], r"body 'box'.*use coupling.window = \S+ s .*coupling.scheme = \"linear_implicit\"")

    def test_a_run_that_goes_on_and_one_that_died(self):
        process, _ = self.start_long_run()
        summary = self.summary()
        self.assertEqual((summary["status"], summary["process"]["pid"]), ("running", process.pid))
        said = self.run_scene("pendulum.json", expect=2)
        self.assertRegex(said, "a run is still in progress in this folder")
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.assertEqual(self.summary()["status"], "running", "nobody was left to write another word")
        self.run_scene("pendulum.json")
        self.assertRegex(self.log(), "the earlier run in .* died")
        self.assertEqual(self.summary()["status"], "ok")


if __name__ == "__main__":
    harness.main()
