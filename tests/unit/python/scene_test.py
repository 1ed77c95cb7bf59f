#!/usr/bin/env python3
"""Scenes as objects: the JSON that they are, copies, references, and errors with the line of Python."""
import inspect
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import tandem as td


def here():
    return f"{__file__}:{inspect.currentframe().f_back.f_lineno}"


def digger():
    s = td.Scene("digger", end_time=4)
    gravel = s.material("gravel", density=2600, young=5e7, friction=.6, restitution=.3)
    arm = s.body("arm", box=(1, .1, .1), density=1000, at=(.5, 0, 1))
    s.revolute("pivot", "ground", arm, at=(0, 0, 1), axis="y")
    bed = s.box("bed", (1, .5, .8), at=(1, 0, .4), open="+z", material=gravel)
    s.fill(bed, gravel, radius=td.normal(.02, .003), height=.3, settle=True)
    return s


class Light(unittest.TestCase):
    def test_import_loads_nothing_heavy(self):
        code = "import sys, tandem as td; td.Scene; td.table; print(sorted(set(sys.modules) & {'numpy', 'h5py', 'matplotlib', 'pandas'}))"
        said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
        self.assertEqual(said.strip(), "[]")

    def test_wrong_name_of_the_package(self):
        with self.assertRaisesRegex(AttributeError, "no 'tabel'; did you mean 'table'"):
            td.tabel

    def test_everything_public_has_a_docstring(self):
        for name in td.__all__:
            value = getattr(td, name)
            self.assertTrue(value.__doc__, name)
            if inspect.isclass(value):
                for key, member in inspect.getmembers(value, lambda m: inspect.isfunction(m) or isinstance(m, property)):
                    if not key.startswith("_") and key not in ("as_json", "with_traceback"):
                        self.assertTrue(member.__doc__, f"{name}.{key}")


class Json(unittest.TestCase):
    def test_a_scene_prints_as_its_json(self):
        data = json.loads(str(digger()))
        self.assertEqual(data["tandem"], "1.1")
        self.assertEqual(data["mbd"]["joints"][0], {"name": "pivot", "type": "revolute", "child": "arm", "position": [0, 0, 1], "axis": [0, 1, 0]})
        group = data["dem"]["particles"][0]
        self.assertEqual(group["fill"], {"type": "packing", "region": {"type": "inside", "wall": "bed"}, "level": .3})
        self.assertEqual(group["sizes"], {"type": "normal", "mean": .02, "deviation": .003, "min": .014, "max": .026})
        self.assertAlmostEqual(data["dem"]["settle"]["kinetic_energy"], 1e-3 * 2600 * 4 / 3 * 3.14159 * .02**4 * 9.81, delta=1e-7)

    def test_objects_print_as_their_json(self):
        self.assertEqual(json.loads(str(digger()["pivot"]))["child"], "arm")

    def test_domain_follows_from_what_is_there(self):
        domain = json.loads(str(digger()))["dem"]["domain"]
        self.assertEqual(domain, {"min": [-.75, -1, -.75], "max": [2.25, 1, 1.8]})

    def test_height_is_from_the_lowest_point(self):
        s = digger()
        s["bed"].position = (1, 0, 2)
        part = s.fill("bed", "gravel", radius=.01, height=.1)
        self.assertAlmostEqual(part.fill["level"], 1.7)
        s["bed"].orientation = {"axis": [0, 1, 0], "angle_deg": 90}
        self.assertAlmostEqual(s.fill("bed", "gravel", radius=.01, height=.1).fill["level"], 1.6)

    def test_a_hopper_is_a_cone_and_a_tube(self):
        s = td.Scene("hopper", end_time=1)
        glass = s.material("glass", density=2500, young=1e7)
        s.wall("cone", cone=(.03, .1, .1), at=(0, 0, .05), open=["+z", "-z"], material=glass)
        s.fill({"type": "above", "wall": "cone"}, glass, radius=.005, height=.25)
        self.assertEqual(s.data["dem"]["walls"][0]["shape"],
                         {"type": "cone", "radius": .03, "top_radius": .1, "height": .1, "segments": 64, "open": ["+z", "-z"]})
        self.assertAlmostEqual(s.data["dem"]["particles"][0]["fill"]["level"], .25)
        with self.assertRaisesRegex(td.SceneError, "the lowest point of the region is not known"):
            s.fill({"type": "between", "walls": ["cone"]}, glass, radius=.005, height=.1)

    def test_save_and_load(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "s.json"
            digger().save(file)
            self.assertEqual(str(td.load(file)), str(digger()))

    def test_frames_are_whole_windows(self):
        for end, window in ((4, None), (.3, None), (100, .01), (.01, .002)):
            s = td.Scene("s", end, window=window)
            windows = s.data["output"]["frame_interval"] / (window or 1e-3)
            self.assertAlmostEqual(windows, round(windows), places=6)
            self.assertGreaterEqual(windows, 1)


class Bodies(unittest.TestCase):
    def test_shapes_have_a_density_only_where_they_give_the_mass(self):
        s = digger()
        s["arm"].wall("gravel", "plate", box=(1, 1, 1))
        self.assertEqual([shape["density"] for shape in s["arm"].shapes], [1000, 0])
        self.assertEqual([shape["use"] for shape in s["arm"].wall("gravel").shapes], ["wall", "wall"])
        heavy = s.body("heavy", box=(1, 1, 1), mass=3, inertia=(1, 1, 1)).wall("gravel").wall("gravel", sphere=1)
        self.assertFalse(any("density" in shape for shape in heavy.shapes))
        self.assertEqual([shape["name"] for shape in heavy.shapes], ["heavy", "heavy_2"])


class Copies(unittest.TestCase):
    def test_a_copy_is_independent(self):
        s = digger()
        v = s.copy()
        v["gravel"].friction = .1
        v["pivot"].damping = 3
        self.assertEqual((s["gravel"].friction, "damping" in s["pivot"]), (.6, False))
        self.assertEqual(v["gravel"].made_at, s["gravel"].made_at)

    def test_parameters(self):
        s = digger()
        width = s.parameter("width", .5, unit="m")
        s["bed"].shape["size"][1] = str(width * 2 - .1)
        self.assertEqual(s.copy().set(width=.7).data["parameters"]["width"]["value"], .7)
        self.assertEqual(s.data["parameters"]["width"]["value"], .5)
        with self.assertRaisesRegex(td.SceneError, "no parameter 'widht'; did you mean 'width'"):
            s.set(widht=1)
        with self.assertRaisesRegex(td.SceneError, "write s.end_time = 3"):
            s.set(end_time=3)

    def test_expressions_keep_their_meaning(self):
        a, b = td.Expression("a"), td.Expression("b")
        scope = {"a": 3.0, "b": 7.0}
        for made, value in ((a - b - 1, -5), (a - (b - 1), -3), (2 / (a + b), .2), (-(a + b) * 2, -20), ((a + 1)**2, 16), (1 - a, -2), (a - -2, 5)):
            self.assertAlmostEqual(eval(made.text.replace("^", "**"), {}, scope), value)


class Drives(unittest.TestCase):
    def test_a_stroke_gets_gains_from_the_largest_force(self):
        s = digger()
        lift = s.cylinder("lift", "ground", "arm", a=(.1, 0, .2), b=(.5, 0, 1), max_force=1000)
        lift.stroke = td.table([0, 1], [0, .1])
        self.assertEqual(lift.control, "stroke")
        self.assertEqual(lift.gains, {"proportional": 5e5, "derivative": 1e4})
        self.assertEqual(lift.target["values"], [0, .1])

    def test_a_stroke_without_force_and_gains_is_refused(self):
        lift = digger().cylinder("lift", "ground", "arm", a=(0, 0, 0), b=(.5, 0, 1))
        with self.assertRaisesRegex(td.SceneError, "max_force="):
            lift.stroke = 1

    def test_control_inputs(self):
        s = digger()
        motor = s.motor("motor", "pivot", max_torque=10)
        motor.speed = "wanted"
        self.assertEqual(motor.input, "wanted")
        self.assertNotIn("target", motor)


class Errors(unittest.TestCase):
    """Each says what, where, and the line of Python."""

    def check(self, pattern, call):
        with self.assertRaisesRegex(td.SceneError, pattern) as caught:
            call()
        self.assertTrue(caught.exception.made_at.startswith(__file__), caught.exception.made_at)

    def test_what_a_newcomer_writes(self):
        s = td.Scene("s", 1)
        r = s.parameter("r", .03)
        g = s.material("g", density=2500, young=1e7)
        bed = s.box("bed", (1, 1, 1), material=g)
        for pattern, call in (("the height is -1", lambda: s.fill(bed, g, radius=.1, height=-1)), ("the height is 'a'", lambda: s.fill(bed, g, radius=.1, height="a")),
                              ("settle is 'no'", lambda: s.fill(bed, g, radius=.1, settle="no")), ("name of the scene is 3", lambda: td.Scene(3, 1)),
                              ("cylinder= is 1 .give .radius, height", lambda: s.body("b", cylinder=1, density=1)),
                              ("cylinder= is .1, 2, 3.", lambda: s.body("b", cylinder=(1, 2, 3), density=1)),
                              ("shape= is 'box'", lambda: s.body("b", shape="box", density=1)), ("mesh= is 3", lambda: s.body("b", mesh=3, density=1)),
                              ("the mass is -1 .give kg above 0", lambda: s.body("b", mass=-1, box=(1, 1, 1))),
                              ("density does not follow", lambda: s.body("b", mass=1, box=(1, 1))), ("no key 'cone'", lambda: s.body("b", cone=1))):
            self.check(pattern, call)
        hinge = s.revolute("h", "ground", s.body("arm", mass=1, inertia=(1, 1, 1)), at=(0, 0, 0), axis="y")
        motor = s.motor("m", hinge, max_torque=5)
        for pattern, call in (("is no function of time .give a number, pairs", lambda: setattr(motor, "speed", [1, 2, 3])),
                              ("speed of 'm' is None", lambda: setattr(motor, "speed", None)), ("times of a table is 'abc'", lambda: td.table("abc", [1])),
                              ("gains of 'weak' do not follow: .* is -5", lambda: s.motor("weak", hinge, max_torque=-5)),
                              ("td.deg.. takes a number", lambda: td.deg("30")), ("deviation of td.normal.. is 0", lambda: td.normal(.1, 0)),
                              ("is that of ln.radius.", lambda: td.log_normal(1, 1000)), ("name of a parameter is 3", lambda: s.parameter(3, 1)),
                              ("arguments= is '--strict' .give a list of texts: arguments=.'--strict'", lambda: s.start(arguments="--strict")),
                              ("out= is 3", lambda: s.start(out=3)), ("controller= is 3", lambda: s.start(controller=3)),
                              ("file is None", lambda: td.load(None)), ("x.json: cannot be written", lambda: digger().save("/nowhere/x.json"))):
            self.check(pattern, call)
        self.assertEqual(s.motor("by_formula", hinge, max_torque=20 * r).gains, {"proportional": "=(20 * r) / 0.1"})
        # Formulas: the energy at rest and the spacing follow, a domain does not.
        s.fill(bed, g, radius=(.9 * r, 1.1 * r), height="=10*r", settle=True)
        self.assertRegex(s.data["dem"]["settle"]["kinetic_energy"], r"^=min\(.*0.9 \* r.*\^4, .*\)$")
        self.assertEqual(s.entries("dem.particles")[0]["fill"]["level"], "=(-0.5) + (10*r)")
        self.assertEqual(s.lattice(g, (0, 0, 0), (1, 1, 1), radius=r).fill["spacing"], "=2.2 * r")
        s.box("wide", (4 * r, 9, 9), material=g)
        self.check("domain does not follow from the scene: 'wide' has a formula", s.json)

    def test_a_material_of_the_library(self):
        s = td.Scene("s", 1)
        self.assertEqual(s.material("glass").entry, {"name": "glass"})
        self.assertEqual(s.material("own", density=1, young=1e7).poisson, .25)
        bed = s.box("bed", (1, 1, 1), material="glass")
        self.check("energy at rest of 'glass' does not follow: .* .give settle=", lambda: s.fill(bed, "glass", radius=.1, settle=True))

    def test_a_list_that_holds_a_text_is_left_to_the_program(self):
        s = td.Scene("s", 1)
        s.section("dem")["materials"] = ["steel"]
        self.assertEqual(list(s.parts()), [])
        self.assertIn("the value is", str(s.error_of("error: dem.materials[0]: the value is 'steel'")))

    def test_wrong_words(self):
        s = digger()
        self.check("no key 'dampin'; did you mean 'damping'", lambda: s.revolute("h", "ground", "arm", at=(0, 0, 0), axis="y", dampin=1))
        self.check("no key 'frictio'; did you mean 'friction'", lambda: setattr(s["gravel"], "frictio", 1))
        self.check("no wall 'bedd'; did you mean 'bed'", lambda: s.fill("bedd", "gravel", radius=.1))
        self.check("no mesh file 'bom.stl'", lambda: s.body("boom", mesh="bom.stl", density=1))
        self.check("'w' is no axis", lambda: s.revolute("h", "ground", "arm", at=(0, 0, 0), axis="w"))
        self.check("already one of the name 'arm', made at .*scene_test.py", lambda: s.body("arm", mass=1, inertia=(1, 1, 1)))
        self.check("neither mass and inertia nor a shape", lambda: s.body("b"))
        self.check("a scene has no 'gravty'; did you mean 'gravity'", lambda: setattr(s, "gravty", (0, 0, 0)))
        self.check("no list 'mbd.body'; did you mean 'mbd.bodies'", lambda: s.add("mbd.body", name="x"))
        self.check("2 times and 3 values", lambda: td.table([0, 1], [0, 1, 2]))
        self.check("needs a material", lambda: s["arm"].wall())
        with self.assertRaisesRegex(AttributeError, "no 'revolut'; did you mean 'revolute'"):
            s.revolut
        with self.assertRaisesRegex(KeyError, "no 'bedd'; did you mean 'bed'"):
            s["bedd"]
        s.sensor("gravel", box=(1, 1, 1))
        with self.assertRaisesRegex(KeyError, "is in dem.materials and dem.sensors"):
            s["gravel"]
        self.assertEqual(s["dem.materials", "gravel"].friction, .6)

    def test_the_line_of_what_the_program_names(self):
        s = digger()
        tie = s.spring("tie", "ground", "arm", a=(0, 0, 0), b=(1, 0, 1), length=-1); line = here()  # noqa: E702
        self.assertEqual(tie.made_at, line)
        for said in ("error: /tmp/s.json: mbd.forces[0].length: is -1", "error: force 'tie': its points meet"):
            error = s.error_of(said, "/tmp/s.json")
            self.assertEqual(error.made_at, line)
            self.assertNotIn("/tmp", str(error))


if __name__ == "__main__":
    unittest.main()
