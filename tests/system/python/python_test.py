#!/usr/bin/env python3
"""Scenes that are built, checked, run, watched and swept in Python, with the programs of TANDEM; and the examples, shortened."""
import csv
import inspect
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np

import tandem as td

EXAMPLES = pathlib.Path(td.__file__).resolve().parents[1] / "examples"


def here():
    return f"{__file__}:{inspect.currentframe().f_back.f_lineno}"


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="tandem_python_")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        os.environ["TANDEM_RUNS"] = str(self.folder / "runs")

    def pendulum(self, end=.5):
        s = td.Scene("pendulum", end_time=end)
        bob = s.body("bob", mass=1, inertia=(.01, .01, .01), at=(1, 0, 0))
        s.revolute("hinge", "ground", bob, at=(0, 0, 0), axis="y")
        return s

    def run_scene(self, s, **keys):
        return s.run(picture=False, report=False, **keys)


class Runs(Case):
    def test_results(self):
        r = self.run_scene(self.pendulum(2))
        self.assertEqual(r.verdict, "ok")
        # From the horizontal: q'^2 / 2 = 9.81 sin(q) / 1.01, for a bob with inertia.
        q, rate = r["hinge.q"], r["hinge.rate"]
        np.testing.assert_allclose(rate.values**2 / 2, 9.81 * np.sin(q) / 1.01, atol=2e-4)
        self.assertEqual((q.unit, len(q), r.summary["windows"]), ("rad", 2000, 2000))
        np.testing.assert_allclose(r.bodies["bob"].pose.position[-1], [math.cos(q[-1]), 0, -math.sin(q[-1])], atol=1e-9)
        self.assertEqual(r.scene["bob"].mass, 1)
        self.assertIn("ok", r._repr_html_())

    def test_check_names_the_line(self):
        s = self.pendulum()
        self.assertIn("ok", s.check())
        s.spring("tie", "ground", "bob", a=(0, 0, 1), b=(1, 0, 0), length=1, stiffness=-3); line = here()  # noqa: E702
        for call in (s.check, s.run):
            with self.assertRaisesRegex(td.SceneError, "stiffness") as caught:
                call()
            self.assertEqual(caught.exception.made_at, line)
        s.remove("tie")
        s.revolute("second", "ground", "bib", at=(0, 0, 0), axis="y"); line = here()  # noqa: E702
        with self.assertRaisesRegex(td.SceneError, "bib.*'bob'") as caught:
            s.check(files_only=True)
        self.assertEqual(caught.exception.made_at, line)

    def test_stop_and_live_values(self):
        run = self.pendulum(1000).start(picture=False, report=False)
        begin = time.monotonic()
        while run.time < .2 and time.monotonic() < begin + 20:
            time.sleep(.02)
        self.assertGreater(run["hinge.q"].last(), .1)
        self.assertIn("<progress", run._repr_html_())
        run.stop()
        r = run.wait()
        self.assertEqual((r.verdict, r.verdict.reason), ("failed", "interrupted"))
        self.assertLess(r.summary["simulated_s"], 1000)

    def test_progress_may_stop(self):
        seen = []
        r = self.run_scene(self.pendulum(1000), progress=lambda run: (seen.append(run.time), run.stop()))
        self.assertEqual(r.verdict.reason, "interrupted")
        self.assertEqual(len(seen), 1)

    def test_failed_checks_return(self):
        s = self.pendulum()
        s.expect("far away", "hinge.q", 100, 1e-3)
        r = self.run_scene(s)
        self.assertEqual((r.verdict, r.verdict.reason), ("failed", "checks"))

    def test_an_error_in_the_run(self):
        s = self.pendulum()
        with self.assertRaisesRegex(td.RunError, "--threads"):
            self.run_scene(s, threads=5000)
        with self.assertRaisesRegex(td.RunError, "mbd_server|false") as caught:
            self.run_scene(s, arguments=["--mbd-server", "/bin/false"])
        self.assertTrue((caught.exception.folder / "run.log").is_file())

    def test_parameters(self):
        s = self.pendulum(.1)
        s.parameter("mass", 2, unit="kg", max=5)
        s["bob"].mass = "=mass"
        self.assertEqual(self.run_scene(s, mass=3).summary["parameters"]["mass"]["value"], 3)
        with self.assertRaisesRegex(td.SceneError, "no parameter 'mas'; did you mean 'mass'"):
            self.run_scene(s, mas=3)
        with self.assertRaisesRegex(td.SceneError, "mass"):
            self.run_scene(s, mass=30)

    def test_without_the_program(self):
        held = os.environ["TANDEM"]
        os.environ["TANDEM"] = "/nowhere"
        try:
            with self.assertRaisesRegex(RuntimeError, "TANDEM is '/nowhere'"):
                self.pendulum().check()
        finally:
            os.environ["TANDEM"] = held


class Controllers(Case):
    def held(self, end=1):
        s = td.Scene("held", end_time=end, window=2e-3)
        bob = s.body("bob", mass=1, inertia=(.01, .01, .01), at=(0, 0, -1))
        s.actuator("motor", s.revolute("hinge", "ground", bob, at=(0, 0, 0), axis="y"), input="torque")
        s.observe("hinge.q", "hinge.rate")
        return s

    def test_same_bits_as_a_program(self):
        law = "40 * (.5 - sensors['hinge.q']) - 14 * sensors['hinge.rate']"
        (self.folder / "program.py").write_text(
            "import json, sys\nsys.stdin.readline()\nfor line in sys.stdin:\n    sensors = json.loads(line)['sensors']\n"
            f"    print(json.dumps({{'inputs': {{'torque': {law}}}}}), flush=True)\n")
        calls = []

        def function(time, sensors):
            calls.append(time)
            return eval(law, {"sensors": sensors})

        inside = self.run_scene(self.held(), controller=function, out="a").summary
        outside = self.run_scene(self.held(), controller=f"{sys.executable} program.py", out="b").summary
        self.assertEqual(inside["state_hash"], outside["state_hash"])
        self.assertEqual((len(calls), calls[0]), (500, 0))
        print(f"\n  {len(calls)} calls, {inside['wall_s'] / len(calls) * 1e6:.0f} us per window with a function, "
              f"{outside['wall_s'] / len(calls) * 1e6:.0f} us with a program")

    def test_errors_in_the_function_are_raised_here(self):
        def function(time, sensors):
            return 0 if time < .1 else 1 / 0

        with self.assertRaises(ZeroDivisionError):
            self.run_scene(self.held(), controller=function)
        for answer, words in (({"torqe": 1}, "'torqe', which is no control input; did you mean 'torque'"), ({}, "no 'torque'"), (None, "None")):
            with self.assertRaisesRegex(td.SceneError, words):
                self.run_scene(self.held(), controller=lambda time, sensors, answer=answer: answer)

    def test_a_scene_without_inputs(self):
        s = self.held()
        s["motor"].size = 1
        with self.assertRaisesRegex(Exception, "controller"):
            self.run_scene(s, controller=lambda time, sensors: 0)


class Sweeps(Case):
    def test_command_and_python_agree(self):
        s = td.Scene("drop", end_time=.1, frame_interval=0)
        s.parameter("g", 9.81, unit="m/s2", max=20)
        s.data["gravity"] = [0, 0, "=-g"]
        s.body("ball", mass=1, inertia=(1, 1, 1))
        s.save("drop.json")
        said = subprocess.run([os.environ["TANDEM"], "sweep", "drop.json", "--set", "g=5:25:3", "--of", "ball.velocity.z:last", "--jobs", "2",
                               "--out", "out"], capture_output=True, text=True, check=False)
        self.assertEqual(said.returncode, 1, said.stdout + said.stderr)  # 25 is beyond its limit
        self.assertTrue(pathlib.Path("out/response.png").exists())
        swept = td.sweep(lambda g: s.copy().set(g=g), g=[5., 15., 25.], score="ball.velocity.z:last", out="out", progress=False)
        self.assertEqual([row.status for row in swept], ["ok", "ok", "failed"], swept.table())
        np.testing.assert_allclose(swept.column("ball.velocity.z:last")[:2], [-.5, -1.5], rtol=1e-9)
        self.assertIn("25", swept[2].reason)

    def test_wrong_words_of_the_command(self):
        self.pendulum().save("s.json")
        for words, wanted in ((["--set", "mass=1:2:3"], "no parameter 'mass'"), (["--set", "mass=1:2"], "NAME=FIRST:LAST:COUNT"),
                              (["--sett", "mass=1"], "--set"), ([], "--set")):
            said = subprocess.run([os.environ["TANDEM"], "sweep", "s.json", *words], capture_output=True, text=True, check=False)
            self.assertIn(wanted, said.stderr)
            self.assertEqual(said.returncode, 2, said.stderr)


class Softening(Case):
    """`tandem soften` on a hopper of some hundred spheres."""

    def hopper(self):
        s = td.templates.hopper()
        s.set(depth=.05, height=.1, young=1e9)
        s.end_time = .24
        s.section("output")["frame_interval"] = .04
        s.save("hopper.json")
        return s

    def soften(self, *words):
        return subprocess.run([os.environ["TANDEM"], "soften", "hopper.json", *words], capture_output=True, text=True, check=False)

    def test_a_faster_scene_within_the_error(self):
        stiff = self.hopper()
        words = ["--error", "25%", "--of", "mouth.passed", "--starts", "2", "--modulus", "4,16,64", "--step", "0.28,0.39", "--window", "0.004", "--threads", "1",
                 "--out", "soft", "-o", "softer.json"]
        said = self.soften(*words)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        print("\n" + said.stdout)
        with open("soft/results.csv") as file:
            rows = {row["setting"]: row for row in csv.DictReader(file)}
        chosen, reference = rows["chosen"], rows["stiff"]
        self.assertGreater(float(chosen["divisor"]), 1)
        self.assertLessEqual(float(chosen["error mouth.passed"]), .25)
        self.assertLessEqual(float(chosen["micro_steps"]), .6 * float(reference["micro_steps"]))  # a quarter of the modulus takes half the steps
        self.assertLess(float(chosen["wall_s"]), float(reference["wall_s"]))
        self.assertGreater(pathlib.Path("soft/soften.png").stat().st_size, 10000)
        # The scene itself: not suspect, and its moduli, step and window are those of the table.
        soft = td.load("softer.json")
        self.assertEqual(soft.data["dem"]["materials"][0]["young"], f"=(young)/{float(chosen['divisor']):g}")
        r = self.run_scene(soft, threads=1)
        self.assertEqual(r.verdict, "ok", r.verdict.lines)
        self.assertLessEqual(r.summary["max_overlap_ratio"], soft.data["dem"].get("overlap_limit", .05))
        self.assertAlmostEqual(r.summary["micro_step_s"], float(chosen["micro_step_s"]), places=9)
        written = json.loads(pathlib.Path("soft/runs/variants/written=1/summary.json").read_text())
        self.assertEqual(r.summary["state_hash"], written["state_hash"])
        self.assertEqual(stiff.data["dem"]["materials"][0]["young"], "=young")
        # The same command again runs nothing.
        runs = {path: path.stat().st_mtime_ns for path in pathlib.Path("soft/runs/variants").glob("*/summary.json")}
        again = self.soften(*words)
        self.assertEqual(again.stdout, said.stdout)
        self.assertEqual(runs, {path: path.stat().st_mtime_ns for path in pathlib.Path("soft/runs/variants").glob("*/summary.json")})

    def test_wrong_words(self):
        self.hopper()
        start = ["--error", "25%", "--of"]
        for words, wanted in ((start + ["mouth.pased"], "did you mean 'mouth.passed'"), (start + ["mouth.flow:meen"], "did you mean 'mean'"),
                              (start + ["mouth"], "'mouth' is no column; it has 'mouth."), (["--of", "mouth.flow", "--error", "x"], "'x' is no error"),
                              (start + ["mouth.flow", "--window", "0.03"], "not a whole multiple of the window of 0.03 s"),
                              (start + ["mouth.flow", "--step", "0.6"], "above 0.4"), (start + ["mouth.flow", "--modulus", "1"], "no step up"),
                              (start + ["mouth.flow", "--set", "muoth=1"], "did you mean 'mouth'"),
                              (start + ["summary.lost_partikles"], "--of summary.lost_partikles: summary.json of this scene has no number 'lost_partikles' (did you mean"),
                              (start + ["mouth.flow", "--limit", "nan"], "'nan' is no number from 0 to"), (["--of", "mouth.flow"], "--error")):
            said = self.soften(*words)
            self.assertIn(wanted, said.stderr)
            self.assertEqual(said.returncode, 2, said.stderr)
        said = self.soften("--error", "0.01%", "--of", "mouth.passed", "--starts", "2", "--threads", "1")
        self.assertEqual(said.returncode, 1, said.stderr)
        self.assertIn("so that a smaller error means nothing", said.stdout)


# Simulated times of the examples here [s]; their own are longer.
SHORT = {"01_pendulum.py": .5, "02_grains.py": .05, "03_hopper.py": .06, "04_hopper_sweep.py": .02, "05_optimise.py": .7, "06_controller.py": .2,
         "07_watch_and_stop.py": .06, "08_change_a_file.py": .02, "09_energy.py": .05, "10_bucket_sweep.py": .01, "excavator.py": .06}
SHORTENED = """
import sys, runpy
sys.path.insert(0, {examples!r})
import tandem as td
from tandem import scenes, results, runs, sweeps, signals
end = {end}
class Short(runs.Run):
    def __init__(self, scene, *words, **keys):
        short = scene.copy()
        window = scene.data.get("coupling", {{}}).get("window", 1e-3)
        short.end_time = round(min(end, scene.end_time) / window) * window
        short.data.get("dem", {{}}).pop("settle", None)
        if short.data.get("output", {{}}).get("frame_interval"):
            short.data["output"]["frame_interval"] = window * max(1, round(short.end_time / window / 3))
        super().__init__(short, *words, **{{**keys, "picture": False, "report": False}})
runs.Run = Short
text = scenes.Scene.json
def json(self, folder=None):
    short = self.copy()
    window = self.data.get("coupling", {{}}).get("window", 1e-3)
    if sys.argv[0].endswith("sweep.py"):
        short.end_time = round(min(end, self.end_time) / window) * window
        short.data.get("dem", {{}}).pop("settle", None)
        short.data.get("output", {{}}).pop("frame_interval", None)
    return text(short, folder)
scenes.Scene.json = json
whole = signals.Signal._part
signals.Signal._part = lambda self, start, stop: whole(self, min(start, end / 2), stop if stop is None or stop <= end else None)
results.Results.movie = lambda self, *words, **keys: None
sys.argv = [{script!r}]
runpy.run_path({script!r}, run_name="__main__")
"""


class Templates(Case):
    def test_each_is_a_valid_scene(self):
        for name in td.templates.__all__:
            made = getattr(td.templates, name)()
            made.check(files_only=True)
            for parameter, keys in made.data["parameters"].items():  # each one is used
                self.assertRegex(str(made).replace(f'"{parameter}": {{', ""), rf'"=[^"]*\b{parameter}\b', f"{name}: {parameter}")

    def test_what_cannot_work_is_refused_by_name(self):
        cases = {"screw": dict(shaft=.03, gap=.03, diameter=0, pitch=0, rate=0, speed=-1), "hopper": dict(mouth=.03, rise=0, depth=.01),
                 "round_hopper": dict(mouth=.03, rise=0), "conveyor": dict(length=.25, speed=0, width=.05, skirt=.01), "chute": dict(slope=81, length=.2),
                 "mixer": dict(blade=.1), "bucket": dict(depth=.12, way=1), "tank": dict(amplitude=.3, spacing=.1), "linkage": dict(crank=.5)}
        for template, wrong in cases.items():
            for name, value in wrong.items():
                s = getattr(td.templates, template)().set(**{name: value})
                with self.assertRaisesRegex(td.SceneError, rf"parameters\.{name}: .* is (below|above) '(min|max)'", msg=f"{template}: {name}={value}"):
                    s.check(files_only=True)
        for wrong, wanted in (({"base": 1.2}, r"parameters.base: 1.2 is above 'max', .*\(coupler \+ rocker\).*1.089"),  # which does not close
                              ({"rocker": .2}, "parameters.crank: 0.2 is above 'max', .*coupler.*rocker.*base")):  # whose crank does not turn round
            with self.assertRaisesRegex(td.SceneError, wanted):
                td.templates.linkage().set(**wrong).check(files_only=True)

    def test_the_screw_moves_grains(self):
        """At pitch times speed / (2 pi) at most, 0.31 m/s, and not much slower; its meshes are beside the file."""
        said = subprocess.run([os.environ["TANDEM"], "new", "scene", "auger", "--template", "screw"], capture_output=True, text=True, check=False)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertTrue(all(pathlib.Path(f"auger_{mesh}.stl").is_file() for mesh in ("flight", "trough")))
        s = td.load("auger.json")
        s.end_time = .9
        del s.data["checks"]
        r = self.run_scene(s)
        self.assertEqual(r.verdict, "ok")
        spheres = r.frames[-1].spheres
        along = spheres.position[:, 2] < -.05
        self.assertGreater(along.sum(), 50)
        self.assertTrue(.15 < spheres.velocity[along, 0].mean() < .31, spheres.velocity[along, 0].mean())
        with self.assertRaisesRegex(td.SceneError, '0.17 is above .max., "=0.8\\*diameter", which is 0.16'):
            self.run_scene(s, shaft=.17)

    def test_command(self):
        said = subprocess.run([os.environ["TANDEM"], "new", "scene", "rig", "--template", "linkage"], capture_output=True, text=True, check=False)
        self.assertEqual(said.returncode, 0, said.stderr)
        r = self.run_scene(td.load("rig.json"), speed=3)
        self.assertEqual(r.verdict, "ok")
        self.assertAlmostEqual(r["crank_pin.rate"].last(), 3, places=2)
        for words, wanted in ((["--template", "hoper"], "no template 'hoper'; did you mean 'hopper'"), (["rig", "--template", "linkage"], "exists"),
                              (["rig.json", "--template", "linkage"], "a file is given by --out"), ([], "--template")):
            said = subprocess.run([os.environ["TANDEM"], "new", "scene", *words], capture_output=True, text=True, check=False)
            self.assertIn(wanted, said.stderr)
            self.assertEqual(said.returncode, 2)


class Tutorial(Case):
    """The blocks of the tutorial, one after the other."""

    def test_blocks(self):
        text = (EXAMPLES.parents[1] / "docs" / "tutorial.md").read_text()
        blocks = re.findall(r"^```(python|sh)\n(.*?)^```", text, re.M | re.S)
        self.assertGreaterEqual(len(blocks), 8)
        script = "\n".join(code if kind == "python" else f"import subprocess; subprocess.run({code!r}, shell=True, check=True)" for kind, code in blocks)
        script = script.replace("end_time=.5", "end_time=.3")  # the tutorial shows more than the test needs
        os.environ["PATH"] = f"{pathlib.Path(os.environ['TANDEM']).parent}:{os.environ['PATH']}"
        said = subprocess.run([sys.executable, "-B", "-c", script], capture_output=True, text=True, check=False)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        print("\n" + said.stdout)


class Examples(Case):
    """Each example with a shorter time, into which ranges of time are moved, and without settling."""

    def run_example(self, name):
        text = SHORTENED.format(examples=str(EXAMPLES), end=SHORT[name], script=str(EXAMPLES / name))
        begin = time.monotonic()
        said = subprocess.run([sys.executable, "-B", "-c", text], capture_output=True, text=True, check=False)
        self.assertEqual(said.returncode, 0, f"{name}:\n{said.stdout}{said.stderr}")
        print(f"  {name}: {time.monotonic() - begin:.1f} s")
        return said.stdout

    def test_all(self):
        sys.path.insert(0, str(EXAMPLES))
        import excavator_meshes
        excavator_meshes.main(self.folder)
        print()
        scripts = sorted(path.name for path in EXAMPLES.glob("*.py") if path.name != "excavator_meshes.py")
        self.assertEqual(scripts, sorted(SHORT))
        os.environ["XDG_CACHE_HOME"] = str(self.folder)
        for name in scripts:
            self.run_example(name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
