#!/usr/bin/env python3
"""Who may talk to a run, over shared memory: strangers of another user are refused and named, and the run goes on."""
import array
import contextlib
import mmap
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import time
import unittest

import harness
from harness import SCENES, Case, alive, until

NOBODY = 65534
OURSELVES = os.getuid()


def as_nobody(work):
    """Runs `work()` in a child of another user; what it returns, as text."""
    inner, outer = os.pipe()
    pid = os.fork()
    if pid == 0:
        said = "nothing"
        try:
            os.setgroups([])
            os.setgid(NOBODY)
            os.setuid(NOBODY)
            said = repr(work())
        except BaseException as error:  # noqa: B902 (told to the test)
            said = repr(error)
        os.write(outer, said.encode())
        os._exit(0)
    os.close(outer)

    def answer():
        os.waitpid(pid, 0)
        with os.fdopen(inner) as pipe:
            return pipe.read()
    return pid, answer


def name_of(run, program):
    return f"\0tandem/{OURSELVES}/{run}-{program}"


def connect(name):
    found = socket.socket(socket.AF_UNIX)
    found.settimeout(5)
    found.connect(name)
    return found


def take_memory(name):
    """What a squatter who listens under `name` is given by the first who comes: bytes, and whether a descriptor."""
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(name)
        listener.listen(1)
        listener.settimeout(10)
        came, _ = listener.accept()
        with came:
            came.settimeout(10)
            said, rights, _, _ = came.recvmsg(1, socket.CMSG_SPACE(4))
            return said, bool(rights)


class Trust(Case):
    RUN = f"trust-{os.getpid()}"

    def server(self, program, *arguments, name=None):
        with open(self.folder / f"{program}.log", "w") as log:
            process = subprocess.Popen([harness.options.bin / program, "--shm", name or f"{self.RUN}-{program}", *arguments],
                                       stdout=log, stderr=log)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.assertTrue(until(lambda: "waiting for a coordinator" in self.said(program), 10 * harness.options.slack))
        time.sleep(0.1)  # it binds the name after it has said so
        return process

    def said(self, program):
        return (self.folder / f"{program}.log").read_text()

    def attached_run(self, *arguments, expect=0):
        return self.run_scene("pendulum.json", "--attach", "--run", self.RUN, "--patience", "10", *arguments, expect=expect)


@unittest.skipUnless(os.geteuid() == 0, "only root can become another user")
class OtherUser(Trust):
    def test_attach_does_not_end_the_wait(self):
        """Issue 32, 8: one connect() of any user ended a waiting server."""
        server = self.server("mbd_server")

        def look():
            with connect(name_of(self.RUN, "mbd_server")) as ours:
                return ours.recv(1)
        _, answer = as_nobody(look)
        self.assertEqual(answer(), "b''", "closed unread, and nothing was given")
        self.attached_run()
        self.assertEqual(server.wait(5), 0)
        self.assertEqual(self.summary()["status"], "ok")
        self.assertRegex(self.said("mbd_server"), rf"refused user {NOBODY} \(pid \d+\) at the name {self.RUN}-mbd_server")

    def test_flood_does_not_hold_up_the_run(self):
        server = self.server("mbd_server")

        def flood():
            end, came = time.monotonic() + 20, 0
            with contextlib.suppress(ConnectionRefusedError):  # once the server has met its coordinator
                while time.monotonic() < end:
                    with contextlib.suppress(BrokenPipeError, ConnectionResetError, BlockingIOError):  # no room
                        connect(name_of(self.RUN, "mbd_server")).close()
                        came += 1
            return came
        _, answer = as_nobody(flood)
        time.sleep(0.3)
        self.attached_run()
        self.assertEqual(server.wait(5), 0)
        came = int(answer())
        self.assertGreater(came, 100)
        lines = self.said("mbd_server").count("refused user")
        self.assertTrue(0 < lines < 25, f"{lines} lines for {came} strangers")

    def test_squatter_is_given_nothing(self):
        """Issue 32, 8: who bound the name first was given the memory, and was taken for the server."""
        squatter, answer = as_nobody(lambda: take_memory(name_of(self.RUN, "mbd_server")))
        self.assertTrue(until(lambda: f"{self.RUN}-mbd_server" in pathlib.Path("/proc/net/unix").read_text(), 5))
        said = self.attached_run(expect=4)
        self.assertRegex(said, rf"is held by user {NOBODY} \(pid {squatter}\), not by a process of this user")
        self.assertEqual(answer(), "(b'', False)")

    def test_squatter_is_named_to_the_server(self):
        name = f"{self.RUN}-x"
        squatter, _ = as_nobody(lambda: take_memory(f"\0tandem/{OURSELVES}/{name}"))
        self.assertTrue(until(lambda: name in pathlib.Path("/proc/net/unix").read_text(), 5))
        refused = subprocess.run([harness.options.bin / "mbd_server", "--shm", name], capture_output=True, text=True, timeout=20)
        os.kill(squatter, signal.SIGKILL)
        os.waitpid(squatter, 0)
        self.assertEqual(refused.returncode, 4)
        self.assertRegex(refused.stderr, rf"is held by user {NOBODY} \(pid {squatter}\)")

    def test_memory_and_processes_are_out_of_reach(self):
        """Forge and replay need the memory: another user cannot open it."""
        _, servers = self.start_long_run()
        links = [f"/proc/{servers['mbd_server']}/fd", f"/proc/{servers['mbd_server']}/mem",
                 f"/proc/{servers['mbd_server']}/map_files"]

        def look():
            found = []
            for link in links:
                with contextlib.suppress(PermissionError):
                    found.append(os.listdir(link) if not link.endswith("mem") else open(link, "r+b"))
            return found
        _, answer = as_nobody(look)
        self.assertEqual(answer(), "[]")


class SameUser(Trust):
    def test_who_leaves_or_says_nothing_does_not_end_the_wait(self):
        server = self.server("mbd_server")
        connect(name_of(self.RUN, "mbd_server")).close()
        silent = connect(name_of(self.RUN, "mbd_server"))
        self.attached_run()
        silent.close()
        self.assertEqual(server.wait(5), 0)
        self.assertIn("is no coordinator: ", self.said("mbd_server"))

    def test_eight_bytes_take_no_memory(self):
        """Issue 32, 10: the announcement of a frame of 3.6 GB made a server take 3.6 GB."""
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(name_of(self.RUN, "mbd_server"))
            listener.listen(1)
            run = self.start("pendulum.json", "--attach", "--run", self.RUN)
            came, _ = listener.accept()
            with came:
                _, rights, _, _ = came.recvmsg(1, socket.CMSG_SPACE(4))
        memory_file = array.array("i", rights[0][2])[0]
        run.kill()
        server = self.server("mbd_server")
        ours = connect(name_of(self.RUN, "mbd_server"))
        self.addCleanup(ours.close)
        ours.sendmsg([b"m"], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", [memory_file]))])
        self.assertEqual(ours.recv(1), b"a")
        with mmap.mmap(memory_file, 0) as memory:  # protocol/shm/segment.hpp: head of 64 bytes, 2 x 256, rings
            memory[576:584] = struct.pack("<Q", 3_600_000_000)
            memory[64:72] = struct.pack("<Q", 8)
            time.sleep(0.5)
        status = pathlib.Path(f"/proc/{server.pid}/status").read_text()
        self.assertLess(int(re.search(r"VmHWM:\s+(\d+) kB", status)[1]), 500_000)


class Links(Trust):
    def setUp(self):
        super().setUp()
        self.precious = self.folder / "precious"
        self.precious.write_text("precious")

    def check_refused(self, spoil):
        """A run whose next restart files meet what `spoil(folder)` leaves there."""
        process = self.start("hanging_box.json", "--end-time", "1000", "--checkpoint-every", "0.05")
        self.assertTrue(until(lambda: (self.out / "checkpoint").exists(), 10 * harness.options.slack))
        for window in range(150, 20000, 50):
            spoil(self.out / "checkpoint" / f"window_{window:06}")
        try:
            said = process.communicate(timeout=20 * harness.options.slack)[0:2]
        except subprocess.TimeoutExpired:
            process.kill()
            said = process.communicate()
        self.assertEqual(self.precious.read_text(), "precious")
        return process.returncode, "".join(said)

    def test_a_linked_folder_is_refused(self):
        elsewhere = self.folder / "elsewhere"
        elsewhere.mkdir()
        status, said = self.check_refused(lambda folder: folder.symlink_to(elsewhere))
        self.assertEqual(status, 5, said)
        self.assertRegex(said, r"window_\d+: is a symbolic link")
        self.assertEqual(list(elsewhere.iterdir()), [])

    def test_a_linked_file_is_not_followed(self):
        """Issue 32, 9: a file of the server's user was overwritten."""
        def spoil(folder):
            folder.mkdir(exist_ok=True)
            for name in ["mbd.h5", "mbd.h5.part", "dem.h5", "dem.h5.part", "run.h5.part", "mbd.h5.new", "dem.h5.new"]:
                with contextlib.suppress(FileExistsError):
                    (folder / name).symlink_to(self.precious)
        process = self.start("hanging_box.json", "--end-time", "0.3", "--checkpoint-every", "0.05")
        until(lambda: (self.out / "checkpoint").exists(), 10 * harness.options.slack)
        for window in range(150, 350, 50):
            spoil(self.out / "checkpoint" / f"window_{window:06}")
        self.finish(process, 20)  # refused or done, by which file was met first: not followed in any case
        self.assertEqual(self.precious.read_text(), "precious")

    def test_a_server_without_a_folder_writes_nothing(self):
        for program in ["mbd_server", "dem_server"]:
            self.server(program)
        said = self.run_scene("hanging_box.json", "--attach", "--run", self.RUN, "--checkpoint-every", "0.01", expect=2)
        self.assertIn("it was given no folder for states", said)
        self.assertEqual(list(self.out.glob("checkpoint/*/mbd.h5")), [])

    def test_a_server_writes_in_its_folder_only(self):
        other = self.folder / "other"
        other.mkdir()
        for program in ["mbd_server", "dem_server"]:
            self.server(program, "--state-folder", other)
        said = self.run_scene("hanging_box.json", "--attach", "--run", self.RUN, "--checkpoint-every", "0.01", expect=2)
        self.assertRegex(said, f"outside of the folders for states: {other}")
        for program in ["mbd_server", "dem_server"]:
            self.server(program, "--state-folder", self.out)
        self.run_scene("hanging_box.json", "--end-time", "0.02", "--attach", "--run", self.RUN, "--checkpoint-every", "0.01")
        self.assertEqual(len(list(self.out.glob("checkpoint/*/mbd.h5"))), 1)


class OverDds(Trust):
    """Runs over a network, here the loopback: who has not the run's secret is refused and named."""

    def setUp(self):
        super().setUp()
        if not self.has_dds():
            self.skipTest("no DDS in this build")
        self.secret = self.folder / "secret"
        self.tandem("keys", "--secret", self.secret)

    def tandem(self, *arguments):
        subprocess.run([harness.options.bin / "tandem", *arguments], check=True, timeout=20)

    def dds_server(self, *arguments, environment=None):
        with open(self.folder / "mbd_server.log", "w") as log:
            process = subprocess.Popen([harness.options.bin / "mbd_server", "--dds", self.RUN, *arguments], stdout=log,
                                       stderr=log, env=os.environ | (environment or {}))
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def dds_run(self, *arguments, expect=0):
        return self.run_scene("pendulum.json", "--transport", "dds", "--attach", "--run", self.RUN, "--patience", "10",
                              *arguments, expect=expect)

    def test_without_a_secret_nothing_starts(self):
        self.assertIn("has no secret (give --secret-file", self.dds_run(expect=2))
        self.assertEqual(self.dds_server().wait(10), 2)
        self.assertIn("has no secret", self.said("mbd_server"))

    def test_what_is_for_dds_is_refused_elsewhere(self):
        self.assertIn("are for --transport dds", self.run_scene("pendulum.json", "--secret-file", self.secret, expect=2))

    def test_a_secret_that_others_can_read_is_refused(self):
        self.secret.chmod(0o644)
        self.assertIn("other users may read or write this secret", self.dds_run("--secret-file", self.secret, expect=2))

    def test_by_file_and_by_environment(self):
        server = self.dds_server(environment={"TANDEM_SECRET": self.secret.read_text()})
        self.dds_run("--secret-file", self.secret)
        self.assertEqual(server.wait(5), 0)
        self.assertEqual(self.summary()["dds_security"], "secret")

    def test_insecure_is_said(self):
        self.run_scene("pendulum.json", "--transport", "dds", "--insecure")
        self.assertEqual(self.summary()["dds_security"], "none")
        self.assertTrue(any("--insecure" in warning for warning in self.summary()["warnings"]))
        self.assertIn("--insecure: whoever reaches interface lo", self.log())

    def test_the_secret_is_on_no_command_line(self):
        process, servers = self.start_long_run("--transport", "dds", "--secret-file", str(self.secret))
        secret = self.secret.read_text().strip()
        for pid in [process.pid, *servers.values()]:
            self.assertNotIn(secret, pathlib.Path(f"/proc/{pid}/cmdline").read_text())

    @unittest.skipUnless(os.geteuid() == 0, "only root can become another user")
    def test_a_squatter_of_another_user_is_refused(self):
        """Issue 32, 9: who knew the run's name could take part in it."""
        name, program = self.RUN, harness.options.bin.resolve() / "mbd_server"

        def squat():
            found = subprocess.run([program, "--dds", name, "--insecure"], capture_output=True, text=True, timeout=30)
            return found.returncode, found.stderr
        squatter, answer = as_nobody(squat)
        time.sleep(0.5)
        server = self.dds_server("--secret-file", self.secret)
        self.dds_run("--secret-file", self.secret)
        self.assertEqual(server.wait(5), 0)
        self.assertEqual(self.summary()["status"], "ok")
        said = answer()
        self.assertIn("(4, ", said)
        self.assertIn("requires the run's secret, and this end was given none", said)

    def test_a_death_is_named_with_certificates(self):
        self.tandem("keys", "--certificates", self.folder / "certificates")
        process, servers = self.start_long_run("--transport", "dds", "--certificates", str(self.folder / "certificates"))
        os.kill(servers["mbd_server"], signal.SIGKILL)
        _, status, said = self.finish(process)
        self.assertEqual(status, 4, said)
        self.assertRegex(said, rf"mbd_server \(pid {servers['mbd_server']}\) was killed by signal 9")
        self.assert_gone(servers.values())
        self.assertEqual(self.summary()["dds_security"], "certificates, secret")


class Heartbeat(Case):
    def test_a_stopped_coordinator_is_noticed(self):
        """Issue 32, 10: servers waited an hour for a hung coordinator."""
        process, servers = self.start_long_run("--lease", "0.5")
        process.send_signal(signal.SIGSTOP)
        seconds = self.assert_gone(servers.values(), 1.5)
        print(f"\n  servers left {seconds:.2f} s after the stop")
        for server in servers:
            self.assertRegex(self.log(), rf"{server} +error +coordinator \(pid {process.pid}\) "
                             r"(gave no sign of life for 500 ms|was lost in window \d+, while)")
        process.kill()

    def test_a_stopped_server_is_noticed(self):
        process, servers = self.start_long_run("--lease", "0.5")
        os.kill(servers["dem_server"], signal.SIGSTOP)
        seconds, status, said = self.finish(process, 2)
        self.assertEqual(status, 4, said)
        self.assertRegex(said, rf"dem_server \(pid {servers['dem_server']}\) gave no sign of life for 500 ms")

    def check_survives(self, *arguments):
        process, servers = self.start_long_run(*arguments)
        for victim in [process.pid, *servers.values()]:
            os.kill(victim, signal.SIGSTOP)
        time.sleep(3)
        for victim in [*servers.values(), process.pid]:
            os.kill(victim, signal.SIGCONT)
        before = self.windows()
        self.assertTrue(until(lambda: self.windows() > before + 3, 5 * harness.options.slack), "the run goes on")
        os.kill(servers["mbd_server"], signal.SIGSTOP)
        time.sleep(3)
        os.kill(servers["mbd_server"], signal.SIGCONT)
        before = self.windows()
        self.assertTrue(until(lambda: self.windows() > before + 3, 5 * harness.options.slack), "the run goes on")
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.finish(process, 2)[1], 130)
        self.assertFalse(any(alive(pid) for pid in servers.values()))

    def test_a_suspend_is_survived(self):
        self.check_survives()

    def test_a_suspend_is_survived_over_dds_when_asked(self):
        """Issue 32, 10: the lease could not be set."""
        if not self.has_dds():
            self.skipTest("no DDS in this build")
        self.check_survives("--transport", "dds", "--lease", "10")

    def test_senseless_times_are_refused(self):
        for arguments, sentence in [(["--lease", "0.01"], "--lease: 0.01 s is out of bounds (give 0.05 to 3600 s)"),
                                    (["--lease", "nan"], "--lease: nan s is out of bounds"),
                                    (["--patience", "1e10"], "--patience: 1e+10 s is out of bounds"),
                                    (["--patience", "-1"], "--patience: -1 s is out of bounds")]:
            self.assertIn(sentence, self.run_scene("pendulum.json", *arguments, expect=2))


if __name__ == "__main__":
    harness.main()
