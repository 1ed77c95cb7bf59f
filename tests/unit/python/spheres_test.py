#!/usr/bin/env python3
"""Contacts between the spheres of a particle solver in Python."""
import unittest

import numpy as np

from tandem.spheres import Bed


def bed(x, v, r):
    """Spheres of one material, without walls."""
    b = Bed.__new__(Bed)
    b.x, b.v, b.r, b.m = np.array(x, float), np.array(v, float), np.array(r, float), np.array(r, float)**3
    b.material, b.paired, b.walls, b.deepest = np.zeros(len(r), int), np.array([[True]]), [], 0.0
    b.pairs = np.triu_indices(len(r), 1)
    return b


class Contacts(unittest.TestCase):
    def test_of_two_spheres(self):
        b = bed([[0, 0, 0], [0.9, 1.2, 0], [5, 0, 0]], [[0.6, 0.8, 0], [0, 0, 0], [0, 0, 0]], [1, 0.75, 1])
        (batch,) = b.contacts({})
        self.assertEqual((list(batch.a), list(batch.b), b.touching), ([0], [1], 1))
        np.testing.assert_allclose(batch.normal, [[-0.6, -0.8, 0]], atol=1e-15)  # towards a
        np.testing.assert_allclose(batch.overlap, [0.25], atol=1e-15)
        np.testing.assert_allclose(batch.approach, [1], atol=1e-15)  # a runs into b
        np.testing.assert_allclose(batch.mass, [1 * 0.421875 / 1.421875], atol=1e-15)
        self.assertAlmostEqual(b.deepest, 0.25 / 0.75)

    def test_of_spheres_that_part(self):
        (batch,) = bed([[0, 0, 0], [1.5, 0, 0]], [[-2, 0, 0], [0, 3, 0]], [1, 1]).contacts({})
        np.testing.assert_allclose(batch.approach, [-2], atol=1e-15)


if __name__ == "__main__":
    unittest.main()
