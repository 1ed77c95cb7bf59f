#!/usr/bin/env python3
"""Ranks on two hosts, which are two network namespaces of this one: messages go through sockets, as they do between hosts."""
import json
import os
import pathlib
import re
import signal
import subprocess
import time

import harness
from harness import Case, until

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "launch" / "scenes"
NAMES = [f"tandem{os.getpid()}{side}" for side in "ab"]
ADDRESSES = ["10.58.7.1", "10.58.7.2"]


def ip(*words):
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


class RanksOnTwoHosts(Case):
    def setUp(self):
        if not (harness.options.bin / "dem_server_mpi").exists():
            self.skipTest("this build has no MPI: ranks on two hosts are NOT tested")
        super().setUp()
        try:
            for name in NAMES:
                ip("netns", "add", name)
                self.addCleanup(ip, "netns", "del", name)
            ip("link", "add", "tandem0", "netns", NAMES[0], "type", "veth", "peer", "name", "tandem0", "netns", NAMES[1])
            for name, address in zip(NAMES, ADDRESSES):
                ip("-n", name, "addr", "add", f"{address}/24", "dev", "tandem0")
                for link in ("tandem0", "lo"):
                    ip("-n", name, "link", "set", link, "up")
        except (OSError, subprocess.CalledProcessError) as error:
            reason = (getattr(error, "stderr", "") or str(error)).strip()
            self.skipTest(f"no network namespaces ({reason}): ranks on two hosts are NOT tested")
        # In place of ssh.
        agent = self.folder / "agent"
        agent.write_text("#!/bin/sh\nhost=$1; shift\ncase $host in " + " ".join(
            f"{address}) name={name};;" for name, address in zip(NAMES, ADDRESSES)) +
            ' esac\nexec ip netns exec $name sh -c "$*"\n')
        agent.chmod(0o755)
        self.environment = os.environ | {
            "OMPI_MCA_plm_rsh_agent": str(agent), "OMPI_MCA_btl_tcp_if_include": "10.58.7.0/24",
            "OMPI_MCA_oob_tcp_if_include": "10.58.7.0/24"}

    def start_on_first(self, scene, *arguments, out):
        command = ["ip", "netns", "exec", NAMES[0], harness.options.bin / "tandem", "run", SHIPPED / scene, "--out", out,
                   "--no-picture", "--no-report", "--threads", 1, *arguments]
        return subprocess.Popen([str(word) for word in command], env=self.environment, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def sent_bytes(self):
        said = subprocess.run(["ip", "-n", NAMES[1], "-s", "-j", "link", "show", "tandem0"], check=True, capture_output=True)
        return json.loads(said.stdout)[0]["stats64"]["tx"]["bytes"]

    def rank_1(self):
        for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                if path.read_bytes().split(b"\0")[0].endswith(b"/dem_server_mpi") and \
                        b"OMPI_COMM_WORLD_RANK=1" in (path.parent / "environ").read_bytes() and \
                        str(self.folder).encode() in (path.parent / "environ").read_bytes():
                    return int(path.parent.name)
            except OSError:
                continue
        return None

    def test_the_same_bits_through_sockets(self):
        frames = {}
        for ranks, arguments in ((1, ()), (2, ("--ranks", 2, "--hosts", ",".join(ADDRESSES)))):
            out = self.folder / f"out{ranks}"
            process = self.start_on_first("spring_box.json", "--end-time", 0.15, *arguments, out=out)
            said, _ = process.communicate(timeout=60 * harness.options.slack)
            self.assertEqual(process.returncode, 0, said)
            frames[ranks] = {file.name: file.read_bytes() for file in out.glob("frames/*")}
        self.assertGreater(len(frames[1]), 3)
        self.assertEqual(frames[1], frames[2])
        sent = self.sent_bytes()
        self.assertGreater(sent, 100_000, "messages of ranks between the hosts")
        print(f"\n  spring_box: {len(frames[1])} equal files; rank 1 sent {sent} bytes to the other host")

    def test_a_rank_dies_on_the_other_host(self):
        out = self.folder / "out"
        process = self.start_on_first("box_weight.json", "--ranks", 2, "--hosts", ",".join(ADDRESSES), out=out)
        windows = out / "windows.csv"
        self.assertTrue(until(lambda: windows.exists() and len(windows.read_text().splitlines()) > 3, 20 * harness.options.slack))
        os.kill(self.rank_1(), signal.SIGKILL)
        begin = time.monotonic()
        said, _ = process.communicate(timeout=20 * harness.options.slack)
        seconds = time.monotonic() - begin
        self.assertEqual(process.returncode, 4, said)
        self.assertRegex(said, r"dem_server (on 2 ranks )?\(pid \d+\) .*in window \d+")
        self.assertLess(seconds, 1 * harness.options.slack)
        print(f"\n  all left after {seconds:.3f} s")

    def test_wrong_hosts_are_refused(self):
        for arguments, sentence in [
                (("--ranks", 2, "--hosts", "10.58.7.2,10.58.7.1"), "'10.58.7.2' is not this host"),
                (("--ranks", 2, "--hosts", "10.58.7.1,10.58.7.1"), "'10.58.7.1' is given twice"),
                (("--ranks", 2, "--hosts", "10.58.7.1,a,b"), "2 ranks cannot be on 3 hosts"),
                (("--ranks", 2, "--hosts", "10.58.7.1,-x"), "'-x' is no name of a host"),
                (("--hosts", "10.58.7.1"), "hosts are those of several ranks")]:
            with self.subTest(sentence):
                process = self.start_on_first("box_weight.json", *arguments, out=self.folder / "refused")
                said, _ = process.communicate(timeout=20)
                self.assertEqual(process.returncode, 2, said)
                self.assertRegex(said, "--hosts: .*" + re.escape(sentence))


if __name__ == "__main__":
    harness.main()
