#!/usr/bin/env python3
"""Liquid at parts from one STL file: a sheet between two levels, with brackets and an overflow."""
import json
import math
import unittest

import harness
from cad_part import Part, steps
from harness import Case

G, DENSITY, UNIT = 9.81, 1000, 0.02  # UNIT: a spacing [m]


class CadLiquid(Case):
    high, low, width = 10, 5, 8  # levels and width [spacings]

    def bulkhead(self, thickness):
        """A sheet across x, with a round overflow above the levels and brackets on its dry side; of a thickness it is
        a closed plate without overflow."""
        part, top, joint = Part(), 13 * UNIT, 10.5 * UNIT
        y = steps(-self.width / 2 * UNIT, self.width / 2 * UNIT, 4)
        if thickness > 0:
            a, b = -0.5 * thickness, 0.5 * thickness
            for x in (a, b):
                part.grid(lambda u, v, x=x: (x, u, v), y, [0, joint, top])
            rim = [(u, 0) for u in y] + [(y[-1], joint)] + [(u, top) for u in reversed(y)] + [(y[0], joint)]
            for c, d in zip(rim, rim[1:] + rim[:1]):
                part.quad((a, *c), (a, *d), (b, *d), (b, *c))
        else:
            part.grid(lambda u, v: (0, u, v), y, [0, joint])
            part.panel_with_hole(lambda u, v: (0, u, v), y, steps(joint, top, 4), 0.75 * UNIT)
        for k in (-1, 1):
            part.quad((0.5 * thickness, k * UNIT, 7 * UNIT), (2 * UNIT, k * UNIT, 7 * UNIT), (2 * UNIT, k * UNIT, 9 * UNIT),
                      (0.5 * thickness, k * UNIT, 9 * UNIT))
        part.write(self.folder / "bulkhead.stl", scale=1000)

    def scene(self, thickness, end):
        self.bulkhead(thickness)
        half, top = 0.5 * thickness, 13 * UNIT

        def basin(name, length, sign):
            return {"name": name, "position": [sign * (half + 0.5 * length * UNIT), 0, 0.5 * top],
                    "shape": {"type": "box", "size": [length * UNIT, self.width * UNIT, top], "open": ["+z", "+x" if sign < 0 else "-x"]}}
        scene = {
            "tandem": "1.1", "name": "bulkhead", "end_time": end, "coupling": {"window": 0.005},
            "sph": {
                "spacing": UNIT,
                "liquids": [{"name": "water", "density": DENSITY, "viscosity": 0.001, "artificial_viscosity": 0.1,
                             "fill": [{"type": "inside", "wall": "deep", "level": self.high * UNIT},
                                      {"type": "inside", "wall": "shallow", "level": self.low * UNIT}]}],
                "walls": [basin("deep", 10, -1), basin("shallow", 5, 1),
                          {"name": "bulkhead", "shape": {"type": "mesh", "file": "bulkhead.stl", "scale": 1e-3}}],
                "sensors": [{"type": "load", "name": "on_bulkhead", "wall": "bulkhead"}, {"type": "load", "name": "on_all"},
                            {"type": "region", "name": "beyond", "position": [0.2, 0, 0.2],
                             "shape": {"type": "box", "size": [0.4, 0.4, 0.8]}}],
                "domain": {"min": [-0.3, -0.2, -0.1], "max": [0.2, 0.2, 0.4]}}}
        path = self.folder / "bulkhead.json"
        path.write_text(json.dumps(scene))
        return path

    def judge(self, thickness, end):
        said = self.run_scene(self.scene(thickness, end), "--threads", "1")
        self.assertNotIn("is open at", said)  # the bulkhead closes both basins
        rows = [line.split(",") for line in (self.out / "sensors.csv").read_text().splitlines()]
        columns = {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}

        def mean(name):
            late = [x for t, x in zip(columns["time"], columns[name]) if t > 0.5 * end]
            return sum(late) / len(late)
        sph = self.summary()["sph"]
        c2 = sph["sound_speed_m_per_s"] ** 2

        def push(level):
            """Half the product of pressure at the bottom and wetted area; the liquid is compressed by its weight."""
            depth = level * UNIT
            return 0.5 * DENSITY * G * depth * self.width * UNIT * c2 / G * math.log(1 + G * depth / c2)
        expected = push(self.high) - push(self.low)
        weight = sph["particles"] * DENSITY * UNIT ** 3 * G
        beyond = self.low * 5 * self.width
        print(f"\n  a bulkhead of {1000 * thickness:g} mm between levels of {self.high} and {self.low} spacings")
        for what, want, seen, share in (("force across [N]", expected, mean("on_bulkhead.force.x"), 0.01 * expected),
                                        ("force upwards [N]", 0, mean("on_bulkhead.force.z"), 0.01 * expected),
                                        ("load on all walls [N]", -weight, mean("on_all.force.z"), 0.002 * weight),
                                        ("particles beyond", beyond, max(columns["beyond.count"]), 0),
                                        ("particles beyond, least", beyond, min(columns["beyond.count"]), 0),
                                        ("particles that passed a wall", 0, sph["passed_walls"], 0)):
            print(f"    {what:30} expected {want:10.5g}  measured {seen:10.5g}  tolerance {share:8.3g}")
            self.assertLessEqual(abs(seen - want), share, what)

    def test_a_sheet_without_thickness(self):
        self.judge(0, 0.15)

    def test_a_thin_plate(self):
        self.judge(0.001, 0.15)


if __name__ == "__main__":
    harness.main()
