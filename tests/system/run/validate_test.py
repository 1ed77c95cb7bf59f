#!/usr/bin/env python3
"""`tandem validate` and `tandem describe`: a run that is started dry refuses what a run refuses, and leaves nothing."""
import json
import os
import pathlib
import struct
import subprocess

import harness
from harness import Case, options

TETRAHEDRON = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
CORNERS = [(-300, -300, -300), (600, 0, -300), (0, 600, -300), (0, 0, 600)]  # mm


def binary_stl(triangles):
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *[x for corner in t for x in CORNERS[corner]], 0) for t in triangles)
    return b" " * 80 + struct.pack("<I", len(triangles)) + records


def running_in(folder):
    """Processes that work in that folder, as those that were started there do."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(process / "cwd") == str(folder) and harness.alive(process.name):
                found.append((process / "comm").read_text().strip())
        except OSError:
            continue
    return found


class Validate(Case):
    def say(self, *arguments, expect=0):
        before = sorted(self.folder.iterdir())
        result = subprocess.run([options.bin / "tandem", *arguments], capture_output=True, text=True, cwd=self.folder,
                                timeout=60 * options.slack)
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        self.assertEqual(running_in(self.folder), [], "the servers are gone")
        self.assertEqual(sorted(self.folder.iterdir()), before, "no file and no folder is left")
        return result.stdout + result.stderr

    def write(self, scene, name="scene.json"):
        (self.folder / name).write_text(json.dumps(scene))
        return name

    def hanging_box(self):
        return json.loads((harness.SCENES / "hanging_box.json").read_text())

    def same_as_run(self, scene, said):
        """A run refuses the scene with the same words."""
        name = self.write(scene)
        validated = self.say("validate", name, expect=2)
        self.assertRegex(validated, said)
        words = validated.split("error: ")[1].split(f"{name}: ")[-1].strip()
        self.assertIn(words, self.run_scene(self.folder / name, expect=2))
        self.assertRegex(self.say("validate", "--files-only", "scene.json"), "scene.json: ok", "only solvers know")

    def test_a_scene_that_runs(self):
        said = self.say("validate", harness.SCENES / "hanging_box.json", harness.SCENES / "pendulum.json")
        self.assertEqual(said.count(": ok\n"), 2, said)
        self.assertEqual(len(said.splitlines()), 2, "nothing else to say")

    def test_a_controller_that_a_run_needs(self):
        scene = json.loads((harness.SCENES / "pendulum.json").read_text())
        hinge = scene["mbd"]["joints"][0]["name"]
        scene["mbd"]["forces"] = [{"name": "motor", "type": "actuator", "joint": hinge, "input": "torque"}]
        said = self.say("validate", self.write(scene))
        self.assertRegex(said, "scene.json: ok with --controller PROGRAM, without which a run is refused\n")
        self.assertRegex(said, "note: a run needs --controller PROGRAM, .*inputs torque")

    def test_spheres_inside_a_wall(self):
        scene = self.hanging_box()
        scene["dem"]["particles"][0]["fill"]["min"][0] = -0.14
        scene["dem"]["particles"][0]["fill"]["max"][0] = 0.06
        self.same_as_run(scene, r"error: scene.json: .*'balls': sphere .* overlaps wall 'inside'.*move the fill or the wall")

    def test_a_loop_that_does_not_close(self):
        scene = json.loads((harness.SCENES / "two_links.json").read_text())
        last = scene["mbd"]["bodies"][-1]["name"]
        scene["mbd"]["joints"].append({"name": "rod", "type": "distance", "parent": "ground", "child": last,
                                       "position": [100, 0, 0], "child_position": scene["mbd"]["bodies"][-1]["position"],
                                       "length": 1})
        self.same_as_run(scene, r"error: .*rod")

    def test_a_server_that_is_missing(self):
        alone = self.folder / "bin"
        alone.mkdir()
        (alone / "tandem").write_bytes((options.bin / "tandem").read_bytes())
        (alone / "tandem").chmod(0o755)
        result = subprocess.run([alone / "tandem", "validate", harness.SCENES / "pendulum.json"], capture_output=True,
                                text=True, timeout=60)
        self.assertEqual(result.returncode, 5, result.stdout + result.stderr)
        self.assertRegex(result.stderr, "mbd_server: cannot be started")

    def test_warnings_and_notes(self):
        scene = self.hanging_box()
        (self.folder / "in_mm.stl").write_bytes(binary_stl(TETRAHEDRON[:3]))
        scene["dem"]["walls"].append({"name": "floor", "material": "glass", "shape": {"type": "mesh", "file": "in_mm.stl"}})
        scene["mbd"]["bodies"].append({"name": "pallet", "mass": 1, "inertia": [1, 1, 1], "position": [0, 0, 0.5]})
        scene["dem"]["walls"].append({"name": "deck", "body": "pallet", "material": "glass",
                                      "shape": {"type": "box", "size": [0.3, 0.3, 0.02]}})
        inlet = {"type": "inlet", "min": [-0.1, -0.1, 0.1], "max": [0.1, 0.1, 0.2], "rate": 1, "start": 1000}
        scene["dem"]["particles"].append(dict(scene["dem"]["particles"][0], name="late", fill=inlet))
        name = self.write(scene)
        said = self.say("validate", name)
        for line in ['warning: wall "floor" is 900 m wide, .* in a domain of 2 m.*: is the file in mm.* "scale": 0.001',
                     'warning: inlet .late. starts at 1000 s', 'note: wall "floor" is not closed: .*an opening of 3 edges',
                     'note: walls act on spheres only: body "pallet" can pass through wall "floor" of the ground']:
            self.assertRegex(said, "\n  " + line)
        described = self.say("describe", name)
        self.assertRegex(described, r"floor +in_mm.stl +1 +\(900, 900, 900\) +3 +3 +1 +0 +0 ")
        self.assertRegex(described, r"\nsolver: 64 spheres in all, on ")
        self.assertRegex(described, '\nwarning: wall "floor" is 900 m wide')
        self.run_scene(self.folder / name)
        summary = self.summary()
        self.assertRegex("\n".join(summary["warnings"]), 'wall "floor" is 900 m wide')
        mesh = summary["meshes"][0]
        self.assertEqual((mesh["wall"], mesh["size_m"], mesh["open_edges"], mesh["volume_m3"]),
                         ("floor", [900, 900, 900], 3, None))

    def test_a_mesh_that_is_cut_off(self):
        scene = self.hanging_box()
        (self.folder / "cut.stl").write_bytes(binary_stl(TETRAHEDRON)[:150])
        scene["dem"]["walls"].append({"name": "floor", "material": "glass", "shape": {"type": "mesh", "file": "cut.stl"}})
        self.assertRegex(self.say("validate", self.write(scene), expect=2),
                         r"cut.stl: the binary STL file is cut off: for the 4 triangles of its header it should have 284 "
                         r"bytes, and has 150, enough for 1")

    def test_degrees_of_freedom_are_never_less_than_none(self):
        scene = json.loads((harness.SCENES / "pendulum.json").read_text())
        scene["mbd"]["joints"].append(dict(scene["mbd"]["joints"][0], name="second"))
        name = self.write(scene)
        self.assertRegex(self.say("describe", name),
                         r"degrees of freedom: 1; redundant equations of closed loops, 5: .*second")
        self.assertRegex(self.say("describe", "--files-only", name),
                         r"degrees of freedom: at least 0: 6 for each of 1 bodies, less 10 equations of joints and "
                         r"couplers give -4, so that at least 4 equations are redundant")


if __name__ == "__main__":
    harness.main()
