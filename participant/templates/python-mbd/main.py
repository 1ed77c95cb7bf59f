#!/usr/bin/env python3
"""A motion solver: free rigid bodies under gravity and the load of the particles. Start: tandem run scene.json
--mbd-server "python3 main.py". Momentum and angular momentum follow the load exactly; the rotation takes the
midpoint rule, which is of second order."""
import numpy as np

from tandem import participant
from tandem.rotations import matrix, rotated


class FreeBodies(participant.MotionSolver):
    features = []  # neither joints nor forces: a scene with any is refused by name

    def configure(self, c, initial):
        self.mass = np.array([body.mass for body in c.bodies])[:, None]
        self.inertia = np.array([body.inertia for body in c.bodies])
        self.gravity = c.gravity
        self.x, self.q, self.v, w = (np.array([getattr(body, name) for body in c.bodies]) for name in
                                     ("position", "quaternion", "velocity", "angular_velocity"))
        R = matrix(self.q)
        self.L = np.einsum("bij,bj->bi", R @ self.inertia @ R.swapaxes(1, 2), w)  # angular momentum, in the world

    def spin(self, q, L):  # the angular velocity that belongs to L
        R = matrix(q)
        return np.linalg.solve(R @ self.inertia @ R.swapaxes(1, 2), L[..., None])[..., 0]

    def turning(self, T):  # the angular acceleration under this torque
        return self.spin(self.q, T - np.cross(self.spin(self.q, self.L), self.L))

    def write(self, bodies, end):  # the state at one end of the window: "begin" or "end"
        b = bodies["body"]
        bodies[end + "_pose"]["position"], bodies[end + "_pose"]["quaternion"] = self.x[b], self.q[b]
        bodies[end + "_twist"]["velocity"] = self.v[b]
        bodies[end + "_twist"]["angular_velocity"] = self.spin(self.q, self.L)[b]

    def predict(self, motion):  # the path with the velocities held; the state stays
        H, x, q, L = motion.window.length, self.x, self.q, self.L
        w = self.spin(q, L)
        self.write(motion.bodies, "begin")
        self.x, self.q = x + H * self.v, rotated(q, H * w)
        self.write(motion.bodies, "end")
        motion.bodies["end_twist"]["angular_velocity"] = w[motion.bodies["body"]]
        self.x, self.q, self.L = x, q, L

    def advance(self, loads, motion):
        H, old_x = motion.window.length, self.x
        F, T = np.zeros_like(self.x), np.zeros_like(self.x)  # bodies without a load have none
        on_bodies = loads.bodies[loads.bodies["body"] != participant.GROUND]
        F[on_bodies["body"]], T[on_bodies["body"]] = on_bodies["mean"]["force"], on_bodies["mean"]["torque"]
        bodies, b = motion.bodies, motion.bodies["body"]
        self.write(bodies, "begin")
        bodies["begin_angular_acceleration"] = self.turning(T)[b]
        a = F / self.mass + self.gravity
        self.x = self.x + H * self.v + H**2 / 2 * a
        self.v = self.v + H * a
        halfway = rotated(self.q, H / 2 * self.spin(self.q, self.L))
        turn = H * self.spin(halfway, self.L + H / 2 * T)
        self.q, self.L = rotated(self.q, turn), self.L + H * T
        self.write(bodies, "end")
        bodies["end_angular_acceleration"] = self.turning(T)[b]
        bodies["begin_acceleration"] = bodies["end_acceleration"] = a[b]
        bodies["applied_impulse"]["force"], bodies["applied_impulse"]["torque"] = H * F[b], H * T[b]
        bodies["applied_work"] = np.sum(F * (self.x - old_x) + T * turn, axis=1)[b]

    def observe(self, frame):
        w = self.spin(self.q, self.L)
        frame.bodies["pose"]["position"], frame.bodies["pose"]["quaternion"] = self.x, self.q
        frame.bodies["twist"]["velocity"], frame.bodies["twist"]["angular_velocity"] = self.v, w
        frame.energy = np.sum(self.mass * (0.5 * self.v**2 - self.x * self.gravity)) + 0.5 * np.sum(w * self.L)

    def save(self):  # arrays are replaced and never changed in place, so that no copy is needed
        self.saved = self.x, self.q, self.v, self.L

    def restore(self):
        self.x, self.q, self.v, self.L = self.saved


participant.run(FreeBodies(), "@NAME@", "0.1")
