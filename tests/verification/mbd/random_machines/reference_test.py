#!/usr/bin/env python3
"""The reference of the random machines against closed forms, each in a random frame."""
import math
import unittest

import numpy as np
from scipy.special import ellipj, ellipk

import machines
import pose
from reference import CannotGo, reference

G = 9.81


def scene(end_time, bodies, joints=(), gravity=(0, 0, -G), **more):
    mbd = {"bodies": list(bodies), "joints": list(joints)} | more
    return {"tandem": "1.0", "name": "closed_form", "end_time": end_time, "gravity": list(gravity), "mbd": mbd}


def body(name, mass, inertia, position, **more):
    return {"name": name, "mass": mass, "inertia": list(inertia), "position": list(position), **more}


def joint(name, kind, child, position, parent="ground", **more):
    return {"name": name, "type": kind, "parent": parent, "child": child, "position": list(position), **more}


def swing(amplitude, w, t):
    """Angle of a pendulum let go at an amplitude, with w the frequency of small swings."""
    k = math.sin(amplitude / 2)
    return 2 * np.arcsin(k * ellipj(ellipk(k * k) - w * t, k * k)[0])


class ClosedForms(unittest.TestCase):
    def motion(self, s, count=4):
        """Positions (time, body) at equal times, computed in another frame and moved back."""
        rng = np.random.default_rng(11)
        q = rng.normal(size=4)
        q /= np.linalg.norm(q)
        R, t = pose.matrix(q), rng.normal(size=3)
        self.times = s["end_time"] * np.arange(1, count + 1) / count
        self.found = reference(machines.plain(pose.moved(s, q, t)), self.times)
        x, p, v, w = self.found["motion"]
        return (x - t) @ R, v @ R, w @ R

    def same(self, a, b, tolerance=3e-9):
        np.testing.assert_allclose(a, b, rtol=0, atol=tolerance)

    def pendulum_at(self, amplitude, w):
        angle = np.array([swing(amplitude, w, t) for t in self.times])
        return np.stack([np.sin(angle), 0 * angle, -np.cos(angle)], 1)

    def test_pendulum(self):
        m, J, a = 2.0, 0.3, 1.2
        start = [math.sin(a), 0, -math.cos(a)]
        q = [math.cos(0.2), 0, math.sin(0.2), 0]
        s = scene(2.0, [body("bob", m, [0.2, J, 0.25], start, orientation=q)], [joint("pin", "revolute", "bob", [0, 0, 0], axis=[0, 1, 0])])
        x, _, _ = self.motion(s)
        self.same(x[:, 0], self.pendulum_at(a, math.sqrt(m * G / (J + m))))
        self.assertEqual((self.found["dof"], self.found["redundant"]), (1, 0))

    def test_pendulum_on_two_hinges(self):
        m, J, a = 2.0, 0.3, 1.2
        s = scene(2.0, [body("bob", m, [0.2, J, 0.25], [math.sin(a), 0, -math.cos(a)])],
                  [joint("pin", "revolute", "bob", [0, 0, 0], axis=[0, 1, 0]), joint("pin2", "revolute", "bob", [0, 1, 0], axis=[0, -1, 0])])
        x, _, _ = self.motion(s)
        self.same(x[:, 0], self.pendulum_at(a, math.sqrt(m * G / (J + m))))
        self.assertEqual((self.found["dof"], self.found["redundant"]), (1, 5))

    def test_parallelogram(self):
        # Two rods of length 1 (mass 1) and a bar of mass 2 between them: one pendulum.
        a, d, rod = 1.0, 1.5, 1 / 12
        tip = np.array([math.sin(a), 0, -math.cos(a)])
        D = np.array([d, 0, 0])
        axis = {"axis": [0, 1, 0]}
        s = scene(1.2, [body("left", 1, [rod] * 3, tip / 2), body("bar", 2, [0.5] * 3, tip + D / 2), body("right", 1, [rod] * 3, D + tip / 2)],
                  [joint("a", "revolute", "left", [0, 0, 0], **axis), joint("b", "revolute", "bar", tip, "left", **axis),
                   joint("c", "revolute", "bar", tip + D, "right", **axis), joint("d", "revolute", "right", D, **axis)])
        x, _, _ = self.motion(s)
        inertia, moment = 2 * (rod + 1 / 4) + 2, (2 * 0.5 + 2) * G
        self.same(x[:, 1] - D / 2, self.pendulum_at(a, math.sqrt(moment / inertia)))
        self.assertEqual((self.found["dof"], self.found["redundant"]), (1, 3))

    def test_sphere_on_a_rod(self):
        # A distance holds the centre of mass: a pendulum that does not turn.
        a = 0.9
        x0 = [math.sin(a), 0, -math.cos(a)]
        s = scene(2.0, [body("bob", 1, [0.1, 0.2, 0.25], x0)], [joint("rod", "distance", "bob", [0, 0, 0], child_position=x0, length=1.0)])
        x, _, w = self.motion(s)
        self.same(x[:, 0], self.pendulum_at(a, math.sqrt(G)))
        self.same(w, 0)

    def test_free_symmetric_body(self):
        # The axis precesses about the angular momentum at L / J1.
        J1, J3, w = 2.0, 0.5, np.array([0.7, 0.0, 3.0])
        s = scene(2.0, [body("top", 1, [J1, J1, J3], [0, 0, 0], velocity=[1, 2, 3], angular_velocity=w.tolist())])
        x, v, omega = self.motion(s)
        self.same(x[:, 0], np.outer(self.times, [1, 2, 3]) - 0.5 * G * np.outer(self.times**2, [0, 0, 1]))
        L = np.array([J1 * w[0], 0, J3 * w[2]])
        h = L / np.linalg.norm(L)
        along, rest = (w @ h) * h, w - (w @ h) * h
        rate = np.linalg.norm(L) / J1
        expected = [along + math.cos(rate * t) * rest + math.sin(rate * t) * np.cross(h, rest) for t in self.times]
        self.same(omega[:, 0], expected, 1e-8)

    def test_screw(self):
        m, J, p = 2.0, 0.3, 0.4
        s = scene(1.0, [body("nut", m, [0.5, 0.5, J], [0, 0, 0])], [joint("thread", "screw", "nut", [0, 0, 0], axis=[0, 0, 1], pitch=p, rate=0.5)])
        x, _, w = self.motion(s)
        angle = 0.5 * self.times - 0.5 * m * G * p / (J + m * p * p) * self.times**2
        self.same(x[:, 0, 2], p * angle)

    def test_gears(self):
        Ja, Jb, ratio, T = 0.2, 0.7, -1.5, 3.0
        s = scene(1.0, [body("a", 1, [1, 1, Ja][:2] + [Ja], [0, 0, 0]), body("b", 1, [1, 1, Jb], [2, 0, 0])],
                  [joint("ja", "revolute", "a", [0, 0, 0], axis=[0, 0, 1], rate=0.4), joint("jb", "revolute", "b", [2, 0, 0], axis=[0, 0, 1])],
                  couplers=[{"name": "mesh", "type": "gear", "joint_a": "ja", "joint_b": "jb", "ratio": ratio}],
                  forces=[{"name": "drive", "type": "actuator", "joint": "ja", "size": {"type": "constant", "value": T}}])
        _, _, w = self.motion(s)
        wa = 0.4 + T / (Ja + ratio**2 * Jb) * self.times
        self.same(w[:, 0, 2], wa)
        self.same(w[:, 1, 2], ratio * wa)

    def test_cardan_joint(self):
        # tan q2 = tan q1 / cos beta where the cross starts across the plane of the shafts; the first shaft is driven.
        beta, n2 = 0.6, [math.sin(0.6), 0, math.cos(0.6)]
        s = scene(1.0, [body("in", 1, [0.2] * 3, [0, 0, 0]), body("out", 1, [0.2] * 3, [0, 0, 0])],
                  [joint("ja", "revolute", "in", [0, 0, 0], axis=[0, 0, 1], motion={"type": "constant", "rate": 2.0}),
                   joint("cross", "universal", "out", [0, 0, 0], "in", axis=[0, 1, 0], axis2=[math.cos(beta), 0, -math.sin(beta)]),
                   joint("jb", "revolute", "out", [0, 0, 0], axis=n2, cut=True)])
        _, _, w = self.motion(s)
        q = 2.0 * self.times
        # With the arm of the driving shaft across the plane of the shafts at first.
        rate = 2.0 * math.cos(beta) / (1 - math.sin(beta) ** 2 * np.sin(q) ** 2)
        rate_other = 2.0 * math.cos(beta) / (1 - math.sin(beta) ** 2 * np.cos(q) ** 2)
        found = w[:, 1] @ n2
        self.assertLess(min(np.abs(found - rate).max(), np.abs(found - rate_other).max()), 1e-8)

    def test_springs(self):
        # Along a line: x'' = -k/m (x - L) - c/m x'.
        m, k, c, L = 2.0, 50.0, 1.2, 1.0
        s = scene(1.5, [body("mass", m, [0.1] * 3, [0, 0, 1.4])], [joint("rail", "prismatic", "mass", [0, 0, 0], axis=[0, 0, 1], rate=0.3)], (0, 0, 0),
                  forces=[{"name": "s", "type": "spring_damper", "body_b": "mass", "point_a": [0, 0, 0], "point_b": [0, 0, 1.4],
                           "stiffness": k, "damping": c, "length": L}])
        x, _, _ = self.motion(s)
        d, w0 = c / (2 * m), math.sqrt(k / m)
        w, t = math.sqrt(w0**2 - d**2), self.times
        self.same(x[:, 0, 2], L + np.exp(-d * t) * (0.4 * np.cos(w * t) + (0.3 + d * 0.4) / w * np.sin(w * t)))

    def test_bushing_about_an_axis(self):
        J, k = 0.3, 12.0
        s = scene(1.0, [body("disc", 1, [1, 1, J], [1, 2, 3])], [joint("pin", "revolute", "disc", [1, 2, 3], axis=[0, 0, 1], rate=1.0)], (0, 0, 0),
                  forces=[{"name": "b", "type": "bushing", "body_b": "disc", "position": [1, 2, 3], "stiffness": [5, 5, 5, 3, 4, k]}])
        _, _, w = self.motion(s)
        self.same(w[:, 0, 2], np.cos(math.sqrt(k / J) * self.times))

    def test_force_that_follows(self):
        # Torque-free in turning: a force fixed in a disc that spins at a constant rate.
        w0 = 2.0
        s = scene(1.0, [body("disc", 1, [1, 1, 1], [0, 0, 0], angular_velocity=[0, 0, w0])], gravity=(0, 0, 0),
                  forces=[{"name": "f", "type": "force", "body": "disc", "point": [0, 0, 0], "direction": [1, 0, 0], "follows": True,
                           "size": {"type": "constant", "value": 3.0}}])
        _, v, _ = self.motion(s)
        self.same(v[:, 0, 0], 3 / w0 * np.sin(w0 * self.times))
        self.same(v[:, 0, 1], 3 / w0 * (1 - np.cos(w0 * self.times)))

    def test_open_loop_is_refused(self):
        axis = {"axis": [0, 1, 0]}
        s = scene(1.0, [body("bob", 1, [0.1] * 3, [1, 0, 0])], [joint("a", "revolute", "bob", [0, 0, 0], **axis),
                                                                joint("b", "spherical", "bob", [2, 0, 0], child_position=[2, 0, 0.1])])
        with self.assertRaises(CannotGo):
            self.motion(s)


if __name__ == "__main__":
    unittest.main()
