#!/usr/bin/env python3
"""Meshes, bounds and rotations; bodies that are scaled and rotated."""
import math
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import tandem as td
from tandem import geometry

sys.path.insert(0, str(pathlib.Path(td.__file__).resolve().parents[1] / "examples"))
import excavator_meshes  # noqa: E402


def cube(size=(1, 1, 1)):
    return np.array(excavator_meshes.prism([(0, 0), (0, size[2]), (size[0], size[2]), (size[0], 0)], size[1]), float)


class Meshes(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        os.environ["XDG_CACHE_HOME"] = holder.name
        self.file = self.folder / "cube.stl"
        geometry.write_stl(self.file, 1000 * cube((1, 2, 3)))

    def test_formats(self):
        wanted = geometry.read_triangles(self.file)
        lines = ["solid cube"]
        for t in wanted:
            lines += ["facet normal 0 0 0", "outer loop"] + [f"vertex {x} {y} {z}" for x, y, z in t] + ["endloop", "endfacet"]
        (self.folder / "ascii.stl").write_text("\n".join(lines + ["endsolid"]))
        corners = wanted.reshape(-1, 3)
        (self.folder / "cube.obj").write_text("\n".join([f"v {x} {y} {z}" for x, y, z in corners] +
                                                        [f"f {3 * i + 1}//1 {3 * i + 2} -{len(corners) - 3 * i - 2}" for i in range(len(wanted))]))
        for name in ("ascii.stl", "cube.obj"):
            np.testing.assert_array_equal(geometry.read_triangles(self.folder / name), wanted)

    def test_volume_and_density_from_mass(self):
        s = td.Scene("s", 1)
        body = s.body("cube", mesh=self.file, scale=1e-3, mass=12)
        self.assertAlmostEqual(body.shapes[0]["density"], 2)
        self.assertEqual(body.mass, "from_shapes")

    def test_meshes_of_the_excavator_are_closed(self):
        excavator_meshes.main(self.folder)
        for name in ("boom.stl", "bucket.stl"):
            edges = {}
            for t in geometry.read_triangles(self.folder / name).round(3):
                points = [tuple(p) for p in t]
                for i in range(3):
                    edges[points[i], points[(i + 1) % 3]] = edges.get((points[i], points[(i + 1) % 3]), 0) + 1
            self.assertTrue(all(edges.get(edge[::-1]) == count for edge, count in edges.items()), name)

    def bucket(self):
        s = td.Scene("s", 1)
        arm = s.body("arm", mass=1, inertia=(1, 1, 1))
        body = s.body("bucket", mesh=self.file, scale=1e-3, density=1)
        s.revolute("tip", arm, body, at=(.5, 0, 3), axis="y")
        return body

    def test_the_flight_of_the_screw(self):
        """Closed, of the volume of an annulus of 0.1 to 0.5 on each turn, and left-handed: where it turns about x it moves what it touches along x."""
        shape = next(s["shape"] for s in td.templates.screw()["screw"].entry["shapes"] if s["name"] == "flight")
        triangles = geometry.read_triangles(shape["file"])
        edges = {}
        for t in triangles.round(6):
            for a, b in zip(t, np.roll(t, -1, axis=0)):
                edges[tuple(a), tuple(b)] = edges.get((tuple(a), tuple(b)), 0) + 1
        self.assertTrue(all(count == 1 and edges.get((b, a)) == 1 for (a, b), count in edges.items()))
        flat = math.sin(math.tau / 64) / (math.tau / 64)  # of a circle with 64 corners
        volume = geometry.volume({"type": "mesh", "file": shape["file"]})
        self.assertAlmostEqual(volume / (3 * .04 * math.pi * (.5**2 - .1**2) * flat), 1, 3)
        self.assertAlmostEqual(geometry.volume({**shape, "stretch": [.5, 2, 2]}) / volume, 2, 6)
        # The winding is outwards, and the front turns into +x: the velocity of the surface, x times r, is along its normal there.
        a, b, c = np.moveaxis(triangles, 1, 0)
        normal, middle = np.cross(b - a, c - a), (a + b + c) / 3
        self.assertGreater(np.einsum("ij,ij->", a, np.cross(b, c)), 0)
        speed = np.einsum("ij,ij->i", normal, np.cross([1, 0, 0], middle))
        front = normal[:, 0] > .5 * np.linalg.norm(normal, axis=1)
        self.assertGreater(front.sum(), 100)
        self.assertTrue((speed[front] > 0).all())

    def test_a_stretched_mesh_is_scaled_in_its_own_axes(self):
        s = td.Scene("a", 1)
        body = s.body("cube", shape={"type": "mesh", "file": str(self.file), "scale": 1e-3, "stretch": [2, 1, 1]}, density=1)
        body.rotate("z", math.pi / 2, about=(0, 0, 0))
        shape = body.entry["shapes"][0]["shape"]
        low, high = geometry.bounds_in(shape, None, None)
        np.testing.assert_allclose(high - low, [2, 2, 3], atol=1e-6)
        self.assertAlmostEqual(geometry.volume(shape), 12, 5)

    def test_scale_keeps_the_joint(self):
        body = self.bucket().scale(y=2)
        low, high = geometry.bounds_in(body.shapes[0]["shape"], None, None)
        np.testing.assert_allclose([low, high], [[0, -2, 0], [1, 2, 3]], atol=1e-6)

    def test_rotate_is_about_the_joint(self):
        body = self.bucket().rotate("y", td.deg(90))
        low, high = geometry.bounds_in(body.shapes[0]["shape"], None, None)
        # x - .5 -> z - 3 and z - 3 -> -(x - .5) of a rotation about +y: z' = 3 - (x - .5), x' = .5 + (z - 3)
        np.testing.assert_allclose([low, high], [[-2.5, -1, 2.5], [.5, 1, 3.5]], atol=1e-6)

    def test_boxes(self):
        s = td.Scene("s", 1)
        body = s.body("b", box=(1, 2, 3), density=1)
        body.scale(z=2, about=(0, 0, 1)).rotate("z", math.pi / 2, about=(1, 0, 0))
        shape = body.shapes[0]
        self.assertEqual(shape["shape"]["size"], [1, 2, 6])
        np.testing.assert_allclose(shape["position"], [1, -1, -1], atol=1e-12)
        low, high = geometry.bounds_in(shape["shape"], shape["position"], shape["orientation"])
        np.testing.assert_allclose(high - low, [2, 1, 6], atol=1e-12)
        ball = s.body("ball", sphere=1, density=1)
        with self.assertRaisesRegex(td.SceneError, "cannot be scaled along one axis"):
            ball.scale(x=2)
        self.assertEqual(ball.scale(-2).shapes[0]["shape"]["radius"], 2)  # mirrored, a ball is a ball
        hull = s.body("hull", shape={"type": "convex_hull", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]}, density=1)
        self.assertEqual(hull.scale(x=2, about=(0, 0, 0)).shapes[0]["shape"]["points"][1], [2, 0, 0])

    def test_what_is_no_factor_is_refused_at_the_call(self):
        s = td.Scene("s", 1)
        a = s.parameter("a", 1.)
        b = s.body("b", box=(1, 2, 3), density=1)
        field = s.body("field", shape={"type": "height_field", "size": [1, 1], "heights": [[0, 1], [0, 1]], "base": -1}, density=1)
        for call, wanted in ((lambda: b.scale(x=0), "x of b.scale.. is 0"), (lambda: b.scale(math.nan), "factor of .* is nan, which is not a finite number"),
                             (lambda: b.scale(z=math.inf), "z of .* is inf"), (lambda: b.scale(x="=a"), 'is the formula .=a.*stretch": ."=a"'),
                             (lambda: b.scale(x=a), "is the formula .=a"), (lambda: b.scale(x="2"), "x of b.scale.. is '2', which is no number"),
                             (lambda: b.scale(2, about=(0, math.nan, 0)), r"about.1. of b.scale.. is nan"),
                             (lambda: b.scale(2, about=(0, 0)), "three numbers"), (lambda: b.rotate("y", math.inf), "angle of b.rotate.. is inf"),
                             (lambda: b.rotate((0, 0, 0), 1), "no direction"), (lambda: field.scale(2), "height_field 'field' of body 'field' cannot"),
                             (lambda: s.body("c", box=(a, 1, 1), density=1).scale(x=2), "box 'c' of body 'c' has a formula")):
            with self.assertRaisesRegex(td.SceneError, wanted) as caught:
                call()
            self.assertIn(__file__, caught.exception.made_at)
        self.assertEqual(b.shapes[0]["shape"]["size"], [1, 2, 3])  # as it was

    def test_names_of_meshes_start_at_the_current_folder(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.file.parent)
        s = td.Scene("s", 1)
        grain = s.material("grain", density=2500, young=1e7)
        shape = {"type": "mesh", "file": self.file.name}
        wall = s.wall("a", shape=shape, material=grain)
        s.add("dem.walls", name="b", material="grain", shape=shape)
        s.body("c", shape=shape, density=1)
        os.chdir("/")
        self.assertEqual([wall.shape["file"], s["c"].shapes[0]["shape"]["file"]], [str(self.file)] * 2)
        os.chdir(self.file.parent)
        s.domain((0, 0, 0), (1, 1, 1))
        self.assertEqual(s.json().count(f'"{self.file}"'), 3)  # a run has another folder
        with self.assertRaisesRegex(td.SceneError, "no mesh file 'cub.stl'"):
            s.wall("d", shape={"type": "mesh", "file": "cub.stl"}, material=grain)


class Rotations(unittest.TestCase):
    def test_all_ways_to_say_it_agree(self):
        c, s = math.cos(.3), math.sin(.3)
        wanted = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        for said in ([math.cos(.15), 0, math.sin(.15), 0], {"axis": [0, 1, 0], "angle": .3}, {"axis": [0, 1, 0], "angle_deg": math.degrees(.3)},
                     {"euler": [0, .3, 0], "order": "xyz"}, {"euler_deg": [0, math.degrees(.3), 0], "order": "zyx"},
                     {"x_axis": [c, 0, -s], "z_axis": [s, 0, c]}, {"y_axis": [0, 2, 0], "z_axis": [s, 0, c]}):
            np.testing.assert_allclose(geometry.rotation(said), wanted, atol=1e-12)


if __name__ == "__main__":
    unittest.main()
