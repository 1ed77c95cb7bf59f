"""Random machines, valid by construction.

A machine is built near the origin with lengths, times and masses around 1: joints on joints, and closed loops whose joints
fit because they are placed on a body pose that is known. Then it is given its units (length 1e-3 to 1e3 m, masses 1e-3 to
1e4 kg), placed in space, and written with full or with few digits. The same seed and number give the same machine.
"""
import math

import numpy as np

import pose

CLASSES = ("tree", "free bodies", "planar loop", "spatial loop", "over-constrained", "cut joints", "gears", "stiff", "mixed")
# Of machines with elements, made for check.py --elements.
ELEMENT_CLASSES = ("motors", "cylinders", "hydraulics", "ropes", "linear couplers")
WINDOWS = 8


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


class Builder:
    def __init__(self, rng):
        self.rng = rng
        self.bodies, self.joints, self.couplers, self.forces = [], [], [], []
        self.extreme = rng.random() < 0.25
        self.parts = []  # what it is made of, for people

    # -- numbers
    def u(self, a, b):
        return float(self.rng.uniform(a, b))

    def log(self, a, b):
        return float(10 ** self.rng.uniform(math.log10(a), math.log10(b)))

    def chance(self, p):
        return bool(self.rng.random() < p)

    def pick(self, options):
        return options[int(self.rng.integers(len(options)))]

    def direction(self):
        if self.chance(0.3):
            return np.eye(3)[int(self.rng.integers(3))] * (1 if self.chance(0.5) else -1)
        return unit(self.rng.normal(size=3))

    def perpendicular(self, n):
        u = unit(np.cross(n, np.eye(3)[np.argmin(np.abs(n))]))
        a = self.pick([0.0, self.u(-3, 3)])
        return math.cos(a) * u + math.sin(a) * np.cross(n, u)

    # -- bodies
    def body(self, center, extent=0.4, velocity=None):
        mass = self.log(1e-3, 1e3) if self.extreme else self.log(0.3, 3)
        a, b, c = (extent * self.log(0.3, 1) * (self.log(1e-3, 1) if self.extreme and self.chance(0.2) else 1)
                   for _ in range(3))
        moments = mass / 12 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
        new = {"name": f"body{len(self.bodies) + 1}", "mass": mass, "inertia": moments, "position": np.array(center, float)}
        q = unit(self.rng.normal(size=4))
        if self.chance(0.6):
            new["orientation"] = q
        elif self.chance(0.5):
            R = pose.matrix(q)
            J = R @ np.diag(moments) @ R.T
            new["inertia"] = np.array([J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]])
        if velocity is not None:
            new["velocity"], new["angular_velocity"] = velocity
        self.bodies.append(new)
        return new["name"]

    def at(self, name):
        return next(b for b in self.bodies if b["name"] == name)

    def place(self, name):
        return np.zeros(3) if name == "ground" else self.at(name)["position"]

    def moments(self, name):
        I = self.at(name)["inertia"]
        I = list(I) + [0.0] * (6 - len(I))
        return [float(J) for J in np.linalg.eigvalsh([[I[0], I[3], I[4]], [I[3], I[1], I[5]], [I[4], I[5], I[2]]])]

    def gyration(self, name):
        """Smallest principal moment."""
        return self.moments(name)[0]

    # -- joints
    def joint(self, kind, parent, child, position, **more):
        new = {"name": f"joint{len(self.joints) + 1}", "type": kind, "child": child, "position": np.array(position, float)}
        if parent != "ground":
            new["parent"] = parent
        new |= more
        # The ground carries, and either body of another pair may be called the child.
        if parent != "ground" and kind in ("revolute", "spherical", "prismatic", "cylindrical") and not new.get("rate") \
                and self.chance(0.2) and not new.get("motion") and "free" not in self.at(parent):
            new["parent"], new["child"] = child, parent
        self.joints.append(new)
        return new

    def motion(self):
        """Of a coordinate, zero at the start."""
        if self.chance(0.5):
            return {"type": "ramp", "to": self.u(-1, 1), "duration": self.u(1, 3), "start": self.pick([0.0, 0.2])}
        a, phase = self.u(-0.5, 0.5), self.u(-3, 3)
        return {"type": "harmonic", "amplitude": a, "frequency": self.u(0.1, 0.6), "phase": phase,
                "offset": -a * math.sin(phase)}

    def add_joint_body(self, parent, kinds=None):
        """A body on one joint."""
        kind = self.pick(kinds or ("revolute",) * 4 + ("prismatic", "cylindrical", "spherical", "spherical", "universal",
                                                       "universal", "planar", "screw", "fixed"))
        anchor = self.place(parent) + self.u(0, 0.6) * unit(self.rng.normal(size=3))
        child = self.body(anchor + self.u(0.2, 1) * unit(self.rng.normal(size=3)))
        more = {}
        if kind not in ("spherical", "fixed"):
            more["axis"] = self.direction()
        if kind == "universal":
            more["axis2"] = self.perpendicular(more["axis"])
        if kind == "screw":
            more["pitch"] = self.u(0.05, 1) * self.pick([-1, 1])
        if kind in ("revolute", "prismatic", "screw") and self.chance(0.5):
            more["rate"] = self.u(-1.5, 1.5)
        elif kind in ("revolute", "prismatic") and self.chance(0.1):
            more["motion"] = self.motion()
        if "motion" not in more and kind in ("revolute", "prismatic", "spherical", "screw") and self.chance(0.2):
            more["damping"] = self.gyration(child) * self.log(0.01, 1)
        if kind in ("revolute", "prismatic") and "motion" not in more and self.chance(0.05):
            more["friction"] = {"force": self.gyration(child) * self.log(0.03, 1), "slip": self.u(0.1, 1)}
        joint = self.joint(kind, parent, child, anchor, **more)
        self.parts.append(kind)
        self.load_joint(joint, child)
        return child

    def load_joint(self, joint, child):
        J = self.gyration(child)
        if joint.get("motion"):
            return
        if joint["type"] == "revolute" and self.chance(0.25):
            self.forces.append({"name": f"force{len(self.forces) + 1}", "type": "rotational_spring_damper",
                                "joint": joint["name"], "stiffness": J * self.log(0.1, 10) ** 2,
                                "damping": self.pick([0.0, J * self.log(0.01, 1)]), "angle": self.u(-1, 1)})
        if joint["type"] in ("revolute", "prismatic") and self.chance(0.15):
            self.forces.append({"name": f"force{len(self.forces) + 1}", "type": "actuator", "joint": joint["name"],
                                "size": self.function(J)})

    def function(self, scale):
        kind = self.pick(["constant", "harmonic", "ramp"])
        if kind == "constant":
            return {"type": kind, "value": scale * self.u(-1, 1), "rate": scale * self.u(-0.5, 0.5)}
        if kind == "harmonic":
            return {"type": kind, "amplitude": scale * self.u(-1, 1), "frequency": self.u(0.1, 1), "phase": self.u(-3, 3)}
        return {"type": kind, "to": scale * self.u(-1, 1), "duration": self.u(0.3, 2)}

    def add_free_body(self):
        name = self.body(self.rng.normal(size=3), velocity=(self.rng.normal(size=3), self.rng.normal(size=3)))
        self.at(name)["free"] = True
        if self.chance(0.3):
            self.joint("free", "ground", name, self.place(name))
        self.parts.append("free body")
        return name

    # -- loops, on a parent with a frame (e1, e2, n) at an anchor
    def frame(self, parent):
        anchor = self.place(parent) + self.u(0, 0.5) * unit(self.rng.normal(size=3))
        n = self.direction()
        e1 = self.perpendicular(n)
        return anchor, e1, np.cross(n, e1), n

    def quadrilateral(self):
        return (np.zeros(2), np.array([self.u(-0.3, 0.3), self.u(0.4, 0.9)]), np.array([self.u(0.8, 1.2), self.u(0.5, 1.2)]),
                np.array([self.u(0.7, 1.3), self.u(-0.1, 0.1)]))

    def some_rate(self):
        """Of the joint that moves a loop of one degree of freedom: a rate, a motion or nothing."""
        if self.chance(0.5):
            return {"rate": self.u(-1.5, 1.5)}
        return {"motion": {"type": "ramp", "to": self.u(-0.2, 0.2), "duration": 2.0}} if self.chance(0.15) else {}

    @staticmethod
    def closing(joints):
        """The joints that connect what those before them connect already."""
        group, closing = {}, []
        for k, (_, a, b, _, _) in enumerate(joints):
            a, b = group.setdefault(a, a), group.setdefault(b, b)
            if a == b:
                closing.append(k)
            group = {i: a if g == b else g for i, g in group.items()}
        return closing

    def loop(self, parent, links, joints, drive=0, moves=True):
        """joints: (kind, index of link before, index after, position, more); -1 is the parent. The first one may drive."""
        names = [self.body(c) for c in links]
        name = lambda i: parent if i < 0 else names[i]
        # The velocity of a free body is not changed by what it carries.
        driven = self.some_rate() if moves and "free" not in (self.at(parent) if parent != "ground" else ()) else {}
        # Which joint is cut matters to the start where only some joints of the loop have rates: these scenes say it.
        cuts = self.closing(joints) if driven else [self.pick([None, None] + [k for k in range(len(joints)) if k != drive])]
        for k, (kind, a, b, p, more) in enumerate(joints):
            more = dict(more)
            if k == drive:
                more |= driven
                if not driven and moves and self.chance(0.3):
                    more["damping"] = self.gyration(names[0]) * self.log(0.01, 1)
            elif k in cuts:
                more["cut"] = True
            joint = self.joint(kind, name(a), name(b), p, **more)
            if k == drive and moves:
                self.load_joint(joint, names[0])
        return names

    def planar_loop(self, parent):
        o, e1, e2, n = self.frame(parent)
        A, B, C, D = self.quadrilateral()
        kind = self.pick(["four-bar", "four-bar", "parallelogram", "slider-crank", "three rockers"])
        if kind in ("parallelogram", "three rockers"):
            C = D + B - A
        if kind == "slider-crank":
            C = np.array([self.u(1.2, 1.8), self.u(-0.2, 0.2)])
        P = [o + p[0] * e1 + p[1] * e2 + self.u(-0.3, 0.3) * n for p in (A, B, C, D)]
        off = lambda: 0.1 * self.rng.normal(size=3)
        mid = lambda a, b: (P[a] + P[b]) / 2 + off()
        axis = {"axis": n}
        flip = lambda: {"axis": n if self.chance(0.7) else -n}
        if kind == "slider-crank":
            links = [mid(0, 1), mid(1, 2), P[2] + off()]
            joints = [("revolute", -1, 0, P[0], axis), ("revolute", 0, 1, P[1], flip()), ("revolute", 1, 2, P[2], flip()),
                      ("prismatic", -1, 2, P[2] + off(), {"axis": e1})]
        else:
            links = [mid(0, 1), mid(1, 2), mid(2, 3)]
            joints = [("revolute", -1, 0, P[0], axis), ("revolute", 0, 1, P[1], flip()), ("revolute", 1, 2, P[2], flip()),
                      ("revolute", -1, 2, P[3], flip())]
            if kind == "three rockers":
                s = self.u(0.3, 0.7)
                Q = o + s * (D[0] * e1 + D[1] * e2)
                R = Q + B[0] * e1 + B[1] * e2
                links.append((Q + R) / 2 + off())
                joints += [("revolute", -1, 3, Q, flip()), ("revolute", 3, 1, R, flip())]
        self.parts.append(kind)
        return self.loop(parent, links, joints)

    def spatial_loop(self, parent):
        o, e1, e2, n = self.frame(parent)
        kind = self.pick(["RSSR", "RSUR", "RRSC", "Cardan shaft to a slider", "distance", "platform"]
                         if parent == "ground" else ["RSSR", "RSUR", "RRSC", "distance"])
        self.parts.append(kind)
        A, B, C, D = self.quadrilateral()
        P = [o + p[0] * e1 + p[1] * e2 + self.u(-0.3, 0.3) * n for p in (A, B, C, D)]
        off = lambda: 0.1 * self.rng.normal(size=3)
        mid = lambda a, b: (P[a] + P[b]) / 2 + off()
        tilted = lambda: unit(n + 0.4 * self.rng.normal(size=3))
        links = [mid(0, 1), mid(1, 2), mid(2, 3)]
        n2 = tilted()
        if kind == "RSSR":
            return self.loop(parent, links, [("revolute", -1, 0, P[0], {"axis": tilted()}), ("spherical", 0, 1, P[1], {}),
                                             ("spherical", 1, 2, P[2], {}), ("revolute", -1, 2, P[3], {"axis": n2})],
                             moves=False)
        if kind == "RSUR":
            u = unit(np.cross(P[2] - P[1], n2))
            v = unit(np.cross(u, P[2] - P[1]))
            return self.loop(parent, links, [("revolute", -1, 0, P[0], {"axis": tilted()}), ("spherical", 0, 1, P[1], {}),
                                             ("universal", 1, 2, P[2], {"axis": u, "axis2": v}),
                                             ("revolute", -1, 2, P[3], {"axis": n2})])
        if kind == "RRSC":
            return self.loop(parent, links, [("revolute", -1, 0, P[0], {"axis": n}), ("revolute", 0, 1, P[1], {"axis": tilted()}),
                                             ("spherical", 1, 2, P[2], {}), ("cylindrical", -1, 2, P[3], {"axis": n})])
        if kind == "Cardan shaft to a slider":
            a = self.direction()
            b = unit(a + 0.5 * self.perpendicular(a))
            x = unit(self.rng.normal(size=3))
            x = unit(x - (x @ a) * a)
            return self.loop(parent, [o - 0.5 * a + off(), o + 0.5 * b + off()],
                             [("revolute", -1, 0, o - 0.7 * a, {"axis": a}),
                              ("universal", 0, 1, o, {"axis": x, "axis2": unit(np.cross(b, x))}),
                              ("cylindrical", -1, 1, o + 0.8 * b, {"axis": b})])
        if kind == "distance":
            first, second = [self.add_joint_body(parent, ("revolute", "spherical", "universal")) for _ in range(2)]
            # What a link between them closes is at rest.
            for j in self.joints[-2:]:
                j.pop("rate", None), j.pop("motion", None)
            p, q = (self.place(b) + 0.3 * unit(self.rng.normal(size=3)) for b in (first, second))
            self.joint("distance", first, second, p, child_position=q, length=float(np.linalg.norm(q - p)))
            return [first, second]
        legs = self.pick([1, 2, 3, 4, 5])
        top = self.body(o + n, velocity=(np.zeros(3), np.zeros(3)))
        self.at(top)["free"] = True
        for k in range(legs):
            a = 2 * math.pi * (k + self.u(0, 0.5)) / legs
            foot = o + 0.7 * (math.cos(a) * e1 + math.sin(a) * e2) + self.u(-0.1, 0.1) * n
            a += self.u(0.3, 0.9) * self.pick([-1, 1])
            end = o + n + 0.4 * (math.cos(a) * e1 + math.sin(a) * e2)
            self.joint("distance", "ground", top, foot, child_position=end,
                       length=float(np.linalg.norm(end - foot)))
        return [top]

    def over_constrained(self, parent):
        kind = self.pick(["door", "shaft", "guides", "Sarrus", "spherical four-bar", "Cardan shaft", "planar"])
        if kind == "planar":
            return self.planar_loop(parent)
        self.parts.append(kind)
        o, e1, e2, n = self.frame(parent)
        off = lambda: 0.15 * self.rng.normal(size=3)
        if kind in ("door", "shaft"):
            hinges = self.pick([2, 2, 3])
            offset = off() if kind == "shaft" else e1 * self.u(0.3, 0.6) + off()
            kinds = ["revolute"] + [self.pick(["revolute"] * 3 + ["cylindrical", "spherical"]) for _ in range(hinges - 1)]
            places = self.rng.permutation(np.linspace(-0.5, 0.5, hinges))
            return self.loop(parent, [o + offset],
                             [(k, -1, 0, o + s * n, {} if k == "spherical" else {"axis": n if self.chance(0.7) else -n})
                              for k, s in zip(kinds, places)])
        if kind == "guides":
            kinds = ["prismatic"] + [self.pick(["prismatic", "cylindrical"]) for _ in range(self.pick([1, 1, 2]))]
            return self.loop(parent, [o + off()], [(k, -1, 0, o + self.u(-0.5, 0.5) * e1 + self.u(-0.5, 0.5) * e2,
                                                    {"axis": n if self.chance(0.7) else -n}) for k in kinds])
        if kind == "Sarrus":
            h, r, links, joints = self.u(0.5, 1), self.u(0.2, 0.4), [], []
            plate = 4
            for leg, (out, axis) in enumerate(((e2, e1), (e1, e2))):
                bulge = self.u(0.3, 0.6)
                Q = [o + r * out, o + (r + bulge) * out + h / 2 * n, o + r * out + h * n]
                links += [(Q[0] + Q[1]) / 2 + 0.3 * off(), (Q[1] + Q[2]) / 2 + 0.3 * off()]
                lower, upper = 2 * leg, 2 * leg + 1
                joints += [("revolute", -1, lower, Q[0], {"axis": axis}), ("revolute", lower, upper, Q[1], {"axis": axis}),
                           ("revolute", upper, plate, Q[2], {"axis": axis})]
            links.append(o + h * n + 0.3 * off())
            return self.loop(parent, links, joints)
        if kind == "spherical four-bar":
            a = [unit((p[0] - 0.5) * e1 + (p[1] - 0.4) * e2 + n) for p in self.quadrilateral()]
            links = [o + self.u(0.3, 1) * unit(a[i] + a[i + 1]) for i in range(3)]
            return self.loop(parent, links, [("revolute", -1, 0, o + self.u(0.3, 1) * a[0], {"axis": a[0]}),
                                             ("revolute", 0, 1, o + self.u(0.3, 1) * a[1], {"axis": a[1]}),
                                             ("revolute", 1, 2, o + self.u(0.3, 1) * a[2], {"axis": a[2]}),
                                             ("revolute", -1, 2, o + self.u(0.3, 1) * a[3], {"axis": a[3]})])
        b = unit(n + self.u(0.2, 0.8) * e1)
        x = unit(math.cos(1.1) * e1 + math.sin(1.1) * e2) if self.chance(0.7) else e2
        return self.loop(parent, [o - 0.5 * n + 0.3 * off(), o + 0.5 * b + 0.3 * off()],
                         [("revolute", -1, 0, o - 0.7 * n, {"axis": n}),
                          ("universal", 0, 1, o, {"axis": x, "axis2": unit(np.cross(b, x))}),
                          ("revolute", -1, 1, o + 0.8 * b, {"axis": b})])

    def cut_joint(self):
        """A free body that a cut joint holds, with a velocity that the joint allows."""
        kind = self.pick(["spherical", "spherical", "revolute", "universal", "cylindrical", "prismatic", "planar", "distance"])
        p, n = self.rng.normal(size=3) * 0.5, self.direction()
        r = self.u(0.2, 1) * unit(self.rng.normal(size=3))
        n2 = self.perpendicular(n)
        w = {"spherical": self.rng.normal(size=3), "revolute": self.u(-1.5, 1.5) * n, "distance": self.rng.normal(size=3),
             "universal": self.u(-1, 1) * n + self.u(-1, 1) * n2, "cylindrical": self.u(-1, 1) * n, "prismatic": np.zeros(3),
             "planar": self.u(-1, 1) * n}[kind]
        slide = {"cylindrical": self.u(-1, 1) * n, "prismatic": self.u(-1, 1) * n,
                 "planar": self.u(-1, 1) * n2}.get(kind, np.zeros(3))
        name = self.body(p + r, velocity=(np.cross(w, r) + slide, w))
        self.at(name)["free"] = True
        more = {"axis": n} if kind not in ("spherical", "distance") else {}
        if kind == "universal":
            more["axis2"] = n2
        if kind == "distance":
            # A rod to its centre of mass, which moves across it.
            v = np.cross(self.rng.normal(size=3), r)
            self.at(name)["velocity"] = v
            self.joint(kind, "ground", name, p, child_position=p + r, length=float(np.linalg.norm(r)))
        else:
            self.joint(kind, "ground", name, p, cut=True, **more)
        self.parts.append("cut " + kind)
        return name

    def gears(self, parent):
        o, e1, e2, n = self.frame(parent)
        kind = self.pick(["gear", "gear", "rack_and_pinion", "belt"])
        self.parts.append(kind)
        shafts, names = [], []
        for k in range(self.pick([2, 3]) if kind != "rack_and_pinion" else 2):
            rack = kind == "rack_and_pinion" and k == 1
            p = o + 0.8 * k * e1
            names.append(self.body(p + (0 if rack else self.u(0, 0.3)) * self.perpendicular(n) + self.u(-0.2, 0.2) * n))
            more = {"rate": self.u(0.3, 1.5)} if k == 0 else {}
            axis = e1 if rack else (n if kind != "gear" or self.chance(0.6) else unit(n + 0.7 * e1))
            shafts.append(self.joint("prismatic" if rack else "revolute", parent, names[-1], p, axis=axis, **more))
            # The ratio belongs to the coordinate of this child against this parent.
            shafts[-1]["child"] = names[-1]
            shafts[-1].pop("parent", None)
            if parent != "ground":
                shafts[-1]["parent"] = parent
        for k in range(1, len(shafts)):
            ratio = self.u(0.3, 3) * (-1 if kind == "gear" else self.pick([-1, 1]) if kind == "rack_and_pinion" else 1)
            self.couplers.append({"name": f"coupler{len(self.couplers) + 1}", "type": kind, "joint_a": shafts[k - 1]["name"],
                                  "joint_b": shafts[k]["name"], "ratio": ratio})
        self.load_joint(shafts[0], names[0])
        return names

    # -- forces
    def spring(self, stiff=False):
        b = self.pick(self.bodies)["name"]
        a = self.pick(["ground"] + [c["name"] for c in self.bodies if c["name"] != b])
        m = min(self.at(c)["mass"] for c in (a, b) if c != "ground")
        w = self.log(30, 1e4) if stiff else self.log(0.3, 8)
        name = f"force{len(self.forces) + 1}"
        if not self.extreme and self.chance(0.2) and not any("free" in x for x in self.bodies):
            # For small rotations only: stiff for either body, between bodies that do not spin.
            m, w = max(self.at(c)["mass"] for c in (a, b) if c != "ground"), max(w, self.log(4, 10))
            J = max(max(self.moments(c)) for c in (a, b) if c != "ground")
            damping = self.pick([0.0, self.log(0.01, 1)])
            K = [m * w * w * self.u(0.3, 1) for _ in range(3)] + [J * w * w * self.u(0.3, 1) for _ in range(3)]
            self.forces.append({"name": name, "type": "bushing", "body_a": a, "body_b": b, "position": self.place(b) + 0.1,
                                "stiffness": np.array(K), "damping": np.array([k / w * damping for k in K])})
            self.parts.append("bushing")
            return
        q = self.place(b) + self.u(0, 0.3) * unit(self.rng.normal(size=3))
        p = self.place(a) + self.u(0, 0.3) * unit(self.rng.normal(size=3))
        if a == "ground" or np.linalg.norm(p - q) < 0.5:
            p = q + self.u(0.5, 1.5) * unit(self.rng.normal(size=3))
        L = float(np.linalg.norm(q - p)) * (1 if stiff else self.u(0.6, 1.2))
        self.forces.append({"name": name, "type": "spring_damper", "body_a": a, "body_b": b, "point_a": p, "point_b": q,
                            "stiffness": m * w * w, "damping": self.pick([0.0, m * w * self.log(0.01, 1)]), "length": L})
        self.parts.append("spring")

    def load(self):
        body = self.pick(self.bodies)
        name, kind = f"force{len(self.forces) + 1}", self.pick(["force", "torque"])
        new = {"name": name, "type": kind, "body": body["name"], "direction": self.direction()}
        if kind == "force":
            new["point"] = body["position"] + self.pick([0, 1]) * 0.1 * self.rng.normal(size=3)
        if self.chance(0.5):
            new["follows"] = True
        J = self.gyration(body["name"])
        # A force whose torque turns the body no faster than the torques do.
        new["size"] = self.function(J if kind == "torque" else min(body["mass"], 5 * J))
        self.forces.append(new)

    # -- elements
    def name_force(self):
        return f"force{len(self.forces) + 1}"

    def gains(self, inertia, of_rate):
        if of_rate:
            return {"proportional": inertia * self.log(1, 10), "integral": self.pick([0.0, inertia * self.log(1, 30)])}
        w = self.log(2, 8)
        new = {"proportional": inertia * w * w, "integral": self.pick([0.0, inertia * w**3 * self.u(0.1, 0.4)]),
               "derivative": inertia * w * self.u(0.3, 2)}
        return new | ({"filter": self.u(0.02, 0.2) / w} if self.chance(0.5) else {})

    def motor(self):
        """On a revolute joint; False where there is none without a drive."""
        driven = {f["joint"] for f in self.forces if f["type"] == "motor"}
        free = [j for j in self.joints if j["type"] == "revolute" and not j.get("motion") and not j.get("cut")
                and j["name"] not in driven]
        if not free:
            return False
        joint = self.pick(free)
        J, gear = self.gyration(joint["child"]), self.u(1, 10)
        control = self.pick(["speed", "position", "throttle"])
        new = {"name": self.name_force(), "type": "motor", "joint": joint["name"], "control": control, "gear_ratio": gear}
        if control == "throttle":
            # A straight line, which the cubic through it is as well.
            rate = self.u(1, 5)
            new["torque_speed"] = {"arguments": [0.0, gear * rate], "values": [J * self.log(0.3, 10) / gear, 0.0]}
            new["target"] = {"type": "harmonic", "amplitude": self.u(-1, 1), "frequency": self.u(0.1, 1), "phase": self.u(-3, 3)}
        else:
            new["gains"] = self.gains(J, control == "speed")
            new["target"] = self.function(1) if control == "speed" else self.motion()
            if self.chance(0.3):
                new["max_torque"] = J * self.log(1, 30) / gear
        if self.chance(0.3):
            new["brake"] = {"torque": J * self.log(0.1, 1), "slip": self.u(0.1, 1)}
        self.forces.append(new)
        self.parts.append("motor")
        return True

    def line(self):
        """Bodies and points of a line element, and the smaller mass."""
        b = self.pick(self.bodies)["name"]
        a = self.pick(["ground", "ground"] + [c["name"] for c in self.bodies if c["name"] != b])
        m = min(self.at(c)["mass"] for c in (a, b) if c != "ground")
        q = self.place(b) + self.u(0, 0.3) * unit(self.rng.normal(size=3))
        p = self.place(a) + self.u(0, 0.3) * unit(self.rng.normal(size=3))
        if a == "ground" or np.linalg.norm(p - q) < 0.8:
            p = q + self.u(1, 2) * unit(self.rng.normal(size=3))
        return {"body_a": a, "body_b": b, "point_a": p, "point_b": q}, m

    def cylinder(self, hydraulic):
        line, m = self.line()
        new = {"name": self.name_force(), "type": "cylinder", **line}
        w = self.log(1, 8)
        if self.chance(0.7):
            new["damping"] = m * w * self.log(0.03, 1)
        if hydraulic:
            long = float(np.linalg.norm(line["point_b"] - line["point_a"]))
            area, supply = self.u(0.01, 0.05), m * self.log(30, 300)
            new |= {"control": "valve", "limits": {"lower": -0.9 * long, "upper": 9.0, "stiffness": 1.0}}
            new["target"] = self.pick([{"type": "constant", "value": 0.0, "rate": 0.0},
                                       {"type": "ramp", "to": self.u(-1, 1), "duration": self.u(0.3, 2)},
                                       {"type": "harmonic", "amplitude": self.u(-1, 1), "frequency": self.u(0.1, 1),
                                        "phase": self.u(-3, 3)}])
            volume = 0.01 + area * long  # about: of chamber a
            new["hydraulics"] = {
                "bore_area": area, "rod_area": area * self.u(0, 0.7), "dead_volume": 0.01,
                "bulk_modulus": m * w * w * volume / area**2, "supply_pressure": supply, "tank_pressure": self.pick([0.0, 0.05 * supply]),
                "valve_flow": area * self.log(0.1, 1), "valve_drop": supply * self.u(0.2, 0.5),
                "laminar_drop": supply * self.log(0.03, 0.3), "leakage": self.pick([0.0, area * self.log(0.01, 0.3) / supply]),
                "pressure_a": supply * self.u(0, 1), "pressure_b": supply * self.u(0, 1), "cavitation_pressure": -1e18}
            if self.chance(0.3):
                new["hydraulics"]["pump_flow"] = area * self.log(0.03, 0.3)
        elif self.chance(0.3):
            new |= {"control": "force", "target": self.function(m * self.log(1, 10))}
        else:
            new |= {"control": "stroke", "gains": self.gains(m, False), "target": self.motion()}
            if self.chance(0.3):
                new["max_force"] = m * self.log(3, 30)
        self.forces.append(new)
        self.parts.append("hydraulic cylinder" if hydraulic else "cylinder")

    def rope(self):
        points, m = [], math.inf
        for _ in range(self.pick([2, 3, 3, 4])):
            for _ in range(20):
                body = self.pick(["ground"] + [c["name"] for c in self.bodies])
                p = (2 if body == "ground" else 0.3) * unit(self.rng.normal(size=3)) + self.place(body)
                if not points or (body != points[-1]["body"] and np.linalg.norm(p - points[-1]["point"]) > 0.5):
                    points.append({"body": body, "point": p})
                    break
        if len(points) < 2 or all(p["body"] == "ground" for p in points):
            return
        m = min(self.at(p["body"])["mass"] for p in points if p["body"] != "ground")
        length = sum(float(np.linalg.norm(p["point"] - q["point"])) for p, q in zip(points, points[1:])) * self.u(0.9, 1.1)
        self.forces.append({"name": self.name_force(), "type": "rope", "points": points, "length": length,
                            "axial_stiffness": m * self.log(2, 10) ** 2 * length, "damping": self.log(0.01, 0.3)})
        self.parts.append("rope")

    def linear_coupler(self, parent):
        o, e1, e2, n = self.frame(parent)
        terms, names = [], []
        for k in range(self.pick([2, 3, 3, 4])):
            slide = self.chance(0.3)
            p = o + 0.8 * k * e1
            names.append(self.body(p + self.u(0, 0.3) * self.perpendicular(n) + self.u(-0.2, 0.2) * n))
            joint = self.joint("prismatic" if slide else "revolute", parent, names[-1], p, axis=self.direction(),
                               **({"rate": self.u(0.3, 1.5)} if k == 0 else {}))
            joint["child"] = names[-1]
            joint.pop("parent", None)
            if parent != "ground":
                joint["parent"] = parent
            terms.append({"joint": joint["name"], "factor": self.log(0.3, 3) * self.pick([-1, 1])})
        self.couplers.append({"name": f"coupler{len(self.couplers) + 1}", "type": "linear", "terms": terms})
        self.parts.append(f"sum of {len(terms)}")
        self.load_joint(self.joints[-1], names[-1])


def grow_with_elements(b, kind):
    if kind == "linear couplers":
        parent = "ground" if b.chance(0.6) else b.add_joint_body("ground", ("revolute", "spherical"))
        b.linear_coupler(parent)
    elif b.chance(0.5):
        for _ in range(b.pick([1, 2, 3])):
            b.add_joint_body(b.pick(["ground"] + [x["name"] for x in b.bodies]))
    else:
        b.pick([b.planar_loop, b.planar_loop, b.spatial_loop])("ground")
    for _ in range(b.pick([1, 1, 2])):
        if kind == "motors" and not b.motor():
            b.add_joint_body("ground", ("revolute",))
            b.motor()
        elif kind in ("cylinders", "hydraulics"):
            b.cylinder(kind == "hydraulics")
        elif kind == "ropes":
            b.rope()
    if b.chance(0.3):
        b.spring()


def grow(b, kind):
    if kind == "tree":
        for _ in range(b.pick([1, 2, 3, 4, 6, 8])):
            b.add_joint_body(b.pick(["ground"] + [x["name"] for x in b.bodies]))
    elif kind == "free bodies":
        for _ in range(b.pick([1, 2])):
            root = b.add_free_body()
            for _ in range(b.pick([0, 1, 2])):
                root = b.add_joint_body(root)
    elif kind == "planar loop":
        b.planar_loop("ground")
        if b.chance(0.4):
            b.add_joint_body(b.pick(b.bodies)["name"])
        elif b.chance(0.3):
            b.planar_loop(b.bodies[1]["name"])
    elif kind == "spatial loop":
        b.spatial_loop("ground")
        if b.chance(0.4):
            b.add_joint_body(b.pick(b.bodies)["name"])
    elif kind == "over-constrained":
        b.over_constrained("ground")
        if b.chance(0.5):
            b.add_joint_body(b.pick(b.bodies)["name"])
    elif kind == "cut joints":
        for _ in range(b.pick([1, 2])):
            name = b.cut_joint()
            if b.chance(0.3):
                b.add_joint_body(name, ("revolute", "prismatic", "spherical"))
    elif kind == "gears":
        parent = "ground" if b.chance(0.6) else b.add_joint_body("ground", ("revolute", "spherical"))
        b.gears(parent)
    elif kind == "stiff":
        grow(b, b.pick(["tree", "free bodies", "planar loop", "over-constrained"]))
        for _ in range(b.pick([1, 2])):
            b.spring(stiff=True)
        return
    else:
        carrier = b.add_free_body() if b.chance(0.3) else b.add_joint_body("ground")
        b.pick([b.planar_loop, b.over_constrained, b.spatial_loop])(carrier)
        for _ in range(b.pick([0, 1, 2])):
            b.add_joint_body(b.pick(b.bodies)["name"])
    for _ in range(b.pick([0, 0, 1, 2])):
        b.spring()
    for _ in range(b.pick([0, 0, 1])):
        b.load()


def with_units(b, L, M, T, gravity):
    """The scene in m, kg and s."""
    bodies = [{**x, "mass": x["mass"] * M, "inertia": x["inertia"] * (M * L * L), "position": x["position"] * L}
              for x in b.bodies]
    for x in bodies:
        x.pop("free", None)
        if "velocity" in x:
            x["velocity"], x["angular_velocity"] = x["velocity"] * (L / T), x["angular_velocity"] / T
    slides = {j["name"]: j["type"] == "prismatic" for j in b.joints}

    def function(f, unit):
        g = dict(f)
        for key in ("value", "to", "from", "amplitude", "offset"):
            if key in g:
                g[key] *= unit
        if f["type"] == "constant":
            g["rate"] *= unit / T
        for key in ("start", "duration"):
            if key in g:
                g[key] *= T
        if "frequency" in g:
            g["frequency"] /= T
        return g

    def gains(g, unit, T):
        per = {"proportional": unit, "integral": unit / T, "derivative": unit * T, "filter": T}
        return {key: value * per[key] for key, value in g.items()}

    force, torque = M * L / T**2, M * L * L / T**2
    joints = []
    for j in b.joints:
        j = dict(j)
        slide = slides[j["name"]]
        for key in ("position", "child_position", "length", "pitch"):
            if key in j:
                j[key] = j[key] * L
        if "rate" in j:
            j["rate"] *= (L if slide else 1) / T
        if "motion" in j:
            j["motion"] = function(j["motion"], L if slide else 1)
        if "damping" in j:
            j["damping"] *= M / T * (1 if slide else L * L)
        if "friction" in j:
            f = j["friction"]
            j["friction"] = {"force": f["force"] * (force if slide else torque), "slip": f["slip"] * (L if slide else 1) / T}
        joints.append(j)
    forces = []
    for f in b.forces:
        f = dict(f)
        kind = f["type"]
        for key in ("point_a", "point_b", "position", "point"):
            if key in f:
                f[key] = f[key] * L
        if kind == "spring_damper":
            f["stiffness"] = min(f["stiffness"] * M / T**2, 1e9)
            f["damping"] *= M / T
            f["length"] *= L
        elif kind == "rotational_spring_damper":
            f["stiffness"] *= torque
            f["damping"] *= torque * T
        elif kind == "bushing":
            units = np.array([1, 1, 1, L * L, L * L, L * L]) * M / T**2
            f["stiffness"], f["damping"] = f["stiffness"] * units, f["damping"] * units * T
        elif kind == "motor":
            of_rate = f["control"] == "speed"
            f["target"] = function(f["target"], 1 / T if of_rate else 1)
            if "gains" in f:
                f["gains"] = gains(f["gains"], torque * T if of_rate else torque, T)
            if "max_torque" in f:
                f["max_torque"] *= torque
            if "torque_speed" in f:
                f["torque_speed"] = {"arguments": [x / T for x in f["torque_speed"]["arguments"]],
                                     "values": [x * torque for x in f["torque_speed"]["values"]]}
            if "brake" in f:
                f["brake"] = {"torque": f["brake"]["torque"] * torque, "slip": f["brake"]["slip"] / T}
        elif kind == "cylinder":
            f["target"] = function(f["target"], {"stroke": L, "force": force, "valve": 1}[f["control"]])
            for key, u in (("damping", M / T), ("max_force", force)):
                if key in f:
                    f[key] *= u
            if "gains" in f:
                f["gains"] = gains(f["gains"], M / T**2, T)
            if "limits" in f:
                f["limits"] = {"lower": f["limits"]["lower"] * L, "upper": f["limits"]["upper"] * L,
                               "stiffness": f["limits"]["stiffness"] * M / T**2}
            if "hydraulics" in f:
                pressure, flow = force / L**2, L**3 / T
                units = {"bore_area": L**2, "rod_area": L**2, "dead_volume": L**3, "bulk_modulus": pressure,
                         "supply_pressure": pressure, "tank_pressure": pressure, "pump_flow": flow, "valve_flow": flow,
                         "valve_drop": pressure, "laminar_drop": pressure, "leakage": flow / pressure,
                         "pressure_a": pressure, "pressure_b": pressure, "cavitation_pressure": 1}
                f["hydraulics"] = {key: value * units[key] for key, value in f["hydraulics"].items()}
        elif kind == "rope":
            f["points"] = [{**p, "point": p["point"] * L} for p in f["points"]]
            f["length"] *= L
            f["axial_stiffness"] *= force
            f["damping"] *= T / L
        elif kind == "actuator":
            f["size"] = function(f["size"], force if slides[f["joint"]] else torque)
        else:
            f["size"] = function(f["size"], force if kind == "force" else torque)
        forces.append(f)
    couplers = []
    for c in b.couplers:
        if c["type"] == "linear":
            couplers.append({**c, "terms": [{**t, "factor": t["factor"] / (L if slides[t["joint"]] else 1)} for t in c["terms"]]})
        else:
            couplers.append({**c, "ratio": c["ratio"] * (L if c["type"] == "rack_and_pinion" else 1)})
    mbd = {"bodies": bodies, "joints": joints, "couplers": couplers, "forces": forces}
    return {"tandem": "1.1", "name": "machine", "gravity": np.asarray(gravity, float),
            "mbd": {k: v for k, v in mbd.items() if v}}


def place(b, scene, L):
    """Somewhere in space; returns the scene and how it stands."""
    joints = scene["mbd"].get("joints", [])
    stand = b.pick(["as built", "anywhere", "anywhere", "joint at the origin", "joint at the origin", "axis along an axis",
                    "far away"])
    if stand == "as built":
        return scene, stand
    q, t = unit(b.rng.normal(size=4)), L * b.rng.normal(size=3)
    if stand == "far away":
        # 1 km, and no more than 10,000 lengths: beyond, the digits of the file do not hold the machine.
        t = min(1000.0, 1e4 * L) * unit(b.rng.normal(size=3))
    exact = b.chance(0.5)
    joint = b.pick(joints) if joints else None
    axes = [j for j in joints if "axis" in j]
    if stand == "axis along an axis" and axes:
        n, e = unit(b.pick(axes)["axis"]), np.eye(3)[int(b.rng.integers(3))]
        turn = np.cross(n, e)
        q = unit(np.concatenate([[1 + n @ e], turn])) if n @ e > -0.999 else np.array([0.0, *unit(np.cross(e, [0.6, 0.5, 0.62]))])
        if b.chance(0.5):
            t = np.zeros(3)
    if stand == "joint at the origin" and joint:
        t = -pose.matrix(q) @ joint["position"]
    scene = pose.moved(scene, q, t)
    if exact:  # else the noise of the rotation stays
        for j in scene["mbd"].get("joints", []):
            for key, scale in (("position", L), ("axis", 1.0), ("axis2", 1.0)):
                if key in j:
                    j[key] = np.where(np.abs(j[key]) < 1e-14 * max(scale, np.abs(j[key]).max()), 0.0, j[key])
    return scene, stand


def has_loops(b):
    tree = [j for j in b.joints if j["type"] not in ("free", "distance") and not j.get("cut")]
    return bool(b.couplers) or any(j["type"] == "distance" or j.get("cut") for j in b.joints) or bool(
        b.closing([(None, j.get("parent", "ground"), j["child"], None, None) for j in tree]))


def make(seed, number, elements=False):
    """Scene as it is written, the machine that it stands for, and what is known about it.

    The machine is the scene itself, but where loops are closed by rounded data: that is the one before rounding.
    """
    rng = np.random.default_rng([seed, number])
    b = Builder(rng)
    classes = ELEMENT_CLASSES if elements else CLASSES
    kind = classes[number % len(classes)]
    (grow_with_elements if elements else grow)(b, kind)
    L = b.log(1e-3, 1e3) if b.chance(0.4) else b.log(0.05, 20)
    M = b.log(1, 10) if b.extreme else b.log(1e-2, 1e3)
    weightless = b.chance(0.15)
    T = math.sqrt(L / 9.81) * (b.log(0.1, 10) if weightless else 1)
    if kind == "hydraulics":
        # The format has least pressures, of 1 Pa.
        lowest = min(f["hydraulics"][key] for f in b.forces if "hydraulics" in f
                     for key in ("bulk_modulus", "supply_pressure", "valve_drop"))
        M = max(M, 10 * L * T**2 / lowest)
    gravity = np.zeros(3) if weightless else 9.81 * b.pick([np.array([0, 0, -1.0]), unit(rng.normal(size=3))])
    scene = with_units(b, L, M, T, gravity)
    duration = T * b.u(0.5, 2.5)
    window = max(1, round(duration / WINDOWS * 1e9))
    scene["end_time"] = window * WINDOWS / 1e9
    scene["coupling"] = {"window": window / 1e9}
    fixed = kind != "stiff" and not b.extreme and b.chance(0.25)
    scene["mbd"]["integrator"] = {"step": window / 1e9 / 512} if fixed else {
        # The tolerance is of one step, and errors add up: over thousands of steps, of 1e5 where there are vibrations.
        "error_tolerance": 1e-10 if kind == "stiff" else 1e-9}
    scene, stand = place(b, scene, L)
    loops = has_loops(b)
    digits = 17 if b.chance(0.6) else b.pick([9, 7, 6])
    if loops and kind == "stiff":
        digits = 17  # rounded lengths alone load the springs
    written = pose.rounded(scene, digits, L) if digits < 17 else scene
    facts = {"seed": seed, "number": number, "class": kind, "parts": b.parts, "stand": stand, "digits": digits, "loops": loops, "length": L,
             "mass_ratio": max(x["mass"] for x in b.bodies) / min(x["mass"] for x in b.bodies),
             "step": "fixed" if fixed else "controlled"}
    return plain(written), plain(scene if loops else written), facts


def plain(x):
    """Lists and numbers as JSON has them."""
    if isinstance(x, dict):
        return {k: plain(v) for k, v in x.items()}
    if isinstance(x, (list, tuple, np.ndarray)):
        return [plain(v) for v in x]
    if isinstance(x, (np.floating, float)):
        return float(x)
    if isinstance(x, np.integer):
        return int(x)
    return x
