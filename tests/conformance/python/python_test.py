#!/usr/bin/env python3
"""The Python package of the participant kit.

usage: python_test.py SOURCES BIN CC [CASE...]
"""
import csv
import ctypes
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCES, BIN, CC = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
sys.path.insert(0, str(SOURCES / "python"))
import numpy as np  # noqa: E402

from tandem import layout  # noqa: E402

PYTHON = sys.executable


def fields(record, prefix="", offset=0):
    """All fields with the offset and size that Python has for them."""
    if isinstance(record, np.dtype):
        for name in record.names:
            inner, start = record.fields[name][:2]
            yield prefix + name, offset + start, inner.itemsize
            if inner.names:
                yield from fields(inner, f"{prefix}{name}.", offset + start)
    else:
        for name, *_ in record._fields_:
            yield prefix + name, offset + getattr(record, name).offset, getattr(record, name).size


class Case(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def tandem(self, scene, *arguments, expect=0, out="out"):
        said = subprocess.run(
            [BIN / "tandem", "run", scene, "--out", self.folder / out, "--no-picture", "--no-report", *arguments],
            capture_output=True, text=True, timeout=240, check=False)
        self.assertEqual(said.returncode, expect, said.stdout + said.stderr)
        return said.stdout + said.stderr

    def project(self, side):
        """Scene and option of a new project from the template."""
        folder = self.folder / f"py_{side}"
        subprocess.run([BIN / "tandem", "new", "participant", folder.name, "--language", "python", "--role", side, "--out",
                        folder], check=True, capture_output=True)
        return folder / "scene.json", f"--{side}-server", f"{PYTHON} {folder}/main.py"

    def last(self, out):
        """The last row of the bodies."""
        with open(self.folder / out / "bodies.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))[-1]


class Layout(Case):
    def test_records_are_those_of_the_header(self):
        ours, lines = [], []
        for name, record in layout.RECORDS.items():
            size = record.itemsize if isinstance(record, np.dtype) else ctypes.sizeof(record)
            ours.append(f"{name} {size}")
            lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
            for field, offset, length in fields(record):
                ours.append(f"{name}.{field} {offset} {length}")
                lines.append(f'printf("{name}.{field} %zu %zu\\n", offsetof({name}, {field}), sizeof((({name}*)0)->{field}));')
        source = self.folder / "layout.c"
        source.write_text("#include <stdio.h>\n#include <tandem/participant.h>\nint main(void) {\n" + "\n".join(lines) + "\n}\n")
        subprocess.run([CC, "-I", SOURCES / "participant/include", source, "-o", self.folder / "layout"], check=True)
        header = subprocess.run([self.folder / "layout"], capture_output=True, text=True, check=True).stdout.splitlines()
        self.assertEqual(ours, header)


class Sentences(Case):
    """A solver that does what the environment says from its third window on."""
    SOLVER = '''
import os
import numpy as np
from tandem import participant

class Faulty(participant.LoadSolver):
    features = ["contact:hooke", "wall:plane"]
    follows_path = window_mean = True
    window = 0

    def configure(self, c):
        assert c.bodies[0].name == "plate" and c.bodies[0].inertia.shape == (3, 3) and c.scene["name"] == "py_dem"
        assert len(c.walls) == 5 and c.walls[0].body == 0 and c.walls[1].body == participant.GROUND
        assert c.pair(0, 0).spring_stiffness == 12000 and c.spheres.position.shape == (64, 3)
        self.spheres = c.spheres
        exec(os.environ.get("AT_CONFIGURE", ""))
        return {"answer": 42, "text": "as given"}

    def advance(self, motion, loads):
        self.window += 1
        if self.window >= 3:
            exec(os.environ.get("IN_WINDOW", ""))
        loads.account["micro_steps"], loads.account["micro_step"] = 10, motion.window.length / 10

    def observe(self):
        s = self.spheres
        return np.arange(len(s.radius)), s.position, s.velocity, np.zeros_like(s.position), s.radius

    def save(self): pass
    def restore(self): pass

participant.run(Faulty(), "faulty", "2.5")
'''

    def setUp(self):
        super().setUp()
        self.scene = self.project("dem")[0]
        # Without gravity the spheres stay where they start, and the solver's zeros are right.
        scene = json.loads(self.scene.read_text())
        scene["gravity"] = [0, 0, 0]
        self.scene.write_text(json.dumps(scene))

    def said(self, expect, *arguments, solver=SOLVER, **environment):
        (self.folder / "faulty.py").write_text(solver)
        os.environ.update(environment)
        try:
            return self.tandem(self.scene, "--end-time", "0.01",
                               "--dem-server", f"{PYTHON} {self.folder}/faulty.py", *arguments, expect=expect)
        finally:
            for name in environment:
                del os.environ[name]

    def test_facts_reach_the_summary(self):
        self.said(0, AT_CONFIGURE="self.warn('it is a test')")
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual((summary["dem_answer"], summary["dem_text"]), (42, "as given"))
        self.assertIn("it is a test", summary["warnings"])
        self.assertEqual(summary["dem_server"]["program"], "faulty 2.5")

    def test_an_error_keeps_its_parts(self):
        said = self.said(2, AT_CONFIGURE="raise participant.Error('is 3', 'dem.walls', 'write 4')")
        self.assertRegex(said, r"(?s)dem\.walls: is 3.*write 4")
        said = self.said(3, IN_WINDOW="raise participant.Error('diverged', 'here', None, participant.NUMERICS)")
        self.assertRegex(said, "here: diverged")

    def test_any_exception_names_type_and_line(self):
        said = self.said(70, IN_WINDOW="{}['key']")
        self.assertRegex(said, r"advance: <string>:1, in <module>.*KeyError: 'key'")
        self.assertIn("faulty.py", (self.folder / "out/run.log").read_text(), "the whole traceback")

    def test_records_of_the_library_are_not_copies_and_inputs_are_read_only(self):
        self.said(0, IN_WINDOW="loads.bodies['mean']['force'][0] = 1, 2, 3")
        last = self.last("out")
        self.assertEqual([float(last[f"plate.contact_force.{axis}"]) for axis in "xyz"], [1, 2, 3])
        said = self.said(70, IN_WINDOW="motion.bodies['end_pose']['position'] = 0")
        self.assertRegex(said, "ValueError: assignment destination is read-only")

    def test_values_are_checked(self):
        said = self.said(3, IN_WINDOW="loads.bodies['mean']['force'][0] = np.nan")
        self.assertRegex(said, "mean.force is .*nan.* not finite")

    def test_capabilities_follow_from_the_methods(self):
        self.said(0, "--scheme", "implicit")
        said = self.said(2, "--scheme", "linear_implicit")
        self.assertRegex(said, "linearise")
        said = self.said(4, solver=self.SOLVER.replace("    def restore(self): pass\n", ""))
        self.assertRegex(said, r"Faulty has no restore\(\), which belongs to save and restore")


    def test_facts_have_names_and_limits(self):
        for key in "", "a b", "summary.x", "\u00e9", "x" * 101:
            with self.subTest(key):
                said = self.said(70, solver=self.SOLVER.replace('"answer"', repr(key)))
                self.assertRegex(said, r'a fact has the key ".*"; a key is 1 to 100 letters')
        said = self.said(70, solver=self.SOLVER.replace('"answer": 42', '**{f"x{i}": i for i in range(300000)}'))
        self.assertIn("there are more than 20000 facts", said)
        said = self.said(4, solver=self.SOLVER.replace('"as given"', '"x" * 5_000_000'))
        self.assertRegex(said, r"sent facts of 500\d{4} bytes, more than 4194304")
        said = self.said(3, solver=self.SOLVER.replace("42", "float('nan')"))
        self.assertRegex(said, r'dem_server: the fact "answer" is nan, not finite')

    def test_spins_at_the_start_reach_solvers_that_know_them(self):
        scene = json.loads(self.scene.read_text())
        low = scene["dem"]["particles"][0]["fill"]["min"]
        rows = ["x,y,z,radius,wx,wy,wz"]
        for i in range(64):
            x, y, z = (low[a] + 0.02 * (i // 4**a % 4) for a in range(3))
            rows.append(f"{x},{y},{z},0.005,0,{i},0.5")
        (self.scene.parent / "spinning.csv").write_text("\n".join(rows) + "\n")
        group = scene["dem"]["particles"][0]
        scene["dem"]["particles"] = [{"name": group["name"], "material": group["material"],
                                      "fill": {"type": "file", "file": "spinning.csv"}}]
        scene.pop("checks", None)
        self.scene.write_text(json.dumps(scene))
        said = self.said(2)
        self.assertRegex(said, "the scene asks for particles.spin, which faulty 2.5 does not know")
        said = self.said(2, AT_CONFIGURE="raise participant.Error('spin %s' % c.spheres.spin[7].tolist())",
                         solver=self.SOLVER.replace('["contact:hooke"', '["particles.spin", "contact:hooke"'))
        self.assertIn("spin [0.0, 7.0, 0.5]", said)

    def test_a_negative_number_of_particles_is_named(self):
        said = self.said(70, solver=self.SOLVER.replace(
            "participant.run(", "participant._LoadCalls.observe = lambda self, frame: setattr(frame.contents, 'count', 2**64 - 1)\nparticipant.run("))
        self.assertRegex(said, r"observe: count: is -1")

    def test_text_before_run_on_a_stream_is_quoted(self):
        for text in "loading the deck\\n", "hi\\n":
            said = self.said(4, "--transport", "stream",
                             solver=self.SOLVER.replace("participant.run(", f"print('{text}', end='', flush=True)\nparticipant.run("))
            self.assertRegex(said, r"dem_server '.*faulty.py' wrote text to the channel, which is its standard output: \"" + text[:2])

    def test_features_are_a_list(self):
        said = self.said(4, solver=self.SOLVER.replace('["contact:hooke", "wall:plane"]', '"joint:*"'))
        self.assertRegex(said, r"Faulty\.features is 'joint:\*'; write a list of names")


class Helpers(unittest.TestCase):
    """The geometry and the sums that the package does for a solver."""

    def test_touches_counts_a_face_once_and_an_edge_between_two(self):
        from types import SimpleNamespace
        from tandem.spheres import touches
        corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
        wall = SimpleNamespace(shape="mesh", triangles=corners[[[0, 1, 2], [0, 2, 3]]])
        x = np.array([[0.5, 0.5, 0.09], [1.06, 0.5, 0.06], [0.2, 0.7, 0.2]])  # on the common edge, beside the rim, above
        (i, point, normal, overlap), = touches(wall, x, np.full(3, 0.1))
        self.assertEqual(i.tolist(), [0, 1])
        np.testing.assert_allclose(point, [[0.5, 0.5, 0], [1, 0.5, 0]])
        np.testing.assert_allclose(normal, [[0, 0, 1], [0.5**0.5, 0, 0.5**0.5]])
        np.testing.assert_allclose(overlap, [0.01, 0.1 - 0.06 * 2**0.5])
        plane = SimpleNamespace(shape="plane", point=np.zeros(3), normal=np.array([0.0, 0, 1]))
        (i, point, normal, overlap), = touches(plane, x, np.full(3, 0.1))
        self.assertEqual((i.tolist(), overlap.round(12).tolist()), ([0, 1], [0.01, 0.04]))

    def test_the_sum_over_a_window_has_mean_moment_and_work(self):
        from types import SimpleNamespace
        from tandem.sets import Frame, WindowSum
        loads = SimpleNamespace(window=SimpleNamespace(length=2.0), bodies=np.zeros(1, layout.BODY_LOAD))
        loads.bodies["body"] = 7
        total = WindowSum(loads)
        for t, share in ((0, 0.5), (1, 1), (2, 0.5)):  # the force grows with the time, at a lever of 3 m
            total.clear()
            total.add(7, np.array([[0.0, 3, 0]]), np.array([[float(t), 0, 0]]))
            total.step(t, share, {7: Frame(None, None, np.array([2.0, 0, 0]), np.array([0, 0, 1.0]))})
        total.write()
        body = loads.bodies[0]
        self.assertEqual(body["mean"]["force"].tolist(), [1, 0, 0])
        self.assertEqual(body["mean"]["torque"].tolist(), [0, 0, -3])
        self.assertEqual(body["end"]["force"].tolist(), [2, 0, 0])
        self.assertEqual(body["first_moment"]["force"].tolist(), [0.5, 0, 0])
        self.assertEqual(body["work"], 2 * 2 - 6)


class Templates(Case):
    def test_free_bodies_move_as_ours(self):
        path, *foreign = self.project("mbd")
        scene = json.loads(path.read_text())
        # A fifth of the template's time; the spheres rebound at once.
        scene["end_time"] = t = 0.06
        for check, expected in zip(scene["checks"], (t - 9.81 * t**2 / 2, -3.0610873110 + 9.81 * (0.3 - t))):
            if not check.get("absolute"):  # window and step leave as many m/s as after the whole time
                check.update(tolerance=check["tolerance"] * abs(check["expected"]), absolute=True)
            check["expected"] = expected
        path.write_text(json.dumps(scene))
        rows = []
        for out, server in (("ours", []), ("theirs", foreign)):
            self.tandem(path, *server, out=out)
            rows.append([float(value) for key, value in self.last(out).items() if key.startswith("plate.")])
            summary = json.loads((self.folder / out / "summary.json").read_text())
            self.assertTrue(all(check["passed"] for check in summary["checks"]), summary["checks"])
        plate = np.array(rows)[:, :7]
        print(f"pose of the plate, largest difference to ours: {np.max(np.abs(plate[0] - plate[1])):.2g}")
        np.testing.assert_allclose(plate[1], plate[0], atol=1e-3)

    def test_spheres_weigh_what_they_weigh(self):
        scene, *foreign = self.project("dem")
        self.tandem(scene, *foreign)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertTrue(all(check["passed"] for check in summary["checks"]), summary["checks"])
        print(f"momentum balance {summary['momentum_balance']:.2g}")
        self.assertLess(abs(summary["momentum_balance"]), 1e-12)

    def test_a_liquid_weighs_what_it_weighs(self):
        scene, *foreign = self.project("sph")
        self.tandem(scene, *foreign)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertTrue(all(check["passed"] for check in summary["checks"]), summary["checks"])
        self.assertEqual(summary["sph"]["method"], "one mass on a spring, velocity Verlet")

    def test_a_liquid_gives_what_it_promises(self):
        scene, *foreign = self.project("sph")
        source = self.folder / "py_sph/main.py"
        text = source.read_text()
        for old, new, why in (
                ("self.pressure, self.density)", "self.pressure)", "returned 4 arrays, not id, position, velocity, pressure, density"),
                ("= observes_liquid = True", "= True", "returned 5 arrays, not id, position, velocity"),
                ("np.tile(self.v, (n, 1))", "self.v", r"velocity has the shape \(3,\), not \(216, 3\)")):
            self.assertIn(old, text)
            source.write_text(text.replace(old, new))
            self.assertRegex(self.tandem(scene, *foreign, expect=70), why)

    def test_what_a_liquid_does_not_know_is_refused(self):
        path, *foreign = self.project("sph")
        scene = json.loads(path.read_text())
        scene["sph"]["liquids"][0]["fill"] = [{"type": "inside", "wall": "sides", "level": 0}]
        path.write_text(json.dumps(scene))
        self.assertRegex(self.tandem(path, *foreign, expect=2),
                         r"sph\.liquids 'water': the scene asks for liquid.inside, which py_sph 0.1 does not know")

    def test_what_a_liquid_cannot_show_ends_the_run(self):
        path, *foreign = self.project("sph")
        text = path.read_text()
        for changes, why in (({'"length": 0.4867': '"length": 0.8'}, "the liquid: would leave its vessel"),
                             ({"[0, 0, 1]": "[0, 1, 0]", "prismatic": "revolute", '"point_b": [0, 0, 0]': '"point_b": [0.1, 0, 0]'},
                              "the body with the walls: turns by more than 0.1 rad"),
                             ({"-0.3]": "-0.1001]", '"length": 0.4867': '"length": 0.497'}, "sph.domain: leaves the domain")):
            scene = text
            for old, new in changes.items():
                self.assertIn(old, scene)
                scene = scene.replace(old, new)
            path.write_text(scene)
            self.assertRegex(self.tandem(path, *foreign, expect=3), why)

    def test_a_start_that_it_does_not_know_is_refused(self):
        scene = self.project("dem")[0]  # with a plate on a spring
        text = json.loads(scene.read_text())
        text["mbd"]["start"] = "equilibrium"
        scene.write_text(json.dumps(text))
        said = self.tandem(scene, *self.project("mbd")[1:], expect=2)
        self.assertRegex(said, "the scene asks for joint:prismatic, .*start.equilibrium.*, which py_mbd 0.1 does not know")

    def test_an_iterated_scheme(self):
        for side in ("mbd", "dem", "sph"):
            scene, *foreign = self.project(side)
            self.tandem(scene, *foreign, "--scheme", "implicit", "--end-time", "0.05")
            self.assertEqual(json.loads((self.folder / "out/summary.json").read_text())["status"], "ok")

    def test_lost_spheres_are_counted_once_in_repeated_windows(self):
        path, *foreign = self.project("dem")
        scene = json.loads(path.read_text())
        del scene["checks"]
        floor = scene["dem"]["walls"][0]
        floor["shape"], floor["position"] = {"type": "box", "size": [0.1, 0.1, 0.02]}, [0, 0, -0.01]
        scene["dem"]["walls"] = [floor]  # the others kept the spheres on the plate
        scene["dem"]["domain"] = {"min": [-0.07, -0.06, -0.05], "max": [0.07, 0.06, 0.6]}
        path.write_text(json.dumps(scene))
        self.tandem(path, *foreign, "--scheme", "implicit", "--end-time", "0.4")
        summary = json.loads((self.folder / "out/summary.json").read_text())
        print(f"{summary['lost_particles']} lost, momentum balance {summary['momentum_balance']:.2g}")
        self.assertGreater(summary["lost_particles"], 10)
        self.assertLess(abs(summary["momentum_balance"]), 1e-12)
        counts = re.findall(r'TopologyType="Polyvertex" NumberOfElements="(\d+)"', (self.folder / "out/particles.xdmf").read_text())
        self.assertEqual(int(counts[-1]), 64 - summary["lost_particles"])


class Liquids(Case):
    """The judge's checks of inlets and outlets, on a liquid that flies freely and on one with a fault."""
    SOLVER = '''
import numpy as np
from tandem import participant

class Flight(participant.LiquidSolver):
    features = ["outlet", "liquid.inlet"]
    follows_path = window_mean = True

    def configure(self, c):
        liquid, s, sph = c.liquids[0], c.spacing, c.scene["sph"]
        self.s, self.mass = s, liquid.density * s**3
        axes = lambda box: [np.arange(a + s / 2, b, s) for a, b in box.T]
        self.x = np.concatenate([np.stack(np.meshgrid(*axes(b)), -1).reshape(-1, 3) for b in liquid.boxes])
        self.v = np.tile(liquid.velocity, (len(self.x), 1))
        self.id, self.layers = np.arange(len(self.x)), 0
        self.inlet, self.drain = sph.get("inlets"), sph.get("outlets")

    def advance(self, motion, loads):
        H, account = motion.window.length, loads.account
        account["micro_steps"], account["micro_step"] = 1, H
        account["momentum_begin"] = self.mass * self.v.sum(0)
        self.x = self.x + H * self.v
        if self.drain:
            out = self.x[:, 0] > self.drain[0]["region"]["point"][0]
            account["lost_momentum"] = self.mass * self.v[out].sum(0)
            self.x, self.v, self.id = self.x[~out], self.v[~out], self.id[~out]
        if self.inlet and motion.window.end * 1e-9 * 0.5 > (self.layers + 1) * self.s:
            self.layers += 1
            y, z = np.meshgrid((np.arange(7) - 3) * self.s, (np.arange(3) - 1) * self.s)
            layer = np.stack([np.full(21, 0.1), y.ravel(), z.ravel()], -1)
            self.x, self.id = np.concatenate([self.x, layer]), np.arange(len(self.id) + 21)
            self.v = np.concatenate([self.v, np.tile([0.5, 0, 0], (21, 1))])
            account["lost_momentum"] = [-21 * self.mass * 0.5, 0, 0]
        account["momentum_end"] = self.mass * self.v.sum(0)
        account["kinetic_energy"] = self.mass * np.sum(self.v**2) / 2

    def observe(self):
        return self.id, self.x, self.v

participant.run(Flight(), "flight", "1")
'''

    def judged(self, old="", new=""):
        """The outcomes of both checks with this change of the solver."""
        self.assertIn(old, self.SOLVER)
        (self.folder / "flight.py").write_text(self.SOLVER.replace(old, new) if old else self.SOLVER)
        said = subprocess.run([BIN / "tandem", "conform", f"{PYTHON} {self.folder}/flight.py", "--role", "sph", "--check", "liquid_inlet",
                               "--check", "liquid_outlet"], capture_output=True, text=True, timeout=120, check=False,
                              env={**os.environ, "PYTHONPATH": str(SOURCES / "python")})
        print(said.stdout)
        return [line.split()[0] for line in said.stdout.splitlines()[:2]]

    def test_a_liquid_without_a_fault_passes(self):
        self.assertEqual(self.judged(), ["PASS", "PASS"])

    def test_faults_are_found(self):
        for old, new, inlet, outlet in (
                ('account["lost_momentum"] = self.mass * self.v[out].sum(0)', "pass", "PASS", "FAIL"),
                ('account["lost_momentum"] = [-21 * self.mass * 0.5, 0, 0]', "pass", "FAIL", "PASS"),
                ("self.id[~out]", "self.id[:len(self.id) - out.sum()]", "PASS", "FAIL"),
                ("> self.drain[0]", "- 0.1 > self.drain[0]", "PASS", "FAIL"),
                ("* 1e-9 * 0.5 >", "* 1e-9 * 0.2 >", "FAIL", "PASS"),
                ("np.arange(7) - 3) * self.s, (np.arange(3) - 1)", "np.arange(3) - 1) * self.s, (np.arange(7) - 3)", "FAIL", "PASS"),
                ("np.full(21, 0.1)", "np.full(21, 0.2)", "FAIL", "PASS"),
                ("np.tile([0.5, 0, 0]", "np.tile([0, 0, 0.5]", "FAIL", "PASS"),
                ('account["kinetic_energy"]', 'account["lost_particles"] = 1; account["kinetic_energy"]', "FAIL", "FAIL")):
            with self.subTest(new):
                self.assertEqual(self.judged(old, new), [inlet, outlet])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
