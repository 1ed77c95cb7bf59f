#!/usr/bin/env python3
"""Holds the pendulum of pendulum_control.json at 0.5 rad: a spring and a damper made of numbers, and its weight."""
import json
import math
import sys

MASS, LENGTH, GRAVITY = 1.0, 1.0, 9.81  # kg, m, m/s2
GOAL = 0.5                              # rad
STIFFNESS = 40.0                        # N m/rad
DAMPING = 2 * math.sqrt(1.01 * (STIFFNESS + MASS * GRAVITY * LENGTH))  # N m s/rad

sys.stdin.readline()  # the names of sensors and inputs, which are known here
for line in sys.stdin:
    sensors = json.loads(line)["sensors"]
    weight = MASS * GRAVITY * LENGTH * math.sin(GOAL)
    torque = weight + STIFFNESS * (GOAL - sensors["hinge.q"]) - DAMPING * sensors["hinge.rate"]
    print(json.dumps({"inputs": {"torque": torque}}), flush=True)
