#!/usr/bin/env python3
"""Results as signals and frames: reductions, units, live files, and the memory of frames."""
import json
import pathlib
import resource
import tempfile
import unittest

import h5py
import numpy as np

import tandem as td


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.summary(status="ok", scene="s", windows=101, elements={"lift": {"type": "cylinder", "force": {"unit": "N"}, "energy": {"unit": "J"}}},
                     joint_units={"hinge": "rad"})
        t = np.arange(101) / 100
        self.t, self.force = t, 3 * t**2
        self.csv("elements", "time,lift.force,lift.energy", t, self.force, t)
        self.csv("joints", "time,hinge.q,hinge.rate", t, np.sin(20 * t), 20 * np.cos(20 * t))
        self.csv("bodies", "time," + ",".join(f"box.position.{a}" for a in "xyz") + "," + ",".join(f"box.orientation.{a}" for a in "wxyz"),
                 t, t, 0 * t, 2 * t, *[np.cos(t / 2), 0 * t, np.sin(t / 2), 0 * t])
        self.r = td.Results(self.folder)

    def summary(self, **keys):
        (self.folder / "summary.json").write_text(json.dumps(keys))

    def csv(self, name, header, *columns):
        rows = [",".join(repr(float(x)) for x in row) for row in zip(*columns)]
        (self.folder / f"{name}.csv").write_text("\n".join([header, *rows]) + "\n")

    def frame(self, number, count=10, **arrays):
        (self.folder / "frames").mkdir(exist_ok=True)
        rng = np.random.default_rng(number)
        with h5py.File(self.folder / "frames" / f"particles_{number:06}.h5", "w") as file:
            file.attrs["time"] = number / 10
            file["position"], file["radius"] = rng.random((count, 3)), np.full(count, .1, np.float32)
            for name, values in arrays.items():
                file[name] = values


class Signals(Case):
    def test_columns_vectors_and_elements(self):
        self.assertEqual(self.r["lift.force"].unit, "N")
        self.assertEqual((self.r["hinge.q"].unit, self.r["hinge.rate"].unit, self.r["box.position"].unit), ("rad", "rad/s", "m"))
        self.assertEqual(self.r["box.position"].shape, (101, 3))
        np.testing.assert_array_equal(self.r["box.position"].z, 2 * self.t)
        self.assertEqual(self.r["lift"].work, 1)
        self.assertEqual(self.r["lift"].force.last(), 3)

    def test_reductions_are_those_of_checks(self):
        q = self.r["lift.force"]
        part = (self.t >= .4 - 1e-12) & (self.t <= .7 + 1e-12)
        self.assertAlmostEqual(q.mean(.4, .7), np.trapz(self.force[part], self.t[part]) / .3)
        self.assertAlmostEqual(q.integral(), 1, places=3)
        self.assertAlmostEqual(q.at(.505), (self.force[50] + self.force[51]) / 2)
        self.assertEqual((q.min(.5), q.max(0, .5), q.range()), (.75, .75, 3))
        self.assertAlmostEqual(q.rms(.4, .7), np.sqrt(np.trapz(self.force[part]**2, self.t[part]) / .3))
        self.assertAlmostEqual(self.r.reduce("lift.force:mean_abs:0.4:0.7"), np.trapz(np.abs(self.force[part]), self.t[part]) / .3)
        self.assertAlmostEqual(self.r["hinge.q"].period(), 2 * np.pi / 20, places=3)
        self.assertEqual(self.r.reduce("lift.force:mean:0.4:0.7"), q.mean(.4, .7))
        self.assertAlmostEqual(self.r.reduce("box.position"), 5**.5)
        with self.assertRaisesRegex(ValueError, "no window ends between 2 s"):
            q.mean(2, 3)

    def test_arithmetic(self):
        np.testing.assert_array_equal(self.r["lift.force"] * 2 - self.r["lift.force"], self.force)
        np.testing.assert_array_equal(np.sqrt(self.r["lift.force"]), np.sqrt(self.force))

    def test_pose(self):
        pose = self.r.bodies["box"].pose
        np.testing.assert_allclose(pose.matrices()[-1] @ [1, 0, 0], [np.cos(1), 0, -np.sin(1)], atol=1e-12)

    def test_wrong_names(self):
        for name, hint in (("lift.forc", "lift.force"), ("liftt", "lift"), ("box.positon", "box.position")):
            with self.assertRaisesRegex(KeyError, f"no '{name}'; did you mean '{hint}'"):
                self.r[name]
        with self.assertRaisesRegex(AttributeError, "no 'forc'; did you mean 'force'"):
            self.r["lift"].forc
        for call, wanted in ((lambda: self.r["lift.nope"], "^the results have no 'lift.nope'; 'lift' has 'lift.energy', 'lift.force'$"),
                             (lambda: self.r["summary.nope"], "^the results have no 'summary.nope', and summary.json has no 'nope'"),
                             (lambda: self.r["summary.windows"], r'write r.summary\["windows"\] or r.reduce\("summary.windows"\)$'),
                             (lambda: self.r.summary["window"], "^summary.json has no 'window'; did you mean 'windows'"),
                             (lambda: self.r.bodies["boxx"], "no body 'boxx'; did you mean 'box'"), (lambda: self.r[3], "3 is no name of a column")):
            with self.assertRaisesRegex(KeyError, wanted):
                call()
        for of, wanted in (("lift.force:mean:a", "time that is no number"), ("lift.force:mean:0:1:2", "more than two times")):
            with self.assertRaisesRegex(ValueError, wanted):
                self.r.reduce(of)
        with self.assertRaisesRegex(KeyError, "no reduction 'men'"):
            self.r.reduce("lift.force:men")
        with self.assertRaisesRegex(KeyError, "is no column; it has 'lift.force', 'lift.energy'"):
            self.r.reduce("lift")

    def test_a_file_that_grows(self):
        with open(self.folder / "elements.csv", "a") as file:
            file.write("1.01,7,8\n1.02,9")
            file.flush()
            self.assertEqual(self.r["lift.force"].last(), 7)
            file.write("0,1\n")
        self.assertEqual(self.r["lift.force"].last(), 90)

    def test_a_file_without_rows(self):
        (self.folder / "elements.csv").write_text("time,lift.force,lift.energy\n")
        self.assertEqual(len(self.r["lift.force"]), 0)
        self.assertIn("no rows yet", repr(self.r["lift.force"]))

    def test_chart(self):
        file = self.folder / "chart.png"
        made = self.r.plot(["lift.force", "box.position", "hinge.*"], file)
        self.assertEqual(made._repr_png_()[1:4], b"PNG")  # which notebooks show
        self.assertGreater(file.stat().st_size, 10000)


class FramesOfRun(Case):
    def test_access(self):
        for number in range(3):
            self.frame(number, group=np.zeros(10))
        self.assertEqual((len(self.r.frames), self.r.frames[-1].time, self.r.frames.at(.12).number), (3, .2, 1))
        self.assertEqual(self.r.frames[0].spheres.position.shape, (10, 3))
        with self.assertRaisesRegex(AttributeError, "no 'positon'; did you mean 'position'"):
            self.r.frames[0].spheres.positon
        with self.assertRaisesRegex(IndexError, "frame 3 of 3"):
            self.r.frames[3]
        with self.assertRaisesRegex(AttributeError, "have no liquid"):
            self.r.frames[0].liquid

    def test_memory_is_that_of_one_frame(self):
        for number in range(20):
            self.frame(number, 100_000)
        size = 100_000 * 3 * 8
        self.r.frames[0].spheres.position.sum()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
        total = sum(frame.spheres.position.mean() for frame in self.r.frames)
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before
        print(f"\n  20 frames of {size / 1e6:.1f} MB: mean {total / 20:.3f}, memory grew by {grown / 1e6:.1f} MB, allowed {2 * size / 1e6:.1f} MB")
        self.assertLess(grown, 2 * size)

    def test_mass_in_a_body(self):
        self.frame(0)
        (self.folder / "scene").mkdir()
        (self.folder / "scene" / "scene.json").write_text(json.dumps({"tandem": "1.1", "name": "s", "end_time": 1, "dem": {
            "materials": [{"name": "a", "density": 3}], "particles": [{"name": "g", "material": "a"}]}}))
        with h5py.File(self.folder / "frames" / "bodies_000000.h5", "w") as file:
            file["bucket"] = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, .5)])
        inside = (self.r.frames[0].spheres.position[:, 2] < .5).sum()
        self.assertAlmostEqual(self.r.mass_in("bucket"), inside * 3 * 4 / 3 * np.pi * float(np.float32(.1))**3)
        with self.assertRaisesRegex(KeyError, "neither a sensor nor a body 'bucke'; did you mean 'bucket'"):
            self.r.mass_in("bucke")


if __name__ == "__main__":
    unittest.main()
