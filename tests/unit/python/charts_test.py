#!/usr/bin/env python3
"""Names at the ends of lines, in charts of results, reports and sweeps: beside the curves, without overlap; and units of the axes."""
import itertools
import json
import pathlib
import tempfile
import unittest

import numpy as np

from tandem.end_labels import label_ends
from tandem.label_places import Box
from tandem.plots import chart, figure
from tandem.responses import response
from tandem.signals import Signal


def boxes(made, texts):
    made.canvas.draw()
    extents = [text.get_window_extent(made.canvas.get_renderer()) for text in texts]
    return [Box(e.x0, e.y0, e.x1, e.y1) for e in extents]


class Beside(unittest.TestCase):
    def check(self, made, axes, texts):
        found = boxes(made, texts)
        frame = axes.get_window_extent(made.canvas.get_renderer())
        self.assertFalse([(a, b) for a, b in itertools.combinations(found, 2) if a.meets(b)])
        self.assertTrue(all(box.left > frame.x1 for box in found), "names are right of the axes")
        self.assertTrue(all(box.inside(Box(0, 0, made.bbox.width, made.bbox.height)) for box in found))

    def test_names_of_lines_that_end_together(self):
        for scale in ("linear", "log"):
            made, axes = figure(1)
            axes[0, 0].set_yscale(scale)
            lines = [(f"line {i}", [1, 1 + 1e-4 * i], "#d9822b") for i in range(8)]
            for _, values, _ in lines:
                axes[0, 0].plot(values)
            limits = axes[0, 0].get_ylim()
            texts = label_ends(axes[0, 0], lines, 1.9)
            self.check(made, axes[0, 0], texts)
            self.assertEqual(axes[0, 0].get_ylim(), limits)
            self.assertEqual([text.get_text() for text in sorted(texts, key=lambda text: text.get_position()[1])], [name for name, *_ in lines])

    def test_lines_without_a_number_have_no_name(self):
        made, axes = figure(1)
        axes[0, 0].plot([1, 2])
        self.assertEqual([text.get_text() for text in label_ends(axes[0, 0], [("a", [1, np.nan], "red"), ("b", [np.nan], "red"), ("", [1], "red")], 2)],
                         ["a"])

    def test_charts_of_results_have_no_legend(self):
        t = np.linspace(0, 1, 5)
        made = chart([Signal("box.position", t, np.stack([t, 1.001 * t, 0 * t], axis=1), "m", ("x", "y", "z"))])
        axes = made.axes[0]
        self.assertIsNone(axes.get_legend())
        self.check(made, axes, axes.texts)
        self.assertEqual({text.get_text() for text in axes.texts}, {"box.position.x", "box.position.y", "box.position.z"})


class Report(unittest.TestCase):
    def test_panels_of_an_element(self):
        from tandem import report_elements
        kept = []
        made, report_elements.svg = report_elements.svg, lambda figure: kept.append(figure) or ""
        self.addCleanup(setattr, report_elements, "svg", made)
        t = np.linspace(0, 1, 5)
        report_elements.element_chart("lift", "cylinder", {"power": ("W", t), "supply_power": ("W", t), "loss_power": ("W", 1.01 * t),
                                                           "flow_a": ("m3/s", t), "flow_b": ("m3/s", -t)}, t)
        power, flow = sorted((axes for axes in kept[0].axes if axes.texts), key=lambda axes: -len(axes.texts))
        self.assertEqual({text.get_text() for text in power.texts}, {"power", "supply", "loss"})
        self.assertEqual({text.get_text() for text in flow.texts}, {"a", "b"})
        for axes in (power, flow):
            self.assertIsNone(axes.get_legend())
            found = boxes(kept[0], axes.texts)
            self.assertFalse([(a, b) for a, b in itertools.combinations(found, 2) if a.meets(b)])


class Row:
    def __init__(self, folder, status="ok", scores=None, **values):
        self.folder, self.status, self.scores, self.values = folder, status, scores or {}, values
        self.results = {"lift.power": Signal("lift.power", np.arange(2), np.arange(2), "W")}


class Sweep:
    def __init__(self, names, rows):
        self.names, self.rows, self.scores = names, rows, ["lift.power:integral", "lift.power:mean"]


class Responses(unittest.TestCase):
    def test_axes_have_units(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "a.json").write_text(json.dumps({"parameters": {"pitch": {"value": 20, "unit": "deg"}, "mouth": .06}}))
            rows = [Row(folder / "a", scores={"lift.power:integral": p * m, "lift.power:mean": p}, pitch=p, mouth=m) for p in (10, 20) for m in (1, 2)]
            made = response(Sweep(["pitch", "mouth"], rows + [Row(folder / "a", "failed", pitch=15, mouth=1)]))
            self.assertEqual({axes.get_xlabel() for axes in made.axes}, {"pitch [deg]"})
            self.assertEqual([axes.get_ylabel() for axes in made.axes], ["lift.power:integral [J]", "lift.power:mean [W]"])
            self.assertEqual([text.get_text() for text in made.axes[0].texts], ["mouth 1", "mouth 2"])
            made = response(Sweep(["mouth", "pitch"], rows))
            self.assertEqual(made.axes[0].get_xlabel(), "mouth")
            self.assertEqual([text.get_text() for text in made.axes[0].texts], ["pitch 10 deg", "pitch 20 deg"])
            grid = [Row(folder / "a", scores={"lift.power:integral": p * m, "lift.power:mean": p}, pitch=p, mouth=m) for p in range(4) for m in range(4)]
            made = response(Sweep(["mouth", "pitch"], grid), str(folder / "map.png"))
            self.assertEqual(made.axes[0].get_ylabel(), "pitch [deg]")


if __name__ == "__main__":
    unittest.main()
