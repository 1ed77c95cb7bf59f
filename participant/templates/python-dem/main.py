#!/usr/bin/env python3
"""A load solver: frictionless spheres with linear springs against each other and against planes, for some hundred
spheres. Start: tandem run scene.json --dem-server "python3 main.py". Each force acts on both partners at once, so
that the balance of momentum is exact; the steps are of second order (velocity Verlet)."""
import numpy as np

from tandem import participant
from tandem.rotations import matrix


class Spheres(participant.LoadSolver):
    features = ["contact:hooke", "wall:plane"]  # a scene with any other is refused by name
    follows_path = window_mean = True

    def configure(self, c):
        if any(pair.friction for pair in c.pairs):
            raise participant.Error("has friction, which this solver does not know", "dem.pairs", "write 0")
        s, n = c.spheres, len(c.materials)
        self.x, self.v, self.r, self.material = s.position.copy(), s.velocity.copy(), s.radius, s.material
        self.m = 4 / 3 * np.pi * np.array([m.density for m in c.materials])[s.material] * s.radius**3
        self.k, self.alpha = np.zeros((n, n)), np.zeros((n, n))  # stiffness and damping of two materials
        for p in c.pairs:
            ln = np.log(max(p.restitution, 1e-300))
            self.k[[p.a, p.b], [p.b, p.a]] = p.spring_stiffness
            self.alpha[[p.a, p.b], [p.b, p.a]] = -2 * ln / np.hypot(ln, np.pi)
        # A share of the limit of stability, 2 / omega of the lightest two spheres.
        self.dt = c.micro_step or 0.2 * np.sqrt(self.m.min(initial=1) / 2 / self.k.max())
        self.planes, self.gravity, self.domain = c.walls, c.gravity, (c.domain_min, c.domain_max)
        self.i, self.j = np.triu_indices(len(self.x), 1)  # all pairs; a larger bed needs cells
        self.deepest, self.ground = 0.0, (np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))

    def push(self, overlap, approach, mass, materials, radius):  # the force that separates two partners [N]
        self.deepest = max(self.deepest, np.max(overlap / radius, initial=0))
        force = self.k[materials] * overlap + self.alpha[materials] * np.sqrt(mass * self.k[materials]) * approach
        return np.where(overlap > 0, force, 0)[:, None]

    def forces(self, frames, loads):  # on the spheres, and added to the loads on the bodies
        force, x, v, r, m = self.m[:, None] * self.gravity, self.x, self.v, self.r, self.m
        near = np.sum((x[self.i] - x[self.j])**2, axis=1) < (r[self.i] + r[self.j])**2
        a, b = self.i[near], self.j[near]
        distance = np.linalg.norm(x[a] - x[b], axis=1)
        n = (x[a] - x[b]) / distance[:, None]
        pair = n * self.push(r[a] + r[b] - distance, np.sum((v[b] - v[a]) * n, axis=1), m[a] * m[b] / (m[a] + m[b]),
                             (self.material[a], self.material[b]), np.minimum(r[a], r[b]))
        np.add.at(force, a, pair), np.add.at(force, b, -pair)
        for plane in self.planes:
            p, R, u, w = frames[plane.body]
            n, arm = R @ plane.normal, x - p
            wall = n * self.push(r - (arm - R @ plane.point) @ n, (u + np.cross(w, arm) - v) @ n, m,
                                 (self.material, plane.material), r)
            force += wall
            loads[plane.body] -= wall.sum(0), np.cross(arm, wall).sum(0)  # the torque is about the centre of mass
        return force, len(a)

    def advance(self, motion, loads):
        H, account, bodies = motion.window.length, loads.account, [int(b) for b in loads.bodies["body"]]
        steps = int(np.ceil(H / self.dt * (1 - 1e-12)))
        h, impulse, work = H / steps, np.zeros((len(bodies), 2, 3)), np.zeros(len(bodies))
        account["momentum_begin"] = self.m @ self.v
        for step in range(steps + 1):
            frames, load = {participant.GROUND: self.ground}, {b: np.zeros((2, 3)) for b in bodies}
            for row, body in enumerate(motion.bodies["body"]):  # the walls follow the path inside the window
                pose, twist = motion.pose_at(row, min(step * h, H))
                frames[int(body)] = pose["position"], matrix(pose["quaternion"]), twist["velocity"], twist["angular_velocity"]
            force, account["contacts"] = self.forces(frames, load)
            share = h / 2 if step in (0, steps) else h
            for row, body in enumerate(bodies):
                impulse[row] += share * load[body]
                work[row] += share * np.sum(load[body] * frames[body][2:])
            self.v = self.v + share * force / self.m[:, None]
            self.x = self.x + h * self.v if step < steps else self.x
        if not np.all((self.x > self.domain[0]) & (self.x < self.domain[1])):
            raise participant.Error("a sphere has left it", "dem.domain", "enlarge it", participant.NUMERICS)
        for name, value in (("mean", impulse / H), ("end", np.array([load[b] for b in bodies]))):
            loads.bodies[name]["force"], loads.bodies[name]["torque"] = value[:, 0], value[:, 1]
        loads.bodies["work"] = work
        account["micro_steps"], account["micro_step"], account["momentum_end"] = steps, h, self.m @ self.v
        account["gravity_impulse"] = H * self.m.sum() * self.gravity
        account["kinetic_energy"] = 0.5 * self.m @ np.sum(self.v**2, axis=1)
        account["largest_overlap_ratio"] = self.deepest

    def observe(self):
        return np.arange(len(self.x)), self.x, self.v, np.zeros_like(self.x), self.r

    def save(self):  # arrays are replaced and never changed in place, so that no copy is needed
        self.saved = self.x, self.v, self.deepest

    def restore(self):
        self.x, self.v, self.deepest = self.saved


participant.run(Spheres(), "@NAME@", "0.1")
