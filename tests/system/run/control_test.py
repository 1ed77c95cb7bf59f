#!/usr/bin/env python3
"""A run under a controller outside, and under controllers that fail."""
import json
import pathlib
import sys

import harness
from harness import Case

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "launch" / "scenes"


class Control(Case):
    def summary_of(self, controller, *arguments, expect=0, out=None):
        out = out or self.out
        self.run_scene(SHIPPED / "pendulum_control.json", "--controller", controller, *arguments, out=out, expect=expect)
        return self.summary(out)

    def shipped(self):
        return f"{sys.executable} {SHIPPED / 'pendulum_control.py'}"

    def test_the_shipped_controller_holds_the_pendulum(self):
        summary = self.summary_of(self.shipped())
        self.assertEqual(summary["status"], "ok")
        for check in summary["checks"]:
            print(f"\n  {check['name']}: {check['value']:.9f}, expected {check['expected']} +- {check['tolerance']}")
        rows = (self.out / "control.csv").read_text().splitlines()
        self.assertEqual((rows[0], len(rows)), ("time,torque", 2501))

    def test_same_bits_on_every_transport(self):
        hashes = set()
        for transport in ["shm", "inproc"]:
            summary = self.summary_of(self.shipped(), "--end-time", "0.1", "--transport", transport,
                                      out=self.folder / transport)
            hashes.add(summary["state_hash"])
        self.assertEqual(len(hashes), 1)

    def test_a_controller_that_dies(self):
        script = self.folder / "dies.py"
        script.write_text("import sys\nsys.stdin.readline()\nsys.stdin.readline()\nraise SystemExit('no idea')\n")
        summary = self.summary_of(f"{sys.executable} {script}", expect=4)
        self.assertEqual(summary["status"], "failed")
        self.assertIn("exited with status 1 at t = 0 s", json.dumps(summary))
        self.assertIn("no idea", (self.out / "run.log").read_text())

    def test_a_controller_ends_with_a_run_that_is_killed(self):
        """Also one that ignores the end of its input, and what it has started."""
        script, pids = self.folder / "stays.py", self.folder / "pids"
        script.write_text(f"""import os, subprocess, sys, time
child = subprocess.Popen(["sleep", "1000"])
with open({str(pids)!r}, "w") as file:
    file.write(f"{{os.getpid()}} {{child.pid}} ")
while True:
    for line in sys.stdin:
        pass
    time.sleep(0.1)
""")
        process = self.start(SHIPPED / "pendulum_control.json", "--controller", f"{sys.executable} {script}")
        self.assertTrue(harness.until(lambda: pids.exists() and pids.read_text().endswith(" "), 20 * harness.options.slack))
        started = pids.read_text().split()
        self.assertTrue(all(harness.alive(pid) for pid in started))
        process.kill()
        process.wait()
        self.assertTrue(harness.until(lambda: not any(harness.alive(pid) for pid in started), 5 * harness.options.slack),
                        "the controller and its child are gone")

    def test_a_second_answer_is_refused(self):
        script = self.folder / "twice.py"
        script.write_text("""import sys
for line in sys.stdin:
    if "time" in line.split(":")[0]:
        print('{"inputs": {"torque": 0}}\\n{"inputs": {"torque": 1}}', flush=True)
""")
        summary = self.summary_of(f"{sys.executable} {script}", expect=4)
        self.assertIn("without being asked at t = 0 s", json.dumps(summary))

    def test_a_controller_that_says_nothing(self):
        summary = self.summary_of("sleep 1000", "--patience", "1", expect=4)
        self.assertIn("controller 'sleep 1000'", json.dumps(summary))
        self.assertIn("did not answer within 1 s", json.dumps(summary))


if __name__ == "__main__":
    harness.main()
