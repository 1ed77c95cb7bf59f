#!/usr/bin/env python3
"""What Python costs a run: python_overhead.py [RUNS]; PYTHONPATH=python, TANDEM=PROGRAM.

1. A run of the pendulum_control machine without callbacks, from Python and by the command, alternately: wall times, and the processor time and
   the time before and after the program that Python adds.
2. The same machine under a controller function: time from the receipt of a question to the answer before it is sent, and what a window takes more."""
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import tandem as td


def machine(end, controlled):
    s = td.Scene("held", end_time=end, window=2e-3, frame_interval=0)
    bob = s.body("bob", mass=1, inertia=(.01, .01, .01), at=(0, 0, -1))
    s.actuator("motor", s.revolute("hinge", "ground", bob, at=(0, 0, 0), axis="y"), **({"input": "torque"} if controlled else {"size": 4.7}))
    if controlled:
        s.observe("hinge.q", "hinge.rate")
    return s


def processor():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def hold(time, sensors):
    return {"torque": 40 * (.5 - sensors["hinge.q"]) - 14 * sensors["hinge.rate"] + 9.81 * math.sin(.5)}


def main(runs=3):
    os.chdir(tempfile.mkdtemp())
    s, ours, theirs, own, around = machine(100, False), [], [], [], []
    s.save("s.json")
    for _ in range(runs):
        begin, used = time.monotonic(), processor()
        run = s.start("a", picture=False, report=False)
        started = time.monotonic()
        run.process.wait()
        ended = time.monotonic()
        run.wait()
        ours.append(time.monotonic() - begin)
        own.append(processor() - used)
        around.append(ours[-1] - (ended - started))
        begin = time.monotonic()
        subprocess.run([os.environ["TANDEM"], "run", "s.json", "--out", "b", "--no-picture", "--no-report", "--quiet"], check=True)
        theirs.append(time.monotonic() - begin)
    a, b = statistics.median(ours), statistics.median(theirs)
    print(f"run of {b:.2f} s by the command, {a:.2f} s from Python (medians of {runs}); Python takes {1e3 * statistics.median(own):.1f} ms of processor time and "
          f"{1e3 * statistics.median(around):.1f} ms before and after the program: {100 * statistics.median(around) / b:.2f} %")

    os.environ["TANDEM_TIME_CONTROLLER"] = "1"
    run = machine(20, True).start("c", controller=hold, picture=False, report=False)
    served = run._controller
    controlled = run.wait().summary
    free = machine(20, False).run("d", picture=False, report=False).summary
    calls = sorted(1e6 * each for each in served.calls)
    extra = 1e6 * (controlled["wall_s"] / controlled["windows"] - free["wall_s"] / free["windows"])
    print(f"{len(calls)} windows: {statistics.median(calls):.1f} us from a question to its answer (median; 90 %: {calls[int(.9 * len(calls))]:.1f} us); "
          f"a window takes {extra:.1f} us more than without a controller")


main(*map(int, sys.argv[1:2]))
