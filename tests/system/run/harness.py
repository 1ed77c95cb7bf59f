"""Starts, watches and kills whole programs of tandem. Standard library only."""
import argparse
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

SCENES = pathlib.Path(__file__).resolve().parent.parent / "scenes"
options = argparse.Namespace(bin=None, faulty=None, slack=1.0)


def main():
    """run_test.py --bin FOLDER [--faulty FOLDER] [--slack FACTOR] [unittest arguments]"""
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=pathlib.Path, required=True, help="folder of the programs")
    parser.add_argument("--faulty", type=pathlib.Path, help="folder of servers with faults (tests/doubles)")
    parser.add_argument("--slack", type=float, default=1.0, help="factor on time limits, for sanitizers")
    _, rest = parser.parse_known_args(namespace=options)
    unittest.main(argv=[sys.argv[0]] + rest, verbosity=2)


def alive(pid):
    """True while the process runs; a zombie does not."""
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def children(pid):
    """{program: pid} of the servers that `pid` has started."""
    found = {}
    for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            for child in task.read_text().split():
                with contextlib.suppress(OSError):
                    found[pathlib.Path(f"/proc/{child}/comm").read_text().strip()] = int(child)
    return found


def until(condition, limit):
    """Polls until `condition()` is true; its value, or a false one after `limit` seconds."""
    end = time.monotonic() + limit
    while True:
        value = condition()
        if value or time.monotonic() > end:
            return value
        time.sleep(0.002)


class Case(unittest.TestCase):
    """One temporary folder per test; at its end nothing of the run is left, neither processes nor shared memory."""

    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="tandem_system_")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.out = self.folder / "out"
        # The list of runs is that of this test alone.
        os.environ["TANDEM_RUNS"] = str(self.folder / "runs")
        self.started = []
        self.shared_memory = self.our_shared_memory()
        self.addCleanup(self.check_nothing_is_left)

    @staticmethod
    def our_shared_memory():
        return {name for name in os.listdir("/dev/shm") if "tandem" in name}

    @staticmethod
    def has_dds():
        said = subprocess.run([options.bin / "tandem", "--version"], capture_output=True, text=True, check=True).stdout
        return "dds" in said

    def check_nothing_is_left(self):
        for process in self.started:
            process.kill()
            process.communicate()
        left = until(lambda: not (self.our_shared_memory() - self.shared_memory), 2)
        self.assertTrue(left, f"left in /dev/shm: {self.our_shared_memory() - self.shared_memory}")

    def start(self, scene, *arguments, out=None, command="run"):
        line = [options.bin / "tandem", command, SCENES / scene, "--out", out or self.out, "--no-picture", "--no-report",
                *arguments]
        process = subprocess.Popen([str(word) for word in line], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True)
        self.started.append(process)
        return process

    def run_scene(self, scene, *arguments, expect=0, out=None):
        process = self.start(scene, *arguments, out=out)
        stdout, stderr = process.communicate(timeout=60 * options.slack)
        self.assertEqual(process.returncode, expect, stdout + stderr)
        return stdout + stderr

    def start_long_run(self, *arguments):
        """A run in its windows that would take minutes, and its servers."""
        shutil.rmtree(self.out, ignore_errors=True)
        process = self.start("hanging_box.json", "--end-time", "1000", *arguments)
        self.assertTrue(until(lambda: self.windows() > 3, 20 * options.slack), "the run does not begin")
        return process, children(process.pid)

    def windows(self):
        """Windows that the run has logged so far."""
        with contextlib.suppress(OSError):
            return (self.out / "windows.csv").read_text().count("\n") - 1
        return -1

    def finish(self, process, limit=1.0):
        """Waits for the end; its seconds, exit status and what it said."""
        begin = time.monotonic()
        try:
            stdout, stderr = process.communicate(timeout=limit * options.slack)
        except subprocess.TimeoutExpired:
            self.fail(f"still runs after {limit * options.slack} s")
        return time.monotonic() - begin, process.returncode, stdout + stderr

    def assert_gone(self, pids, limit=1.0):
        begin = time.monotonic()
        gone = until(lambda: not any(alive(pid) for pid in pids), limit * options.slack)
        self.assertTrue(gone, f"still there: {[pid for pid in pids if alive(pid)]}")
        return time.monotonic() - begin

    def summary(self, out=None):
        return json.loads(((out or self.out) / "summary.json").read_text())

    def log(self):
        return (self.out / "run.log").read_text()
