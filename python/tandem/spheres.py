"""The spheres of a scene as arrays, and their contacts with each other and with planes and triangles: for a load solver of
some hundred spheres and some dozen triangles. All pairs are looked at; a larger bed needs cells."""
import copy
from types import SimpleNamespace

import numpy as np

from tandem.library import Error


class Bed:
    """id, x, v (n x 3), r, m and material of the spheres. The arrays are replaced and never changed in place, so that
    copied() keeps a state."""
    _of_spheres = "id", "x", "v", "r", "m", "material"

    def __init__(self, c):
        s = c.spheres
        self.id, self.x, self.v = np.arange(len(s.radius)), s.position.copy(), s.velocity.copy()
        self.r, self.material = s.radius, s.material
        self.m = 4 / 3 * np.pi * np.array([m.density for m in c.materials])[s.material] * s.radius**3
        self.gravity, self.domain, self.walls = c.gravity, (c.domain_min, c.domain_max), c.walls
        self.paired = ~np.isnan(c.of_pairs(lambda pair: 1.0))
        self.lost, self.deepest, self.touching = 0, 0.0, 0
        self.pairs = np.triu_indices(len(self.id), 1)

    def copied(self):
        return copy.copy(self)

    def contacts(self, frames):
        """Contacts in batches, first those between spheres, then those with each wall at the Frame of its body. Arrays of
        a batch: a and b (indices of spheres; b is None at a wall), body and point (of a wall, relative to the centre of
        mass of its body), normal (of length 1, towards a), overlap, approach [m/s], mass (reduced), materials (for a
        table of two materials)."""
        x, v, r, m = self.x, self.v, self.r, self.m
        a, b = self.pairs
        near = np.sum((x[a] - x[b])**2, axis=1) < (r[a] + r[b])**2
        a, b = a[near], b[near]
        self.touching = len(a)
        distance = np.linalg.norm(x[a] - x[b], axis=1)
        normal = (x[a] - x[b]) / distance[:, None]
        yield self._batch(a=a, b=b, body=None, point=None, normal=normal, overlap=r[a] + r[b] - distance,
                          approach=np.sum((v[b] - v[a]) * normal, axis=1), mass=m[a] * m[b] / (m[a] + m[b]),
                          materials=(self.material[a], self.material[b]), radius=np.minimum(r[a], r[b]))
        for wall in self.walls:
            p, R, velocity, spin = frames[wall.body]
            for a, point, normal, overlap in touches(wall, (x - p) @ R, r):
                point, normal = point @ R.T, normal @ R.T
                approach = np.sum((velocity + np.cross(spin, point) - v[a]) * normal, axis=1)
                yield self._batch(a=a, b=None, body=wall.body, point=point, normal=normal, overlap=overlap, approach=approach,
                                  mass=m[a], materials=(self.material[a], wall.material), radius=r[a])

    def _batch(self, **arrays):
        batch = SimpleNamespace(**arrays)
        if not np.all(self.paired[batch.materials]):
            raise Error("two materials without a pair are in contact", "dem.pairs", "add the pair")
        self.deepest = max(self.deepest, np.max(batch.overlap / batch.radius, initial=0))
        return batch

    def begin_window(self, account):
        account["momentum_begin"] = self.m @ self.v

    def end_window(self, account, steps, window):
        """Removes the spheres that have left the domain, and fills in the balance of the window."""
        account["micro_steps"], account["micro_step"] = steps, window.length / steps
        account["gravity_impulse"] = window.length * self.m.sum() * self.gravity
        inside = np.all((self.x >= self.domain[0]) & (self.x <= self.domain[1]), axis=1)
        account["lost_momentum"] = self.m[~inside] @ self.v[~inside]
        self.lost += np.sum(~inside)
        for name in self._of_spheres:
            setattr(self, name, getattr(self, name)[inside])
        if not np.all(inside):
            self.pairs = np.triu_indices(len(self.id), 1)
        account["momentum_end"] = self.m @ self.v
        account["kinetic_energy"] = 0.5 * self.m @ np.sum(self.v**2, axis=1)
        account["largest_overlap_ratio"], account["lost_particles"] = self.deepest, self.lost
        account["contacts"] = self.touching

    def observed(self):
        """What observe() returns, for spheres without spin."""
        return self.id, self.x, self.v, np.zeros_like(self.x), self.r


def exert(contact, push, force, loads):
    """Pushes [N] the spheres `a` of a batch along the normal, and the partner in the opposite direction: added to the forces on
    the spheres (n x 3) and, at a wall, to the loads (a WindowSum)."""
    on_a = push[:, None] * contact.normal
    np.add.at(force, contact.a, on_a)
    if contact.b is None:
        loads.add(contact.body, contact.point, -on_a)
    else:
        np.add.at(force, contact.b, -on_a)


def closest_points(triangles, x):
    """Of each triangle to each sphere (spheres x triangles x 3)."""
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
