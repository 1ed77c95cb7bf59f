#!/usr/bin/env python3
"""Recordings of coupled runs against one server each, and what a failed run leaves for that."""
import json
import os
import signal
import subprocess

import harness
from harness import SCENES, Case, options

ROLES = ["mbd", "dem"]


class ReplayCase(Case):
    def replay(self, recording, *arguments, expect=0, fault=None):
        line = [options.bin / "tandem", "replay", recording, *arguments]
        result = subprocess.run([str(word) for word in line], capture_output=True, text=True, timeout=60 * options.slack,
                                env={**os.environ, "TANDEM_FAULT": json.dumps(fault or {})})
        self.assertEqual(result.returncode, expect, result.stdout + result.stderr)
        return result.stdout + result.stderr

    def record(self, *arguments):
        file = self.folder / "run.rec"
        self.run_scene("hanging_box.json", "--end-time", "0.012", "--record", file, *arguments)
        return file


class Replay(ReplayCase):
    def test_both_roles_are_equal_to_the_bit(self):
        recording = self.record()
        for role in ROLES:
            for server in [(), ("--server", f"{role}_server"), ("--server", options.bin / f"{role}_server"),
                           ("--server", options.bin / f"{role}_server", "--transport", "stream")]:
                said = self.replay(recording, "--role", role, *server)
                self.assertRegex(said, rf"equal: \d\d answers of {role}_server in 12 windows")
                self.assertIn("not compared: the facts", said)
        said = self.replay(recording, "--list")
        self.assertRegex(said, r"\n +0\.\d{6}  mbd_server -> tandem +hello +0 +0 +\d+\n")
        self.assertRegex(said, r"\n +0\.\d{6}  tandem -> dem_server +advance_dem +11 +0 +\d+\n")
        self.assertFalse((self.out / "last_windows.rec").exists())

    def test_bodies_that_touch(self):
        file = self.folder / "chain.rec"
        self.run_scene(SCENES.parents[2] / "launch/scenes/chain/chain_preview.json", "--end-time", "0.02", "--record", file)
        self.assertRegex(self.replay(file, "--role", "mbd"), r"equal: \d\d answers of mbd_server in 10 windows")

    def test_a_stream_is_for_a_program(self):
        said = self.replay(self.record(), "--role", "dem", "--transport", "stream", expect=2)
        self.assertRegex(said, r"--transport stream: the solver of tandem runs inside this process .*--server .*/dem_server")

    def test_the_end_of_a_cut_file_is_told(self):
        whole = self.record()
        self.assertNotIn("cut off", self.replay(whole, "--list"))
        cut = self.folder / "cut.rec"
        cut.write_bytes(whole.read_bytes()[:-10])
        for arguments in [("--list",), ("--role", "dem"), ("--role", "mbd")]:
            self.assertRegex(self.replay(cut, *arguments), r"the file is cut off or damaged: its last \d+ bytes are no whole frame")

    def test_one_wrong_number_is_named(self):
        recording = self.record()
        for role, value in [("mbd", r"motion of window 4, BodyMotion of body \d+: end_twist\.v_WB\.z"),
                            ("dem", r"load of window 4, BodyLoad of [\w ]+: end\.torque\.y")]:
            server = options.faulty / f"{role}_server"
            said = self.replay(recording, "--role", role, "--server", server, expect=1, fault={"spoil": 4})
            self.assertRegex(said, rf"different: {value}: replayed [-.\de]+, recorded [-.\de]+, difference 0.125\n")
            self.assertRegex(said, r"\d+ answers before it are equal")
            if role == "dem":
                self.assertRegex(said, r"\d orders to linearise or keep a frame are left out")

    def test_restart_files_are_read_and_stay(self):
        self.run_scene("hanging_box.json", "--end-time", "0.012", "--checkpoint-every", "1", out=self.folder / "first")
        file = self.folder / "run.rec"
        self.run_scene("hanging_box.json", "--end-time", "0.02", "--restart", self.folder / "first", "--record", file,
                       "--checkpoint-every", "1")
        before = {path: path.stat().st_mtime_ns for path in self.folder.rglob("checkpoint/*/*")}
        self.assertGreater(len(before), 3)
        for role in ROLES:
            for server in [(), ("--server", options.bin / f"{role}_server")]:
                said = self.replay(file, "--role", role, *server)
                self.assertIn("1 orders to write a restart file are not repeated", said)
        self.assertEqual({path: path.stat().st_mtime_ns for path in self.folder.rglob("checkpoint/*/*")}, before)

    def test_refusals(self):
        recording = self.record()
        for arguments, words in [((SCENES / "pendulum.json", "--role", "mbd"), "is no recording"),
                                 ((self.folder / "nothing", "--role", "mbd"), "nothing: "),
                                 ((self.folder, "--list"), str(self.folder)),
                                 ((recording,), "needs --role mbd, --role dem, --role sph or --list"),
                                 ((recording, "--role", "dem", "--server", "./no_such_program"), "no_such_program does not exist"),
                                 ((recording, "--role", "dem", "--list"), "--role excludes --list"),
                                 ((recording, "--role", "dem", "--patience", "-1"), "--patience")]:
            with self.subTest(words):
                self.assertIn(words, self.replay(*arguments, expect=2))
        said = self.replay(recording, "--role", "dem", "--server", options.bin / "mbd_server", expect=4)
        self.assertIn("role is mbd_server, the run needs dem_server here", said)
        said = self.replay(recording, "--role", "dem", "--server", "/bin/false", "--patience", "5", expect=1)
        self.assertRegex(said, r"different: instead of hello of window 0 there is no answer: dem_server '/bin/false'")


class FailedRuns(ReplayCase):
    def test_a_failure_of_a_server_comes_again(self):
        server, fault = options.faulty / "dem_server", {"fails": 4}
        os.environ["TANDEM_FAULT"] = json.dumps(fault)
        self.addCleanup(os.environ.pop, "TANDEM_FAULT")
        said = self.run_scene("hanging_box.json", "--dem-server", server, expect=3)
        file = self.out / "last_windows.rec"
        self.assertEqual(said.count("last_windows.rec"), 1, said)
        self.assertRegex(said, rf"\(.*for tandem replay: {file}\)\n")
        self.assertIn("last_windows.rec", self.summary()["error"]["hint"])
        said = self.replay(file, "--role", "dem", "--server", server, fault=fault)
        self.assertRegex(said, r"equal: .*\nthe recording ends without a report: both fail: .*a planned failure")
        said = self.replay(file, "--role", "dem", expect=1)
        self.assertRegex(said, r"different: instead of failure of window 4 \(.*a planned failure.*\) it answered load of window 4")
        self.assertRegex(self.replay(file, "--role", "mbd"), r"equal: .*\nthe recording ends without a report: ")
        # The next run in this folder removes it.
        self.run_scene("hanging_box.json", "--end-time", "0.01")
        self.assertFalse(file.exists())

    def kill(self, *arguments, windows=3):
        process, servers = self.start_long_run(*arguments)
        self.assertTrue(harness.until(lambda: self.windows() > windows, 60 * options.slack))
        os.kill(servers["dem_server"], signal.SIGKILL)
        self.finish(process)

    def test_a_killed_server_leaves_its_last_order(self):
        self.kill()
        said = self.replay(self.out / "last_windows.rec", "--role", "dem")
        self.assertRegex(said, r"equal: ")
        self.assertRegex(said, r"the recording ends without a report: .*dem_server \(pid \d+\) was killed by signal 9")

    def test_with_a_recording_nothing_else_is_kept(self):
        file = self.folder / "run.rec"
        self.kill("--record", file)
        self.assertFalse((self.out / "last_windows.rec").exists())
        self.assertEqual(self.log().count(f"for tandem replay: {file}"), 1)
        self.assertRegex(self.replay(file, "--role", "mbd"), "equal: ")

    def test_an_interrupted_run_leaves_none(self):
        process, _ = self.start_long_run()
        process.send_signal(signal.SIGINT)
        self.finish(process, 5)
        self.assertFalse((self.out / "last_windows.rec").exists())

    def test_of_a_long_run_the_last_windows_are_listed(self):
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        scene["dem"]["particles"][0]["fill"]["count"] = 2
        scene["coupling"]["window"] = 1e-5
        scene["end_time"] = 1
        scene["output"] = {"frame_interval": 1}
        (self.folder / "scene.json").write_text(json.dumps(scene))
        process = self.start(self.folder / "scene.json", "--threads", "1")
        self.assertTrue(harness.until(lambda: self.windows() > 5000, 60 * options.slack))
        os.kill(harness.children(process.pid)["dem_server"], signal.SIGKILL)
        self.finish(process)
        file = self.out / "last_windows.rec"
        self.assertLess(file.stat().st_size, 16 << 20)
        said = self.replay(file, "--role", "dem", expect=2)
        self.assertRegex(said, r"windows 0 to \d+ are missing.*record the whole run: tandem run --record FILE; --list")
        self.assertRegex(self.replay(file, "--list"), r"\.\.\.  \d+ frames of windows 0 to \d+ are missing\n")


if __name__ == "__main__":
    harness.main()
