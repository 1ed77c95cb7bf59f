#!/usr/bin/env python3
"""LIGGGHTS as tandem's particle solver: README.md says what it maps and what it refuses."""
import json
import pathlib
import tempfile

import numpy as np
from liggghts_library import Liggghts
from scipy.spatial import cKDTree

from tandem import participant
from tandem.participant import GROUND, Error
from tandem.rotations import matrix

AXES = np.eye(3)


def rotation_vector(R):
    """The rotation of a matrix, of less than half a turn, as a vector."""
    axial = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    sine = np.linalg.norm(axial)
    angle = np.arctan2(sine, (np.trace(R) - 1) / 2)
    return axial * (angle / sine if sine > 1e-12 else 1)


def about(axis, angle):
    """The rotation matrix about an axis of the world."""
    K = np.cross(np.eye(3), AXES[axis])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def cut_of_plane(point, normal, low, high):
    """The triangles of a plane inside of a box."""
    sideways = np.cross(normal, AXES[np.argmin(np.abs(normal))])
    sideways /= np.linalg.norm(sideways)
    other, reach = np.cross(normal, sideways), 2 * np.linalg.norm(high - low)
    middle = (low + high) / 2
    middle = middle - normal * ((middle - point) @ normal)
    polygon = [middle + reach * (a * sideways + b * other) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    for axis in range(3):
        for bound, side in ((low[axis], 1), (high[axis], -1)):
            depth = [side * (corner[axis] - bound) for corner in polygon]
            cut = []
            for i, corner in enumerate(polygon):
                if depth[i - 1] * depth[i] < 0:
                    before = polygon[i - 1]
                    cut.append(before + (corner - before) * depth[i - 1] / (depth[i - 1] - depth[i]))
                if depth[i] >= 0:
                    cut.append(corner)
            polygon = cut
    return np.array([[polygon[0], polygon[i], polygon[i + 1]] for i in range(1, len(polygon) - 1)]).reshape(-1, 3, 3)


class Walls:
    """The walls of one body, which move together, and what acts on them."""

    def __init__(self, position, R):
        self.position, self.R = np.array(position), R  # of the meshes in LIGGGHTS
        self.meshes = []
        self.load = np.zeros(6)   # force and torque at the end of the last step
        self.twist = np.zeros(6)


class Spheres(participant.LoadSolver):
    features = ["contact:hertz_mindlin", "contact:hertz_frictionless", "wall:plane", "wall:triangles"]
    follows_path = window_mean = True

    def configure(self, c):
        if c.solver_options:
            raise Error(f"is {json.dumps(c.solver_options)}", "dem.solver_options", "this solver has no options")
        dem, self.gravity = c.scene["dem"], c.gravity
        self.domain, self.h, self.files = (c.domain_min, c.domain_max), None, tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.files.name)
        shear = [m.young / (2 * (1 + m.poisson)) for m in c.materials]
        rayleigh = [np.pi * s.min() * np.sqrt(m.density / G) / (0.1631 * m.poisson + 0.8766)
                    for i, (m, G) in enumerate(zip(c.materials, shear)) for s in [c.spheres.radius[c.spheres.material == i]]
                    if len(s)]
        self.dt = c.micro_step or 0.2 * min(rayleigh)
        self.walls = {GROUND: Walls(np.zeros(3), np.eye(3))}
        for body in c.boundary:
            self.walls[int(body)] = Walls(c.bodies[body].position, matrix(c.bodies[body].quaternion))
        triangles = [self.triangles(c, wall) for wall in c.walls]
        everything = [np.array(self.domain), *(t.reshape(-1, 3) for t in triangles)]
        low = np.min([points.min(0) for points in everything if len(points)], axis=0)
        high = np.max([points.max(0) for points in everything if len(points)], axis=0)
        self.liggghts = Liggghts(["-screen", "/dev/null", "-log", "/dev/stderr"])
        for line in self.deck(c, dem, low, high, triangles):
            self.liggghts.command(line)
        self.deepest, self.contacts, self.lost = 0.0, 0, 0
        self.set_step(c.window)
        self.liggghts.command("log none")
        return {"liggghts": "3.8.0", "micro_step_s": self.h}

    def triangles(self, c, wall):
        """In the world, at the start."""
        walls = self.walls[wall.body]
        if wall.shape == "plane":
            if wall.body != GROUND:
                raise Error("is a plane of a body", f"dem.walls '{wall.name}'", "this solver moves triangles only: use a box")
            return cut_of_plane(wall.point, wall.normal, *self.domain)
        return walls.position + wall.triangles @ walls.R.T

    def deck(self, c, dem, low, high, triangles):
        n, s, margin = len(c.materials), c.spheres, 0.1 * (high - low)
        yield from ("units si", "hard_particles yes", "atom_style granular", "atom_modify map array", "boundary m m m", "newton off",
                    "communicate single vel yes", "processors 1 1 1")
        density = np.array([m.density for m in c.materials])[s.material]
        data = [f"spheres of {c.origin}\n\n{len(s.radius)} atoms\n{n} atom types\n"]
        for axis, (a, b) in enumerate(zip((low - margin).tolist(), (high + margin).tolist())):
            data.append(f"{a!r} {b!r} {'xyz'[axis]}lo {'xyz'[axis]}hi")
        data.append("\nAtoms\n")
        for i, (x, r, rho, kind) in enumerate(zip(s.position.tolist(), s.radius.tolist(), density.tolist(), s.material)):
            data.append(f"{i + 1} {kind + 1} {2 * r!r} {rho!r} {x[0]!r} {x[1]!r} {x[2]!r}")
        data.append("\nVelocities\n")
        for i, v in enumerate(s.velocity.tolist()):
            data.append(f"{i + 1} {v[0]!r} {v[1]!r} {v[2]!r} 0 0 0")
        (self.folder / "spheres.data").write_text("\n".join(data) + "\n")
        yield f"read_data {self.folder}/spheres.data"
        yield f"neighbor {0.25 * s.radius.min()!r} bin"
        yield "neigh_modify delay 0"
        yield "region outside block " + " ".join(repr(x) for x in np.transpose(self.domain).ravel().tolist()) + " units box side out"

        def of_pairs(name):
            values = [getattr(pair, name) if (pair := c.pair(a, b)) else 0.5 for a in range(n) for b in range(n)]
            return f"peratomtypepair {n} " + " ".join(repr(value) for value in values)

        yield "fix young all property/global youngsModulus peratomtype " + " ".join(repr(m.young) for m in c.materials)
        yield "fix poisson all property/global poissonsRatio peratomtype " + " ".join(repr(m.poisson) for m in c.materials)
        yield "fix restitution all property/global coefficientRestitution " + of_pairs("restitution")
        law = "model hertz"
        if dem.get("contact", "hertz_mindlin") == "hertz_mindlin":
            yield "fix friction all property/global coefficientFriction " + of_pairs("friction")
            law += " tangential history"
        yield f"pair_style gran {law}"
        yield "pair_coeff * *"
        strength = float(np.linalg.norm(c.gravity))
        if strength:
            yield f"fix gravity all gravity {strength!r} vector " + " ".join(repr(g) for g in (c.gravity / strength).tolist())
        meshes = []
        for wall, corners in zip(c.walls, triangles):
            if not len(corners):
                continue  # a plane that does not cut the domain
            walls, name = self.walls[wall.body], f"mesh{wall.index}"
            write_stl(self.folder / f"{name}.stl", corners)
            yield (f"fix {name} all mesh/surface/stress file {self.folder}/{name}.stl type {wall.material + 1} "
                   f"reference_point " + " ".join(repr(x) for x in walls.position.tolist()))
            walls.meshes.append(name.encode())
            meshes.append(name)
        if meshes:
            yield f"fix walls all wall/gran {law} mesh n_meshes {len(meshes)} meshes " + " ".join(meshes)
        for body, walls in self.walls.items():
            if body == GROUND:
                continue
            for value in ("vx", "vy", "vz", "wx", "wy", "wz"):
                yield f"variable {value}{body} equal 0"
            origin = " ".join(repr(x) for x in walls.position.tolist())
            for name in (mesh.decode() for mesh in walls.meshes):
                yield f"fix {name}v all move/mesh mesh {name} linear/variable v_vx{body} v_vy{body} v_vz{body}"
                for axis, letter in enumerate("xyz"):
                    yield (f"fix {name}{letter} all move/mesh mesh {name} rotate/variable origin {origin} axis "
                           f"{' '.join(str(a) for a in AXES[axis])} omega v_w{letter}{body}")
        yield "fix integrate all nve/sphere"
        yield "thermo 1000000000"
        yield "thermo_modify lost error norm no"

    def set_step(self, H):
        """A whole number of micro steps in the window."""
        self.steps = int(np.ceil(H / self.dt * (1 - 1e-9)))
        if self.h != H / self.steps:
            self.h = H / self.steps
            self.liggghts.command(f"timestep {self.h!r}")
            self.liggghts.command("run 0 post no")

    def atoms(self):
        get = self.liggghts.atoms
        return (get(b"x", 3, "f8"), get(b"v", 3, "f8"), get(b"omega", 3, "f8"), get(b"radius", 1, "f8"), get(b"rmass", 1, "f8"))

    def advance(self, motion, loads):
        H, account = motion.window.length, loads.account
        self.set_step(H)
        x, v, w, r, m = self.atoms()
        account["momentum_begin"] = m @ v
        for body in motion.bodies:
            self.aim(int(body["body"]), body["end_pose"], H)
        impulse, work = {b: np.zeros(6) for b in self.walls}, dict.fromkeys(self.walls, 0.0)
        moment = {b: np.zeros(6) for b in self.walls}
        for step in range(self.steps):
            self.liggghts.command("run 1 pre no post no")
            for body, walls in self.walls.items():
                load = sum((self.liggghts.fix_vector(mesh, 6) for mesh in walls.meshes), np.zeros(6))
                # Velocity Verlet: each step has half of the forces at its begin and half of those at its end.
                mean = (walls.load + load) / 2
                impulse[body] += self.h * mean
                begin, end = self.h * step - H / 2, self.h * (step + 1) - H / 2
                moment[body] += self.h * (begin * walls.load + end * load) / 2
                walls.load = load
                work[body] += self.h * mean @ walls.twist
        x, v, w, r, m = self.atoms()
        gravity_impulse = H * m.sum() * self.gravity
        outside = np.any((x < self.domain[0]) | (x > self.domain[1]), axis=1)
        account["lost_momentum"] = m[outside] @ v[outside]
        if np.any(outside):
            self.lost += int(outside.sum())
            self.liggghts.command("delete_atoms region outside compress no")
            self.liggghts.command("run 0 post no")
            x, v, w, r, m = self.atoms()
        for load in loads.bodies:
            body = int(load["body"])
            for name, value in (("mean", impulse[body] / H), ("first_moment", moment[body] / H), ("end", self.walls[body].load)):
                load[name]["force"], load[name]["torque"] = value[:3], value[3:]
            load["work"] = work[body]
        account["micro_steps"], account["micro_step"], account["momentum_end"] = self.steps, self.h, m @ v
        account["gravity_impulse"] = gravity_impulse
        account["lost_particles"] = self.lost
        account["kinetic_energy"] = 0.5 * m @ np.sum(v**2, axis=1) + 0.2 * (m * r**2) @ np.sum(w**2, axis=1)
        account["largest_overlap_ratio"], account["contacts"] = self.deepest, self.contacts

    def aim(self, body, pose, H):
        """Sets the velocities with which the meshes reach this pose at the end of the window."""
        walls, R = self.walls[body], matrix(pose["quaternion"])
        velocity, spin = (pose["position"] - walls.position) / H, rotation_vector(R @ walls.R.T) / H
        walls.twist = np.concatenate([velocity, spin])
        for name, value in zip(("vx", "vy", "vz", "wx", "wy", "wz"), walls.twist.tolist()):
            self.liggghts.command(f"variable {name}{body} equal {value!r}")
        walls.position = walls.position + H * velocity
        # LIGGGHTS turns about x, y and z one after the other, which differs from a turn about `spin` by a small rest.
        # The next window makes up for it, as it starts from where the meshes are.
        turn = about(2, self.h * spin[2]) @ about(1, self.h * spin[1]) @ about(0, self.h * spin[0])
        walls.R = np.linalg.matrix_power(turn, self.steps) @ walls.R

    def observe(self):
        x, v, w, r, _ = self.atoms()
        ids = self.liggghts.atoms(b"id", 1, "i4")
        order = np.argsort(ids)
        if len(r):
            pairs = cKDTree(x).query_pairs(2 * r.max(), output_type="ndarray")
            a, b = pairs.T
            overlap = r[a] + r[b] - np.linalg.norm(x[a] - x[b], axis=1)
            self.contacts = int(np.sum(overlap > 0))
            self.deepest = max(self.deepest, float(np.max(overlap / np.minimum(r[a], r[b]), initial=0)))
        return ids[order] - 1, x[order], v[order], w[order], r[order]


def write_stl(path, triangles):
    with open(path, "w", encoding="ascii") as file:
        file.write("solid wall\n")
        for corners in triangles:
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            normal = normal / np.linalg.norm(normal)
            file.write("facet normal {!r} {!r} {!r}\nouter loop\n".format(*normal.tolist()))
            for corner in corners:
                file.write("vertex {!r} {!r} {!r}\n".format(*corner.tolist()))
            file.write("endloop\nendfacet\n")
        file.write("endsolid wall\n")


participant.run(Spheres(), "liggghts_spheres", "1.0")
