"""An integration of a scene's machine that shares no idea with the solver.

Absolute coordinates of each body (position and quaternion), the equations of Newton and Euler, and constraints at
acceleration level by Gauss's principle: among all accelerations that the constraints allow, the one nearest to that of the
free bodies in the metric of the masses. Dependent constraint rows are dropped; the rank is decided with lengths divided by
the size of the machine. scipy integrates to 1e-10. At each time of output position and velocity are projected back onto all
constraints, the dropped ones as well, and what the projection had to move is checked.

All rows are made of two kinds, with e a direction that turns with body a unless said:
  displacement   e . (d' - w_a x d),  d from a point of a to a point of b  (e along d for distances and springs)
  turn           e . (w_b - w_a)                                           (e across both axes for a universal joint)
"""
import time

import numpy as np
import scipy.linalg
from scipy.integrate import DOP853, Radau

TOLERANCE = 1e-10
# Singular values of the rows, each of length 1, below this share of the largest belong to dependent rows.
RANK = 1e-7


class CannotGo(Exception):
    """Why this machine has no independent reference."""


def cross(a, b):
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def dot(a, b):
    return np.einsum("...i,...i->...", a, b)


def rotate(R, v):
    return np.einsum("...ij,...j->...i", R, v)


def matrices(q):
    """Rotation matrices of quaternions (w, x, y, z)."""
    w, x, y, z = (q / np.linalg.norm(q, axis=-1, keepdims=True)).T
    R = np.empty(q.shape[:-1] + (3, 3))
    R[..., 0, 0], R[..., 0, 1], R[..., 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[..., 1, 0], R[..., 1, 1], R[..., 1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[..., 2, 0], R[..., 2, 1], R[..., 2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R


def quaternion_rates(q, w):
    out = np.empty_like(q)
    out[..., 0] = -0.5 * dot(w, q[..., 1:])
    out[..., 1:] = 0.5 * (q[..., :1] * w + cross(w, q[..., 1:]))
    return out


def turned(q, theta):
    """q after a rotation vector theta in world axes."""
    angle = np.linalg.norm(theta, axis=-1, keepdims=True)
    s = 0.5 * np.sinc(angle / (2 * np.pi))
    c, v = np.cos(angle / 2), s * theta
    out = np.empty_like(q)
    out[..., :1] = c * q[..., :1] - dot(v, q[..., 1:])[..., None]
    out[..., 1:] = c * q[..., 1:] + q[..., :1] * v + cross(v, q[..., 1:])
    return out / np.linalg.norm(out, axis=-1, keepdims=True)


def rotation_vector(R):
    """Of a rotation matrix, below half a turn."""
    v = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    s, c = np.linalg.norm(v), 0.5 * (np.trace(R) - 1)
    return v if s == 0 else v * (np.arctan2(s, c) / s)


def across(n):
    """Two directions that complete n to a right-handed frame."""
    n = np.asarray(n) / np.linalg.norm(n)
    e = np.eye(3)[np.argmin(np.abs(n))]
    u = np.cross(n, e)
    u /= np.linalg.norm(u)
    return u, np.cross(n, u)


def function_of_time(f):
    """Value, first and second derivative."""
    kind = f["type"]
    if kind == "constant":
        v, r = f.get("value", 0.0), f.get("rate", 0.0)
        return lambda t: (v + r * t, r, 0.0)
    if kind == "harmonic":
        w, a, p, o = 2 * np.pi * f["frequency"], f["amplitude"], f.get("phase", 0.0), f.get("offset", 0.0)
        return lambda t: (o + a * np.sin(w * t + p), a * w * np.cos(w * t + p), -a * w * w * np.sin(w * t + p))
    if kind == "ramp":
        y0, y1, t0, T = f.get("from", 0.0), f["to"], f.get("start", 0.0), f["duration"]

        def ramp(t):
            x = min(max((t - t0) / T, 0.0), 1.0)
            return (y0 + (y1 - y0) * x**3 * (10 - 15 * x + 6 * x * x), (y1 - y0) / T * 30 * (x * (1 - x)) ** 2,
                    (y1 - y0) / T**2 * 60 * x * (1 - x) * (1 - 2 * x))
        return ramp
    raise CannotGo(f"functions of type {kind}")


def size_of(scene):
    """Diagonal of the box of all points that the file names."""
    mbd = scene["mbd"]
    points = [b.get("position", [0, 0, 0]) for b in mbd["bodies"]]
    points += [j["position"] for j in mbd.get("joints", [])]
    for f in mbd.get("forces", []):
        if f["type"] == "spring_damper":
            points += [f["point_a"], f["point_b"]]
    points = np.array(points, float)
    size = np.linalg.norm(points.max(0) - points.min(0))
    return size if size > 0 else 1.0


class Machine:
    """Bodies, constraint rows and forces of a scene. The ground is the last body, which has no unknowns."""

    def __init__(self, scene):
        mbd = scene["mbd"]
        self.scene, self.size = scene, size_of(scene)
        bodies = mbd["bodies"]
        self.n = n = len(bodies)
        self.names = [b["name"] for b in bodies]
        self.index = {b["name"]: i for i, b in enumerate(bodies)} | {"ground": n}
        x = np.array([b.get("position", [0, 0, 0]) for b in bodies], float)
        # Near the origin differences keep their digits.
        self.shift = x.mean(0)
        self.x0 = np.vstack([x - self.shift, np.zeros(3)])
        self.q0 = np.array([b.get("orientation", [1, 0, 0, 0]) for b in bodies] + [[1, 0, 0, 0]], float)
        self.q0 /= np.linalg.norm(self.q0, axis=1, keepdims=True)
        self.R0 = matrices(self.q0)
        self.gravity = np.array(scene.get("gravity", [0, 0, -9.81]), float)
        self.mass = np.array([b["mass"] for b in bodies], float)
        self.J, self.P = np.empty((n, 3)), np.empty((n, 3, 3))  # principal moments, their axes in the body
        for i, b in enumerate(bodies):
            I = list(b["inertia"]) + [0.0] * (6 - len(b["inertia"]))
            self.J[i], self.P[i] = np.linalg.eigh(
                np.array([[I[0], I[3], I[4]], [I[3], I[1], I[5]], [I[4], I[5], I[2]]]))
        # Base rows and what is made of them.
        self._A, self._B = [], []
        self._rows = []      # constraint rows: (list of (base, factor), function of time or None)
        self._forces = []    # joint forces: (base, law(value, rate, t))
        self._elements = []  # the same with states z: (base, law(value, rate, t, z) -> force, z', first z, count)
        self._ropes = []     # (bases of the spans, length, stiffness, damping)
        self.z0, self.z_scale = [], []
        self.coordinate = {}  # base row of a joint's coordinate
        self.full = {}        # base rows of all relative motion of a joint
        for j in mbd.get("joints", []):
            self._add_joint(j)
        for c in mbd.get("couplers", []):
            if c["type"] == "linear":
                self._rows.append(([(self.coordinate[t["joint"]], t["factor"]) for t in c["terms"]], None))
                continue
            a, b = self.coordinate[c["joint_a"]], self.coordinate[c["joint_b"]]
            self._rows.append(([(b, 1.0), (a, -c["ratio"])], None))
        self.loads, self.bushings = [], []
        for f in mbd.get("forces", []):
            self._add_force(f)
        self._compile()

    # Base rows are named ("A", k) or ("B", k).
    def _local(self, body, direction):
        return self.R0[body].T @ np.asarray(direction, float)

    def _point(self, body, p):
        return self.R0[body].T @ (np.asarray(p, float) - self.shift - self.x0[body])

    def _A_row(self, a, b, pa, pb, e, value="offset"):
        self._A.append((a, b, self._point(a, pa), self._point(b, pb), np.zeros(3) if e is None else self._local(a, e),
                        e is None))
        return "A", len(self._A) - 1

    def _B_row(self, a, b, e, kind, n=None, n2=None):
        """kind: how the row is measured: axis (tilt of axis n), frame (turn of frames), angle (about n), cross."""
        zero = np.zeros(3)
        self._B.append((a, b, zero if e is None else self._local(a, e), kind,
                        zero if n is None else self._local(a, n),
                        zero if n is None else self._local(b, n if n2 is None else n2)))
        return "B", len(self._B) - 1

    def _constrain(self, base, f=None):
        self._rows.append(([(base, 1.0)], f))

    def _add_joint(self, j):
        kind, a, b = j["type"], self.index[j.get("parent", "ground")], self.index[j["child"]]
        if kind == "free":
            return
        p = j["position"]
        if kind == "distance":
            base = self._A_row(a, b, p, j["child_position"], None)
            self._A_length = getattr(self, "_A_length", {})
            self._A_length[base[1]] = j["length"]
            self._constrain(base)
            return
        pb = j.get("child_position", p)
        n = np.array(j.get("axis", [0, 0, 1]), float)
        n /= np.linalg.norm(n)
        u, w = across(n)
        shift = {e: self._A_row(a, b, p, pb, d) for e, d in zip("uwn", (u, w, n))}
        mode = "frame" if kind in ("fixed", "prismatic") else "axis"
        tilt = {e: self._B_row(a, b, d, mode, n) for e, d in zip("uw", (u, w))}
        spin = self._B_row(a, b, n, "frame" if mode == "frame" else "angle", n)
        self.full[j["name"]] = [*shift.values(), *tilt.values(), spin]
        held = {"fixed": "uwn uw s", "revolute": "uwn uw ", "prismatic": "uw uw s", "cylindrical": "uw uw ",
                "screw": "uw uw ", "spherical": "uwn  ", "universal": "uwn  ", "planar": "n uw "}[kind].split(" ")
        for e in held[0]:
            self._constrain(shift[e])
        for e in held[1]:
            self._constrain(tilt[e])
        if held[2]:
            self._constrain(spin)
        if kind == "universal":
            self._constrain(self._B_row(a, b, None, "cross", n, j["axis2"]))
        if kind == "screw":
            self._rows.append(([(shift["n"], 1.0), (spin, -j["pitch"])], None))
        coordinate = {"revolute": spin, "prismatic": shift["n"], "screw": spin}.get(kind)
        if coordinate:
            self.coordinate[j["name"]] = coordinate
        if "motion" in j:
            f = function_of_time(j["motion"])
            self._constrain(coordinate, f)
        c = j.get("damping", 0)
        if c:
            if kind == "spherical":
                bases = [self._B_row(a, b, e, "frame", n) for e in np.eye(3)]
            elif coordinate:
                bases = [coordinate]
            else:
                raise CannotGo(f"damping of a {kind} joint")
            for base in bases:
                self._forces.append((base, lambda q, r, t: -c * r))
        if "friction" in j:
            F, slip = j["friction"]["force"], j["friction"]["slip"]
            self._forces.append((coordinate, lambda q, r, t: -F * np.tanh(r / slip)))
        if "limits" in j:
            raise CannotGo("stops")

    def _add_force(self, f):
        kind = f["type"]
        if "table" in f or "damping_table" in f or "input" in f:
            raise CannotGo("tables and inputs")
        if kind == "spring_damper":
            base = self._A_row(self.index[f.get("body_a", "ground")], self.index[f["body_b"]], f["point_a"],
                               f["point_b"], None)
            k, c, L = f.get("stiffness", 0), f.get("damping", 0), f["length"]
            self._forces.append((base, lambda q, r, t: -k * (q - L) - c * r))
        elif kind == "rotational_spring_damper":
            k, c, q0 = f.get("stiffness", 0), f.get("damping", 0), f.get("angle", 0)
            self._forces.append((self.coordinate[f["joint"]], lambda q, r, t: -k * (q - q0) - c * r))
        elif kind == "motor":
            self._add_motor(f)
        elif kind == "cylinder":
            self._add_cylinder(f)
        elif kind == "rope":
            points = f["points"]
            spans = [self._A_row(self.index[p["body"]], self.index[q["body"]], p["point"], q["point"], None)
                     for p, q in zip(points, points[1:])]
            self._ropes.append((spans, f["length"], f["axial_stiffness"] / f["length"], f.get("damping", 0)))
        elif kind == "actuator":
            g = function_of_time(f["size"])
            self._forces.append((self.coordinate[f["joint"]], lambda q, r, t: g(t)[0]))
        elif kind == "bushing":
            a, b = self.index[f.get("body_a", "ground")], self.index[f["body_b"]]
            K, C = [np.diag(m) if len(m) == 6 else np.reshape(m, (6, 6))
                    for m in (f["stiffness"], f.get("damping", [0] * 6))]
            self.bushings.append((a, b, self._point(a, f["position"]), self._point(b, f["position"]), K, C,
                                  self.R0[a], self.R0[b]))
        else:
            body = self.index[f["body"]]
            point = self._point(body, f["point"]) if kind == "force" else np.zeros(3)
            e = np.array(f["direction"], float)
            e /= np.linalg.norm(e)
            follows = f.get("follows", False)
            self.loads.append((body, kind == "torque", point, self._local(body, e) if follows else e, follows,
                               function_of_time(f["size"])))

    def _add_element(self, base, law, z0, scale):
        self._elements.append((base, law, len(self.z0), len(z0)))
        self.z0 += z0
        self.z_scale += scale

    def _controller(self, gains, target, of_rate, limit, scale):
        """PID with a filter and anti-windup, and its states."""
        kp, ki, kd, tau = (gains.get(k, 0.0) for k in ("proportional", "integral", "derivative", "filter"))
        windup = gains.get("anti_windup", kp / ki if ki else 1.0)
        g, integral, filtered = function_of_time(target), ki != 0, kd != 0 and tau > 0

        def law(q, r, t, z):
            value, rate, _ = g(t)
            e = value - (r if of_rate else q)
            asked, zd = kp * e, []
            if filtered:
                zd = [(e - z[-1]) / tau]
                asked += kd * zd[0]
            else:
                asked += kd * (rate - r)
            asked += ki * z[0] if integral else 0.0
            force = min(max(asked, -limit), limit)
            return force, ([e + (force - asked) / (ki * windup)] if integral else []) + zd
        count = int(integral) + int(filtered)
        return law, [0.0] * count, ([scale * self.scene["end_time"]] if integral else []) + [scale] * filtered

    def _add_motor(self, f):
        if f.get("rotor_inertia"):
            raise CannotGo("rotors")
        base, gear = self.coordinate[f["joint"]], f.get("gear_ratio", 1.0)
        if "brake" in f:
            T, slip = f["brake"]["torque"], f["brake"]["slip"]
            self._forces.append((base, lambda q, r, t: -T * np.tanh(r / slip)))
        if f["control"] == "throttle":
            (x0, x1), (y0, y1) = f["torque_speed"]["arguments"], f["torque_speed"]["values"]
            g = function_of_time(f["target"])

            def law(q, r, t):
                x = g(t)[0]
                speed = gear * r * (-1 if x < 0 else 1)
                return x * gear * (y0 + (y1 - y0) * (speed - x0) / (x1 - x0))
            self._forces.append((base, law))
            return
        self._add_element(base, *self._controller(f["gains"], f["target"], f["control"] == "speed",
                                                  gear * f.get("max_torque", np.inf), 1.0))

    def _add_cylinder(self, f):
        base = self._A_row(self.index[f.get("body_a", "ground")], self.index[f["body_b"]], f["point_a"], f["point_b"], None)
        L = float(np.linalg.norm(np.asarray(f["point_b"], float) - np.asarray(f["point_a"], float)))
        c = f.get("damping", 0.0)
        if f["control"] == "force":
            g = function_of_time(f["target"])
            self._forces.append((base, lambda q, r, t: g(t)[0] - c * r))
            return
        if f["control"] == "stroke":
            law, z0, scale = self._controller(f["gains"], f["target"], False, f.get("max_force", np.inf), self.size)
        else:
            law, z0, scale = self._hydraulics(f)

        def damped(q, r, t, z):
            force, zd = law(q - L, r, t, z)
            return force - c * r, zd
        self._add_element(base, damped, z0, scale)

    def _hydraulics(self, f):
        h, limits, g = f["hydraulics"], f["limits"], function_of_time(f["target"])
        A, B = h["bore_area"], h["bore_area"] - h.get("rod_area", 0.0)
        V0, K, pump, leak = h["dead_volume"], h["bulk_modulus"], h.get("pump_flow", np.inf), h.get("leakage", 0.0)
        ps, pt, drop, d = h["supply_pressure"], h["tank_pressure"], h["valve_drop"], h["laminar_drop"]
        factor = h["valve_flow"] / drop * (drop * drop + d * d) ** 0.25
        edge = lambda x, dp: factor * x * dp / (dp * dp + d * d) ** 0.25

        def law(s, v, t, z):
            if not limits["lower"] < s < limits["upper"]:
                raise CannotGo("a cylinder at its end")
            x = g(t)[0]
            qa = min(edge(x, ps - z[0]), pump) if x >= 0 else edge(-x, pt - z[0])
            qb = edge(x, pt - z[1]) if x >= 0 else min(edge(-x, ps - z[1]), pump)
            lost = leak * (z[0] - z[1])
            return A * z[0] - B * z[1], [K * (qa - lost - A * v) / (V0 + A * (s - limits["lower"])),
                                         K * (qb + lost + B * v) / (V0 + B * (limits["upper"] - s))]
        return law, [h["pressure_a"], h["pressure_b"]], [ps, ps]

    def _compile(self):
        A, B, n = self._A, self._B, self.n
        self.nA, self.nB = len(A), len(B)
        arr = lambda rows, k, shape: np.array([r[k] for r in rows]).reshape((-1,) + shape)
        self.Aa, self.Ab = arr(A, 0, ()).astype(int), arr(A, 1, ()).astype(int)
        self.Apa, self.Apb, self.Ae = arr(A, 2, (3,)), arr(A, 3, (3,)), arr(A, 4, (3,))
        self.along = np.array([r[5] for r in A], dtype=bool)
        self.Ba, self.Bb = arr(B, 0, ()).astype(int), arr(B, 1, ()).astype(int)
        self.Be, self.Bna, self.Bnb = arr(B, 2, (3,)), arr(B, 4, (3,)), arr(B, 5, (3,))
        self.Bkind = np.array([r[3] for r in B], dtype="U5")
        self.cross_rows = self.Bkind == "cross"
        self.lengths = np.zeros(self.nA)
        for k, L in getattr(self, "_A_length", {}).items():
            self.lengths[k] = L
        self.Rrel0 = np.einsum("kji,kjl->kil", self.R0[self.Ba], self.R0[self.Bb]) if self.nB else np.zeros((0, 3, 3))

        flat = lambda base: base[1] + (self.nA if base[0] == "B" else 0)
        self.rows = len(self._rows)
        self.C = np.zeros((self.rows, self.nA + self.nB))
        self.driven = []
        for i, (parts, f) in enumerate(self._rows):
            for base, factor in parts:
                self.C[i, flat(base)] += factor
            if f:
                self.driven.append((i, f))
        self.forces = [(flat(base), law) for base, law in self._forces]
        self.elements = [(flat(base), law, slice(i, i + count)) for base, law, i, count in self._elements]
        self.ropes = [([flat(base) for base in spans], *data) for spans, *data in self._ropes]
        # Base rows that the equations need; the others only say what a joint at rest is.
        used = np.abs(self.C).sum(0) > 0
        for k, _ in self.forces:
            used[k] = True
        self.flat = flat
        # Angles that some law or row takes the value of are integrated along.
        wanted = {k for k, _ in self.forces} | {k for k, *_ in self.elements} | {k for i in range(self.rows) for k in np.nonzero(self.C[i])[0]}
        self.angles = [k - self.nA for k in sorted(wanted) if k >= self.nA and self.Bkind[k - self.nA] == "angle"]
        self.m = len(self.angles)
        self.tail0 = np.concatenate([np.zeros(self.m), self.z0])

    # State: x, q, v, w of the bodies, then angles and the states of elements.
    def pack(self, x, q, v, w, angles):
        return np.concatenate([x[:self.n].ravel(), q[:self.n].ravel(), v[:self.n].ravel(), w[:self.n].ravel(), angles])

    def unpack(self, y):
        n = self.n
        zero = np.zeros((1, 3))
        x = np.concatenate([y[:3 * n].reshape(n, 3), self.x0[n:]])
        q = np.concatenate([y[3 * n:7 * n].reshape(n, 4), self.q0[n:]])
        v = np.concatenate([y[7 * n:10 * n].reshape(n, 3), zero])
        w = np.concatenate([y[10 * n:13 * n].reshape(n, 3), zero])
        return x, q, v, w, y[13 * n:]

    def evaluate(self, y, t):
        """Everything that rows and forces are made of."""
        s = State()
        s.x, s.q, s.v, s.w, s.angles = self.unpack(y)
        s.z = s.angles[self.m:]
        s.R = matrices(s.q)
        Aa, Ab, Ba, Bb = self.Aa, self.Ab, self.Ba, self.Bb
        wa, wb = s.w[Aa], s.w[Ab]
        ra, rb = rotate(s.R[Aa], self.Apa), rotate(s.R[Ab], self.Apb)
        s.d = d = s.x[Ab] + rb - s.x[Aa] - ra
        wra, wrb = cross(wa, ra), cross(wb, rb)
        dd = s.v[Ab] + wrb - s.v[Aa] - wra
        e = rotate(s.R[Aa], self.Ae)
        ed = cross(wa, e)
        k = self.along
        if k.any():
            L = np.linalg.norm(d[k], axis=1)[:, None]
            e[k] = d[k] / L
            ed[k] = (dd[k] - e[k] * dot(e[k], dd[k])[:, None]) / L
        moved = dd - cross(wa, d)
        s.G = G = np.zeros((self.nA + self.nB, self.n + 1, 6))
        i = np.arange(self.nA)
        G[i, Ab, :3] = e
        G[i, Ab, 3:] = cross(rb, e)
        G[i, Aa, :3] = -e
        G[i, Aa, 3:] = -cross(ra + d, e)
        eB = rotate(s.R[Ba], self.Be)
        wBa, wBb = s.w[Ba], s.w[Bb]
        edB = cross(wBa, eB)
        k = self.cross_rows
        if k.any():
            n1, n2 = rotate(s.R[Ba[k]], self.Bna[k]), rotate(s.R[Bb[k]], self.Bnb[k])
            eB[k] = cross(n1, n2)
            edB[k] = cross(cross(wBa[k], n1), n2) + cross(n1, cross(wBb[k], n2))
        i = np.arange(self.nA, self.nA + self.nB)
        G[i, Bb, 3:] = eB
        G[i, Ba, 3:] = -eB
        s.rate = np.concatenate([dot(e, moved), dot(eB, wBb - wBa)])
        s.bias = np.concatenate([dot(ed, moved) + dot(e, cross(wb, wrb) - cross(wa, wra) - cross(wa, dd)),
                                 dot(edB, wBb - wBa)])
        s.e = e
        s.Pw = s.R[:self.n] @ self.P  # principal axes in the world
        return s

    def value(self, s, k):
        """Of a base row: length, displacement or angle."""
        if k < self.nA:
            return np.linalg.norm(s.d[k]) - self.lengths[k] if self.along[k] else s.e[k] @ s.d[k]
        b = k - self.nA
        Ra, Rb = s.R[self.Ba[b]], s.R[self.Bb[b]]
        na, nb = Ra @ self.Bna[b], Rb @ self.Bnb[b]
        e = Ra @ self.Be[b]
        kind = self.Bkind[b]
        if kind == "axis":
            return e @ np.cross(na, nb)
        if kind == "cross":
            return -na @ nb
        if kind == "frame":
            return e @ (Ra @ rotation_vector(Ra.T @ Rb @ self.Rrel0[b].T))
        # The turn about the axis from the start, near the integrated angle.
        u = across(self.Bna[b])[0]
        f = self.Rrel0[b].T @ u
        a1, a2, fb = Ra @ u, Ra @ np.cross(self.Bna[b], u), Rb @ f
        angle, near = np.arctan2(a2 @ fb, a1 @ fb), s.angles[self.angles.index(b)]
        return angle + 2 * np.pi * round((near - angle) / (2 * np.pi))

    def applied(self, s, t):
        f = np.zeros((self.n + 1, 6))
        f[:self.n, :3] = self.mass[:, None] * self.gravity
        def argument(k):
            if k >= self.nA:
                b = k - self.nA
                return s.angles[self.angles.index(b)] if self.Bkind[b] == "angle" else 0.0
            return np.linalg.norm(s.d[k]) if self.along[k] else s.e[k] @ s.d[k]

        for k, law in self.forces:
            f += s.G[k] * law(argument(k), s.rate[k], t)
        s.z_rate = np.zeros(len(self.z0))
        for k, law, own in self.elements:
            force, s.z_rate[own] = law(argument(k), s.rate[k], t, s.z[own])
            f += s.G[k] * force
        for spans, length, stiffness, damping in self.ropes:
            e = sum(argument(k) for k in spans) - length
            tension = stiffness * e * (1 + damping * sum(s.rate[k] for k in spans)) if e > 0 else 0.0
            if tension > 0:
                for k in spans:
                    f -= s.G[k] * tension
        for body, torque, point, e, follows, size in self.loads:
            F = size(t)[0] * (s.R[body] @ e if follows else e)
            if torque:
                f[body, 3:] += F
            else:
                f[body, :3] += F
                f[body, 3:] += np.cross(s.R[body] @ point, F)
        for a, b, pa, pb, K, C, Ra0, Rb0 in self.bushings:
            Ra, Rb = s.R[a] @ Ra0.T, s.R[b] @ Rb0.T
            p = s.x[b] + s.R[b] @ pb
            motion = lambda i: s.v[i] + np.cross(s.w[i], p - s.x[i])
            turn = rotation_vector(Ra.T @ Rb)
            if np.linalg.norm(turn) > 3:
                raise CannotGo("a bushing turned by half a turn")
            D = np.concatenate([Ra.T @ (p - s.x[a] - s.R[a] @ pa), turn])
            D_rate = np.concatenate([Ra.T @ (motion(b) - motion(a)), Ra.T @ (s.w[b] - s.w[a])])
            h = -(K @ D + C @ D_rate)
            F, T = Ra @ h[:3], Ra @ h[3:]
            f[b, :3] += F
            f[a, :3] -= F
            f[b, 3:] += T + np.cross(p - s.x[b], F)
            f[a, 3:] -= T + np.cross(p - s.x[a], F)
        w = s.w[:self.n]
        Jw = rotate(s.Pw, self.J * np.einsum("nij,ni->nj", s.Pw, w))
        f[:self.n, 3:] -= cross(w, Jw)
        return f[:self.n]

    def weighted(self, s, G):
        """Rows times M^(-1/2), in principal axes."""
        n = self.n
        H = np.empty((G.shape[0], n, 6))
        H[:, :, :3] = G[:, :n, :3] / np.sqrt(self.mass)[:, None]
        H[:, :, 3:] = np.einsum("rni,nij->rnj", G[:, :n, 3:], s.Pw) / np.sqrt(self.J)
        return H.reshape(G.shape[0], 6 * n)

    def unweighted(self, s, u):
        u = u.reshape(self.n, 6)
        a = np.empty((self.n, 6))
        a[:, :3] = u[:, :3] / np.sqrt(self.mass)[:, None]
        a[:, 3:] = rotate(s.Pw, u[:, 3:] / np.sqrt(self.J))
        return a

    def constraint_rows(self, s):
        return np.tensordot(self.C, s.G, 1)

    def find_rank(self, y, t):
        """Rank, the smallest singular value that counts, and a set of independent rows."""
        if self.rows == 0:
            return 0, 1.0, np.zeros(0, int)
        s = self.evaluate(y, t)
        G = self.constraint_rows(s)[:, :self.n].copy()
        G[:, :, 3:] /= self.size
        G = G.reshape(self.rows, -1)
        values = np.linalg.svd(G / np.linalg.norm(G, axis=1, keepdims=True), compute_uv=False)
        rank = int((values > RANK * values[0]).sum())
        H = self.weighted(s, self.constraint_rows(s))
        H /= np.linalg.norm(H, axis=1, keepdims=True)
        order = scipy.linalg.qr(H.T, mode="r", pivoting=True)[1]
        return rank, values[rank - 1] / values[0], np.sort(order[:rank])

    def accelerations(self, s, t, keep):
        f = self.applied(s, t)
        fh = np.empty((self.n, 6))
        fh[:, :3] = f[:, :3] / np.sqrt(self.mass)[:, None]
        fh[:, 3:] = np.einsum("nij,ni->nj", s.Pw, f[:, 3:]) / np.sqrt(self.J)
        fh = fh.ravel()
        if len(keep):
            C = self.C[keep]
            H = self.weighted(s, np.tensordot(C, s.G, 1))
            wanted = -C @ s.bias
            for i, g in self.driven:
                at = np.nonzero(keep == i)[0]
                if len(at):
                    wanted[at[0]] += g(t)[2]
            scale = 1 / np.linalg.norm(H, axis=1)
            H *= scale[:, None]
            Q, R = np.linalg.qr(H.T)
            fh = fh + Q @ scipy.linalg.solve_triangular(R, scale * wanted - H @ fh, trans="T", check_finite=False)
        return self.unweighted(s, fh)

    def derivative(self, t, y, keep):
        s = self.evaluate(y, t)
        try:
            a = self.accelerations(s, t, keep)
        except np.linalg.LinAlgError:
            return np.full_like(y, np.nan)  # a trial step went too far: scipy takes a shorter one
        n = self.n
        return np.concatenate([s.v[:n].ravel(), quaternion_rates(s.q[:n], s.w[:n]).ravel(), a[:, :3].ravel(),
                               a[:, 3:].ravel(), s.rate[[self.nA + b for b in self.angles]], s.z_rate])

    def least(self, s, residual):
        """The smallest motion, in the metric of the masses, that takes away a residual of all rows."""
        H = self.weighted(s, self.constraint_rows(s))
        scale = 1 / np.linalg.norm(H, axis=1)
        u = np.linalg.lstsq(H * scale[:, None], scale * residual, rcond=RANK)[0]
        return self.unweighted(s, u)

    def residuals(self, s, t):
        used = np.nonzero(np.abs(self.C).sum(0))[0]
        values = np.zeros(self.nA + self.nB)
        for k in used:
            values[k] = self.value(s, k)
        position, velocity = self.C @ values, self.C @ s.rate
        for i, g in self.driven:
            f = g(t)
            position[i] -= f[0]
            velocity[i] -= f[1]
        return position, velocity

    def project(self, y, t):
        """Onto position and velocity constraints; also how far that moved it, as a share of the size."""
        if self.rows == 0:
            return y, 0.0
        moved = 0.0
        for _ in range(3):
            s = self.evaluate(y, t)
            x = self.least(s, self.residuals(s, t)[0])
            moved += np.abs(x[:, :3]).max() / self.size + np.abs(x[:, 3:]).max()
            y = self.pack(s.x[:self.n] - x[:, :3], turned(s.q[:self.n], -x[:, 3:]), s.v, s.w, s.angles)
        s = self.evaluate(y, t)
        angles = np.array([self.value(s, self.nA + b) for b in self.angles])
        u = self.least(s, self.residuals(s, t)[1])
        return self.pack(s.x, s.q, s.v[:self.n] - u[:, :3], s.w[:self.n] - u[:, 3:], np.concatenate([angles, s.z])), moved

    def roots(self):
        """The free bodies: of each group that joints of the tree hold together, the first that is no joint's child."""
        joints = [j for j in self.scene["mbd"].get("joints", [])
                  if j["type"] not in ("free", "distance") and not j.get("cut")]
        group = list(range(self.n + 1))
        for _ in joints:
            for j in joints:
                a, b = self.index[j.get("parent", "ground")], self.index[j["child"]]
                group[a] = group[b] = min(group[a], group[b]) if self.n not in (group[a], group[b]) else self.n
        children = {self.index[j["child"]] for j in joints}
        roots = {}
        for i in range(self.n):
            if group[i] != self.n and i not in children:
                roots.setdefault(group[i], i)
        return roots.values()

    def start(self):
        """State at the start: as the tree of the joints moves with the rates of the scene, then changed by the least, in the
        metric of the masses, that closes the loops and keeps those rates."""
        n = self.n
        y = self.pack(self.x0, self.q0, np.zeros((n, 3)), np.zeros((n, 3)), self.tail0)
        s = self.evaluate(y, 0.0)
        rows, right, held, rates = [], [], [], []
        for j in self.scene["mbd"].get("joints", []):
            if j["type"] in ("free", "distance") or j.get("cut"):
                continue
            rate = function_of_time(j["motion"])(0.0)[1] if "motion" in j else j.get("rate", 0.0)
            twist = dict.fromkeys(self.full[j["name"]], 0.0)
            if rate != 0:
                twist[self.coordinate[j["name"]]] = rate
                if j["type"] == "screw":
                    twist[self.full[j["name"]][2]] = j["pitch"] * rate
                held.append(self.flat(self.coordinate[j["name"]]))
                rates.append(rate)
            for base, value in twist.items():
                rows.append(s.G[self.flat(base), :n])
                right.append(value)
        for i in self.roots():
            b = self.scene["mbd"]["bodies"][i]
            rows += list(np.eye(6 * n)[6 * i:6 * i + 6].reshape(6, n, 6))
            right += list(b.get("velocity", [0, 0, 0])) + list(b.get("angular_velocity", [0, 0, 0]))
        H, r = np.array(rows), np.array(right)
        H[:, :, 3:] /= self.size
        H = H.reshape(len(H), -1)
        norm = np.linalg.norm(H, axis=1)
        u, _, rank, _ = np.linalg.lstsq(H / norm[:, None], r / norm, rcond=RANK)
        if rank < 6 * n:
            raise CannotGo("the joints of the tree do not determine the start")
        if np.abs((H @ u - r) / norm).max() > 1e-9 * np.abs(u).max():
            raise CannotGo("the tree's joints close a loop with different rates")
        u = u.reshape(n, 6)
        s.v[:n], s.w[:n] = u[:, :3], u[:, 3:] / self.size
        # The least change that all constraints ask for.
        G = np.concatenate([self.constraint_rows(s), s.G[held]])
        wanted = np.concatenate([np.zeros(self.rows), rates])
        for i, g in self.driven:
            wanted[i] = g(0.0)[1]
        if len(G):
            now = np.einsum("rni,ni->r", G[:, :n, :3], s.v[:n]) + np.einsum("rni,ni->r", G[:, :n, 3:], s.w[:n])
            H = self.weighted(s, G)
            scale = 1 / np.linalg.norm(H, axis=1)
            change = np.linalg.lstsq(H * scale[:, None], scale * (wanted - now), rcond=RANK)[0]
            left = scale * (H @ change - wanted + now)
            weighted = np.sqrt(self.mass @ dot(s.v[:n], s.v[:n]) + (self.J * np.einsum("nij,ni->nj", s.Pw, s.w[:n])**2).sum())
            if np.abs(left).max() > 1e-8 * max(np.abs(scale * wanted).max(), weighted):
                raise CannotGo("the rates do not fit together")
            d = self.unweighted(s, change)
            s.v[:n] += d[:, :3]
            s.w[:n] += d[:, 3:]
        return self.pack(self.x0, self.q0, s.v, s.w, self.tail0)

    def perturbed(self, y, t, share, rng):
        """A state nearby that the constraints allow."""
        s = self.evaluate(y, t)
        T = self.scene["end_time"]
        d = rng.normal(size=(self.n, 12)) * share
        y = self.pack(s.x[:self.n] + self.size * d[:, :3], turned(s.q[:self.n], d[:, 3:6]),
                      s.v[:self.n] + self.size / T * d[:, 6:9], s.w[:self.n] + d[:, 9:] / T, s.angles)
        return self.project(y, t)[0]


class State:
    pass


def integrate(machine, y, times, method, tolerance, seconds):
    """States at the times; raises CannotGo when that takes longer than so many seconds."""
    n, T = machine.n, times[-1]
    size = machine.size
    atol = np.concatenate([np.full(3 * n, size), np.ones(4 * n), np.full(3 * n, size / T), np.full(3 * n, 1 / T),
                           np.ones(machine.m), machine.z_scale]) * tolerance
    begin, t, states, worst = time.process_time(), 0.0, [], 0.0
    conditions = []  # the smallest until each time
    step = None
    for end in times:
        rank, smallest, keep = machine.find_rank(y, t)
        if states and rank != known:
            raise CannotGo(f"the rank changes from {known} to {rank} at {t:.4g} s")
        known = rank
        conditions.append(min([smallest, *conditions[-1:]]))
        solver = method(lambda t, y: machine.derivative(t, y, keep), t, y, end, rtol=max(tolerance, 3e-14), atol=atol,
                        **({"first_step": min(step, end - t)} if step else {}))
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise CannotGo(f"scipy: {message}")
            conditions[-1] = min(conditions[-1], machine.find_rank(solver.y, solver.t)[1])
            spent = time.process_time() - begin
            if spent > seconds or (spent > 0.15 * seconds and solver.t / T < 0.5 * spent / seconds):
                raise CannotGo(f"{method.__name__} reaches {solver.t:.3g} of {T:.3g} s in {spent:.0f} s")
            if solver.step_size and solver.status == "running":
                step = solver.step_size
        y, moved = machine.project(solver.y.copy(), end)
        q = y[3 * n:7 * n].reshape(n, 4)
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        worst = max(worst, moved)
        if moved > max(1e-6, 1e3 * tolerance):
            raise CannotGo(f"constraints drift by {moved:.2g} until {end:.4g} s")
        t = end
        states.append(y)
    return states, worst, np.array(conditions), rank


def poses(machine, states):
    """Positions, quaternions, velocities and angular velocities over time."""
    parts = [machine.unpack(y) for y in states]
    n = machine.n
    return (np.array([p[0][:n] + machine.shift for p in parts]), np.array([p[1][:n] for p in parts]),
            np.array([p[2][:n] for p in parts]), np.array([p[3][:n] for p in parts]))


@np.errstate(all="ignore")
def reference(scene, times, seconds=20.0):
    """Motion at the times and facts; raises CannotGo."""
    machine = Machine(scene)
    y, opened = machine.project(machine.start(), 0.0)
    if opened > 1e-6:
        raise CannotGo(f"the machine is open by {opened:.2g} at the start")
    begin = time.process_time()
    try:
        method = DOP853
        states, drift, condition, rank = integrate(machine, y, times, DOP853, TOLERANCE, 0.5 * seconds)
    except CannotGo as why:
        if "DOP853" not in str(why):
            raise
        method = Radau
        states, drift, condition, rank = integrate(machine, y, times, Radau, TOLERANCE, 0.5 * seconds)
    return {"machine": machine, "motion": poses(machine, states), "drift": drift, "condition": condition,
            "dof": 6 * machine.n - rank, "redundant": machine.rows - rank, "method": method,
            "states": [y, *states], "seconds": time.process_time() - begin}


@np.errstate(all="ignore")
def growth(found, times, seconds=20.0):
    """How far small errors of position and velocity at the start move the machine until each time, as a multiple of them."""
    machine = found["machine"]
    near = machine.perturbed(found["states"][0], 0.0, 1e-4, np.random.default_rng(1))
    others = integrate(machine, near, times, found["method"], 1e-7, seconds)[0]
    size, T = machine.size, times[-1]
    first, *later = [[poses(machine, [s]) for s in pair] for pair in zip(found["states"], [near, *others])]
    moved = lambda A, B: max(np.abs(A[0] - B[0]).max() / size, angle_between(A[1], B[1]).max())
    faster = lambda A, B: T * max(np.abs(A[2] - B[2]).max() / size, np.abs(A[3] - B[3]).max())
    start = max(moved(*first), faster(*first), 1e-12)
    return np.maximum(1, np.maximum.accumulate([moved(*pair) / start for pair in later]))


def angle_between(p, q):
    """Of orientations [rad]."""
    return 2 * np.minimum(np.linalg.norm(p - q, axis=-1), np.linalg.norm(p + q, axis=-1))
