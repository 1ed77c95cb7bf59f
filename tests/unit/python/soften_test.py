#!/usr/bin/env python3
"""What `tandem soften` changes in a scene, how it measures errors, and what it refuses. No program is needed."""
import json
import math
import pathlib
import tempfile
import unittest
from types import SimpleNamespace

import numpy as np

import tandem as td
from tandem.signals import Signal
from tandem.soften_command import numbers, scene_of
from tandem.soften_errors import Measure, error_of_text
from tandem.soften_folder import Folder
from tandem.soften_scene import expect_window, moduli_of_library, random_fills, shares, softened, steps_in, windows
from tandem.soften_words import reading


def bed(**keys):
    s = td.Scene("bed", end_time=.4, window=1e-3, frame_interval=.02)
    grain = s.material("grain", density=2500, young=1e9, friction=.4, restitution=.5)
    s.lattice(grain, (0, 0, 0), (.1, .1, .1), radius=.005, spacing=.011, jitter=.5, **keys)
    s.plane("floor", at=(0, 0, 0), normal="z", material=grain)
    return s


class Changes(unittest.TestCase):
    def test_moduli_step_window_and_start(self):
        s = bed(seed=7)
        soft = softened(s, {}, 16, 2e-5, 2e-3, start=3, overlap_limit=.3)
        dem = soft.data["dem"]
        self.assertEqual((dem["materials"][0]["young"], dem["micro_step"], soft.window, dem["overlap_limit"]), (6.25e7, 2e-5, 2e-3, .3))
        self.assertEqual(dem["particles"][0]["fill"]["seed"], 9)
        self.assertEqual(s.data["dem"]["materials"][0]["young"], 1e9)  # the scene itself stays
        self.assertEqual(softened(s, {}, 1, 0, 1e-3).json(), s.json())

    def test_all_kinds_of_stiffness(self):
        """Damping of the law `paper` goes with the root of the stiffness, so that rebounds stay as they are."""
        s = bed()
        s.data["dem"]["pairs"] = [{"a": "grain", "b": "grain", "normal_stiffness": 1e8, "tangential_stiffness": 8e7, "normal_damping": 40.0,
                                   "tangential_damping": 20.0, "spring_stiffness": "=2*k", "restitution": .5, "friction": .4}]
        pair = softened(s, {}, 16, 0, 1e-3).data["dem"]["pairs"][0]
        self.assertEqual([pair[k] for k in ("normal_stiffness", "tangential_stiffness", "normal_damping", "tangential_damping", "spring_stiffness")],
                         [6.25e6, 5e6, 10.0, 5.0, "=(2*k)/16"])
        self.assertEqual((pair["restitution"], pair["friction"]), (.5, .4))

    def test_moduli_of_the_library(self):
        s = bed()
        del s.data["dem"]["materials"][0]["young"]
        taken = moduli_of_library({"grain.young": {"value": 7.1e10}, "steel.young": {"value": 2.1e11}, "steel.density": {"value": 7850}})
        materials = {m["name"]: m.get("young") for m in softened(s, taken, 4, 0, 1e-3).data["dem"]["materials"]}
        self.assertEqual(materials, {"grain": 1.775e10, "steel": 5.25e10})

    def test_random_starts(self):
        s = bed()
        self.assertEqual(softened(s, {}, 1, 0, 1e-3, start=2).data["dem"]["particles"][0]["fill"]["seed"], 2)  # its default is 1
        s.data["dem"]["particles"][0]["fill"]["jitter"] = 0
        self.assertEqual(random_fills(s), [])
        s.data["dem"]["particles"][0]["radius"] = [.004, .005]
        self.assertEqual(len(random_fills(s)), 1)

    def test_levels(self):
        np.testing.assert_allclose(shares(.2), [.2, .2 * math.sqrt(2), .39])
        np.testing.assert_allclose(shares(.048)[-1], .384, rtol=1e-9)
        self.assertEqual(shares(.4), [.4])
        s = bed()
        self.assertEqual(windows(s, 1e-3), [.001, .002, .004, .01, .02])  # all divide 0.02 s between frames
        s.section("coupling")["adaptive"] = {"min_window": 1e-4, "max_window": 1e-3}
        self.assertEqual(windows(s, 1e-3), [.001])
        self.assertEqual(softened(s, {}, 4, 0, 2e-3).window, 1e-3)


    def test_a_window_holds_whole_steps(self):
        """The step is none longer than asked; a longer one than the window is as long as it; one at the limit stays below it."""
        self.assertEqual([steps_in(1e-3, step, .39e-3) for step in (1e-4, 9.99e-5, 1.01e-4, .3e-3, .37e-3)], [10, 11, 10, 4, 3])
        self.assertEqual(steps_in(1e-3, 4e-3, 5e-3), 1)
        self.assertEqual(steps_in(1e-3, 2e-4, 2e-4), 6)


class Errors(unittest.TestCase):
    def results(self, values, dt=.1, **numbers_):
        signal = Signal("w.q", dt * np.arange(1, len(values) + 1), np.array(values, float))
        return SimpleNamespace(__class__=dict, reduce=lambda of: numbers_[of.split(":")[1]]), signal

    def error(self, of, here, right):
        runs = [{of: signal} for _, signal in (here, right)]
        return Measure(of).error(*runs)

    def test_a_course_is_compared_at_common_times(self):
        """The rms of 0.1 over a range of 2, from every second row of the run with shorter windows."""
        right = self.results([1, 2, 3])
        here = self.results([9, 1.1, 9, 2.1, 9, 2.9], dt=.05)
        self.assertAlmostEqual(self.error("w.q", here, right), .05)

    def test_a_vector_is_relative_to_the_box_that_it_stays_in(self):
        t = np.arange(1, 4) * .1
        right = Signal("w.v", t, np.array([[0, 0, 0], [3, 4, 0], [0, 0, 0]], float), axes=tuple("xyz"))
        here = Signal("w.v", t, right.values + [0, 0, .5], axes=tuple("xyz"))
        self.assertAlmostEqual(Measure("w.v").error({"w.v": here}, {"w.v": right}), .1)

    def test_a_number(self):
        here, right = (SimpleNamespace(reduce=lambda of, v=v: v) for v in (1.1, -1.0))
        self.assertAlmostEqual(Measure("f.flow:mean").error(here, right), 2.1)
        self.assertEqual(Measure("summary.lost_particles").error(*[SimpleNamespace(reduce=lambda of: 0)] * 2), 0)

    def test_what_does_not_change_has_no_relative_error(self):
        with self.assertRaisesRegex(td.SceneError, "w.q: does not change in the stiff run"):
            self.error("w.q", self.results([1, 2]), self.results([1, 1]))
        self.assertEqual(self.error("w.q", self.results([1, 1]), self.results([1, 1])), 0)
        with self.assertRaisesRegex(td.SceneError, "is 0 in the stiff run"):
            Measure("f.flow:mean").error(SimpleNamespace(reduce=lambda of: 1), SimpleNamespace(reduce=lambda of: 0))
        with self.assertRaisesRegex(td.SceneError, "no time that both runs have"):
            self.error("w.q", self.results([1, 2]), self.results([1, 2], dt=.07))


    def test_results_to_which_no_error_is_relative(self):
        """Refused after the runs of the stiff scene, also where all starts agree."""
        def runs(signal, *numbers_):
            signal = Signal("w.q", np.arange(1, 4) * .1, np.array(signal, float))
            return [type("Run", (dict,), {"reduce": lambda self, of, v=v: v})({"w.q": signal}) for v in numbers_]
        for of, stiff, wanted in (("w.q", runs([1, 1, 1], 0, 0), "does not change"), ("w.q:mean", runs([1, 1, 1], 1, 1), "does not change"),
                                  ("w.q:mean", runs([0, 1, 2], 1, 0), "is 0 in"), ("w.q:mean", runs([0, 1, 2], 1, math.nan), "is nan in"),
                                  ("summary.n", runs([0, 1, 2], 7, 7), "the same from all starts"), ("w.q", runs([0, math.nan, 1], 0), "no finite numbers")):
            with self.subTest(of=of, wanted=wanted), self.assertRaisesRegex(td.SceneError, wanted):
                Measure(of).expect_to_change(stiff)
        for of, stiff in (("w.q", runs([0, 1, 2], 0, 0)), ("w.q:mean", runs([0, 1, 2], 1, 1)), ("summary.n", runs([0, 1, 2], 7)), ("summary.n", runs([0, 1, 2], 7, 8))):
            Measure(of).expect_to_change(stiff)


class Refusals(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def refusal(self, s, of="floor.force", **keys):
        with self.assertRaises(td.SceneError) as caught:
            td.soften(s, keys.pop("error", "1%"), of, out=str(self.folder / "out"), progress=False, **keys)
        return str(caught.exception)

    def test_errors(self):
        self.assertEqual([error_of_text(text) for text in ("1%", "0.5%", "0.02")], [.01, .005, .02])
        for text in ("0", "1", "100%", "one", "-1%", "nan", "inf", "nan%", "%", "1_0%"):
            with self.assertRaisesRegex(td.SceneError, "is no error .*--error 1%"):
                error_of_text(text)

    def test_scenes(self):
        self.assertIn("no grains to soften", self.refusal(td.Scene("machine", 1)))
        s = bed()
        self.assertIn("no result is named", self.refusal(s, of=[]))
        s.data["dem"]["particles"][0]["fill"]["jitter"] = 0
        self.assertIn("no random numbers, so that its scatter cannot be found (give the fill a jitter, or write --starts 1", self.refusal(s))
        s = bed()
        s.window = "=w"
        self.assertIn("coupling.window is the expression '=w'", self.refusal(s))
        (self.folder / "out").mkdir()
        (self.folder / "out" / "mine").touch()
        self.assertIn("is no folder of a softening", self.refusal(bed()))

    def test_words_of_python(self):
        """Before anything runs, and as errors that say what to write."""
        for keys, wanted in (({"starts": 0}, "--starts: 0 is no number of random starts"), ({"modulus": 8}, r"--modulus: 8 is no list .*modulus=\[8\]"),
                             ({"step": [math.nan]}, "--step: nan is not a finite number"), ({"modulus": [math.inf]}, "--modulus: inf is not a finite"),
                             ({"overlap": math.nan}, "--overlap: nan is no overlap"), ({"window": ["a"]}, "--window: 'a' is not a finite number"),
                             ({"of": ["floor.force:mean:.5:.9"]}, "outside the run, which ends at 0.4 s"), ({"of": ["f:mean:0:9"]}, "outside the run"),
                             ({"of": ["floor.force:mean:.3:.2"]}, "before the other one"), ({"of": ["floor.force:meen"]}, "did you mean 'mean'"),
                             ({"of": ["floor.force:mean:nan"]}, "a time that is no number"), ({"limit": math.nan}, "nan is no wall time"), ({"limit": 0}, "0 is no wall time"), ({"of": [7]}, "7 is no name of a result")):
            with self.subTest(keys=keys):
                self.assertRegex(self.refusal(bed(), **keys), wanted)
        self.assertIn("'s.json' is no scene (write td.soften(td.load(", self.refusal("s.json"))
        self.assertFalse((self.folder / "out").exists())

    def test_windows(self):
        with self.assertRaisesRegex(td.SceneError, r"output.frame_interval of 0.02 s is not a whole multiple of the window of 0.003 s \(these fit: 0.002, 0.004, 0.01, 0.02\)"):
            s = bed()
            s.end_time = .6
            expect_window(s, .003)
        with self.assertRaisesRegex(td.SceneError, "end_time of 0.4 s is not a whole multiple of the window of 0.03 s"):
            expect_window(bed(), .03)
        with self.assertRaisesRegex(td.SceneError, "is no window"):
            expect_window(bed(), 0)

    def test_words(self):
        self.assertEqual(numbers("4,16", "--modulus"), [4, 16])
        with self.assertRaisesRegex(td.SceneError, "--step: 'a,b' is no list of numbers"):
            numbers("a,b", "--step")
        with self.assertRaisesRegex(td.SceneError, "--modulus: '1_0' is no list of numbers"):
            numbers("1_0", "--modulus")
        with self.assertRaisesRegex(td.SceneError, "--modulus: 'nan' is not a finite number"):
            numbers("2,nan", "--modulus")
        s = bed()
        s.parameter("mouth", .1)
        s.save(str(self.folder / "s.json"))
        self.assertEqual(scene_of(str(self.folder / "s.json"), ["mouth=.2"]).data["parameters"]["mouth"]["value"], .2)
        with self.assertRaisesRegex(td.SceneError, "no parameter 'muoth'; did you mean 'mouth'"):
            scene_of(str(self.folder / "s.json"), ["muoth=.2"])
        for word, wanted in (("wide", "'mouth=wide' gives no value"), ("1_0", "'mouth=1_0' gives no value"), ("nan", "'nan' is not a finite number"),
                             ("1e400", "'1e400' is not a finite number")):
            with self.assertRaisesRegex(td.SceneError, wanted):
                scene_of(str(self.folder / "s.json"), [f"mouth={word}"])

    def test_a_suspect_stiff_scene_and_an_error_below_its_scatter(self):
        stiff = SimpleNamespace(setting=SimpleNamespace(divisor=1, window=1e-3), share=.2, parts={}, wall_s=1.0, overlap=.01, fault="",
                                status="suspect", rules={"overlap": "spheres overlap by 0.14"})
        found = SimpleNamespace(measures=[Measure("hinge.q")], stiff=stiff, candidates=[], scatter={"hinge.q": .0123}, wanted=.01, chosen=None)
        self.assertIn("WARNING: the scene as it is is itself suspect.", reading(found))
        self.assertIn("\n  overlap: spheres overlap by 0.14\n", reading(found))
        self.assertIn("SUSPECT by overlap; stiff: its errors are the scatter", reading(found))
        self.assertIn("differ by 1.2 % of hinge.q, so that a smaller error means nothing\nwrite --error 2%", reading(found))


class Files(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.at = pathlib.Path(holder.name).resolve()

    def folder(self, s=None, out="out", file=None):
        claimed = Folder(s or bed(), str(self.at / out), file and str(self.at / file))
        self.addCleanup(claimed.release)
        return claimed

    def test_the_input_is_not_overwritten(self):
        """Neither by -o, nor by the default of a scene that the folder's own runs made."""
        bed().save(str(self.at / "bed.json"))
        with self.assertRaisesRegex(td.SceneError, "-o: .*bed.json' is the scene itself, which the softened scene would overwrite"):
            self.folder(td.load(str(self.at / "bed.json")).copy(), file="bed.json")
        self.folder().write_scene(bed())
        with self.assertRaisesRegex(td.SceneError, "is the scene itself"):
            self.folder(td.load(str(self.at / "out" / "bed_soft.json")))
        with self.assertRaisesRegex(td.SceneError, "bed_soft.json' was made by the softening in"):
            self.folder(td.load(str(self.at / "out" / "bed_soft.json")), file="new.json")
        first = self.folder(out="two", file="new.json")
        first.write_scene(bed())
        first.release()
        with self.assertRaisesRegex(td.SceneError, "new.json' was made by"):
            self.folder(td.load(str(self.at / "new.json")), out="two")
        self.folder(td.load(str(self.at / "new.json")), out="three")

    def test_places_that_cannot_be_written(self):
        for file, wanted in (("none/a.json", "there is no folder '.*none'"), (".", "is a folder"), ("out/soften.png", "is a file of the softening")):
            with self.assertRaisesRegex(td.SceneError, wanted):
                self.folder(file=file)
        self.assertFalse((self.at / "out").exists())
        (self.at / "out").touch()
        with self.assertRaisesRegex(td.SceneError, "is no folder"):
            self.folder()

    def test_one_softening_at_a_time(self):
        first = self.folder()
        with self.assertRaisesRegex(td.SceneError, "another softening works in '.*out'"):
            self.folder()
        first.release()
        self.folder()

    def test_earlier_results_do_not_stay(self):
        """Where a second call writes nothing, nothing is there; a scene that was changed by hand stays."""
        for changed in (False, True):
            first = self.folder(file="soft.json")
            first.write_scene(bed())
            (self.at / "out" / "soften.png").touch()
            first.release()
            if changed:
                (self.at / "soft.json").write_text("{}")
            second = self.folder()
            second.forget_earlier_results()
            second.release()
            self.assertEqual((self.at / "soft.json").exists(), changed)
            self.assertEqual(sorted(p.name for p in (self.at / "out").iterdir()), [".lock", "soften.json"])

    def test_a_softened_scene_is_plain(self):
        text = json.loads(softened(bed(), {}, 16, 2e-5, 2e-3, 1, .3).json())
        self.assertEqual(set(text), set(json.loads(bed().json())))


if __name__ == "__main__":
    unittest.main()
