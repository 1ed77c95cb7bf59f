#!/usr/bin/env python3
"""A solver of a liquid: one mass, which the walls of one body hold by a spring and a dashpot in place of pressure. It weighs, it
is accelerated with its vessel, and it does not flow. Start: tandem run scene.json --sph-server "python3 main.py". The force
acts on liquid and vessel at once, so that the balance of momentum is exact; the steps are of second order (velocity Verlet)."""
import numpy as np

from tandem import participant


class Lump(participant.LiquidSolver):
    features = ["wall:*", "liquid.free_slip", "liquid.no_slip"]  # a scene with any other is refused by name
    follows_path = window_mean = observes_liquid = True

    def configure(self, c):
        self.c, liquid = c, c.liquids[0]
        holders = {wall.body for wall in c.walls}
        if len(holders) > 1 or not len(liquid.boxes):
            raise participant.Error("has walls on two bodies, or nothing is filled", "sph", "write walls of one body, and a box")
        self.vessel = holders.pop() if holders else None
        edges, g = liquid.boxes[:, 1] - liquid.boxes[:, 0], np.linalg.norm(c.gravity)
        volumes = edges.prod(1)
        self.mass, depth = liquid.density * volumes.sum(), np.cbrt(volumes.sum())
        self.start = self.x = volumes @ liquid.boxes.mean(1) / volumes.sum()
        self.v = np.array(liquid.velocity)
        axes = lambda box: [np.arange(a + c.spacing / 2, b, c.spacing) for a, b in box.T]  # one particle in each cube
        self.particles = np.concatenate([np.stack(np.meshgrid(*axes(b), indexing="ij"), -1).reshape(-1, 3) for b in liquid.boxes])
        self.pressure, speed = np.zeros(len(self.particles)), liquid.sound_speed or 10 * np.sqrt(g * depth)
        if not speed:
            raise participant.Error("has no gravity, from which a speed of sound would follow", "sph.liquids", "give sound_speed")
        # A cube of edge d has the stiffness rho c^2 d, and with the mass rho d^3 the frequency c / d.
        self.omega = speed / depth
        # Held so that a hydrostatic liquid is at rest at the start.
        self.at_rest = self.start - (c.gravity / self.omega**2 if liquid.hydrostatic else 0)
        self.pose = None  # of the vessel at the start
        if liquid.hydrostatic and self.vessel is not None:
            corners = np.stack(np.meshgrid(*[[0, 1]] * 3), -1).reshape(-1, 3)
            depths = self.particles @ c.gravity - min((np.choose(k, b) @ c.gravity) for b in liquid.boxes for k in corners)
            self.pressure = liquid.density * depths
        self.density = liquid.density + self.pressure / speed**2
        return {"method": "one mass on a spring, velocity Verlet", "sound_speed_m_per_s": speed}

    def force(self, frames, total):
        """On the liquid, and opposite on the vessel. What this model cannot show ends the run."""
        if self.vessel is None:
            return np.zeros(3)
        at, fail = frames[self.vessel], lambda *words: participant.Error(*words, "take another solver", participant.NUMERICS)
        if self.pose is None:
            self.pose = at
            self.anchor = at.rotation.T @ (self.at_rest - at.position)
        if np.trace(self.pose.rotation.T @ at.rotation) < 1 + 2 * np.cos(0.1):
            raise fail("turns by more than 0.1 rad, in which this liquid cannot flow", "the body with the walls")
        arm = at.rotation @ self.anchor
        strain, rate = self.x - at.position - arm, self.v - at.velocity - np.cross(at.spin, arm)
        force = -self.mass * (self.omega**2 * strain + self.omega * rate)
        if force @ self.c.gravity > 1e-6 * self.mass * self.c.gravity @ self.c.gravity:
            raise fail("would leave its vessel, which this solver cannot compute", "the liquid")
        total.add(self.vessel, (self.x - at.position)[None], -force[None])
        return force

    def advance(self, motion, loads):
        H, total, account = motion.window.length, participant.WindowSum(loads), loads.account
        steps = int(np.ceil(H / min(self.c.micro_step or H, 0.05 / self.omega) * (1 - 1e-12)))
        h = H / steps
        account["momentum_begin"], account["gravity_impulse"] = self.mass * self.v, self.mass * H * self.c.gravity
        for step in range(steps + 1):  # the first and the last one have half of the impulse of a step
            frames, share = motion.frames(min(step * h, H)), h if 0 < step < steps else h / 2
            total.clear()
            self.v = self.v + share * (self.force(frames, total) / self.mass + self.c.gravity)
            total.step(step * h, share, frames)
            self.x = self.x + h * self.v if step < steps else self.x
        total.write()
        account["momentum_end"], account["kinetic_energy"] = self.mass * self.v, self.mass * self.v @ self.v / 2
        account["micro_steps"], account["micro_step"] = steps, h
        now = self.particles + self.x - self.start
        if (now < self.c.domain_min).any() or (now > self.c.domain_max).any():
            raise participant.Error("leaves the domain", "sph.domain", "make it larger", participant.NUMERICS)

    def observe(self):
        n = len(self.particles)
        return (np.arange(n), self.particles + self.x - self.start, np.tile(self.v, (n, 1)), self.pressure, self.density)

    def save(self):
        self.saved = self.x, self.v

    def restore(self):
        self.x, self.v = self.saved


participant.run(Lump(), "@NAME@", "0.1")
