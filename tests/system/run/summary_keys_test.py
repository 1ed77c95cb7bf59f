#!/usr/bin/env python3
"""The numbers of summary.json that checks may name are those that runs write: common/scene/figures.def."""
import json
import os
import pathlib
import re
import subprocess

import fill_test
import harness
from harness import SCENES, Case, options

ROOT = pathlib.Path(__file__).resolve().parents[3]
SHIPPED = ROOT / "launch" / "scenes"
# Written after the checks have been evaluated.
LATER = {"exit_status"}
# Of runs on a GPU, and of machines and collisions that no scene below has.
RARE = {"resident_regions", "mbd_assembly.distance_m", "mbd_misfit.share", "advised_micro_step_s",
        "border.BODY.stable_omega_H", "border.BODY.stable_window_s", "border.BODY.growth_per_window",
        "mbd_position_error_estimate_m", "mbd_position_error_estimate", "mbd_rotation_error_estimate_rad",
        "mbd_energy_error_estimate_J"}


def numbers(value, path=""):
    """Paths of all numbers; lists have none."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, f"{path}.{key}" if path else key)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield path


class SummaryKeys(Case):
    def setUp(self):
        super().setUp()
        table = (ROOT / "common" / "scene" / "figures.def").read_text()
        self.known = set(re.findall(r'^(?:NUMBER|COORDINATOR_KEY)\((?!none)\w+, "([^"]+)"', table, re.M))
        for solver, key in re.findall(r'^(\w+)_FACT\(\w+, (?:Count|Number|Estimate), \w+, "([^"]+)"', table, re.M):
            prefix = "sph." if solver == "SPH" else f"{solver.lower()}_" if key == "solver_seconds" else ""
            self.known.add(prefix + key)
        self.seen = set()

    def look_at(self, scene, *arguments, out="out"):
        """Runs the scene, and gives `validate` a check of each number that the run has written."""
        path = scene
        if isinstance(scene, dict):
            path = self.folder / "scene.json"
            path.write_text(json.dumps(scene))
        else:
            scene = json.loads(pathlib.Path(scene).read_text())
        process = self.start(path, *arguments, out=self.folder / out)
        said = process.communicate(timeout=120 * options.slack)
        self.assertIn(process.returncode, (0, 1), said)
        written = [key for key in numbers(self.summary(self.folder / out))
                   if key not in LATER and not key.startswith("verdict.")]
        self.assertGreater(len(written), 40)
        scene["checks"] = [{"name": key, "of": f"summary.{key}", "expected": 0, "tolerance": 1, "absolute": True}
                           for key in written]
        checked = self.folder / "checked.json"
        checked.write_text(json.dumps(scene))
        result = subprocess.run([options.bin / "tandem", "validate", "--files-only", checked], capture_output=True,
                                text=True)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        for key in written:
            key = re.sub(r"^border\.[^.]+", "border.BODY", key)
            key = re.sub(r"^belts\.[^.]+", "belts.WALL", key)
            key = re.sub(r"^elements\..+\.", "elements.COLUMN.", key)
            key = re.sub(r"^sensors\..+\.", "sensors.SENSED.", key)
            key = re.sub(r"^inlets\.[^.]+", "inlets.INLET", key)
            key = re.sub(r"^fills\.[^.]+\.void_fraction", "fills.PACKING.void_fraction", key)
            key = re.sub(r"^fills\.[^.]+\.(spheres|mass_kg)", r"fills.FILL.\1", key)
            key = re.sub(r"^sph\.inlets\.[^.]+", "sph.inlets.FEED", key)
            key = re.sub(r"^sph\.outlets\.[^.]+", "sph.outlets.DRAIN", key)
            self.seen.add(re.sub(r"^outlets\.[^.]+", "outlets.OUTLET", key))

    def test_the_list_is_what_runs_write(self):
        box = json.loads((SCENES / "hanging_box.json").read_text())
        box["dem"]["start_overlap"] = "relax"
        box["coupling"]["adaptive"] = {"energy_tolerance": 1e-2, "path_tolerance": 1e-5, "min_window": 1e-5,
                                       "max_window": 1e-3}
        balls = box["dem"]["particles"][0]
        box["dem"]["particles"].append({
            **balls, "name": "rain", "fill": {"type": "inlet", "min": [-0.1, -0.1, 0.5], "max": [0.1, 0.1, 0.6],
                                              "rate": 100, "count": 3}})
        box["dem"]["outlets"] = [{"name": "drain",
                                  "region": {"type": "box", "min": [-1, -1, -1], "max": [1, 1, -0.9]}}]
        box["dem"]["walls"][0]["surface_velocity"] = [0.1, 0, 0]
        box["dem"]["sensors"] = [{"name": "inside", "body": "box", "flow": "z", "shape": {"type": "box", "size": [0.2, 0.2, 0.2]}}]
        box.setdefault("output", {})["dissipation"] = True
        self.look_at(box, "--end-time", "0.03", "--checkpoint-every", "1", out="first")
        self.look_at(box, "--end-time", "0.05", "--restart", self.folder / "first", out="second")
        self.look_at(SCENES / "pendulum.json", out="pendulum")
        self.look_at(SCENES / "box_on_floor.json", "--end-time", "0.01", out="contact")
        wheel = json.loads((SCENES / "rules.json").read_text())["scenes"]["wheel_with_rim"]
        self.look_at(wheel, "--end-time", "0.01", out="wheel")
        self.look_at(SHIPPED / "stiff" / "undamped_contact.json", "--end-time", "0.01", out="plate")
        os.environ["TANDEM_CACHE"] = str(self.folder / "cache")
        self.addCleanup(os.environ.pop, "TANDEM_CACHE")
        self.look_at(fill_test.BED, out="bed")
        self.look_at(SHIPPED / "mbd" / "four_bars.json", out="four_bars")
        self.look_at(SHIPPED / "mbd" / "stops.json", out="stops")
        tank = json.loads((SHIPPED / "tank.json").read_text())
        tank["sph"]["inlets"] = [{"name": "feed", "position": [0, 0, 0.4], "shape": {"type": "disc", "radius": 0.05},
                                  "orientation": {"axis": [1, 0, 0], "angle_deg": 180}, "velocity": 0.5}]
        tank["sph"]["outlets"] = [{"name": "drain", "region": {"type": "plane", "point": [0, 0, -0.05], "normal": [0, 0, -1]}}]
        self.look_at(tank, "--end-time", "0.01", out="tank")
        self.assertEqual(self.known - self.seen - RARE, set(), "listed, and not written by any run here")
        print(f"\n  {len(self.seen)} numbers written, {len(self.known)} listed")

    def test_a_misspelt_one_is_found_before_the_run(self):
        box = json.loads((SCENES / "hanging_box.json").read_text())
        box["checks"][0]["of"] = "summary.lost_partcles"
        (self.folder / "scene.json").write_text(json.dumps(box))
        for verb in (["validate"], ["run", "--out", self.out]):
            result = subprocess.run([options.bin / "tandem", *verb, self.folder / "scene.json"], capture_output=True,
                                    text=True)
            self.assertEqual(result.returncode, 2)
            self.assertIn("checks[0].of: summary.json of this scene has no number 'lost_partcles' (did you mean "
                          "'lost_particles'?)", result.stdout + result.stderr)
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    harness.main()
