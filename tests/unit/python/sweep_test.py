#!/usr/bin/env python3
"""Sweeps: order, resuming, variants that fail, tables and pictures. The program is fake_tandem.py."""
import csv
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import tandem as td
from tandem.sweep_command import main, values_of

os.environ["TANDEM"] = str(pathlib.Path(__file__).resolve().parent / "fake_tandem.py")


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.out = self.folder / "out"
        self.s = td.Scene("s", 1)
        self.s.parameter("x", 1)
        self.s.parameter("y", 1)

    def sweep(self, **keys):
        keys = {"score": "lift.force:mean", "out": self.out, "progress": False, **keys}
        return td.sweep(self.s, **keys)

    def runs(self):
        return (self.out / "runs").read_text().split() if (self.out / "runs").exists() else []


class Sweeps(Case):
    def test_all_combinations_in_order(self):
        swept = self.sweep(x=[1, 2, 3], y=(5, 6), jobs=3)
        self.assertEqual([(row["x"], row["y"], row.score) for row in swept], [(x, y, x * x) for x in (1, 2, 3) for y in (5, 6)])
        self.assertEqual(swept.best()["x"], 3)
        self.assertEqual(swept.best(least=True)["x"], 1)
        self.assertEqual(list(swept.column("x")), [1, 1, 2, 2, 3, 3])

    def test_failed_and_suspect_variants_are_marked_and_kept(self):
        swept = self.sweep(x=[-1, 2, 11])
        self.assertEqual([row.status for row in swept], ["failed", "ok", "suspect"])
        self.assertIn("x is negative", swept[0].reason)
        self.assertEqual(swept[2].reason, "x is large")
        self.assertEqual(swept.best()["x"], 2)
        with open(self.out / "results.csv") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([(row["x"], row["status"], row["lift.force:mean"]) for row in rows],
                         [("-1", "failed", ""), ("2", "ok", "4.0"), ("11", "suspect", "121.0")])
        self.assertIn("x=-1: x: x is negative", swept.table())

    def test_the_same_sweep_again_runs_nothing(self):
        self.sweep(x=[-1, 2])
        again = self.sweep(x=[-1, 2, 3])
        self.assertEqual(self.runs(), ["-1", "2", "3"])
        self.assertEqual([row.status for row in again], ["failed", "ok", "ok"])
        self.sweep(x=[-1, 2, 3], retry=True)
        self.assertEqual(self.runs(), ["-1", "2", "3", "-1"])

    def test_a_wrong_score_ends_the_sweep(self):
        """A wrong reduction before anything runs, a column that is not there after the first variant."""
        for score, wanted in (("lift.force:meen", "did you mean 'mean'"), (["lift.force:mean:a"], "a time that is no number"), ("lift.force:max:0:7", "outside the run")):
            with self.assertRaisesRegex(td.SceneError, wanted):
                self.sweep(x=[1, 2, 3], score=score)
        for keys, wanted in (({"x": []}, "x has no values"), ({"x": [1, 2, 1.0]}, "x has the value 1 twice"), ({"x": [1], "jobs": 0}, "jobs is 0"),
                             ({"x": [1], "score": 3}, "score: it is 3"), ({"x": [1], "score": "lift.force:meen"}, "^score lift.force:meen: ")):
            with self.assertRaisesRegex(td.SceneError, wanted) as caught:
                self.sweep(**keys)
            self.assertIn(__file__, caught.exception.made_at)
        with self.assertRaisesRegex(td.SceneError, "3 is no scene"):
            td.sweep(3, x=[1])
        self.assertEqual(self.runs(), [])
        before = []
        for _ in range(2):  # nothing runs again where the first variant has been run before
            with self.assertRaisesRegex(td.SceneError, "did you mean 'lift.force'"):
                self.sweep(x=range(11, 41), score="lift.forse:max")
            self.assertLess(len(self.runs()), 30)
            self.assertEqual(before or self.runs(), self.runs())
            before = self.runs()
        self.s.save(self.folder / "s.json")
        self.assertEqual(main([str(self.folder / "s.json"), "--set", "x=1,2", "--of", "lift.forse:max", "--out", str(self.out)]), 2)

    def test_other_threads_run_anew(self):
        """Where they are given; with `timed` also where they follow from the jobs, or the jobs alone are others."""
        for keys, count in (({}, 1), ({"jobs": 2}, 1), ({"threads": 1}, 2), ({"threads": 1, "jobs": 2}, 2), ({"threads": 2}, 3),
                            ({"timed": True}, 4), ({"timed": True}, 4), ({"timed": True, "jobs": 2}, 5), ({"timed": True, "threads": 5, "jobs": 2}, 6)):
            self.sweep(x=[2], **keys)
            self.assertEqual(len(self.runs()), count, keys)

    def test_a_changed_scene_runs_anew(self):
        self.sweep(x=[2])
        self.s.end_time = 2
        self.sweep(x=[2])
        self.assertEqual(self.runs(), ["2", "2"])

    def test_forty_variants_are_resumed_after_a_kill(self):
        self.s.save(self.folder / "s.json")
        command = [sys.executable, "-m", "tandem.sweep_command", str(self.folder / "s.json"), "--set", "x=" + ",".join(map(str, range(-1, 39))), "--of",
                   "lift.force:max", "--out", str(self.out), "--jobs", "2"]
        first = subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)
        while len(self.runs()) < 12:
            time.sleep(.01)
        os.killpg(first.pid, signal.SIGKILL)
        first.wait()
        time.sleep(.3)
        for pid in filter(str.isdigit, os.listdir("/proc")):  # the run that takes a minute was in a session of its own
            try:
                words = pathlib.Path(f"/proc/{pid}/cmdline").read_text()
            except OSError:
                continue
            if "fake_tandem" in words and str(self.out) in words:
                os.kill(int(pid), signal.SIGKILL)
        done = len(self.runs())
        (self.folder / "s.json").write_text((self.folder / "s.json").read_text())
        swept = td.sweep(lambda x: td.load(self.folder / "s.json", x=x), score="lift.force:max", out=self.out, jobs=2, progress=False, limit=4,
                         x=[float(x) for x in range(-1, 39)])
        status = [row.status for row in swept]
        self.assertEqual((status[0], status[8]), ("failed", "timed out"))
        self.assertEqual(sum(s in ("ok", "suspect") for s in status), 38)
        self.assertLessEqual(len(self.runs()), 40 + 3, f"{done} had been started before")

    def test_an_interrupted_variant_runs_again(self):
        swept = self.sweep(x=[7], limit=2)
        self.assertEqual((swept[0].status, swept[0].reason), ("timed out", "stopped after 2 s"))
        (self.out / "variants" / "x=7.timed_out").unlink()
        self.sweep(x=[7], limit=2)
        self.assertEqual(self.runs(), ["7", "7"])

    def test_functions(self):
        def variant(x):
            if x == 3:
                raise ValueError("no three")
            return self.s.copy().set(x=x)

        swept = td.sweep(variant, x=range(1, 5), score=lambda r: 1 / float(r["lift.force"].last() - 4), out=self.out, progress=False)
        self.assertEqual([row.status for row in swept], ["ok", "ok", "failed", "ok"])
        self.assertIn("ValueError: no three", swept[2].reason)
        self.assertIn("no score: float division by zero", swept[1].reason)
        swept = td.sweep(variant, x=[1, 2], score=lambda r: float("inf") if r["lift.force"][0] == 4 else 1, out=self.out, progress=False)
        self.assertEqual((swept[1].reason, swept.best()["x"]), ("score is inf", 1))

    def test_shares_and_collection(self):
        self.assertEqual([row.status for row in self.sweep(x=[1, 2, 3], share="2/3")], ["pending", "ok", "pending"])
        self.assertEqual([row.status for row in self.sweep(x=[1, 2, 3], share="1/3")], ["ok", "ok", "pending"])
        self.assertEqual([row.status for row in self.sweep(x=[1, 2, 3])], ["ok", "ok", "ok"])
        self.assertEqual(self.runs(), ["2", "1", "3"])

    def test_pictures(self):
        one = self.sweep(x=[-1, 2, 3, 11])
        one.picture(self.folder / "one.png")
        shown = one._repr_html_()  # in a notebook: columns stay aligned, and the picture is below them
        self.assertIn('<pre style="font-family:monospace', shown)
        self.assertIn('<img src="data:image/png;base64,iVBOR', shown)
        self.sweep(x=[-1, 2, 3, 11], y=[1, 2, 3, 4], jobs=4).picture(self.folder / "two.png")
        for name in ("one", "two"):
            self.assertGreater((self.folder / f"{name}.png").stat().st_size, 10000)

    def test_wrong_words(self):
        with self.assertRaisesRegex(td.SceneError, "no parameter 'z'; there is 'x', 'y'"):
            self.sweep(z=[1])
        for limit in (float("nan"), float("inf"), -1):
            with self.assertRaisesRegex(td.SceneError, f"limit: {limit} is no wall time of a run"):
                self.sweep(x=[1], limit=limit)
        with self.assertRaisesRegex(td.SceneError, "nan is not a finite number"):
            self.sweep(x=[1, float("nan")])
        (self.folder / "other").mkdir()
        (self.folder / "other" / "file").touch()
        with self.assertRaisesRegex(td.SceneError, "no folder of a sweep"):
            self.sweep(x=[1], out=self.folder / "other")


class Words(Case):
    def test_values(self):
        self.assertEqual(values_of("mouth=0.05:0.08:4"), ("mouth", [.05, .06, .07, .08]))
        self.assertEqual(values_of("pitch=10,20"), ("pitch", [10, 20]))
        for text in ("mouth", "mouth=", "=1", "mouth=1:2", "mouth=1:2:1", "mouth=a", "mouth=1_0", "mouth=1:2:1_0"):
            with self.assertRaisesRegex(td.SceneError, "gives no parameter values"):
                values_of(text)
        for text, word in (("mouth=nan", "nan"), ("mouth=1,inf", "inf"), ("mouth=0:-inf:3", "-inf"), ("mouth=1e400", "1e400")):
            with self.assertRaisesRegex(td.SceneError, f"--set: '{word}' is not a finite number"):
                values_of(text)

    def test_command(self):
        self.s.save(self.folder / "s.json")
        with open(os.devnull, "w") as sink:
            held, sys.stdout = sys.stdout, sink
            try:
                status = main([str(self.folder / "s.json"), "--set", "x=1:3:3", "--of", "lift.force:mean", "--out", str(self.out), "--jobs", "2"])
            finally:
                sys.stdout = held
        self.assertEqual(status, 0)
        self.assertTrue((self.out / "response.png").exists())


if __name__ == "__main__":
    unittest.main()
