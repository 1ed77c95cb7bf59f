#!/usr/bin/env python3
"""A load solver: frictionless spheres with linear springs against each other, planes and triangles, for some
hundred spheres and some dozen triangles. Start: tandem run scene.json --dem-server "python3 main.py". Each force acts
on both partners at once, so that the balance of momentum is exact; the steps are of second order (velocity Verlet)."""
import numpy as np

from tandem import participant
from tandem.rotations import matrix


def closest_points(triangles, x):  # of each triangle to each sphere (spheres x triangles x 3)
    edge = np.roll(triangles, -1, axis=1) - triangles
    normal = np.cross(edge[:, 0], edge[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    arm = x[:, None, None] - triangles  # from the corners
    along = np.clip(np.sum(arm * edge, axis=-1) / np.sum(edge**2, axis=-1), 0, 1)
    on_edge = triangles + along[..., None] * edge
    nearest = np.argmin(np.sum((x[:, None, None] - on_edge)**2, axis=-1), axis=2)
    on_edge = np.take_along_axis(on_edge, nearest[..., None, None], axis=2)[:, :, 0]
    inside = np.all(np.sum(np.cross(edge, arm) * normal[:, None], axis=-1) >= 0, axis=2)
    foot = x[:, None] - np.sum(arm[:, :, 0] * normal, axis=-1)[..., None] * normal
    return np.where(inside[..., None], foot, on_edge)


def touches(wall, x, r):
    """Where spheres touch a wall, in the frame of its body: indices of spheres, points, normals, overlaps. A sphere
    occurs again in the next yield if it touches more than one face."""
    if wall.shape == "plane":
        height = (x - wall.point) @ wall.normal
        i = np.flatnonzero(height < r)
        yield i, x[i] - height[i, None] * wall.normal, np.tile(wall.normal, (len(i), 1)), (r - height)[i]
        return
    points = closest_points(wall.triangles, x)
    away = x[:, None] - points
    distance = np.linalg.norm(away, axis=-1)
    distance[(distance >= r[:, None]) | (distance == 0)] = np.inf
    while np.any(touching := np.isfinite(distance.min(axis=1))):
        i = np.flatnonzero(touching)
        t = np.argmin(distance[i], axis=1)  # the deepest point comes first
        point, normal = points[i, t], away[i, t] / distance[i, t, None]
        yield i, point, normal, r[i] - distance[i, t]
        # Points in the tangent plane of this one belong to the same face, as those of its other triangles do.
        height = np.einsum("itk,ik->it", points[i] - point[:, None], normal)
        distance[i] = np.where(np.abs(height) < 1e-6 * r[i, None], np.inf, distance[i])


class Spheres(participant.LoadSolver):
    features = ["contact:hooke", "wall:plane", "wall:triangles"]  # a scene with any other is refused by name
    follows_path = window_mean = True
    of_spheres = "id", "x", "v", "r", "m", "material"

    def configure(self, c):
        if any(pair.friction for pair in c.pairs):
            raise participant.Error("has friction, which this solver does not know", "dem.pairs", "write 0")
        s, n, self.id = c.spheres, len(c.materials), np.arange(len(c.spheres.radius))
        self.x, self.v, self.r, self.material = s.position.copy(), s.velocity.copy(), s.radius, s.material
        self.m = 4 / 3 * np.pi * np.array([m.density for m in c.materials])[s.material] * s.radius**3
        self.k, self.alpha = np.zeros((n, n)), np.zeros((n, n))  # stiffness and damping of two materials
        for p in c.pairs:
            ln = np.log(max(p.restitution, 1e-300))
            self.k[[p.a, p.b], [p.b, p.a]] = p.spring_stiffness
            self.alpha[[p.a, p.b], [p.b, p.a]] = -2 * ln / np.hypot(ln, np.pi)
        # A share of the limit of stability, 2 / omega of the lightest two spheres.
        self.dt = c.micro_step or 0.2 * np.sqrt(self.m.min(initial=1) / 2 / self.k.max())
        self.walls, self.gravity, self.domain = c.walls, c.gravity, (c.domain_min, c.domain_max)
        self.lost, self.deepest, self.ground = 0, 0.0, (np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))

    def push(self, overlap, approach, mass, materials, radius):  # the force that separates two partners [N]
        self.deepest = max(self.deepest, np.max(overlap / radius, initial=0))
        k, alpha = self.k[materials], self.alpha[materials]
        if not np.all(k > 0):
            raise participant.Error("two materials without a pair are in contact", "dem.pairs", "add the pair")
        return (k * overlap + alpha * np.sqrt(mass * k) * approach)[:, None]

    def forces(self, frames, loads):  # on the spheres, and added to the loads on the bodies
        force, x, v, r, m = self.m[:, None] * self.gravity, self.x, self.v, self.r, self.m
        near = np.sum((x[self.i] - x[self.j])**2, axis=1) < (r[self.i] + r[self.j])**2
        a, b = self.i[near], self.j[near]
        distance = np.linalg.norm(x[a] - x[b], axis=1)
        n = (x[a] - x[b]) / distance[:, None]
        pair = n * self.push(r[a] + r[b] - distance, np.sum((v[b] - v[a]) * n, axis=1), m[a] * m[b] / (m[a] + m[b]),
                             (self.material[a], self.material[b]), np.minimum(r[a], r[b]))
        np.add.at(force, a, pair), np.add.at(force, b, -pair)
        for wall in self.walls:
            p, R, u, w = frames[wall.body]
            for i, point, normal, overlap in touches(wall, (x - p) @ R, r):
                arm, n = point @ R.T, normal @ R.T
                approach = np.sum((u + np.cross(w, arm) - v[i]) * n, axis=1)
                on_spheres = n * self.push(overlap, approach, m[i], (self.material[i], wall.material), r[i])
                force[i] += on_spheres
                loads[wall.body] -= on_spheres.sum(0), np.cross(arm, on_spheres).sum(0)  # about the centre of mass
        return force, len(a)

    def advance(self, motion, loads):
        H, account, bodies = motion.window.length, loads.account, [int(b) for b in loads.bodies["body"]]
        steps = int(np.ceil(H / self.dt * (1 - 1e-12)))
        h, impulse, work = H / steps, np.zeros((len(bodies), 2, 3)), np.zeros(len(bodies))
        moment = np.zeros_like(impulse)
        self.i, self.j = np.triu_indices(len(self.x), 1)  # all pairs; a larger bed needs cells
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
                moment[row] += share * (step * h - H / 2) * load[body]
                work[row] += share * np.sum(load[body] * frames[body][2:])
            self.v = self.v + share * force / self.m[:, None]
            self.x = self.x + h * self.v if step < steps else self.x
        account["gravity_impulse"] = H * self.m.sum() * self.gravity
        account["lost_momentum"] = self.remove_lost()
        end = np.array([load[b] for b in bodies])
        for name, value in (("mean", impulse / H), ("first_moment", moment / H), ("end", end)):
            loads.bodies[name]["force"], loads.bodies[name]["torque"] = value[:, 0], value[:, 1]
        loads.bodies["work"] = work
        account["micro_steps"], account["micro_step"], account["momentum_end"] = steps, h, self.m @ self.v
        account["kinetic_energy"] = 0.5 * self.m @ np.sum(self.v**2, axis=1)
        account["largest_overlap_ratio"], account["lost_particles"] = self.deepest, self.lost

    def remove_lost(self):  # returns the momentum of the spheres that have left the domain
        inside = np.all((self.x >= self.domain[0]) & (self.x <= self.domain[1]), axis=1)
        momentum = self.m[~inside] @ self.v[~inside]
        self.lost += np.sum(~inside)
        for name in self.of_spheres:
            setattr(self, name, getattr(self, name)[inside])
        return momentum

    def observe(self):
        return self.id, self.x, self.v, np.zeros_like(self.x), self.r

    def save(self):  # arrays are replaced and never changed in place, so that no copy is needed
        self.saved = {name: getattr(self, name) for name in (*self.of_spheres, "lost", "deepest")}

    def restore(self):
        vars(self).update(self.saved)


participant.run(Spheres(), "@NAME@", "0.1")
