#!/usr/bin/env python3
"""CPU time that one call of advance() of idle_particles.py takes: from the C function pointer through ctypes to the solver and
back, with one body. usage: PYTHONPATH=python python_call.py"""
import ctypes
import pathlib
import time
import types

import numpy as np

from tandem import layout, participant

source = pathlib.Path(__file__).with_name("idle_particles.py").read_text()
names = {}
exec(source.replace("participant.run(", "SOLVER = ("), names)  # the class without the run
solver = names["Idle"]()
solver.configure(types.SimpleNamespace(boundary=[0]))
table, kept = participant._table(solver)

bodies, boundary = np.zeros(2, layout.BODY_LOAD), np.zeros(1, layout.BODY_MOTION)
motion = layout.MotionSet(layout.Window(0, 0, 1000000), 1, boundary.ctypes.data)
loads = layout.LoadSet(layout.Window(0, 0, 1000000), layout.Account(), 1, bodies.ctypes.data)
advance = table.advance
counts = 20000
best = []
for _ in range(5):
    begin = time.process_time()
    for _ in range(counts):
        if advance(None, ctypes.byref(motion), ctypes.byref(loads)):
            raise SystemExit("the call failed")
    best.append((time.process_time() - begin) / counts * 1e6)
print(f"{min(best):.2f} us per call, of {counts} calls, least of 5; all: " + " ".join(f"{value:.2f}" for value in best))
