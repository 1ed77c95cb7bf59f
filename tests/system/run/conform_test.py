#!/usr/bin/env python3
"""tandem conform as a command: our servers over both transports, wrong programs, the report."""
import html.parser
import json
import signal
import subprocess

import harness
from harness import Case, options


class Page(html.parser.HTMLParser):
    """Checks that tags are closed in order, and counts rows."""
    VOID = {"meta", "br"}

    def __init__(self):
        super().__init__()
        self.open, self.rows, self.outside = [], 0, []

    def handle_starttag(self, tag, attrs):
        self.outside += [value for key, value in attrs if key in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)
        self.rows += ("class", "check") in attrs

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag


class Conform(Case):
    def conform(self, *arguments):
        run = subprocess.run([str(options.bin / "tandem"), "conform", *map(str, arguments)], capture_output=True, text=True,
                             timeout=60 * options.slack, cwd=self.folder)
        return run.returncode, run.stdout, run.stderr

    def limits(self):
        return ["--answer-limit", str(options.slack), "--patience", str(10 * options.slack)]

    def test_our_servers_pass_over_both_transports_and_leave_a_report(self):
        for role, transport in (("mbd", "shm"), ("mbd", "stream"), ("dem", "shm"), ("dem", "stream")):
            with self.subTest(role=role, transport=transport):
                out = self.folder / f"{role}_{transport}"
                status, said, error = self.conform(f"{role}_server", "--role", role, "--transport", transport, "--out", out, *self.limits())
                self.assertEqual(status, 0, said + error)
                self.assertNotIn("FAIL", said)
                report = json.loads((out / "conform.json").read_text())
                self.assertTrue(report["passed"])
                self.assertEqual(report["counts"]["passed"], len(report["checks"]))
                self.assertEqual(len(said.splitlines()), len(report["checks"]) + 1)
                page = Page()
                page.feed((out / "conform.html").read_text())
                self.assertEqual((page.open, page.rows, page.outside), ([], len(report["checks"]), []))
                self.assertIn("registered", (out / "participant.log").read_text())

    def test_a_long_run_is_added(self):
        for role, check in (("mbd", "long_motion"), ("dem", "long_load")):
            status, said, error = self.conform(f"{role}_server", "--role", role, "--long", "2", "--check", check, *self.limits())
            self.assertEqual(status, 0, said + error)
            self.assertRegex(said, rf"PASS +{check}")
        status, _, error = self.conform("mbd_server", "--role", "mbd", "--long", "1")
        self.assertEqual(status, 2)
        self.assertIn("--long: 1 s is no time of a long run (give 2 to 100000 s of simulated time)", error)

    def test_a_faulty_server_fails_by_name(self):
        for role, fault, check in (("mbd", {"torques": 0.5}, "torque_impulse"), ("dem", {"late": 0.5}, "momentum_balance")):
            with self.subTest(role=role):
                program = f"env 'TANDEM_FAULT={json.dumps(fault)}' {options.faulty / f'{role}_server'}"
                status, said, error = self.conform(program, "--role", role, *self.limits())
                self.assertEqual(status, 1, said + error)
                self.assertRegex(said, rf"(?m)^FAIL +{check} ")

    def test_a_program_that_does_not_register_fails_in_one_line(self):
        for program, transport in (("/bin/true", "shm"), ("/bin/cat", "stream")):
            status, said, _ = self.conform(program, "--role", "dem", "--transport", transport, "--patience", "5")
            self.assertEqual(status, 1, said)
            self.assertRegex(said, rf"^FAIL +hello +dem_server '{program}'")
            if program == "/bin/true":
                self.assertRegex(said, r"'/bin/true' \(pid \d+\) exited with status 0 in window 0, before hello")
            self.assertRegex(said, r"\nthe participant \(dem_server\): 0 passed, 1 failed, .*\nwith --out DIR, .*participant.log\n$")
        # Its own error says more than its exit status.
        _, said, _ = self.conform("/bin/sh -c 'echo error: no licence >&2; exit 7'", "--role", "dem")
        self.assertRegex(said, r"FAIL +hello .* exited with status 7 .*; its last line: error: no licence")
        status, said, _ = self.conform("dem_server", "--role", "mbd")
        self.assertEqual(status, 1)
        self.assertIn("role is dem_server", said)

    def test_on_a_scene_of_the_user(self):
        scene = harness.SCENES.parents[2] / "launch/scenes/spring_box.json"
        status, said, error = self.conform("mbd_server", "--role", "mbd", "--scene", scene, *self.limits())
        self.assertEqual(status, 0, said + error)
        self.assertIn("window_halves", said)
        self.assertNotIn("free_fall", said)

    def test_wrong_use(self):
        scene = harness.SCENES.parents[2] / "launch/scenes/pendulum.json"
        (self.folder / "conform.json").write_text("mine")
        for arguments, part in ((["mbd_server", "--role", "mbd", "--out", "."], "conform.json: is there, and the folder has no tandem_conform.json"),
                                (["dem_server", "--role", "den"], "did you mean 'dem'?"),
                                (["/nowhere/x", "--role", "mbd"], "does not exist"), (["mbd_server"], "--role is required"),
                                (["--role", "mbd"], "no participant is given"),
                                (["mbd_server", "--role", "mbd", "--check", "free_fal"], "did you mean 'free_fall'?"),
                                (["dem_server", "--role", "dem", "--scene", scene], "has no particles"),
                                (["mbd_server", "--role", "mbd", "--set", "weight=2"], "--set: needs --scene"),
                                (["mbd_server", "--role", "mbd", "--scene", scene, "--set", "weight=2"], "weight"),
                                (["mbd_server", "--role", "mbd", "--out", "/dev/null/x"], "cannot be created")):
            status, said, error = self.conform(*arguments)
            self.assertEqual(status, 2, said + error)
            self.assertIn(part, error)

    def test_its_own_input_is_not_overwritten(self):
        scene = self.folder / "tandem_conform.json"
        text = (harness.SCENES.parents[2] / "launch/scenes/spring_box.json").read_text()
        scene.write_text(text)
        status, _, error = self.conform("mbd_server", "--role", "mbd", "--scene", scene, "--out", ".")
        self.assertEqual(status, 2)
        self.assertIn("tandem_conform.json: is an input of this tandem conform", error)
        status, _, error = self.conform("mbd_server", "--role", "mbd", "--out", ".")
        self.assertEqual(status, 2)
        self.assertIn("tandem_conform.json: is there, and tandem conform has not written it", error)
        self.assertEqual(scene.read_text(), text)

    def test_a_signal_ends_a_participant_that_hangs(self):
        (self.folder / "hang").write_text("#!/bin/sh\necho $$ > pid\nwhile :; do sleep 0.1; done\n")
        (self.folder / "hang").chmod(0o755)
        process = subprocess.Popen([options.bin / "tandem", "conform", "./hang", "--role", "mbd", "--patience", "100"], cwd=self.folder,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        pid = int(harness.until(lambda: (self.folder / "pid").exists() and (self.folder / "pid").read_text(), 60))
        process.send_signal(signal.SIGTERM)
        _, said = process.communicate(timeout=10)
        self.assertEqual((process.returncode, said), (130, "error: interrupted\n"))
        self.assertTrue(harness.until(lambda: not harness.alive(pid), 5))

    def test_list(self):
        status, said, _ = self.conform("--role", "dem", "--list")
        self.assertEqual(status, 0)
        self.assertIn("momentum_balance ", said)
        self.assertNotIn("free_fall", said)


if __name__ == "__main__":
    harness.main()
