#!/usr/bin/env python3
"""Servers that are not tandem's: chosen by the command line or by the scene, dying, lacking capabilities, reporting nothing."""
import json
import os
import shutil
import subprocess
import time

import harness
from harness import Case, SCENES, alive, options, until

BODIES, PARTICLES = "mbd", "dem"
ROLLBACK = 1 << 1


class Foreign(Case):
    def foreign(self, role, *words):
        return " ".join([f"'{options.faulty / 'foreign_solver'}'", role, *words])

    def scene(self, name="scene.json", base="hanging_box.json", **parts):
        """A copy of a scene of ours, with further keys of mbd, dem, coupling or of the scene itself."""
        scene = json.loads((SCENES / base).read_text())
        for part, keys in parts.items():
            if isinstance(keys, dict):
                scene[part] = {**scene.get(part, {}), **keys}
            else:
                scene[part] = keys
        scene.pop("checks", None)
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(scene))
        return path

    def run_it(self, *arguments, scene="hanging_box.json", expect=0, end_time="0.02"):
        shutil.rmtree(self.out, ignore_errors=True)
        return self.run_scene(scene, "--end-time", end_time, *arguments, expect=expect)

    def verb(self, verb, *arguments, expect=0):
        said = subprocess.run([options.bin / "tandem", verb, *arguments], capture_output=True, text=True,
                              timeout=60 * options.slack, check=False)
        self.assertEqual(said.returncode, expect, said.stdout + said.stderr)
        return said.stdout + said.stderr


class ForeignServers(Foreign):
    def test_either_side_is_replaced_and_reports_nothing(self):
        self.run_it()
        ours = self.summary()
        self.assertEqual(ours["mbd_server"].keys(), {"program"})
        rows = (self.out / "bodies.csv").read_bytes()
        said = self.run_it("--mbd-server", self.foreign(BODIES), "--dem-server", self.foreign(PARTICLES))
        self.assertEqual((self.out / "bodies.csv").read_bytes(), rows, "the same solvers, started otherwise")
        summary = self.summary()
        self.assertEqual(summary["status"], "ok")
        self.assertRegex(summary["mbd_server"]["program"], r"foreign_bodies \d")
        self.assertIn("foreign_solver", summary["dem_server"]["command"])
        for key in ("spheres", "backend", "variant", "state_hash", "constraint_violation", "sphere_steps_per_s"):
            self.assertIsNone(summary[key], key)
        self.assertNotIn("mbd_steps", summary)
        self.assertRegex(said, r"particles +not reported by foreign_particles")
        self.assertTrue([line for line in summary["verdict"]["not_judged"] if "not reported by foreign_bodies" in line])
        self.assertNotIn("energy_mbd", summary["verdict"]["judged"])

    def test_one_side_is_replaced(self):
        for option, role in (("--mbd-server", BODIES), ("--dem-server", PARTICLES)):
            with self.subTest(role):
                self.run_it(option, self.foreign(role))
                self.assertEqual(self.summary()["status"], "ok")

    def test_over_a_stream(self):
        self.run_it("--dem-server", self.foreign(PARTICLES), "--transport", "stream")
        self.assertEqual(self.summary()["status"], "ok")

    def test_the_log_tells_it_by_its_command(self):
        self.run_it("--dem-server", self.foreign(PARTICLES))
        self.assertRegex(self.log(), r"dem_server '.*foreign_solver.* dem' \(pid \d+\) registered: foreign_particles")

    def test_what_it_prints_and_whom_it_leaves_behind_keep_nobody_waiting(self):
        script, pid = self.folder / "leaves.sh", self.folder / "pid"
        script.write_text(f"#!/bin/sh\necho printed by the script\nsetsid sleep 30 &\necho $! > {pid}\n"
                          f"exec {self.foreign(PARTICLES)} \"$@\"\n")
        script.chmod(0o755)
        begin = time.monotonic()
        try:
            said = self.run_it("--dem-server", str(script))
        finally:
            subprocess.run(["kill", pid.read_text().strip()], check=False)
        self.assertLess(time.monotonic() - begin, 20)
        self.assertIn("printed by the script", self.log())
        self.assertNotIn("printed by the script", said)

    def test_an_estimate_is_not_made_of_figures_that_are_absent(self):
        self.run_it("--mbd-server", self.foreign(BODIES), "--estimate", "richardson")
        self.assertRegex(self.summary()["mbd_position_error_estimate"], "not estimated: .* not reported by foreign_bodies")

    def test_a_program_of_path_and_one_of_this_folder(self):
        os.symlink(options.faulty / "foreign_solver", self.folder / "my solver")
        here, path = os.getcwd(), os.environ["PATH"]
        try:
            os.chdir(self.folder)
            self.run_it("--dem-server", "'./my solver' dem")
            os.environ["PATH"] = f"{self.folder}:{path}"
            self.run_it("--dem-server", r"my\ solver dem")
        finally:
            os.chdir(here)
            os.environ["PATH"] = path
        self.assertEqual(self.summary()["status"], "ok")

    def test_validate_and_describe_use_it(self):
        scene = str(SCENES / "hanging_box.json")
        servers = ["--mbd-server", self.foreign(BODIES), "--dem-server", self.foreign(PARTICLES)]
        self.assertIn("ok", self.verb("validate", scene, *servers))
        said = self.verb("describe", scene, *servers)
        self.assertRegex(said, "degrees of freedom: not reported by foreign_bodies")
        self.assertRegex(said, "solver: spheres and micro step are not reported by foreign_particles")
        said = self.verb("validate", scene, "--dem-server", self.foreign(PARTICLES, "exit=3", "'say=no licence'"), expect=4)
        self.assertRegex(said, r"foreign_solver.*exited with status 3 .*no licence")

    def test_a_study_uses_it(self):
        study = self.folder / "study.json"
        study.write_text(json.dumps({
            "study": "1.0", "name": "swap", "scene": str(self.scene(end_time=0.01)),
            "sweep": [{"of": "window", "values": [1e-3, 5e-4]}],
            "reference": {"type": "run", "set": [{"of": "window", "value": 2.5e-4}], "every": 1e-3},
            "measures": [{"name": "height", "of": ["box.position.z"], "unit": "m"}]}))
        said = self.verb("study", str(study), "--out", str(self.out), "--mbd-server", self.foreign(BODIES))
        self.assertRegex(said, "3 runs, 0 of them done before")
        self.assertIn("time not reported", said)
        said = self.verb("study", str(study), "--out", str(self.out))
        self.assertRegex(said, "3 runs, 0 of them done before", "runs with other servers are other runs")


class ForeignRefusals(Foreign):
    def test_no_such_program(self):
        text = self.folder / "plain.txt"
        text.write_text("no program")
        bad = self.folder / "bad.sh"
        bad.write_text("#!/no/such/interpreter\n")
        bad.chmod(0o755)
        for command, pattern, status in (
                ("no_such_solver --fast", "--dem-server: no folder of PATH has a program 'no_such_solver'", 2),
                ("./no_such_solver", "--dem-server: program .*no_such_solver does not exist", 2),
                (str(text), "--dem-server: program .*plain.txt is not executable", 2),
                (str(self.folder), "--dem-server: program .* is a folder", 2),
                (str(bad), "bad.sh: cannot be started: No such file.*a script needs a first line", 5),
                ("'unclosed", "--dem-server: the quote ' in character 1 .* is not closed", 2),
                ("", "--dem-server: the command names no program", 2),
                ("  ", "--dem-server: the command names no program", 2)):
            with self.subTest(command):
                self.assertRegex(self.run_it("--dem-server", command, expect=status), pattern)

    def test_not_where_nothing_is_started(self):
        for argument, pattern in (("--transport=inproc", "--transport inproc runs the solvers inside"),
                                  ("--attach", "with --attach you start the servers yourself")):
            self.assertRegex(self.run_it("--dem-server", self.foreign(PARTICLES), argument, expect=2), pattern)
        said = self.run_it("--dem-server", self.foreign(PARTICLES), scene="pendulum.json", expect=2)
        self.assertIn("--dem-server: the scene has no particles", said)

    def test_the_server_of_the_other_side(self):
        for name in "dem_server", str(options.bin / "dem_server"):
            said = self.run_it("--mbd-server", name, expect=2 if name == "dem_server" else 4)
            self.assertRegex(said, "--dem-server")
        self.assertIn("role is dem_server, the run needs mbd_server here", said)
        said = self.run_it("--mbd-server", "dem_server", expect=2)
        self.assertRegex(said, r"--mbd-server: 'dem_server' computes the particles, and the server of the bodies is wanted here")

    def test_the_state_of_another_solver(self):
        self.run_it("--checkpoint-every", "0.01")
        first = self.folder / "first"
        self.out.rename(first)
        said = self.run_it("--restart", first, "--mbd-server", self.foreign(BODIES), end_time="0.03", expect=2)
        self.assertRegex(said, r"its state of mbd_server was written by mbd_server \S+, and here foreign_bodies \S+ runs")
        self.run_it("--restart", first, "--mbd-server", str(options.bin / "mbd_server"), end_time="0.03")

    def test_death_is_told_by_its_command(self):
        command = self.foreign(PARTICLES, "exit=3", "'say=cannot open deck.in'")
        said = self.run_it("--dem-server", command, expect=4)
        self.assertRegex(said, r"dem_server '.*foreign_solver.*' \(pid \d+\) exited with status 3 while the servers started")
        self.assertIn("its last line in run.log: cannot open deck.in", said)
        self.assertIn("cannot open deck.in", self.log())
        said = self.run_it("--dem-server", self.foreign(PARTICLES, "exit=0"), expect=4)
        self.assertRegex(said, r"exited with status 0 while the servers started")
        said = self.run_it("--mbd-server", self.foreign(BODIES, "die=7"), expect=4)
        self.assertRegex(said, r"mbd_server '.*' \(pid \d+\) exited with status 7 in window 2")

    def test_it_is_ended_with_its_children(self):
        script, pids = self.folder / "hangs.sh", self.folder / "pids"
        script.write_text(f"#!/bin/sh\nsleep 1000 &\necho $! $$ > {pids}\nwait\n")
        script.chmod(0o755)
        said = self.run_it("--dem-server", str(script), "--patience", "0.5", expect=4)
        self.assertIn("dem_server", said)
        for pid in map(int, pids.read_text().split()):
            self.assertTrue(until(lambda pid=pid: not alive(pid), 2), pid)

    def test_a_lacking_capability_is_named_with_what_is_possible(self):
        lacking = ["--dem-server", self.foreign(PARTICLES, f"lack={ROLLBACK}")]
        self.run_it(*lacking)
        said = self.run_it("--scheme", "implicit", *lacking, expect=2)
        self.assertRegex(said, r"scheme 'implicit' needs rollback \(save and restore\), which foreign_particles \S+ does not "
                               r"offer \(these schemes are possible: parallel, mbd_first, dem_first, linear_implicit\)")
        both = [*lacking, "--mbd-server", self.foreign(BODIES, f"lack={ROLLBACK | 1}")]
        said = self.run_it(*both, expect=2)
        self.assertRegex(said, r"scheme 'dem_first' needs a predicted path .* \(these schemes are possible: mbd_first\)")
        self.run_it("--scheme", "mbd_first", *both)
        adaptive = self.scene(coupling={"adaptive": {"min_window": 1e-5, "max_window": 1e-2}})
        said = self.verb("validate", str(adaptive), *lacking, expect=2)
        self.assertRegex(said, r"coupling.adaptive needs rollback .*foreign_particles.*\(leave out coupling.adaptive\)")
        said = self.run_it("--checkpoint-every", "0.01", "--dem-server", self.foreign(PARTICLES, f"lack={1 << 7}"), expect=2)
        self.assertRegex(said, r"--checkpoint-every needs restart files .*\(leave out --checkpoint-every\)")


class SceneServers(Foreign):
    def test_a_server_of_the_scene_needs_permission(self):
        (self.folder / "deck").mkdir()
        os.symlink(options.faulty / "foreign_solver", self.folder / "deck" / "solver")
        wanted = {"step": 3, "deck": ["a", {"b": None}]}
        scene = self.scene("deck/scene.json", dem={"server": "./solver dem tell", "solver_options": wanted})
        said = self.run_it(scene=scene, expect=2)
        self.assertRegex(said, r"dem.server: the scene would start the program './solver dem tell' on this computer, as you "
                               r"\(if you trust it, add --allow-scene-servers; --dem-server dem_server takes")
        self.assertFalse(self.out.exists(), "nothing was started or written")
        self.assertIn("as you", self.verb("validate", str(scene), expect=2))
        self.assertRegex(self.verb("validate", "--files-only", str(scene)), "note: dem.server names a program of its own")
        self.run_it("--allow-scene-servers", scene=scene)
        self.assertEqual(self.summary()["foreign_options"], wanted)
        # The command line wins, and our server refuses options that it does not know.
        said = self.run_it("--dem-server", "dem_server", scene=scene, expect=2)
        self.assertRegex(said, r"dem.solver_options.deck: dem_server has no solver options")
        self.run_it("--dem-server", self.foreign(PARTICLES), scene=scene)
        self.assertNotIn("foreign_options", self.summary())

    def test_our_own_server_by_its_name(self):
        scene = self.scene(mbd={"server": "mbd_server"})
        self.run_it(scene=scene)
        self.assertEqual(self.summary()["mbd_server"].keys(), {"program"})
        self.assertNotIn("note", self.verb("validate", "--files-only", str(scene)))
        said = self.run_it(scene=self.scene(mbd={"server": "dem_server"}), expect=2)
        self.assertRegex(said, r"mbd.server: 'dem_server' computes the particles")

    def test_our_bodies_have_no_options(self):
        scene = self.scene(mbd={"solver_options": {"rate": 1}})
        self.assertRegex(self.run_it(scene=scene, expect=2), r"mbd.solver_options.rate: mbd_server has no solver options")
        self.assertIn("ok", self.verb("validate", str(self.scene(mbd={"solver_options": {}}))))

    def test_a_study_of_it_needs_permission(self):
        scene = self.scene(end_time=0.01, mbd={"server": "./solver mbd"})
        os.symlink(options.faulty / "foreign_solver", self.folder / "solver")
        study = self.folder / "study.json"
        study.write_text(json.dumps({
            "study": "1.0", "name": "swap", "scene": str(scene), "sweep": [{"of": "window", "values": [1e-3]}],
            "measures": [{"name": "closure", "of": ["summary.impulse_closure"], "expected": 0}]}))
        self.assertIn("--allow-scene-servers", self.verb("study", str(study), "--out", str(self.out), expect=2))
        self.verb("study", str(study), "--out", str(self.out), "--allow-scene-servers")


if __name__ == "__main__":
    harness.main()
