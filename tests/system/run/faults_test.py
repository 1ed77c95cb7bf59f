#!/usr/bin/env python3
"""Result folders, and what is left in them after kills, full disks, signals and deletions.

TANDEM_KILLS, TANDEM_STOPS and TANDEM_DISKS say how many kills at random times (a fifth as many over DDS), how many stops of each end and how many full
disks; TANDEM_WINDOWS how many windows the run has whose memory is watched; TANDEM_SEED where the random numbers begin.
"""
import collections
import json
import os
import pathlib
import pty
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

import harness
from harness import SCENES, Case, alive, children, until

READER = pathlib.Path(__file__).resolve().parent / "read_results.py"
SERVERS = ["mbd_server", "dem_server"]


def number(name, default):
    return int(os.environ.get(name, default))


class FaultCase(Case):
    def read_results(self, folder=None):
        """What h5py and the standard library find in the folder; a test fails where they cannot read it."""
        # Debian's Python, whose h5py the package list brings.
        said = subprocess.run(["/usr/bin/python3", READER, folder or self.out], capture_output=True, text=True, timeout=120)
        self.assertEqual(said.returncode, 0, said.stderr)
        return json.loads(said.stdout)

    def tandem(self, *arguments, expect=0):
        said = subprocess.run([harness.options.bin / "tandem", *map(str, arguments)], capture_output=True, text=True, timeout=120)
        self.assertEqual(said.returncode, expect, said.stdout + said.stderr)
        return said.stdout + said.stderr

    def status(self, folder=None):
        said = subprocess.run([harness.options.bin / "tandem", "ps", "--status", folder or self.out], capture_output=True, text=True,
                              timeout=60)
        return said.stdout.strip() if said.returncode == 0 else "no run"

    def scene_with_frames(self, end_time=1000):
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        scene.pop("checks")
        scene.update(end_time=end_time, output={"frame_interval": 2e-3})
        path = self.folder / "frames.json"
        path.write_text(json.dumps(scene))
        return path


class ResultFolders(FaultCase):
    def test_files_of_others_stay(self):
        (self.out / "photos").mkdir(parents=True)
        (self.out / "photos" / "me.jpg").write_text("x")
        (self.out / "run.log").write_text("x")
        said = self.run_scene("pendulum.json", expect=2)
        self.assertIn("older version of tandem", said)
        self.assertTrue((self.out / "photos" / "me.jpg").exists())
        shutil.rmtree(self.out)
        for _ in range(2):  # in a folder of a run too
            self.run_scene("pendulum.json", "--checkpoint-every", "0.05")
            (self.out / "photos").mkdir(exist_ok=True)
            (self.out / "photos" / "me.jpg").write_text("x")
            (self.out / "checkpoint" / "notes.txt").write_text("x")
        self.assertRegex(self.log(), "left alone in .*: (photos/, checkpoint/notes.txt|checkpoint/notes.txt, photos/)")

    def test_each_file_of_a_run_is_its_own(self):
        """Whatever a run leaves, the next one takes away."""
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        scene["output"] = {"frame_interval": 1e-2}
        (self.folder / "scene.json").write_text(json.dumps(scene))
        line = [harness.options.bin / "tandem", "run", self.folder / "scene.json", "--out", self.out, "--checkpoint-every", "0.02",
                "--estimate", "richardson", "--quiet"]
        self.assertEqual(subprocess.run(line, timeout=120 * harness.options.slack).returncode, 0)
        self.assertTrue((self.out / "half_steps" / "summary.json").exists())
        self.assertTrue((self.out / "report.html").exists())
        names = []
        for out in self.out, self.folder / "fresh":
            self.run_scene("pendulum.json", out=out)
            names.append(sorted(str(path.relative_to(out)) for path in out.rglob("*")))
        self.assertEqual(*names)

    def test_a_folder_belongs_to_one_run(self):
        process, _ = self.start_long_run()
        said = self.run_scene("pendulum.json", expect=2)
        self.assertIn(f"a run is still in progress in this folder: pid {process.pid} on ", said)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGINT)
        self.finish(process, 5)
        self.assertEqual(self.summary()["scene"], "hanging_box")

    def test_a_folder_that_is_deleted_is_an_error(self):
        for arguments in [], ["--checkpoint-every", "0.002"]:
            process, _ = self.start_long_run(*arguments)
            # The run may put a file there while it is being emptied.
            self.assertTrue(until(lambda: shutil.rmtree(self.out, ignore_errors=True) or not self.out.exists(), 5))
            _, status, said = self.finish(process, 10)
            self.assertEqual(status, 5, said)
            self.assertIn("was deleted, moved or replaced while the run went on", said)
            self.assertFalse(self.out.exists())

    def test_a_folder_that_is_moved_gets_its_ending_and_another_in_its_place_nothing(self):
        process, _ = self.start_long_run("--checkpoint-every", "0.002")
        moved = self.folder / "moved"
        self.out.rename(moved)
        self.out.mkdir()
        (self.out / "mine").write_text("x")
        _, status, said = self.finish(process, 10)
        self.assertEqual(status, 5, said)
        self.assertIn("was deleted, moved or replaced while the run went on", said)
        self.assertEqual(os.listdir(self.out), ["mine"])
        self.assertEqual(self.summary(moved)["status"], "failed")

    def test_a_table_or_log_that_is_deleted_is_an_error(self):
        for name in "windows.csv", "run.log":
            process, _ = self.start_long_run()
            (self.out / name).unlink()
            _, status, said = self.finish(process, 10)
            self.assertEqual(status, 5, said)
            self.assertIn(f"{name}: was deleted, moved or replaced while the run went on", said)
            self.assertEqual(self.summary()["status"], "failed")

    def test_the_summary_says_how_far_a_run_is(self):
        process, _ = self.start_long_run()
        self.assertTrue(until(lambda: self.summary()["windows"] > 0, 20 * harness.options.slack), "only that of the start")
        summary = self.summary()
        self.assertEqual((summary["status"], summary["process"]["pid"]), ("running", process.pid))
        self.assertGreater(summary["simulated_s"], 0)
        self.assertEqual(self.status(), "running")
        process.kill()
        process.communicate()
        self.assertEqual(self.status(), "died")

    def test_bytes_that_are_not_utf8_are_refused_at_the_entry(self):
        bad = os.fsencode(self.folder) + b"/p\xff.json"
        shutil.copy(SCENES / "pendulum.json", bad)
        for words in [[bad, b"--out", b"out"], [os.fsencode(SCENES / "pendulum.json"), b"--out", b"o\xff"]]:
            said = subprocess.run([os.fsencode(harness.options.bin / "tandem"), b"run", *words], capture_output=True, timeout=60,
                                  cwd=self.folder)
            self.assertEqual(said.returncode, 2, said.stderr)
            self.assertIn(b"is not UTF-8: \"", said.stderr)
            self.assertIn(b"\\xff", said.stderr)
        scene = (SCENES / "pendulum.json").read_bytes().replace(b'"pendulum"', b'"p\xff"')
        (self.folder / "name.json").write_bytes(scene)
        self.assertIn("invalid string", self.run_bytes("name.json"))

    def run_bytes(self, scene):
        said = subprocess.run([harness.options.bin / "tandem", "run", self.folder / scene, "--out", self.out], capture_output=True,
                              timeout=60)
        self.assertEqual(said.returncode, 2, said.stderr)
        return said.stderr.decode(errors="replace")


class ListOfRuns(FaultCase):
    def test_ps_and_stop(self):
        self.assertEqual(self.tandem("ps"), "no runs\n")
        first, _ = self.start_long_run("--checkpoint-every", "500")
        second_out = self.folder / "second"
        second = self.start("pendulum.json", "--end-time", "1000", out=second_out)
        self.assertTrue(until(lambda: len(json.loads(self.tandem("ps", "--json"))) == 2, 10 * harness.options.slack))
        self.assertTrue(until(lambda: all(run["windows"] for run in json.loads(self.tandem("ps", "--json"))), 10 * harness.options.slack))
        runs = {run["pid"]: run for run in json.loads(self.tandem("ps", "--json"))}
        self.assertEqual({pid: run["folder"] for pid, run in runs.items()},
                         {first.pid: str(self.out), second.pid: str(second_out)})
        self.assertEqual({run["status"] for run in runs.values()}, {"running"})
        self.assertRegex(self.tandem("ps"), rf"{first.pid}  running .* hanging_box .* {self.out}\n")
        second.kill()
        second.communicate()
        self.assertEqual(self.status(second_out), "died")
        self.assertRegex(self.tandem("ps"), rf"{second.pid}  died ")
        self.tandem("stop", self.out)
        _, status, _ = self.finish(first, 5)
        self.assertEqual(status, 130)
        self.assertEqual(len(list(self.out.glob("checkpoint/*/run.h5"))), 1)
        self.assertIn("no such run is in progress on this host", self.tandem("stop", self.out, expect=2))
        self.assertIn("no such run is in progress on this host", self.tandem("stop", second.pid, expect=2))
        self.assertEqual(self.tandem("ps", "--forget-died"), "1 forgotten\nno runs\n")


class Signals(FaultCase):
    def start_with(self, *arguments, prefix=(), **options):
        shutil.rmtree(self.out, ignore_errors=True)
        line = [*prefix, harness.options.bin / "tandem", "run", SCENES / "hanging_box.json", "--out", self.out, "--no-picture",
                "--no-report", "--checkpoint-every", "500", *arguments]
        process = subprocess.Popen([str(word) for word in line], text=True, **options)
        self.started.append(process)
        return process

    def check_interrupted(self, process):
        self.assertEqual(process.wait(10 * harness.options.slack), 130)
        summary = self.summary()
        self.assertEqual((summary["status"], summary["reason"]), ("failed", "interrupted"))
        self.assertEqual(len(list(self.out.glob("checkpoint/*/run.h5"))), 1, "the last checkpoint")
        self.assertEqual(self.read_results()["rows"]["bodies"], summary["windows"])

    def test_a_closed_terminal(self):
        """SIGHUP to all programs of the run, to the first one as often as it comes."""
        process = self.start_with("--end-time", "1000")
        self.assertTrue(until(lambda: self.windows() > 3, 20 * harness.options.slack))
        for server in children(process.pid).values():
            os.kill(server, signal.SIGHUP)
        for _ in range(3):
            process.send_signal(signal.SIGHUP)
            time.sleep(0.002)
        self.check_interrupted(process)

    def test_nohup(self):
        process = self.start_with("--end-time", "1000", prefix=["nohup"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.assertTrue(until(lambda: self.windows() > 3, 20 * harness.options.slack))
        process.send_signal(signal.SIGHUP)
        seen = self.windows()
        self.assertTrue(until(lambda: self.windows() > seen + 3, 20 * harness.options.slack), "a SIGHUP that nohup keeps off")
        # As systemd and batch systems do: to all programs of the run.
        for program in [*children(process.pid).values(), process.pid]:
            os.kill(program, signal.SIGTERM)
        self.check_interrupted(process)

    def test_a_closed_console(self):
        """SIGPIPE: a run whose console is gone goes on to its end."""
        process = self.start_with("--end-time", "0.3", stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        process.stdout.close()
        process.stderr.close()
        self.assertEqual(process.wait(60 * harness.options.slack), 0)
        self.assertIn(self.summary()["status"], ("ok", "suspect"))
        self.assertEqual(self.read_results()["rows"]["bodies"], 300)
        self.assertIn("the console takes no more text", self.log())

    def test_a_terminal_that_is_gone_without_a_signal(self):
        """The progress line is written to it five times a second."""
        ours, theirs = pty.openpty()
        process = self.start_with("--end-time", "3", stdout=theirs, stderr=theirs)
        os.close(theirs)
        self.assertTrue(until(lambda: self.windows() > 3, 20 * harness.options.slack))
        os.close(ours)
        self.assertEqual(process.wait(120 * harness.options.slack), 0)
        self.assertEqual(self.summary()["windows"], 3000)
        self.assertIn("the console takes no more text", self.log())

    def test_a_limit_of_file_sizes(self):
        """SIGXFSZ: the file that is too large is named; what is complete stays."""
        limit = 150_000
        # Shared memory counts as a file.
        process = self.start_with("--end-time", "1000", "--transport", "inproc", stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        _, said = process.communicate(timeout=60 * harness.options.slack)
        self.assertEqual(process.returncode, 5, said)
        self.assertRegex(said, r"(bodies|joints|windows|border)\.csv: cannot write: File too large")
        self.assertEqual(self.summary()["error"]["code"], "resource")
        self.assertGreater(self.read_results()["rows"]["bodies"], 10)


class FullDisk(FaultCase):
    def test_at_random_places(self):
        """No crash, nothing complete lost, exit 5 with a sentence, and the summary says so."""
        count = number("TANDEM_DISKS", 5)
        random.seed(number("TANDEM_SEED", 1))
        scene, disk, told = self.scene_with_frames(0.3), self.folder / "disk", collections.Counter()
        disk.mkdir()
        for i in range(count):
            size = round(60 * 60 ** random.random())  # 60 kB to 3.6 MB
            every = random.choice(["0.001", "0.005", "0.02"])
            line = f"mount -t tmpfs -o size={size}k none {disk} && {harness.options.bin}/tandem run {scene} --threads 1 " \
                   f"--checkpoint-every {every} --out {disk}/out --no-picture --no-report --quiet; status=$?; " \
                   f"cp -r {disk}/out {self.folder}/kept{i}; exit $status"
            result = subprocess.run(["unshare", "-rm", "sh", "-c", line], capture_output=True, text=True,
                                    timeout=120 * harness.options.slack)
            if "unshare" in result.stderr or "mount:" in result.stderr:
                self.skipTest("no mount namespaces here: " + result.stderr.strip())
            kept = self.folder / f"kept{i}"
            with self.subTest(size=size, every=every):
                if not (kept / "summary.json").exists():  # no room to begin
                    self.assertEqual(result.returncode, 5, result.stderr)
                    self.assertRegex(result.stderr, "No space left on device")
                    told["no room to begin"] += 1
                    continue
                found, summary = self.read_results(kept), self.summary(kept)
                self.assertEqual(found["drafts"], [])
                self.assertIn(summary["windows"] - found["rows"].get("bodies", 0), (0, 1), "the window whose row was refused")
                self.assertLessEqual(found["checkpoints"], 1)
                if result.returncode == 0:
                    told["there was room"] += 1
                    continue
                self.assertEqual(result.returncode, 5, result.stderr)
                self.assertRegex(result.stderr, r"error .*([Ss]pace|disk full)")
                self.assertEqual((summary["status"], summary["error"]["code"]), ("failed", "resource"))
                what = re.search(r"([\w.]+): (cannot|writing|making)", summary["error"]["where"] + ": " + summary["error"]["what"])
                told[re.sub(r"_?\d+", "", what.group(1)) if what else summary["error"]["what"]] += 1
            shutil.rmtree(kept)
        print("\n  the disk was full at:", dict(told))


class Kills(FaultCase):
    def test_over_shm(self):
        self.kill_at_random_times(number("TANDEM_KILLS", 8), "shm")

    def test_over_dds(self):
        if not self.has_dds():
            self.skipTest("no DDS in this build")
        self.kill_at_random_times(number("TANDEM_KILLS", 20) // 5, "dds")

    def kill_at_random_times(self, count, transport):
        """Survivors leave within a second, what was written is readable, a reader says `died`, the next run starts."""
        random.seed(number("TANDEM_SEED", 1))
        scene, slowest, late, told = self.scene_with_frames(), 0.0, 0, collections.Counter()
        for i in range(count):
            target = ["tandem", *SERVERS][i % 3]
            wait = random.choice([0.15, 0.8]) * random.random()
            with self.subTest(kill=i, target=target, wait=wait):
                process = self.start(scene, "--threads", "1", "--checkpoint-every", "0.003", "--transport", transport)
                time.sleep(wait)
                servers = children(process.pid)
                pid = servers.get(target)
                if target != "tandem" and pid is None:
                    target = "tandem"  # before there were servers
                process.kill() if target == "tandem" else os.kill(pid, signal.SIGKILL)
                # A second is what is promised on a machine that is not overloaded; the bound lets tests run side by side.
                survivors = [*servers.values()] if target == "tandem" else [*servers.values(), process.pid]
                seconds = self.assert_gone(survivors, 4)
                process.wait(2 * harness.options.slack)
                slowest, late = max(slowest, seconds), late + (seconds > 1)
                self.check_what_is_left(process, target, pid)
                told[target] += 1
                self.run_scene("pendulum.json", "--end-time", "0.005")
        print(f"\n  {dict(told)} killed over {transport}: the last survivor left after {slowest:.3f} s, {late} after more than 1 s")

    def check_what_is_left(self, process, target, pid):
        if target == "tandem":
            process.communicate()
            marker = self.out / "tandem_run.json"
            if not marker.exists() or marker.stat().st_size and json.loads(marker.read_text())["pid"] != process.pid:
                return  # before the folder was its own
            self.assertEqual(self.status(), "died")
            found = self.read_results()
            if (self.out / "summary.json").exists():
                self.assertEqual(self.summary()["status"], "running")
                self.assertGreaterEqual(found["rows"].get("bodies", 0), self.summary()["windows"])
            return
        _, said = process.communicate()
        self.assertEqual(process.returncode, 4, said)
        self.assertRegex(said, rf"{target} \(pid {pid}\) was killed by signal 9")
        self.assertEqual((self.summary()["status"], self.summary()["error"]["code"]), ("failed", "peer_lost"))
        self.assertEqual(self.status(), "failed")
        found = self.read_results()
        self.assertEqual(found["drafts"], [])
        self.assertEqual(found["not_told"], 0)
        # A window whose bodies could no longer be observed has no row.
        self.assertIn(self.summary()["windows"] - found["rows"].get("bodies", 0), (0, 1))


class Stops(FaultCase):
    LEASE = 0.5  # [s]
    SILENT = {"shm": r"gave no sign of life for \d+ ms", "dds": r"fell silent for \d+ ms"}

    def test_over_shm(self):
        self.stop_at_random_times(number("TANDEM_STOPS", 2), "shm")

    def test_over_dds(self):
        if not self.has_dds():
            self.skipTest("no DDS in this build")
        self.stop_at_random_times(number("TANDEM_STOPS", 1), "dds")

    def stop_at_random_times(self, count, transport):
        """Each end is stopped that many times at random moments: the others say who is silent, and leave."""
        random.seed(number("TANDEM_SEED", 1))
        slowest, named = dict.fromkeys(["tandem", *SERVERS], 0.0), dict.fromkeys(["tandem", *SERVERS], 0)
        for i in range(count):
            for target in slowest:
                with self.subTest(stop=i, target=target):
                    process, servers = self.start_long_run("--threads", "1", "--transport", transport, "--lease", str(self.LEASE))
                    time.sleep(0.1 * random.random())
                    pid = process.pid if target == "tandem" else servers[target]
                    speaker, name = ("_server", "coordinator") if target == "tandem" else ("tandem", target)
                    sentence = re.compile(rf"{speaker} +error .*{name} \(pid {pid}( on \S+)?\) {self.SILENT[transport]}")
                    os.kill(pid, signal.SIGSTOP)
                    begin = time.monotonic()
                    # The bound beyond the lease lets tests run side by side; the time is printed.
                    self.assertTrue(until(lambda: sentence.search(self.log()), (self.LEASE + 1.5) * harness.options.slack),
                                    self.log())
                    slowest[target] = max(slowest[target], time.monotonic() - begin)
                    self.check_the_others_leave(process, target, servers)
                    named[target] += 1
        print(f"\n  over {transport}, with a lease of {self.LEASE} s, stopped, named: " +
              "; ".join(f"{target} {count}, {named[target]}, at the latest after {seconds:.3f} s" for target, seconds in slowest.items()))

    def check_the_others_leave(self, process, target, servers):
        if target == "tandem":
            self.assert_gone(servers.values(), 2)
            process.kill()
            process.communicate()
            self.assertEqual(self.status(), "died")
            return
        self.assertEqual(self.finish(process, 3)[1], 4)
        self.assertEqual((self.summary()["status"], self.summary()["error"]["code"]), ("failed", "peer_lost"))
        self.assert_gone(servers.values(), 2)


class Memory(FaultCase):
    def resident(self, pid):
        """Memory of a process [kB], 0 where it is gone."""
        try:
            return int(re.search(r"VmRSS:\s+(\d+)", pathlib.Path(f"/proc/{pid}/status").read_text()).group(1))
        except (OSError, AttributeError):
            return 0

    def test_does_not_grow_with_the_windows(self):
        """Rows took 280 B for each window and body; over these windows that would be 2.8 MB, and the bound is 1.5."""
        if harness.options.slack > 1:
            self.skipTest("sanitizers keep memory that was freed")
        windows = number("TANDEM_WINDOWS", 12_000)
        scene = json.loads((SCENES / "hanging_box.json").read_text())
        scene["dem"]["particles"][0]["fill"]["count"] = 2
        scene["coupling"]["window"] = 1e-5
        scene["end_time"] = 1e-5 * windows
        scene["checks"].append({"name": "it swings", "of": "box.position.z", "reduce": "range", "expected": 0, "tolerance": 10,
                                "absolute": True, "why": "the rows are read back"})
        (self.folder / "scene.json").write_text(json.dumps(scene))
        process = self.start(self.folder / "scene.json", "--threads", "1", "--checkpoint-every", str(windows * 1e-7))
        begin, seen = windows // 6, []
        while process.poll() is None:
            done = (self.out / "windows.csv").stat().st_size / 110 if (self.out / "windows.csv").exists() else 0
            if done > begin:
                pids = {"tandem": process.pid, **children(process.pid)}
                seen.append({name: self.resident(pid) for name, pid in pids.items()})
            time.sleep(0.05 if windows < 100_000 else 5)
        said = process.communicate()
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(self.summary()["windows"], windows)
        self.assertGreater(len(seen), 3, "it was over too soon to see")
        for name in ["tandem", *SERVERS]:
            sizes = [one[name] for one in seen if one.get(name)]
            print(f"\n  {name}: {sizes[0]} kB after {begin} windows, {sizes[-1]} kB after {windows}")
            self.assertLess(sizes[-1] - sizes[0], 1500)


if __name__ == "__main__":
    harness.main()
