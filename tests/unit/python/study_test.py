#!/usr/bin/env python3
"""Pictures of studies: which lines are drawn, what is a sentence instead, and that words cover neither each other nor the frame."""
import csv
import itertools
import json
import pathlib
import tempfile
import unittest

from tandem.axis_ticks import log_ticks, written
from tandem.label_places import Box, free_place, place_along, spread
from tandem.study_data import Study, is_round_off, read, recommended
from tandem.study_lines import front, hull, panel
from tandem.study_picture import draw, figure_of


def box_of(text, renderer):
    extent = text.get_window_extent(renderer)
    return Box(extent.x0, extent.y0, extent.x1, extent.y1)


def study(settings, cells, line="", measures=("e",), **plot):
    """`cells`: rows of values of the settings, status, errors of the measures, time."""
    names = [*settings, "status", *(f"error_{name}" for name in measures), "cpu_s"]
    rows = [dict(zip(names, map(str, row))) for row in cells]
    entries = [{"name": name, "unit": "m"} if isinstance(name, str) else name for name in measures]
    return Study({"name": "s", "settings": settings, "line": line, "measures": entries, **plot}, rows)


def of_order(order, constants, steps=(4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)):
    """Methods with errors C h^order and times 1/h."""
    return [(name, h, "ok", c * h**order, 1e-3 / h) for name, c in constants.items() for h in steps]


class Lines(unittest.TestCase):
    def test_a_line_for_each_method_in_the_order_of_the_step(self):
        s = study(["scheme", "window"], of_order(2, {"a": 1, "b": 9}), "window")
        shown = panel(s, s.measures[0])
        self.assertEqual([line.label for line in shown.lines], ["a", "b"])
        self.assertEqual([row.settings["window"] for row in shown.lines[0].points], ["0.004", "0.002", "0.001", "0.0005", "0.00025"])
        self.assertEqual((shown.lines[0].envelope, shown.order, shown.floor), ([], 2, None))

    def test_a_setting_that_matters_little_is_in_the_envelope(self):
        cells = [(a, p, h, "ok", c * k * h, 1e-3 / h) for (a, c), (p, k), h in
                 itertools.product((("a", 1), ("b", 9)), (("mixed", 1), ("double", 1.05)), (4e-3, 2e-3, 1e-3))]
        s = study(["scheme", "precision", "window"], cells, "window")
        shown = panel(s, s.measures[0])
        self.assertEqual([line.label for line in shown.lines], ["a", "b"])
        self.assertGreater(len(shown.lines[0].envelope), 3)
        for k, factor in ((1, 1), (2, 3)):  # a setting that matters makes lines of its own
            s = study(["scheme", "precision", "window"], [row[:4] + (row[4] * (factor if row[1] == "double" else 1),) + row[5:] for row in cells],
                      "window")
            self.assertEqual(len(panel(s, s.measures[0]).lines), 2 * k)

    def test_at_most_six_lines(self):
        s = study(["rho_inf", "step"], of_order(2, {0.1 * k: 1 + k for k in range(9)}), "step")
        shown = panel(s, s.measures[0])
        self.assertEqual([line.label for line in shown.lines], ["rho_inf 0"] + [f"rho_inf {k / 10:g}" for k in range(1, 6)])
        self.assertEqual(len(shown.others), 15)

    def test_the_envelope_has_all_runs_inside(self):
        cells = [("a", k, "ok", 10.0**-(1 + 7 * k % 5), 0.1 * (1 + 3 * k % 7)) for k in range(20)]
        s = study(["scheme", "seed"], cells)
        line, = panel(s, s.measures[0]).lines
        import matplotlib.path
        import numpy as np
        outline = matplotlib.path.Path(np.log(line.envelope))
        for row in line.rows:
            self.assertTrue(outline.contains_point(np.log((row.cpu, row.error("e"))), radius=1e-6) or
                            outline.contains_point(np.log((row.cpu, row.error("e"))), radius=-1e-6))
        errors = [row.error("e") for row in front(line.rows, "e")]
        self.assertEqual(errors, sorted(errors, reverse=True))
        self.assertEqual(errors[-1], min(row.error("e") for row in line.rows))
        self.assertEqual(len(hull([(1, 1), (10, 1), (1, 10), (10, 10), (3, 3)])), 4)

    def test_a_floor_is_where_finer_steps_gain_nothing(self):
        cells = [(m, h, "ok", c * h**2 + 1e-7, 1e-3 / h) for m, c in (("a", 1), ("b", 2)) for h in (1e-2, 1e-3, 1e-4, 5e-5, 2.5e-5, 1e-5)]
        s = study(["m", "step"], cells, "step")
        self.assertAlmostEqual(panel(s, s.measures[0]).floor, 1e-7, delta=1e-9)
        s = study(["m", "step"], [row for row in cells if row[0] == "a"] + of_order(2, {"c": 1}, (1e-2, 1e-3, 1e-4, 1e-5)), "step")
        self.assertIsNone(panel(s, s.measures[0]).floor)

    def test_no_guide_where_time_does_not_grow_with_the_step(self):
        s = study(["m", "window"], [("a", h, "ok", h**2, 1.0) for h in (4e-3, 2e-3, 1e-3, 5e-4)], "window")
        self.assertIsNone(panel(s, s.measures[0]).order)

    def test_the_fastest_run_with_the_wanted_error_is_recommended_not_a_suspect_one(self):
        cells = [("a", 1, "suspect", 1e-3, 0.1), ("b", 1, "ok", 1e-3, 0.3), ("c", 1, "ok", 1e-5, 0.9), ("d", 1, "ok", 1e-1, 0.01)]
        s = study(["m", "x"], cells, measures=("e",))
        s.measures[0].want = 2e-3
        self.assertEqual(recommended(s, s.measures[0]).settings["m"], "b")
        s.measures[0].want = 1e-9
        self.assertIsNone(recommended(s, s.measures[0]))


class Figures(unittest.TestCase):
    def overlaps(self, study):
        """All pairs of words that cover each other, and words outside the figure."""
        figure, pictures = figure_of(study)
        figure.canvas.draw()  # gives the words of the axes their places
        renderer = figure.canvas.get_renderer()
        whole = Box(0, 0, figure.bbox.width, figure.bbox.height)
        texts = list(figure.texts)
        for picture in pictures:
            axes = picture.axes
            ticks = [label for axis in (axes.xaxis, axes.yaxis) for label in axis.get_ticklabels()]
            texts += picture.labels + picture.words + [axes.xaxis.label, axes.yaxis.label, axes._left_title] + ticks
        boxes = [(text.get_text(), box_of(text, renderer)) for text in texts if text.get_text() and text.get_visible()]
        found = [(a, b) for (a, one), (b, other) in itertools.combinations(boxes, 2) if one.meets(other)]
        return found + [words for words, box in boxes if not box.inside(whole)], pictures, figure

    def test_no_words_overlap(self):
        crowded = study(["rho_inf", "step"], of_order(2, {0.1 * k: 1 + 1e-3 * k for k in range(6)}), "step")
        crowded.measures[0].want = 3e-7
        far = study(["scheme", "seed", "window"], [(m, k, h, "ok", 10.0**-(k % 4) * c, 0.1 + 0.1 * (k * 7 % 5)) for m, c in (("parallel", 1), ("dem_first", .9))
                                                   for k in range(9) for h in (1e-3, 1e-4)], "window")
        far.measures[0].want = 0.5
        bad = study(["m", "step"], [(m, h, "diverged", "", "") for m in ("a", "b") for h in (1, .5, .25)] + of_order(1, {"c": 1}), "step")
        for each in (crowded, far, bad):
            found, pictures, _ = self.overlaps(each)
            self.assertEqual(found, [], each.settings)
            self.assertEqual(len(pictures), 1)
        self.assertEqual([text.get_text() for text in pictures[0].labels], ["c", "a: no run ends", "b: no run ends"])

    def test_round_off_is_a_sentence_instead_of_a_panel(self):
        cells = [("a", h, "ok", 3e-17 * k, h, 1e-3 / h) for k, h in enumerate((4e-3, 2e-3, 1e-3))]
        s = study(["scheme", "window"], cells, "window", ("impulse", "angle"))
        self.assertTrue(is_round_off(s, s.measures[0]))
        found, pictures, figure = self.overlaps(s)
        self.assertEqual((found, [picture.measure.name for picture in pictures]), ([], ["angle"]))
        self.assertIn("impulse: at most 6·10⁻¹⁷ m in all 3 runs. That is round-off: no setting matters.", " ".join(text.get_text() for text in figure.texts))

    def test_bars_of_repeated_timings(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "plot.json").write_text(json.dumps({"name": "s", "settings": ["step"], "line": "step", "repeat": 3,
                                                          "measures": [{"name": "e", "unit": "m"}]}))
            with open(folder / "results.csv", "w", newline="") as file:
                rows = csv.writer(file)
                rows.writerow(["step", "status", "error_e", "cpu_s", "cpu_low_s", "cpu_high_s"])
                rows.writerows([(h, "ok", h, 1e-3 / h, .8e-3 / h, 1.5e-3 / h) for h in (1e-3, 1e-4, 1e-5)])
            self.assertTrue(draw(folder).read_bytes().startswith(b"\x89PNG"))
            s = read(folder)
        _, (picture,) = figure_of(s)
        self.assertEqual([tuple(round(x, 9) for x in segment[:, 0]) for segment in picture.axes.collections[0].get_segments()],
                         [(.8, 1.5), (8, 15), (80, 150)])

    def test_a_study_without_any_error_is_sentences(self):
        s = study(["step"], [(1, "diverged", "", ""), (2, "diverged", "", "")], "step")
        found, pictures, figure = self.overlaps(s)
        self.assertEqual((found, pictures), ([], []))
        self.assertIn("e: no run has an error that can be drawn.", [text.get_text() for text in figure.texts])


class Places(unittest.TestCase):
    def test_labels_keep_their_order_and_do_not_overlap(self):
        wanted, heights = [10, 11, 12, 50, 95, 99], [10] * 6
        centres = spread(wanted, heights, 0, 100)
        self.assertEqual(centres, sorted(centres))
        self.assertTrue(all(b - a >= 10 - 1e-9 for a, b in zip(centres, centres[1:])))
        self.assertTrue(5 <= centres[0] and centres[-1] <= 95)
        self.assertEqual(centres[3], 50)
        self.assertEqual(spread([20, 80], [10, 10], 0, 100), [20, 80])

    def test_free_places(self):
        room, taken = Box(0, 0, 200, 100), [Box(90, 40, 110, 60)]
        for box in (free_place((100, 50), (40, 12), room, taken, []), place_along([(5, 50)], (40, 12), room, [Box(5, 52, 30, 70)], [], False)):
            self.assertTrue(box.inside(room))
            self.assertFalse(any(box.meets(other) for other in taken))
        self.assertEqual(place_along([(5, 50)], (40, 12), room, [Box(5, 52, 30, 70)], [], False).low, 36)

    def test_ticks(self):
        self.assertEqual([f"{tick:g}" for tick in log_ticks(0.15, 0.9)[0][:3]], ["0.2", "0.3", "0.4"])
        self.assertEqual(len(log_ticks(1e-12, 1)[0]), 7)
        self.assertEqual([written(x) for x in (0.02, 500, 2e-4, 1e-6, 0.999999999999e-6)], ["0.02", "500", "2·10⁻⁴", "10⁻⁶", "10⁻⁶"])


if __name__ == "__main__":
    unittest.main()
