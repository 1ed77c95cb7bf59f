#!/usr/bin/env python3
"""A load solver: frictionless spheres with linear springs against each other, planes and triangles. Start: tandem run
scene.json --dem-server "python3 main.py". Each force acts on both partners at once, so that the balance of momentum is
exact; the steps are of second order (velocity Verlet)."""
import numpy as np

from tandem import participant
from tandem.spheres import Bed, exert


class Spheres(participant.LoadSolver):
    features = ["contact:hooke", "wall:plane", "wall:triangles"]  # a scene with any other is refused by name
    follows_path = window_mean = True

    def configure(self, c):
        if any(pair.friction for pair in c.pairs):
            raise participant.Error("has friction, which this solver does not know", "dem.pairs", "write 0")
        self.bed, log = Bed(c), lambda pair: np.log(max(pair.restitution, 1e-300))
        self.stiffness = c.of_pairs(lambda pair: pair.spring_stiffness)
        self.damping = c.of_pairs(lambda pair: -2 * log(pair) / np.hypot(log(pair), np.pi))
        # A share of the limit of stability, 2 / omega of the lightest two spheres.
        self.dt = c.micro_step or 0.2 * np.sqrt(self.bed.m.min(initial=1) / 2 / np.nanmax(self.stiffness))

    def forces(self, frames, loads):  # on the spheres, and added to the loads on the bodies
        force = self.bed.m[:, None] * self.bed.gravity
        for contact in self.bed.contacts(frames):
            k, alpha = self.stiffness[contact.materials], self.damping[contact.materials]
            exert(contact, k * contact.overlap + alpha * np.sqrt(k * contact.mass) * contact.approach, force, loads)
        return force

    def advance(self, motion, loads):
        bed, H, total = self.bed, motion.window.length, participant.WindowSum(loads)
        steps = int(np.ceil(H / self.dt * (1 - 1e-12)))
        h = H / steps
        bed.begin_window(loads.account)
        for step in range(steps + 1):  # the first and the last one have half of the impulse of a step
            frames, share = motion.frames(min(step * h, H)), h if 0 < step < steps else h / 2
            total.clear()
            bed.v = bed.v + share * self.forces(frames, total) / bed.m[:, None]
            total.step(step * h, share, frames)
            bed.x = bed.x + h * bed.v if step < steps else bed.x
        total.write()
        bed.end_window(loads.account, steps, motion.window)

    def observe(self):
        return self.bed.observed()

    def save(self):
        self.saved = self.bed.copied()

    def restore(self):
        self.bed = self.saved.copied()


participant.run(Spheres(), "@NAME@", "0.1")
