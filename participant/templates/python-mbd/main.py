#!/usr/bin/env python3
"""A motion solver: free rigid bodies under gravity and the load of the particles. Start: tandem run scene.json
--mbd-server "python3 main.py". Momentum and angular momentum follow the load exactly; the rotation takes the
midpoint rule, which is of second order."""
import numpy as np

from tandem import participant
from tandem.rotations import in_world, rotated


class FreeBodies(participant.MotionSolver):
    features = []  # neither joints nor forces: a scene with any is refused by name

    def configure(self, c, initial):
        self.mass = np.array([body.mass for body in c.bodies])[:, None]
        self.inertia, self.gravity = np.array([body.inertia for body in c.bodies]), c.gravity
        self.x, self.q, self.v, w = c.states()
        self.L = np.einsum("bij,bj->bi", in_world(self.q, self.inertia), w)  # angular momentum

    def spin(self, q, L):  # the angular velocity that belongs to L
        return np.linalg.solve(in_world(q, self.inertia), L[..., None])[..., 0]

    def state(self, a, T):  # with the accelerations under these torques
        w = self.spin(self.q, self.L)
        return self.x, self.q, self.v, w, a, self.spin(self.q, T - np.cross(w, self.L))

    def predict(self, motion):  # the path with the velocities held; the state stays
        H, w = motion.window.length, self.spin(self.q, self.L)
        motion.set_begin(self.x, self.q, self.v, w)
        motion.set_end(self.x + H * self.v, rotated(self.q, H * w), self.v, w)

    def advance(self, loads, motion):
        H, x, (F, T) = motion.window.length, self.x, loads.mean(len(self.x))
        a = F / self.mass + self.gravity
        motion.set_begin(*self.state(a, T))
        self.x, self.v = x + H * self.v + H**2 / 2 * a, self.v + H * a
        halfway = rotated(self.q, H / 2 * self.spin(self.q, self.L))
        turn = H * self.spin(halfway, self.L + H / 2 * T)
        self.q, self.L = rotated(self.q, turn), self.L + H * T
        motion.set_end(*self.state(a, T))
        motion.set_applied(H * F, H * T, np.sum(F * (self.x - x) + T * turn, axis=1))

    def observe(self, frame):
        w = self.spin(self.q, self.L)
        frame.set_bodies(self.x, self.q, self.v, w)
        frame.energy = np.sum(self.mass * (self.v**2 / 2 - self.x * self.gravity)) + np.sum(w * self.L) / 2

    def save(self):  # arrays are replaced and never changed in place, so that no copy is needed
        self.saved = self.x, self.q, self.v, self.L

    def restore(self):
        self.x, self.q, self.v, self.L = self.saved


participant.run(FreeBodies(), "@NAME@", "0.1")
