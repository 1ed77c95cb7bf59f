#!/usr/bin/env python3
"""Every way to die, at the start, in mid-run and at the end: who survives leaves within a second and says why."""
import os
import shutil
import signal
import time
import unittest

import harness
from harness import Case, alive, children, until

SERVERS = ["mbd_server", "dem_server"]


class KilledServer(Case):
    def check_the_death_is_told(self, process, server, pid, where):
        seconds, status, said = self.finish(process)
        self.assertEqual(status, 4, said)
        self.assertRegex(said, rf"{server} \(pid {pid}\) was killed by signal 9 \(Killed\) {where}")
        summary = self.summary()
        self.assertEqual((summary["status"], summary["error"]["code"]), ("failed", "peer_lost"))
        print(f"\n  {server}: coordinator left after {seconds:.3f} s")

    def test_at_the_start(self):
        for server in SERVERS:
            with self.subTest(server):
                process = self.start("hanging_box.json")
                pid = until(lambda: children(process.pid).get(server), 10)
                os.kill(pid, signal.SIGKILL)
                self.check_the_death_is_told(process, server, pid, "(while the servers started|before the first)")

    def test_in_mid_run(self):
        for server in SERVERS:
            with self.subTest(server):
                process, servers = self.start_long_run()
                self.assertEqual(set(servers), set(SERVERS))
                os.kill(servers[server], signal.SIGKILL)
                self.check_the_death_is_told(process, server, servers[server], r"in window \d+ \(t = [\d.]+ s\)")
                self.assert_gone(servers.values())
                self.assertGreater(self.summary()["windows"], 3)
                survivor = SERVERS[1 - SERVERS.index(server)]
                self.assertRegex(self.log(), rf"{survivor} +error +{server} \(pid {servers[server]}\) .*in window \d+")

    def test_at_the_end(self):
        for server in SERVERS:
            with self.subTest(server):
                shutil.rmtree(self.out, ignore_errors=True)
                process = self.start("hanging_box.json", "--end-time", "0.2")
                pid = until(lambda: children(process.pid).get(server), 10)
                until(lambda: self.windows() >= 199, 30 * harness.options.slack)
                if alive(pid):
                    os.kill(pid, signal.SIGKILL)
                # The kill may come just before or just after the server has said goodbye.
                _, status, said = self.finish(process)
                self.assertIn(status, (0, 4), said)
                if status == 4:
                    self.assertRegex(said, rf"{server} \(pid {pid}\) was killed by signal 9")

    def test_the_next_run_needs_no_cleaning(self):
        process, servers = self.start_long_run()
        os.kill(servers["dem_server"], signal.SIGKILL)
        self.finish(process)
        self.run_scene("hanging_box.json")
        self.assertEqual(self.summary()["status"], "ok")

    def test_over_dds(self):
        if not self.has_dds():
            self.skipTest("no DDS in this build")
        process, servers = self.start_long_run("--transport", "dds")
        os.kill(servers["mbd_server"], signal.SIGKILL)
        self.check_the_death_is_told(process, "mbd_server", servers["mbd_server"], r"in window \d+")


class KilledCoordinator(Case):
    def check_servers_leave(self, process, servers):
        process.kill()
        seconds = self.assert_gone(servers.values())
        process.communicate()
        print(f"\n  servers left after {seconds:.3f} s")

    def test_at_the_start(self):
        process = self.start("hanging_box.json")
        until(lambda: len(children(process.pid)) == 2, 10)
        self.check_servers_leave(process, children(process.pid))

    def test_in_mid_run(self):
        process, servers = self.start_long_run()
        self.check_servers_leave(process, servers)
        for server in SERVERS:
            self.assertRegex(self.log(), rf"{server} +error +.*coordinator \(pid {process.pid}\).*window \d+")

    def test_at_the_end(self):
        process = self.start("hanging_box.json", "--end-time", "0.2")
        until(lambda: len(children(process.pid)) == 2, 10)
        servers = children(process.pid)
        until(lambda: self.windows() >= 199, 30 * harness.options.slack)
        self.check_servers_leave(process, servers)

    def test_the_next_run_needs_no_cleaning(self):
        process, servers = self.start_long_run()
        self.check_servers_leave(process, servers)
        self.run_scene("hanging_box.json")


class SilentServer(Case):
    def test_a_stopped_server_is_named_when_patience_ends(self):
        for server in SERVERS:
            with self.subTest(server):
                process, servers = self.start_long_run("--patience", "1")
                os.kill(servers[server], signal.SIGSTOP)
                seconds, status, said = self.finish(process, 3)
                self.assertEqual(status, 4, said)
                self.assertRegex(said, rf"{server} \(pid {servers[server]}\) gave no sign for 1\d\d\d ms in window \d+")
                self.assertGreaterEqual(seconds, 0.9)
                self.assert_gone(servers.values())


class Interrupt(Case):
    def check_results_are_kept(self, process, servers):
        _, status, said = self.finish(process)
        self.assertEqual(status, 130, said)
        self.assert_gone(servers.values())
        summary = self.summary()
        self.assertEqual((summary["status"], summary["reason"]), ("failed", "interrupted"))
        self.assertGreater(summary["windows"], 3)
        self.assertEqual(len((self.out / "bodies.csv").read_text().splitlines()), summary["windows"] + 1)
        self.assertEqual(self.windows(), summary["windows"])

    def test_ctrl_c(self):
        process, servers = self.start_long_run()
        process.send_signal(signal.SIGINT)
        self.check_results_are_kept(process, servers)

    def test_sigterm(self):
        process, servers = self.start_long_run()
        process.send_signal(signal.SIGTERM)
        self.check_results_are_kept(process, servers)

    def test_ctrl_c_in_process(self):
        process, servers = self.start_long_run("--transport", "inproc")
        process.send_signal(signal.SIGINT)
        self.check_results_are_kept(process, servers)

    def test_a_second_ctrl_c_ends_at_once(self):
        process, servers = self.start_long_run()
        os.kill(servers["dem_server"], signal.SIGSTOP)  # the window will not end
        time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        time.sleep(0.2)
        self.assertIsNone(process.poll(), "the first Ctrl-C waits for the window")
        process.send_signal(signal.SIGINT)
        _, status, _ = self.finish(process)
        self.assertEqual(status, 130)
        os.kill(servers["dem_server"], signal.SIGCONT)
        self.assert_gone(servers.values())


if __name__ == "__main__":
    harness.main()
