#!/usr/bin/env python3
"""The search of `tandem soften` on errors and costs in closed form, against all settings."""
import itertools
import math
import random
import unittest

from tandem.soften_search import GAIN, Outcome, Search

LENGTHS = (9, 7, 5)


class Synthetic:
    """Errors as powers of modulus, step and window whose squares add up; costs of steps, windows and a rest."""

    def __init__(self, modulus=.05, step=.1, window=.1, per_step=1.0, per_window=.1, rest=.05, power=.6, scatter=0.0, fault=lambda p: ""):
        self.coefficients, self.parts, self.power, self.scatter, self.fault = (modulus, step, window), (per_step, per_window, rest), power, scatter, fault
        self.calls = []

    def work(self, point):
        return 1e5 / (2**(point[0] / 2) * 2**(point[1] / 2)), 1e3 / 2**point[2]

    def outcome(self, point):
        a, b, c = self.coefficients
        square = (a * (2**(self.power * point[0]) - 1))**2 + (b * (2**(point[1] / 2) - 1))**2 + (c * (2**point[2] - 1))**2
        noise = random.Random(str(point)).uniform(.7, 1) * self.scatter if point != (0, 0, 0) else 0
        steps, windows = self.work(point)
        per_step, per_window, rest = self.parts
        return Outcome([math.sqrt(square + noise**2)], per_step * steps / 1e5, per_window * windows / 1e3, rest, self.fault(point))

    def evaluate(self, point):
        self.calls.append(point)
        return self.outcome(point)

    def search(self, **keys):
        return Search(LENGTHS, self.evaluate, self.work, scatter=self.scatter, **keys)

    def cheapest(self):
        every = itertools.product(*map(range, LENGTHS))
        return min(self.outcome(p).cost for p in every if self.outcome(p).passes)


class SearchTest(unittest.TestCase):
    def expect_cheapest(self, model, tolerance=1.06):
        search = model.search()
        best = search.run()
        self.assertTrue(search.tried[best].passes)
        self.assertLessEqual(search.tried[best].cost, tolerance * model.cheapest(), f"{best} after {model.calls}")
        self.assertEqual(len(model.calls), len(set(model.calls)))
        self.assertLess(len(model.calls), 25)
        return search

    def test_finds_the_cheapest_of_all_settings(self):
        for modulus, step, window in itertools.product((.005, .05, .2), (.03, .6), (.03, .2)):
            with self.subTest(modulus=modulus, step=step, window=window):
                self.expect_cheapest(Synthetic(modulus, step, window))

    def test_windows_that_cost_most(self):
        self.expect_cheapest(Synthetic(per_step=.1, per_window=1.0))

    def test_scatter(self):
        for scatter in (.3, .8):
            self.expect_cheapest(Synthetic(modulus=.02, scatter=scatter), 1.2)

    def test_no_neighbour_is_better(self):
        model = Synthetic()
        search = model.search()
        best = search.run()
        for axis in range(3):
            above = tuple(level + (i == axis) for i, level in enumerate(best))
            outcome = model.outcome(above)
            self.assertFalse(outcome.passes and outcome.cost <= GAIN * model.outcome(best).cost)
            self.assertIn(search.limit(axis)[1], ("error", "cost", "last"))

    def test_faults_limit(self):
        model = Synthetic(.001, .001, .001, fault=lambda p: "suspect: collision_steps" if p[1] > 1 else "")
        search = self.expect_cheapest(model)
        self.assertEqual(search.best()[1], 1)
        shown, why = search.limit(1)
        self.assertEqual((shown[1], why), (2, "fault"))
        self.assertEqual(search.limit(0), (None, "last"))

    def test_nothing_is_cheaper(self):
        model = Synthetic(modulus=50, step=50, window=50)
        search = model.search()
        self.assertEqual(search.run(), (0, 0, 0))
        self.assertEqual([search.limit(axis)[1] for axis in range(3)], ["error"] * 3)
        self.assertEqual(set(model.calls), {(0, 0, 0), (2, 0, 0), (0, 2, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)})

    def test_a_time_that_does_not_fall(self):
        search = Synthetic(.001, .001, .001, per_step=0, per_window=0, rest=1).search()
        self.assertEqual(search.run(), (0, 0, 0))
        self.assertLess(len(search.tried), 8)  # one level of each axis, and the neighbours of the stiff scene

    def test_the_number_of_runs_is_bounded(self):
        model = Synthetic()
        model.search(most=6).run()
        self.assertEqual(len(model.calls), 6)

    def test_equal_settings_are_measured_once(self):
        """A window of few steps: neighbouring levels of the micro step have the same number of them. From some modulus on a window has one step."""
        model = Synthetic(.01, .01, .01)
        count = lambda p: max(1, math.ceil(6 * 2**p[2] / 2**((p[0] + p[1]) / 2) * (1 - 1e-9)))  # noqa: E731
        windows = lambda p: 1000 / 2**p[2]  # noqa: E731
        model.work = lambda p: (windows(p) * count(p), windows(p))
        search = model.search()
        best = search.run()
        settings = [(p[0], p[2], count(p)) for p in model.calls]
        self.assertEqual(len(settings), len(set(settings)))
        every = [model.outcome(p) for p in itertools.product(*map(range, LENGTHS))]
        least = min((o.per_step + o.per_window + o.rest for o in every if o.passes))
        self.assertLessEqual(search.tried[best].cost, 1.2 * least, f"{best} after {model.calls}")
        self.assertNotIn("untried", [search.limit(axis)[1] for axis in range(3)])

    def test_several_results(self):
        """The setting keeps the error of each result."""
        model = Synthetic(modulus=.01)
        one = model.outcome
        model.outcome = lambda p: one(p)._replace(shares=[one(p).shares[0], .3 * p[2]])
        search = model.search()
        self.assertLessEqual(search.run()[2], 3)
        self.assertLessEqual(search.tried[search.best()].cost, 1.06 * model.cheapest())


if __name__ == "__main__":
    unittest.main()
