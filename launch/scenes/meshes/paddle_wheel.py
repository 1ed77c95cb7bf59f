#!/usr/bin/env python3
"""Writes paddle_wheel.obj: a hub about the y axis with eight paddles, for the waterfall scenes [m]."""
import math
import pathlib

HUB_RADIUS, RADIUS, WIDTH, THICKNESS, PADDLES, SEGMENTS = 0.07, 0.34, 0.76, 0.02, 8, 48

vertices, faces = [], []


def ring(radius, y):
    first = len(vertices)
    for k in range(SEGMENTS):
        a = 2 * math.pi * k / SEGMENTS
        vertices.append((radius * math.cos(a), y, radius * math.sin(a)))
    return first


def quad(a, b, c, d):
    faces.extend([(a, b, c), (a, c, d)])


near, far = ring(HUB_RADIUS, -WIDTH / 2), ring(HUB_RADIUS, WIDTH / 2)
centre_near, centre_far = len(vertices), len(vertices) + 1
vertices.extend([(0, -WIDTH / 2, 0), (0, WIDTH / 2, 0)])
for k in range(SEGMENTS):
    n = (k + 1) % SEGMENTS
    quad(near + k, near + n, far + n, far + k)
    faces.extend([(centre_near, near + n, near + k), (centre_far, far + k, far + n)])

for p in range(PADDLES):
    a = 2 * math.pi * p / PADDLES
    radial, normal = (math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))
    first = len(vertices)
    # The foot stays inside the hub, so that no gap opens between hub and paddle.
    for r in (HUB_RADIUS - 0.005, RADIUS):
        for t in (-THICKNESS / 2, THICKNESS / 2):
            for y in (-WIDTH / 2 + 1e-4, WIDTH / 2 - 1e-4):
                vertices.append((r * radial[0] + t * normal[0], y, r * radial[1] + t * normal[1]))
    c = [first + i for i in range(8)]
    quad(c[0], c[1], c[3], c[2])
    quad(c[4], c[6], c[7], c[5])
    quad(c[0], c[4], c[5], c[1])
    quad(c[2], c[3], c[7], c[6])
    quad(c[0], c[2], c[6], c[4])
    quad(c[1], c[5], c[7], c[3])

lines = ["# made by paddle_wheel.py"]
lines += [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in vertices]
lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
(pathlib.Path(__file__).parent / "paddle_wheel.obj").write_text("\n".join(lines) + "\n")
