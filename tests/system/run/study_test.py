#!/usr/bin/env python3
"""`tandem study`: rows, order, resumption and the cheapest setting, on a pendulum of 0.2 s."""
import csv
import json
import os
import re
import signal
import subprocess

import harness
from harness import Case, options


class Study(Case):
    def setUp(self):
        super().setUp()
        self.file = self.folder / "study.json"
        self.study = {
            "study": "1.0", "name": "pendulum", "scene": str(harness.SCENES / "pendulum.json"),
            "set": [{"of": "window", "value": 0.05}],
            "sweep": [{"of": "rho_inf", "values": [0.5, 0.9]}, {"of": "mbd_step", "values": [0.01, 0.005, 0.0025]}],
            "order_in": "mbd_step",
            "reference": {"type": "run", "set": [{"of": "mbd_step", "value": 5e-5}], "every": 0.05},
            "measures": [{"name": "angle", "of": ["hinge.q"], "unit": "rad"},
                         {"name": "energy", "of": ["summary.mbd_energy_drift_J"]}]}

    def run_study(self, *arguments, expect=0):
        self.file.write_text(json.dumps(self.study))
        result = subprocess.run([options.bin / "tandem", "study", self.file, "--out", self.out, *arguments],
                                capture_output=True, text=True, timeout=120 * options.slack)
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def rows(self):
        with open(self.out / "results.csv", newline="") as lines:
            return list(csv.DictReader(lines))

    def test_rows_order_and_picture(self):
        said = self.run_study("--jobs", "2", "--want", "angle=1e-3")
        rows = self.rows()
        self.assertEqual([row["status"] for row in rows], ["ok"] * 6)
        orders = [float(order) for order in re.findall(r"order in mbd_step  rho_inf=0\.[59]: ([\d.]+),", said)][:2]
        print(f"\n  order in mbd_step: {orders} (expected 2 within 0.1)")
        for order in orders:
            self.assertAlmostEqual(order, 2, delta=0.1)
        self.assertRegex(said, r"cheapest with angle <= 0.001: error [\d.e-]+, [\d.e-]+ s: rho_inf=")
        self.assertTrue((self.out / "study.png").read_bytes().startswith(b"\x89PNG"))
        self.assertGreater(float(rows[0]["cpu_s"]), 0)

    def test_goes_on_where_it_stopped(self):
        self.study["sweep"][1]["values"] = [0.01, 0.005]
        self.out.mkdir()
        (self.out / "results.csv").write_text("mine")
        self.assertIn("results.csv: is there, and the folder has no tandem_study.json", self.run_study(expect=2))
        (self.out / "results.csv").rename(self.out / "mine.csv")
        self.assertIn("5 runs, 0 of them done before", self.run_study())
        before = self.rows()
        self.study["sweep"][1]["values"] = [0.01, 0.005, 0.0025]
        self.assertIn("7 runs, 5 of them done before", self.run_study())
        after = self.rows()
        self.assertTrue(any(row["front"] for row in after))
        after = [row for row in after if row["mbd_step"] != "0.0025"]
        for row in before + after:
            del row["front"]  # new runs may be better than those of before
        self.assertEqual(after, before)

    def test_repeated_timings_of_a_scene_with_a_parameter(self):
        scene = json.loads((harness.SCENES / "pendulum.json").read_text())
        scene.update(tandem="1.1", parameters={"weight": 1})
        scene["mbd"]["bodies"][0]["mass"] = "=weight"
        (self.folder / "pendulum.json").write_text(json.dumps(scene))
        self.study.update(scene="pendulum.json", repeat=3)
        self.study["sweep"] = [{"of": "mbd_step", "values": [0.01, 0.005]}]
        self.assertIn("7 runs, 0 of them done before", self.run_study("--jobs", "1", "--set", "weight=2", "--want", "angle=1"))
        for row in self.rows():
            self.assertLessEqual(float(row["cpu_low_s"]), float(row["cpu_s"]))
            self.assertLessEqual(float(row["cpu_s"]), float(row["cpu_high_s"]))
            self.assertEqual([(self.out / "runs" / f"{row['run']}{end}" / "summary.json").is_file() for end in ("", ".2", ".3", ".4")],
                             [True, True, True, False])
            self.assertEqual(json.loads((self.out / "scenes" / f"{row['run']}.json").read_text())["mbd"]["bodies"][0]["mass"], 2)
        plot = json.loads((self.out / "plot.json").read_text())
        self.assertEqual((plot["repeat"], plot["measures"][0]["want"]), (3, 1))
        self.assertIn("7 runs, 7 of them done before", self.run_study("--jobs", "1", "--set", "weight=2"))
        self.assertIn("weight", self.run_study("--set", "wieght=2", expect=2))

    def test_a_diverged_run_is_a_row(self):
        self.study["sweep"] = [{"of": "/mbd/integrator/max_iterations", "values": [20, 1]}]
        self.study.pop("order_in")
        self.study["set"].append({"of": "newton_tolerance", "value": 1e-14})
        said = self.run_study("--want", "angle=1e-12", expect=1)
        self.assertEqual([row["status"] for row in self.rows()], ["ok", "diverged"])
        self.assertIn("did not converge in 1 iterations", self.rows()[1]["problem"])
        self.assertIn("no setting has angle <= 1e-12; the best: error", said)

    def test_a_run_that_takes_too_long_is_a_row(self):
        self.study.update({"limit": 1, "reference": {"type": "table", "times": [1000],
                                                     "signals": [{"of": "hinge.q", "values": [0]}]}})
        self.study["set"] = [{"of": "end_time", "value": 1000}, {"of": "window", "value": 0.05}]
        self.study["sweep"] = [{"of": "mbd_step", "values": [1e-6]}]
        self.study.pop("order_in")
        self.run_study()
        self.assertEqual([row["status"] for row in self.rows()], ["timed_out"])
        self.assertEqual(self.rows()[0]["problem"], "stopped at the limit of 1 s")

    def test_a_suspect_run_is_a_marked_row_that_counts(self):
        scene = json.loads((harness.SCENES / "falling_balls.json").read_text())
        scene["dem"]["particles"][0]["velocity"] = [0, 0, -2]
        (self.folder / "balls.json").write_text(json.dumps(scene))
        self.study = {
            "study": "1.0", "name": "balls", "scene": "balls.json",
            "sweep": [{"of": "/dem/materials/0/young", "values": [1e6, 1e9]}],
            "measures": [{"name": "overlap", "of": ["summary.max_overlap_ratio"]}]}
        said = self.run_study("--want", "overlap=0.5")
        self.assertEqual([row["status"] for row in self.rows()], ["suspect", "ok"])
        self.assertRegex(self.rows()[0]["problem"], "the largest overlap is .* use young = ")
        self.assertRegex(said, r"\(suspect: the largest overlap is")
        self.assertTrue(self.rows()[0]["error_overlap"])

    def start_endless(self, runs):
        """A study whose runs would take hours; returns when all of them are in progress."""
        self.study.pop("order_in")
        self.study["set"] = [{"of": "end_time", "value": 1e5}, {"of": "window", "value": 0.05}]
        self.study["sweep"] = [{"of": "mbd_step", "values": [1e-6, 2e-6][:runs]}]
        self.study["reference"] = {"type": "table", "times": [1e5], "signals": [{"of": "hinge.q", "values": [0]}]}
        self.file.write_text(json.dumps(self.study))
        process = subprocess.Popen([options.bin / "tandem", "study", self.file, "--out", self.out, "--jobs", str(runs)],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(process.kill)
        begun = harness.until(lambda: len(list(self.out.glob("runs/*/bodies.csv"))) == runs, 60)
        self.assertTrue(begun)
        return process

    def pids(self):
        return [json.loads(path.read_text())["pid"] for path in self.out.glob("runs/*/tandem_run.json")]

    def check_runs_end(self, number):
        process = self.start_endless(2)
        process.send_signal(number)
        said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, said)
        self.assertIn("the study was interrupted", said)
        self.assertEqual([pid for pid in self.pids() if harness.alive(pid)], [])
        reasons = [json.loads(path.read_text())["reason"] for path in self.out.glob("runs/*/summary.json")]
        self.assertEqual(reasons, ["interrupted"] * 2)
        self.assertFalse((self.out / "results.csv").exists())

    def test_sigterm_to_it_alone_ends_its_runs(self):
        self.check_runs_end(signal.SIGTERM)

    def test_ctrl_c_to_it_alone_ends_its_runs(self):
        self.check_runs_end(signal.SIGINT)

    def test_runs_that_go_on_or_died_are_said(self):
        process = self.start_endless(1)
        first, = self.pids()
        said = self.run_study(expect=2)
        self.assertRegex(said, rf"a run of this study is still in progress: pid {first} on .*tandem stop ")
        self.assertFalse((self.out / "results.csv").exists())
        os.kill(first, signal.SIGKILL)
        said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, said)
        self.assertEqual([row["status"] for row in self.rows()], ["died"])
        self.assertIn("1 of 1 runs have no result, as they died or failed", said)

    def test_its_runs_end_with_it(self):
        process = self.start_endless(1)
        process.kill()
        process.communicate()
        self.assertTrue(harness.until(lambda: not any(map(harness.alive, self.pids())), 60))

    def test_its_own_input_is_not_overwritten(self):
        self.out.mkdir()
        self.file = self.out / "tandem_study.json"
        self.assertIn("tandem_study.json: is an input of this tandem study", self.run_study(expect=2))
        self.assertEqual(json.loads(self.file.read_text()), self.study)
        self.file = self.folder / "study.json"
        self.assertIn("tandem_study.json: is there, and tandem study has not written it", self.run_study(expect=2))
        self.assertEqual([path.name for path in self.out.iterdir()], ["tandem_study.json"])

    def test_wrong_requests_are_exit_status_2(self):
        self.assertIn("--want: there is no measure 'angel' (did you mean 'angle'?)",
                      self.run_study("--want", "angel=1", expect=2))
        self.assertIn("--want: 'small' is no error > 0", self.run_study("--want", "angle=small", expect=2))
        self.study["sweep"][0]["of"] = "roh_inf"
        self.assertIn("study.json: sweep[0].of: there is no setting 'roh_inf' (did you mean 'rho_inf'?",
                      self.run_study(expect=2))
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    harness.main()
