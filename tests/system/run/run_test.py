#!/usr/bin/env python3
"""`tandem run` as a user meets it: results, exit status, wrong folders, servers started by hand."""
import json
import os
import pathlib
import signal
import subprocess
import unittest

import harness
from harness import Case, options, until

SUMMARY_KEYS = """scene version protocol transport backend device precision variant left_out spheres bodies windows
    micro_steps simulated_s wall_s sphere_steps_per_s us_per_micro_step time_split impulse_closure energy_residual
    momentum_balance constraint_violation max_overlap_ratio lost_particles warnings state_hash status checks""".split()


class Results(Case):
    def test_summary_has_all_keys(self):
        self.run_scene("hanging_box.json")
        summary = self.summary()
        self.assertEqual([key for key in SUMMARY_KEYS if key not in summary], [])
        self.assertEqual([key for key in SUMMARY_KEYS if summary[key] is None], [])
        self.assertEqual(summary["status"], "ok")
        self.assertEqual(summary["windows"], 50)
        self.assertEqual(summary["spheres"], 64)
        self.assertEqual(set(summary["time_split"]), {"dem", "mbd", "exchange", "output"})
        self.assertLess(sum(summary["time_split"].values()), summary["wall_s"] * 1.01)
        print(f"\n  impulse closure {summary['impulse_closure']:.2e} (limit 1e-12), "
              f"momentum balance {summary['momentum_balance']:.2e}, energy residual {summary['energy_residual']:.2e}")
        self.assertLessEqual(summary["impulse_closure"], 1e-12)
        for name in ["bodies.csv", "joints.csv", "windows.csv", "run.log"]:
            self.assertGreater((self.out / name).stat().st_size, 0, name)

    def test_same_bits_on_every_transport_and_again(self):
        transports = ["shm", "shm", "inproc"]
        if self.has_dds():
            transports.append("dds")
        for scheme in ["dem_first", "mbd_first", "parallel"]:
            hashes = []
            for number, transport in enumerate(transports):
                out = self.folder / f"{scheme}{number}"
                self.run_scene("hanging_box.json", "--scheme", scheme, "--transport", transport, out=out)
                hashes.append(self.summary(out)["state_hash"])
            print(f"\n  {scheme}: {dict(zip(transports, hashes))}")
            self.assertEqual(len(set(hashes)), 1)

    def test_only_the_server_that_is_needed(self):
        for scene, absent in [("pendulum.json", "dem_server"), ("falling_balls.json", "mbd_server")]:
            with self.subTest(scene):
                out = self.folder / scene
                self.run_scene(scene, out=out)
                self.assertEqual(self.summary(out)["status"], "ok")
                self.assertNotIn(absent, (out / "run.log").read_text())
                self.assertIsNone(self.summary(out)["impulse_closure"])

    def test_overrides_reach_the_run(self):
        self.run_scene("hanging_box.json", "--end-time", "0.01", "--window", "5e-4", "--scheme", "parallel")
        summary = self.summary()
        self.assertEqual((summary["windows"], summary["simulated_s"], summary["scheme"]), (20, 0.01, "parallel"))
        self.assertEqual(summary["checks"], [], "they are about the whole run")
        self.assertRegex(summary["warnings"][0], "checks of the scene are left out")

    def test_a_run_replaces_an_earlier_one(self):
        self.run_scene("hanging_box.json")
        self.run_scene("pendulum.json")
        self.assertEqual(self.summary()["scene"], "pendulum")

    def test_frames_without_spheres(self):
        scene = json.loads((harness.SCENES / "hanging_box.json").read_text())
        scene["output"] = {"frame_interval": 0.01, "particles": False}
        file = self.folder / "without.json"
        file.write_text(json.dumps(scene))
        self.run_scene("hanging_box.json", out=self.folder / "with")
        self.run_scene(file)
        self.assertEqual(self.summary()["dem_state_hash"], self.summary(self.folder / "with")["dem_state_hash"])
        names = {path.name for path in self.out.iterdir()}
        self.assertLessEqual({"bodies.csv", "bodies.xdmf", "windows.csv", "summary.json"}, names)
        self.assertEqual([name for name in names if name.startswith("particles")], [])

    def test_a_recording_is_kept(self):
        self.run_scene("pendulum.json", "--record", self.folder / "frames")
        self.assertGreater((self.folder / "frames").stat().st_size, 10_000)

    def test_servers_started_by_hand(self):
        with self.subTest("an interrupt while they are waited for"):
            process = self.start("pendulum.json", "--attach", "--run", f"nobody-{os.getpid()}")
            process.stdout.readline()
            process.send_signal(signal.SIGTERM)
            _, status, said = self.finish(process, 2)
            self.assertEqual(status, 130, said)
            self.assertIn("the run was interrupted before its first window", said)
            self.assertEqual(self.summary()["reason"], "interrupted")
        # They outlive the first SIGTERM as well, which batch systems send to all programs of a run.
        process = self.start("hanging_box.json", "--attach", "--run", f"by-hand-{os.getpid()}")
        servers = []
        for _ in range(2):
            line = process.stdout.readline()
            self.assertRegex(line, r"^start: (mbd|dem)_server --shm by-hand-")
            words = line.split()[1:]
            servers.append(subprocess.Popen([options.bin / words[0], *words[1:]], stderr=subprocess.DEVNULL))
        self.started += servers
        if until(lambda: self.windows() > 1, 20 * options.slack):
            for server in servers:
                server.send_signal(signal.SIGTERM)
        _, status, said = self.finish(process, 30)
        self.assertEqual(status, 0, said)
        self.assertEqual([server.wait(5) for server in servers], [0, 0])


class OtherVerbs(Case):
    def say(self, *arguments, expect=0):
        result = subprocess.run([options.bin / "tandem", *arguments], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def test_version(self):
        self.assertRegex(self.say("--version"), r"tandem \d+\.\d+\.\d+, protocol \d+\.\d+\nback ends: cpu.*\n"
                                                r"transports: shm, inproc")

    def test_schema_is_json(self):
        self.assertEqual(json.loads(self.say("schema"))["type"], "object")

    def test_describe(self):
        said = self.say("describe", harness.SCENES / "hanging_box.json")
        for line in ["slide +prismatic +ground +box", "degrees of freedom: 1", "balls +glass", "50 windows of 0.001 s"]:
            self.assertRegex(said, line)

    def test_validate_tells_good_from_wrong(self):
        wrong = self.folder / "wrong.json"
        wrong.write_text((harness.SCENES / "pendulum.json").read_text().replace('"mass": 1', '"mass": -1'))
        said = self.say("validate", harness.SCENES / "pendulum.json", wrong, expect=2)
        self.assertRegex(said, r"pendulum.json: ok")
        self.assertRegex(said, r"wrong.json: mbd.bodies\[0\].mass: .*-1")

    def test_no_verb_is_an_error(self):
        self.assertRegex(self.say(expect=2), "no verb is given .known verbs: run, validate")

    def test_unknown_verbs_and_options_are_named(self):
        self.assertRegex(self.say("frobnicate", expect=2), "tandem has no verb 'frobnicate' .known verbs: run, validate")
        self.assertRegex(self.say("valdiate", "x.json", expect=2), "no verb 'valdiate' .did you mean 'validate'")
        self.assertRegex(self.say("run", "x.json", "--bakend=cpu", expect=2),
                         "tandem run has no option '--bakend' .did you mean '--backend'")


class Refusals(Case):
    def test_wrong_command_lines(self):
        for arguments in [["--backend", "gpu"], ["--patience", "0"], ["--frobnicate"]]:
            self.run_scene("hanging_box.json", *arguments, expect=2)
            self.assertFalse(self.out.exists())

    def refusal(self, *words, program="tandem", expect=2):
        said = subprocess.run([harness.options.bin / program, *words], capture_output=True, text=True, timeout=60)
        self.assertEqual(said.returncode, expect, said.stderr)
        self.assertEqual(said.stdout, "")
        return said.stderr

    def test_values_that_are_no_times(self):
        run = "run", harness.SCENES / "hanging_box.json", "--out", self.out
        for value in "nan", "inf", "-inf":
            for option in "--end-time", "--window":
                self.assertIn(f"{option}: {value} is no time that a run can have (give a finite number of seconds)",
                              self.refusal(*run, f"{option}={value}"))
            self.assertIn(f"--checkpoint-every: {value} s is no time between restart files (give 1e-9 to 9e9 s",
                          self.refusal(*run, f"--checkpoint-every={value}"))
        self.assertIn("--checkpoint-every: 0 s is no time", self.refusal(*run, "--checkpoint-every", "0"))
        self.assertIn("'inf' is not a finite number > 0", self.refusal("import", "x.urdf", "--stops", "1", "inf"))
        self.assertFalse(self.out.exists())

    def test_a_link_to_nothing_is_no_folder(self):
        self.out.symlink_to(self.folder / "nowhere")
        self.assertIn("is a link to a folder that does not exist (make that folder, or give another --out)",
                      self.run_scene("hanging_box.json", expect=2))

    def test_an_empty_name_is_that_of_the_option(self):
        self.assertIn('--shm: "" is no name for a channel', self.refusal("--shm", "", program="mbd_server"))

    def test_long_words_are_not_repeated(self):
        long = "x" * 3000
        run = "run", harness.SCENES / "hanging_box.json", "--out", self.out
        for words in [(*run, "--backend", long), (*run, "--threads", long), (*run, f"--patience={long}"), (*run, long),
                      (*run, "--run", long, "--attach"), (*run, "--estimate", long), (*run, f"--transport={long}"),
                      ("validate", "--files-only", long[:300]), ("stop", long), ("ps", "--status", long)]:
            self.assertLess(len(self.refusal(*words)), 1000, words[-1][:20])
        for words in ("--shm", long), ("--shm", "a", "--log-level", long), ("--shm", "a", "--state-folder", long):
            self.assertLess(len(self.refusal(*words, program="dem_server")), 1000, words[0])

    def test_too_small_limits_are_said(self):
        for limit, words, sentence in (
                ("-s 128", ("mbd_server", "--shm", "nobody"), "ulimit -s: the stack is limited to 128 KiB, and 1024 are needed"),
                ("-s 128", ("tandem", "ps"), "ulimit -s: the stack is limited to 128 KiB, and 1024 are needed"),
                ("-n 16", ("tandem", "ps"), "ulimit -n: a program may have 16 open files, and 64 are needed")):
            limited = ["sh", "-c", f'ulimit {limit}; exec "$@"', "sh", harness.options.bin / words[0], *words[1:]]
            said = subprocess.run(limited, capture_output=True, text=True, timeout=60)
            self.assertEqual(said.returncode, 5, said.stderr)
            self.assertIn(sentence, said.stderr)

    def test_wrong_scenes(self):
        said = self.run_scene("no_such_scene.json", expect=2)
        self.assertRegex(said, "no_such_scene.json")
        said = self.run_scene("hanging_box.json", "--scheme", "dem_frist", expect=2)
        self.assertRegex(said, r"hanging_box.json: coupling.scheme.*dem_frist.*dem_first")
        self.assertFalse(self.out.exists(), "a wrong scene leaves no folder")

    def test_a_failed_check_is_exit_status_1(self):
        scene = (harness.SCENES / "hanging_box.json").read_text().replace('"expected": 0,', '"expected": 5,', 1)
        path = self.folder / "wrong_check.json"
        path.write_text(scene)
        said = self.run_scene(path, expect=1)
        self.assertRegex(said, "CHECK FAILED +no ball is lost: 0 ")
        self.assertEqual((self.summary()["status"], self.summary()["reason"]), ("failed", "checks"))

    def test_a_solver_that_cannot_go_on_is_exit_status_3(self):
        scene = json.loads((harness.SCENES / "hanging_box.json").read_text())
        scene["mbd"]["integrator"] = {"tolerance": 1e-18, "max_iterations": 1}
        inlet = {"type": "inlet", "min": [-0.1, -0.1, 0.1], "max": [0.1, 0.1, 0.2], "rate": 1, "start": 1000}
        scene["dem"]["particles"].append(dict(scene["dem"]["particles"][0], name="late", fill=inlet))
        path = self.folder / "impossible.json"
        path.write_text(json.dumps(scene))
        for transport in ["shm", "inproc"]:
            said = self.run_scene(path, "--transport", transport, expect=3)
            self.assertRegex(said, r"did not converge in 1 iterations .*in window 0 \(t = 0 s\)")
            summary = self.summary()
            self.assertEqual((summary["status"], summary["error"]["code"]), ("failed", "numerics"))
            self.assertGreaterEqual(min(summary["time_split"].values()), 0)
            self.assertIn("inlet 'late' starts at 1000 s", " ".join(summary["warnings"]), "of before the run")

    def test_a_failed_run_leaves_a_report(self):
        scene = json.loads((harness.SCENES / "hanging_box.json").read_text())
        scene["mbd"]["integrator"] = {"tolerance": 1e-18, "max_iterations": 1}
        path = self.folder / "impossible.json"
        path.write_text(json.dumps(scene))
        subprocess.run([options.bin / "tandem", "run", path, "--out", self.out, "--quiet"], capture_output=True, timeout=120)
        self.assertIn("did not converge in 1 iterations", (self.out / "report.html").read_text())

    def test_folders_that_cannot_be_used(self):
        self.folder.joinpath("file").write_text("x")
        self.assertRegex(self.run_scene("pendulum.json", expect=2, out=self.folder / "file"), "file: is not a folder")
        self.assertRegex(self.run_scene("pendulum.json", expect=2, out=self.folder), "holds files, but none of an earl")
        self.assertRegex(self.run_scene("pendulum.json", expect=5, out=pathlib.Path("/proc/tandem")), "/proc/tandem")

    def test_a_full_disk_is_named(self):
        disk = self.folder / "disk"
        disk.mkdir()
        line = f"mount -t tmpfs -o size=16k none {disk} && exec {options.bin}/tandem run {harness.SCENES}/pendulum.json" \
               f" --end-time 10 --out {disk}/out --no-picture --no-report"
        result = subprocess.run(["unshare", "-rm", "sh", "-c", line], capture_output=True, text=True, timeout=60)
        if "unshare" in result.stderr or "mount:" in result.stderr:
            self.skipTest("no mount namespaces here: " + result.stderr.strip())
        self.assertEqual(result.returncode, 5, result.stdout + result.stderr)
        self.assertRegex(result.stderr, r"disk/out.*space")


if __name__ == "__main__":
    harness.main()
