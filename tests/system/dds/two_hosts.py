#!/usr/bin/python3
"""Runs over DDS between two "hosts": network namespaces joined by a veth pair, each with its own /dev/shm and its own
loopback. The namespaces have no names and live as long as their processes, so nothing is left behind, whatever happens.

usage: two_hosts.py CASE --bin FOLDER --scene SCENE [--end-time S] [--slack FACTOR]
Exit status 77 (skipped) only where TANDEM_SKIP_NETNS=1 is set and namespaces cannot be made."""

import argparse
import ctypes
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
A, B = "10.77.0.1", "10.77.0.2"
LIMIT = 100  # bound of any wait [s]; ctest has a longer one
PROMPT = 1.0  # survivors of a disaster end within this time [s]


def fail(sentence):
    sys.exit(f"FAILED: {sentence}")


def die_with_parent():
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def enter_host_a():
    """Starts this script again inside new namespaces, which become host A."""
    unshare = ["unshare", "--net", "--mount"] + ([] if os.geteuid() == 0 else ["--map-root-user"])
    probe = subprocess.run(unshare + ["mount", "-t", "tmpfs", "tmpfs", "/dev/shm"], capture_output=True, text=True)
    if probe.returncode != 0:
        if os.environ.get("TANDEM_SKIP_NETNS") == "1":
            print(f"skipped: no network namespaces here: {probe.stderr.strip()}")
            sys.exit(77)
        fail(f"this test needs network and mount namespaces, but 'unshare' says: {probe.stderr.strip()}. Run it as root, "
             "allow user namespaces (sysctl kernel.unprivileged_userns_clone=1), or skip it with TANDEM_SKIP_NETNS=1")
    os.environ["TANDEM_IN_HOST_A"] = "1"
    os.execvp("unshare", unshare + [sys.executable] + sys.argv)


class Hosts:
    """Host A is where this process lives; host B is entered through its first process."""

    def __init__(self):
        self.children = []
        subprocess.run(["mount", "-t", "tmpfs", "tmpfs", "/dev/shm"], check=True)
        self.b = self.start(["unshare", "--net", "--mount", "sh", "-c",
                             "mount -t tmpfs tmpfs /dev/shm && ip link set lo up && echo ready && exec sleep 1000"],
                            stdout=subprocess.PIPE)
        if self.b.stdout.readline() != b"ready\n":
            fail("host B did not start")
        self.enter_b = ["nsenter", "--net", "--mount", "--target", str(self.b.pid), f"--wd={ROOT}"]
        for command in (["ip", "link", "set", "lo", "up"],
                        ["ip", "link", "add", "veth-a", "type", "veth", "peer", "name", "veth-b", "netns", str(self.b.pid)],
                        ["ip", "address", "add", f"{A}/24", "dev", "veth-a"],
                        ["ip", "link", "set", "veth-a", "up"],
                        self.enter_b + ["ip", "address", "add", f"{B}/24", "dev", "veth-b"],
                        self.enter_b + ["ip", "link", "set", "veth-b", "up"]):
            subprocess.run(command, check=True)

    def start(self, command, **options):
        child = subprocess.Popen(command, preexec_fn=die_with_parent, **options)
        self.children.append(child)
        return child

    def shared_memory(self):
        return [subprocess.run(enter + ["ls", "/dev/shm"], check=True, capture_output=True, text=True).stdout
                for enter in ([], self.enter_b)]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for child in self.children:
            child.kill()
            child.wait()


class Test:
    def __init__(self, hosts, options, folder):
        self.hosts, self.options, self.folder = hosts, options, folder
        self.tandem = options.bin / "tandem"
        self.scene = self.take_scene()
        self.secret = folder / "secret"
        self.secret.touch(0o600)
        self.secret.write_text("0123456789abcdef0123456789abcdef\n")

    def take_scene(self):
        """A copy of the scene that ends when we want it, and that host B cannot read: it comes over the network."""
        scenes = self.folder / "scenes"
        shutil.copytree(self.options.scene.parent, scenes)
        copy = scenes / self.options.scene.name
        scene = json.loads(copy.read_text())
        if self.options.end_time is not None:
            scene["end_time"] = self.options.end_time
            scene.pop("checks", None)  # they are about the whole run
        copy.write_text(json.dumps(scene))
        subprocess.run(self.hosts.enter_b + ["mount", "-t", "tmpfs", "tmpfs", scenes], check=True)
        return copy

    def run(self, *extra, name):
        """One run to its end; returns its summary."""
        out = self.folder / name
        command = [self.tandem, "run", self.scene, "--out", out, "--threads", "1", "--no-picture", "--no-report"]
        result = subprocess.run(command + list(extra), capture_output=True, text=True,
                                timeout=LIMIT, preexec_fn=die_with_parent)
        if result.returncode != 0:
            fail(f"run '{name}' ended with status {result.returncode}:\n{result.stdout}{result.stderr}{self.logs()}")
        return json.loads((out / "summary.json").read_text())

    def logs(self):
        return "".join(f"--- {path.name}\n{path.read_text()}" for path in sorted(self.folder.glob("*.log")))

    def server(self, program, host, run):
        """Starts one server by hand, as a user does."""
        log = open(self.folder / f"{program}.log", "w")
        script = ROOT / "launch" / {"mbd_server": "start_mbd", "dem_server": "start_dem"}[program]
        command = [script, "--bin", self.options.bin, "--dds", run, "--secret-file", self.secret]
        if host == "A":
            command = command + ["--interface", "veth-a"]
        else:
            command = self.hosts.enter_b + command + ["--interface", "veth-b", "--peer", A]
        return self.hosts.start(command, stdout=log, stderr=log)

    @property
    def dds(self):
        return ["--transport", "dds", "--attach", "--dds-interface", "veth-a", "--secret-file", self.secret]

    def same_result(self):
        inproc = self.run("--transport", "inproc", name="inproc")
        shm = self.run("--transport", "shm", name="shm")
        servers = [self.server("mbd_server", "A", "same"), self.server("dem_server", "B", "same")]
        dds = self.run(*self.dds, "--run", "same", "--dds-peer", B, name="dds")
        for server in servers:
            if server.wait(timeout=LIMIT) != 0:
                fail(f"a server left with status {server.returncode}:\n{self.logs()}")
        for summary, transport in ((inproc, "inproc"), (shm, "shm"), (dds, "dds")):
            print(f"{transport:7} state_hash {summary['state_hash']}, {summary['windows']} windows, "
                  f"wall {summary['wall_s']:.2f} s")
            if summary["transport"] != transport:
                fail(f"the summary of the {transport} run says transport {summary['transport']}")
        if len({summary["state_hash"] for summary in (inproc, shm, dds)}) != 1:
            fail("the transports do not give the same state")
        if self.hosts.shared_memory() != ["", ""]:
            fail(f"something is left in /dev/shm: {self.hosts.shared_memory()}")

    def ssh_example(self):
        """launch/ssh/run_distributed, with a stand-in for ssh that enters host B instead of connecting to it."""
        ssh = self.folder / "ssh"
        ssh.write_text(f'#!/bin/sh\n[ "$1" = user@nodeb ] && exec {" ".join(self.hosts.enter_b)} sh -c "$2"\n')
        ssh.chmod(0o755)
        out = self.folder / "out"
        result = subprocess.run(
            [ROOT / "launch/ssh/run_distributed", self.scene, "--out", out, "--interface", "veth-a", "--dem",
             "user@nodeb", "--remote-interface", "veth-b", "--bin", self.options.bin, "--", "--no-picture", "--no-report"]
           ,
            env=os.environ | {"TANDEM_SSH": str(ssh)}, capture_output=True, text=True, timeout=LIMIT,
            preexec_fn=die_with_parent)
        if result.returncode != 0:
            logs = "".join(path.read_text() for path in self.folder.glob("*.log"))
            fail(f"run_distributed ended with status {result.returncode}:\n{result.stdout}{result.stderr}{logs}")
        if json.loads((out / "summary.json").read_text())["transport"] != "dds":
            fail("the run did not use DDS")

    def survivors_end(self, disaster, victims):
        """A run over both hosts, a disaster in its midst: all others end soon, each with a reason."""
        processes = {"mbd_server": self.server("mbd_server", "A", "doomed"),
                     "dem_server": self.server("dem_server", "B", "doomed")}
        log = open(self.folder / "tandem.log", "w")
        processes["tandem"] = self.hosts.start(
            [self.tandem, "run", self.scene, "--out", self.folder / "out", "--threads", "1", "--no-report",
             "--no-picture"] + self.dds + ["--run", "doomed"], stdout=log, stderr=log)
        self.wait_for_windows()
        disaster(processes)
        begin = time.monotonic()
        for name, process in processes.items():
            status = process.wait(timeout=20)
            seconds = time.monotonic() - begin
            print(f"{name} ended with status {status} after {seconds:.2f} s")
            if name in victims:
                continue
            if status != 4:
                fail(f"{name} ended with status {status}, not 4:\n{self.logs()}")
            if seconds > PROMPT * self.options.slack:
                fail(f"{name} took {seconds:.2f} s to end:\n{self.logs()}")
            self.show_reason(name)

    def wait_for_windows(self):
        table = self.folder / "out" / "bodies.csv"
        limit = time.monotonic() + LIMIT
        while not (table.exists() and table.stat().st_size > 4096):
            if time.monotonic() > limit:
                fail(f"the run made no progress:\n{self.logs()}")
            time.sleep(0.02)

    def show_reason(self, name):
        text = (self.folder / f"{name}.log").read_text()
        reason = [line for line in text.splitlines()
                  if re.search(r"fell silent|closed its end|died in window", line)]
        if not reason:
            fail(f"{name} gave no reason:\n{text}")
        print(f"  {reason[-1].strip()}")

    def killed_server(self):
        def kill(processes):
            processes["dem_server"].send_signal(signal.SIGKILL)
        self.survivors_end(kill, {"dem_server"})
        text = (self.folder / "tandem.log").read_text()
        if "dem_server (pid" not in text:
            fail(f"the coordinator does not name the dead peer:\n{text}")

    def cut_cable(self):
        def cut(_):
            subprocess.run(["ip", "link", "set", "veth-a", "down"], check=True)
        # mbd_server shares host A with the coordinator, but its address is on the cable that went.
        self.survivors_end(cut, set())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", choices=["same_result", "ssh_example", "killed_server", "cut_cable"])
    parser.add_argument("--bin", type=Path, required=True, help="folder of the programs under test")
    parser.add_argument("--scene", type=Path, required=True)
    parser.add_argument("--slack", type=float, default=1.0, help="factor on the limit of 1 s, for busy or slow machines")
    parser.add_argument("--end-time", type=float, help="of the run, in place of the scene's [s]")
    options = parser.parse_args()
    # The programs are started from other folders, too.
    options.bin, options.scene = options.bin.resolve(), options.scene.resolve()
    if os.environ.get("TANDEM_IN_HOST_A") != "1":
        enter_host_a()
    with tempfile.TemporaryDirectory() as folder, Hosts() as hosts:
        getattr(Test(hosts, options, Path(folder)), options.case)()
    print("ok")


main()
