#!/usr/bin/env python3
"""Writes the multibody reference scenes to its folder: make.py [--chain LINKS] [--windows WINDOWS].

Expected values come from closed forms, from the literature, or from reduced equations of motion that are integrated here
with Runge-Kutta steps so small that the last digit written does not change.
"""
import argparse
import cmath
import json
import math
import pathlib

G = 9.81  # [m/s2]


# ---------------------------------------------------------------- reduced equations

def integrate(rate, y, t, h):
    """Classical Runge-Kutta; rate(y) is a list."""
    steps = round(t / h)
    for _ in range(steps):
        a = rate(y)
        b = rate([u + h / 2 * d for u, d in zip(y, a)])
        c = rate([u + h / 2 * d for u, d in zip(y, b)])
        d = rate([u + h * k for u, k in zip(y, c)])
        y = [u + h / 6 * (p + 2 * q + 2 * r + s) for u, p, q, r, s in zip(y, a, b, c, d)]
    return y


def derivative(f, x):
    """Complex step: exact to round-off."""
    return f(complex(x, 1e-30)).imag / 1e-30


# ---------------------------------------------------------------- parts of a scene

def body(name, mass, inertia, position, **more):
    return {"name": name, "mass": mass, "inertia": inertia, "position": position, **more}


def joint(name, kind, child, position, axis=None, parent=None, **more):
    j = {"name": name, "type": kind}
    if parent:
        j["parent"] = parent
    j.update(child=child, position=position)
    if axis:
        j["axis"] = axis
    return {**j, **more}


def rod(name, mass, length, a, b):
    """Uniform thin rod from a to b in the x-y plane; its inertia along its own axis does not count there."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    assert abs(math.hypot(dx, dy) - length) < 1e-12
    I = mass * length**2 / 12
    return body(name, mass, [I, I, I], [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, 0])


def check(name, of, expected, tolerance, why, **more):
    return {"name": name, "of": of, "expected": expected, "tolerance": tolerance, "absolute": True, **more, "why": why}


def keeps_energy(tolerance):
    return check("energy [J]", "summary.mbd_energy_drift_J", 0, tolerance, "nothing dissipates")


def scene(name, description, end_time, window, integrator, bodies, joints, checks, gravity=(0, -G, 0), forces=(), couplers=()):
    mbd = {"integrator": integrator, "bodies": bodies, "joints": joints}
    if couplers:
        mbd["couplers"] = couplers
    if forces:
        mbd["forces"] = forces
    data = {"tandem": "1.0", "name": name, "description": description, "gravity": list(gravity), "end_time": end_time,
            "coupling": {"window": window}, "mbd": mbd, "checks": checks}
    pathlib.Path(__file__).with_name(name + ".json").write_text(text(data) + "\n")


def text(value, indent=0, flat=False):
    """JSON with one body, joint, force or check per line."""
    plain = json.dumps(value)
    if flat or not isinstance(value, (dict, list)) or len(plain) + indent <= 100:
        return plain
    pad = " " * (indent + 2)
    if isinstance(value, list):
        inside = ",\n".join(pad + text(v, indent + 2, True) for v in value)
        return "[\n" + inside + "\n" + " " * indent + "]"
    inside = ",\n".join(pad + json.dumps(k) + ": " + text(v, indent + 2) for k, v in value.items())
    return "{\n" + inside + "\n" + " " * indent + "}"


# ---------------------------------------------------------------- reference problems

POINT = [1e-12, 1e-12, 1e-12]  # inertia of a point mass: small relative to all others [kg m2]


def simple_pendulum():
    why = "sin(phi/2) = k cd(sqrt(g/L) t, k), k = sin(pi/4); x = -sin phi, y = -cos phi"
    def write(name, what, inertia, within, **more):
        checks = [check("x after 10 s [m]", "bob.position.x", -0.275087462576117, 3e-4 * within, why),
                  check("y after 10 s [m]", "bob.position.y", -0.961419205099125, 1e-4 * within, why),
                  keeps_energy(5e-5 * within)]
        scene(name, what, 10, 0.1, {"rho_inf": 0.9, "step": 0.0025}, [body("bob", 1, inertia, [-1, 0, 0])],
              [joint("hinge", "revolute", "bob", [0, 0, 0], [0, 0, 1], **more)], checks)

    write("simple_pendulum", "A01: a point mass on a massless bar, let go from the horizontal.", POINT, 1)
    # The inertia of a free body must not be lost in round-off relative to m L^2.
    write("simple_pendulum_cut", "A01 with the hinge as a cut joint: the mass is a free body under constraints.", [1e-9] * 3, 8,
          cut=True)


def double_pendulum():
    """Two point masses of 1 kg on bars of 1 m, from the horizontal."""
    def rate(y):
        a, b, u, v = y  # angles from the horizontal -x, rates
        c, s = math.cos(b - a), math.sin(b - a)
        ra, rb = 2 * G * math.cos(a) + s * v * v, G * math.cos(b) - s * u * u
        det = 2 - c * c
        return [u, v, (ra - c * rb) / det, (2 * rb - c * ra) / det]

    a, b, _, _ = integrate(rate, [0, 0, 0, 0], 1, 1e-4)
    why = "reduced equations, Runge-Kutta (make.py)"
    scene("double_pendulum", "Two point masses on massless bars, let go from the horizontal.", 1, 0.01,
          {"rho_inf": 0.9, "step": 1e-4}, [body("first", 1, POINT, [-1, 0, 0]), body("second", 1, POINT, [-2, 0, 0])],
          [joint("top", "revolute", "first", [0, 0, 0], [0, 0, 1]),
           joint("middle", "revolute", "second", [-1, 0, 0], [0, 0, 1], "first")],
          [check("x of the lower mass [m]", "second.position.x", -math.cos(a) - math.cos(b), 1e-5, why),
           check("y of the lower mass [m]", "second.position.y", -math.sin(a) - math.sin(b), 1e-5, why),
           keeps_energy(1e-5)])


def four_bars(windows):
    bodies, joints = [], []
    for i in range(windows + 1):
        bodies.append(rod(f"v{i}", 1, 1, (i, 0), (i, 1)))
        joints.append(joint(f"a{i}", "revolute", f"v{i}", [i, 0, 0], [0, 0, 1], rate=-1))
    for i in range(windows):
        bodies.append(rod(f"h{i}", 1, 1, (i, 1), (i + 1, 1)))
        joints.append(joint(f"b{i}", "revolute", f"h{i}", [i, 1, 0], [0, 0, 1], f"v{i}"))
        joints.append(joint(f"c{i}", "revolute", f"v{i + 1}", [i + 1, 1, 0], [0, 0, 1], f"h{i}"))
    c = ((windows + 1) / 2 + windows) / ((windows + 1) / 3 + windows)
    theta, _ = integrate(lambda y: [y[1], -c * G * math.cos(y[0])], [math.pi / 2, -1], 10, 1e-4)
    why = "theta'' = -g [(N+1)/2 + N] / [(N+1)/3 + N] cos theta, exact for N windows"
    scene("four_bars", f"A02: {windows} windows of four bars, which pass singular positions twice per turn.", 10, 0.1,
          {"rho_inf": 0.9, "step": 1e-3}, bodies, joints,
          [check("x of B0 / 2 [m]", "v0.position.x", math.cos(theta) / 2, 1e-3, why),
           check("y of B0 / 2 [m]", "v0.position.y", math.sin(theta) / 2, 1e-3, why), keeps_energy(1.1e-3)])


def turn(axis, angle):
    """Rotation matrix about x, y or z; the angle may be complex."""
    c, s = cmath.cos(angle), cmath.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = [[0] * 3 for _ in range(3)]
    R[axis][axis], R[i][i], R[j][j], R[i][j], R[j][i] = 1, c, c, -s, s
    return R


def times(A, B):
    return [[sum(A[i][k] * B[k][j] for k in range(3)) for j in range(len(B[0]))] for i in range(3)]


BRICARD_POINTS = [(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)]
BRICARD_AXES = [1, 2, 0, 1, 2, 0]


def bricard_inertia(i):
    inertia = [1.01 / 12] * 3
    inertia[[k for k in range(3) if BRICARD_POINTS[i][k] != BRICARD_POINTS[i + 1][k]][0]] = 1 / 600
    return inertia


def bricard_angle(t):
    """The first hinge angle p. All angles are (p, r, p, r, p, r), sin r = -sin p / (1 + sin p): one degree of freedom with
    kinetic energy J(p) p'^2 / 2, whose J comes from complex steps."""
    e = 1e-30

    def frames(p):
        r = -cmath.asin(cmath.sin(p) / (1 + cmath.sin(p)))
        R, start, result = [[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0], []
        for i in range(5):
            R = times(R, turn(BRICARD_AXES[i], (p, r)[i % 2]))
            along = times(R, [[b - a] for a, b in zip(BRICARD_POINTS[i], BRICARD_POINTS[i + 1])])
            result.append((R, [s + d[0] / 2 for s, d in zip(start, along)]))
            start = [s + d[0] for s, d in zip(start, along)]
        return result

    def speed_squared(p):
        J = V = 0
        for i, (R, c) in enumerate(frames(complex(p, e))):
            dR = [[x.imag / e for x in map(complex, row)] for row in R]
            R = [[complex(x).real for x in row] for row in R]
            W = times([list(column) for column in zip(*R)], dR)  # body axes
            w = [W[2][1], W[0][2], W[1][0]]
            J += sum((x.imag / e) ** 2 for x in map(complex, c)) + sum(I * u * u for I, u in zip(bricard_inertia(i), w))
            V += G * complex(c[1]).real
        return 2 * (bricard_height - V) / J

    bricard_height = sum(G * complex(c[1]).real for _, c in frames(0))

    def half_slope(p, d=1e-3):
        f = speed_squared
        return (f(p - 2 * d) - 8 * f(p - d) + 8 * f(p + d) - f(p + 2 * d)) / (24 * d)

    return integrate(lambda y: [y[1], half_slope(y[0])], [0, 0], t, 2e-3)


def bricard():
    bodies, joints = [], []
    for i in range(5):
        a, b = BRICARD_POINTS[i], BRICARD_POINTS[i + 1]
        bodies.append(body(f"rod{i + 1}", 1, bricard_inertia(i), [(u + v) / 2 for u, v in zip(a, b)]))
    for i in range(6):
        axis = [float(k == BRICARD_AXES[i]) for k in range(3)]
        joints.append(joint(f"p{i}", "revolute", f"rod{min(i + 1, 5)}", list(BRICARD_POINTS[i]), axis,
                            f"rod{i}" if 0 < i < 5 else None))
    p, rate = bricard_angle(1)
    why = "one degree of freedom: hinge angles (p, r, p, r, p, r), sin r = -sin p / (1 + sin p) (make.py)"
    scene("bricard", "A04: Bricard's six-bar. Six hinges, one more than the mobility formula allows: one equation is redundant.",
          1, 0.01, {"rho_inf": 0.9, "step": 1e-3}, bodies, joints,
          [check("first hinge angle [rad]", "p0.q", p, 1e-5, why), check("its rate [rad/s]", "p0.rate", rate, 1e-4, why),
           keeps_energy(1e-4)])


def squeezer():
    """Andrews' squeezer of the test set for IVP solvers, whose names and numbers these are."""
    m = [.04325, .00365, .02373, .00706, .07050, .00706, .05498]
    I = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
    xa, ya, xb, yb, xc, yc = -.06934, -.00227, -.03635, .03273, .014, .072
    d, da, e, ea, rr, ra, ss, sa, sb, sc, sd = .028, .0115, .02, .01421, .007, .00092, .035, .01874, .01043, .018, .02
    ta, tb, u, ua, ub, zf, zt, fa = .02308, .00916, .04, .01228, .00449, .02, .04, .01421
    be, th, ga, ph, de, om, ep = (-0.0617138900142764496, 0, 0.455279819163070380, 0.222668390165885885,
                                  0.487364979543842550, -0.222668390165885885, 1.23054744454982119)
    sin, cos = math.sin, math.cos
    centres = [
        (ra * cos(be), ra * sin(be)),
        (rr * cos(be) - da * cos(be + th), rr * sin(be) - da * sin(be + th)),
        (xb + sa * sin(ga) + sb * cos(ga), yb - sa * cos(ga) + sb * sin(ga)),
        (xa + zt * cos(de) + (e - ea) * sin(ph + de), ya + zt * sin(de) - (e - ea) * cos(ph + de)),
        (xa + ta * cos(de) - tb * sin(de), ya + ta * sin(de) + tb * cos(de)),
        (xa + u * sin(ep) + (zf - fa) * cos(om + ep), ya - u * cos(ep) + (zf - fa) * sin(om + ep)),
        (xa + ua * sin(ep) - ub * cos(ep), ya - ua * cos(ep) - ub * sin(ep))]
    F = [rr * cos(be), rr * sin(be), 0]
    E = [F[0] - d * cos(be + th), F[1] - d * sin(be + th), 0]
    E_of_3 = [xb + ss * sin(ga), yb - ss * cos(ga), 0]
    assert math.hypot(E[0] - E_of_3[0], E[1] - E_of_3[1]) < 1e-15
    g = [xa + zt * cos(de), ya + zt * sin(de), 0]
    H = [xa + u * sin(ep), ya - u * cos(ep), 0]
    D = [xb + sc * sin(ga) + sd * cos(ga), yb - sc * cos(ga) + sd * sin(ga), 0]
    bodies = [body(f"k{i + 1}", m[i], [I[i]] * 3, [*centres[i], 0]) for i in range(7)]
    z = [0, 0, 1]
    joints = [joint("O", "revolute", "k1", [0, 0, 0], z), joint("F", "revolute", "k2", F, z, "k1"),
              joint("B", "revolute", "k3", [xb, yb, 0], z), joint("A5", "revolute", "k5", [xa, ya, 0], z),
              joint("G", "revolute", "k4", g, z, "k5"), joint("A7", "revolute", "k7", [xa, ya, 0], z),
              joint("H", "revolute", "k6", H, z, "k7"), joint("E3", "revolute", "k3", E, z, "k2", cut=True),
              joint("E4", "revolute", "k4", E, z, "k2", cut=True), joint("E6", "revolute", "k6", E, z, "k2", cut=True)]
    end = [15.81077119515371, -15.75637105841184, 0.0408222401196458, -0.5347301163420796, 0.5244099658799541,
           0.5347301163420796, 1.048080741041938]
    start = [be, th, ga, ph, de, om, ep]
    names = ["beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon"]
    of = ["O", "F", "B", "G", "A5", "H", "A7"]
    scene("squeezer", "Andrews' squeezing mechanism: seven bodies and three loops in a plane; it starts 0.2 mrad from a dead point.", 0.03, 0.0005, {"rho_inf": 0.9, "step": 2e-6}, bodies, joints,
          [check(f"{n} [rad]", f"{j}.q", b - a, 1e-3 * abs(b), "reference solution less the start, at 1e-3 of the angle")
           for n, j, a, b in zip(names, of, start, end)],
          gravity=(0, 0, 0),
          forces=[{"name": "spring", "type": "spring_damper", "body_b": "k3", "point_a": [xc, yc, 0], "point_b": D,
                   "stiffness": 4530, "length": .07785},
                  {"name": "drive", "type": "actuator", "joint": "O", "size": {"type": "constant", "value": .033}}])


def governor():
    z, y = [0, 0, 1], [0, 1, 0]
    c, s = math.cos(math.pi / 6), -math.sin(math.pi / 6)
    thin, across = .3 * 2e-4 / 12, .3 * (1 + 1e-4) / 12
    bodies = [body("shaft", .3, [across, across, thin], [0, 0, .5]),
              body("slider", 3, [.005, .005, .005], [0, 0, .5])]
    joints = [joint("bearing", "revolute", "shaft", [0, 0, 0], z, rate=2 * math.pi),
              joint("slide", "prismatic", "slider", [0, 0, .5], z, "shaft")]
    forces = []
    for side, sign in (("right", 1), ("left", -1)):
        # Rotated about y so that its x axis is along the rod.
        half = math.atan2(-s, sign * c) / 2
        bodies.append(body(f"rod_{side}", .3, [thin, across, across], [sign * (.05 + c / 2), 0, 1 + s / 2],
                           orientation=[math.cos(half), 0, math.sin(half), 0]))
        bodies.append(body(f"ball_{side}", 5, POINT, [sign * (.05 + c), 0, 1 + s]))
        joints.append(joint(f"hinge_{side}", "revolute", f"rod_{side}", [sign * .05, 0, 1], y, "shaft"))
        joints.append(joint(f"weld_{side}", "fixed", f"ball_{side}", [sign * (.05 + c), 0, 1 + s], None, f"rod_{side}"))
        forces.append({"name": f"spring_{side}", "type": "spring_damper", "body_a": "slider", "body_b": f"rod_{side}",
                       "point_a": [sign * .05, 0, .5], "point_b": [sign * (.05 + c / 2), 0, 1 + s / 2], "stiffness": 8e5,
                       "damping": 4e4, "length": .5})
    scene("governor", "A05: a flyball governor whose slider hangs on stiff, strongly damped springs.", 10, 0.1,
          {"rho_inf": 0.9, "step": 1.25e-3}, bodies, joints,
          [check("slider after 10 s [m]", "slider.position.z", 0.619622917061, 1e-4, "reduced equations, 12 digits")],
          gravity=(0, 0, -G), forces=forces)


def heavy_top():
    scene("heavy_top", "The heavy top at 150 rad/s, as a free body with a cut ball joint at its tip.", 1, 0.01,
          {"rho_inf": 0.9, "step": 1e-4},
          [body("top", 15, [.234375, .46875, .234375], [0, 1, 0], velocity=[4.61538, 0, 0],
                angular_velocity=[0, 150, -4.61538])],
          [joint("tip", "spherical", "top", [0, 0, 0], cut=True)],
          [check(f"{n} after 1 s [m]", f"top.position.{n}", x, 2e-3, "reduced equations, 13 digits")
           for n, x in zip("xyz", (0.1733439640987, 0.6400885920705, -0.7484907911336))] + [keeps_energy(5e-3)],
          gravity=(0, 0, -G))


# ---------------------------------------------------------------- extreme cases

def flipping_body():
    J = (1, 2, 3)
    w0 = [1e-3, 6, 2e-3]

    def rate(y):
        w, (s, a, b, c) = y[:3], y[3:]
        return [(J[1] - J[2]) * w[1] * w[2] / J[0], (J[2] - J[0]) * w[2] * w[0] / J[1], (J[0] - J[1]) * w[0] * w[1] / J[2],
                (-a * w[0] - b * w[1] - c * w[2]) / 2, (s * w[0] + b * w[2] - c * w[1]) / 2,
                (s * w[1] + c * w[0] - a * w[2]) / 2, (s * w[2] + a * w[1] - b * w[0]) / 2]

    seconds = 8  # in the middle of the second flip
    end = integrate(rate, w0 + [1, 0, 0, 0], seconds, 5e-4)
    why = "Euler's equations, Runge-Kutta (make.py)"
    scene("flipping_body", "A free asymmetric body that turns about its middle axis and flips over and over.", seconds, 0.1,
          {"rho_inf": 0.9, "step": 2e-4}, [body("body", 1, list(J), [0, 0, 0], angular_velocity=w0)], [],
          [check(f"orientation {n} [-]", f"body.orientation.{n}", x, 1e-4, why) for n, x in zip("wxyz", end[3:])] +
          [keeps_energy(1e-4)], gravity=(0, 0, 0))


def chain(links):
    """Uniform rods of 0.1 m, from the horizontal."""
    L = 0.1
    bodies = [rod(f"r{i}", .1, L, (i * L, 0), ((i + 1) * L, 0)) for i in range(links)]
    joints = [joint(f"j{i}", "revolute", f"r{i}", [i * L, 0, 0], [0, 0, 1], f"r{i - 1}" if i else None) for i in range(links)]
    scene("chain", f"A chain of {links} links, let go from the horizontal.", 1, 0.01, {"rho_inf": 0.9, "step": 1e-3}, bodies,
          joints, [check("energy relative to the fall [J]", "summary.mbd_energy_drift_J", 0, 1e-2, "nothing dissipates")])


def closed_chain():
    """A ring of eight rods, stiffened by a spring of 1e9 N/m across each corner: a rigid body but for 1e-8."""
    n, L, m = 8, 0.25, 1
    radius, inner = L / (2 * math.sin(math.pi / n)), L / (2 * math.tan(math.pi / n))
    centre = (radius, 0)  # the pin is at the origin
    corner = [(centre[0] - radius * math.cos(2 * math.pi * k / n), radius * math.sin(2 * math.pi * k / n))
              for k in range(n + 1)]
    bodies = [rod(f"r{k}", m, L, corner[k], corner[k + 1]) for k in range(n)]
    joints = [joint("pin", "revolute", "r0", [0, 0, 0], [0, 0, 1])]
    joints += [joint(f"j{k}", "revolute", f"r{k % n}", [*corner[k], 0], [0, 0, 1], f"r{k - 1}") for k in range(1, n + 1)]
    across = 2 * inner * math.sin(math.pi / n)
    forces = [{"name": f"s{k}", "type": "spring_damper", "body_a": f"r{k}", "body_b": f"r{(k + 1) % n}",
               "point_a": bodies[k]["position"], "point_b": bodies[(k + 1) % n]["position"], "stiffness": 1e9,
               "length": across} for k in range(n)]
    J = n * m * (L * L / 12 + inner * inner + radius * radius)
    angle, _ = integrate(lambda y: [y[1], -n * m * G * radius / J * math.cos(y[0])], [0, 0], 1, 1e-4)
    # r4 is across: its centre is fixed in the ring.
    x, y = bodies[4]["position"][:2]
    why = "a rigid ring: theta'' = -m g R / J cos theta (make.py)"
    scene("closed_chain", "A closed chain of eight rods under springs of 1e9 N/m, which swings as a rigid ring.", 1, 0.01,
          {"rho_inf": 0.8, "step": 1e-3}, bodies, joints,
          [check("x of the far rod [m]", "r4.position.x", math.cos(angle) * x - math.sin(angle) * y, 1e-4, why),
           check("y of the far rod [m]", "r4.position.y", math.sin(angle) * x + math.cos(angle) * y, 1e-4, why)],
          forces=forces)


def mass_ratio():
    angle, _ = integrate(lambda y: [y[1], G / 2 * math.cos(y[0])], [0, 0], 1, 1e-4)
    why = "a pendulum of 2 m: the light mass changes it by 1e-6 of itself"
    scene("mass_ratio", "A mass of 1 kg carries one of 1e6 kg.", 1, 0.01, {"rho_inf": 0.8, "step": 1e-3},
          [body("light", 1, POINT, [-1, 0, 0]), body("heavy", 1e6, [1e-6] * 3, [-2, 0, 0])],
          [joint("top", "revolute", "light", [0, 0, 0], [0, 0, 1]),
           joint("middle", "revolute", "heavy", [-1, 0, 0], [0, 0, 1], "light")],
          [check("x of the heavy mass [m]", "heavy.position.x", -2 * math.cos(angle), 1e-4, why),
           check("y of the heavy mass [m]", "heavy.position.y", -2 * math.sin(angle), 1e-4, why)])


def dead_point():
    """Slider-crank; the force on the slider pushes it towards the crank, 1e-6 rad away from the outer dead point."""
    r, l, force, start = .1, .3, 100, 1e-6
    crank, connecting, slider = 1, .5, 1  # [kg]

    def x_slider(p):
        return r * cmath.cos(p) + l * cmath.sqrt(1 - (r / l * cmath.sin(p)) ** 2)

    def inertia(p):
        s, c = cmath.sin(p), cmath.cos(p)
        cosine = cmath.sqrt(1 - (r / l * s) ** 2)
        turn_rate = -r * c / (l * cosine)  # of the rod, whose angle is -asin(r sin p / l)
        dx = -r * s + r * s * turn_rate  # of the slider: l cos(psi), psi' = turn_rate, l sin(psi) = -r s
        cx, cy = -r * s + r * s * turn_rate / 2, r * c / 2
        return (crank * r * r / 3 + connecting * (cx * cx + cy * cy + l * l / 12 * turn_rate**2) + slider * dx * dx)

    def rate(y):
        p, w = y
        return [w, (-force * derivative(x_slider, p) - derivative(inertia, p) * w * w / 2) / inertia(p).real]

    end, end_rate = integrate(rate, [start, 0], .4, 2e-5)
    tip = (r * math.cos(start), r * math.sin(start))
    x = x_slider(start).real
    z = [0, 0, 1]
    why = "one degree of freedom, Runge-Kutta (make.py)"
    scene("dead_point", "A slider-crank, at rest 1e-6 rad beside its dead point, under a force on the slider.", .4, .01,
          {"rho_inf": 0.9, "step": 1e-4},
          [rod("crank", crank, r, (0, 0), tip), rod("rod", connecting, l, tip, (x, 0)), body("slider", slider, [.01] * 3, [x, 0, 0])],
          [joint("shaft", "revolute", "crank", [0, 0, 0], z), joint("big_end", "revolute", "rod", [*tip, 0], z, "crank"),
           joint("small_end", "revolute", "slider", [x, 0, 0], z, "rod"), joint("guide", "prismatic", "slider", [x, 0, 0], [1, 0, 0])],
          [check("crank angle [rad]", "shaft.q", end - start, 1e-3, why), check("its rate [rad/s]", "shaft.rate", end_rate, 1e-1, why)],
          gravity=(0, 0, 0),
          forces=[{"name": "push", "type": "force", "body": "slider", "point": [x, 0, 0], "direction": [-1, 0, 0],
                   "size": {"type": "constant", "value": force}}])


def gear_train():
    I, torque, t = [.01, .08, .5], 2, 1
    reduced = I[0] + I[1] / 4 + I[2] / 16
    q = torque / reduced * t * t / 2
    bodies = [body(f"gear{k + 1}", 1 + k, [I[k]] * 3, [k * .2, 0, 0]) for k in range(3)]
    joints = [joint(f"axle{k + 1}", "revolute", f"gear{k + 1}", [k * .2, 0, 0], [0, 0, 1]) for k in range(3)]
    why = "theta'' = T / (I1 + I2 / 4 + I3 / 16)"
    rate = torque / reduced * t
    passed_on = torque - I[0] * torque / reduced  # torque on the first gear that does not accelerate it
    scene("gear_train", "Three gears, 1 : 2 each, driven by a torque on the first.", t, .01, {"rho_inf": 0.9, "step": 1e-3}, bodies,
          joints, [check("first gear [rad]", "axle1.q", q, 1e-9, why), check("last gear [rad]", "axle3.q", q / 4, 1e-9, why),
                   check("work of the motor [J]", "motor.energy", torque * q, 1e-8, "T theta"),
                   check("its power [W]", "summary.elements.motor.power.largest", torque * rate, 1e-8, "T theta'"),
                   check("torque on the second gear [N m]", "mesh1.torque.axle2", -2 * passed_on, 1e-9, "(T - I1 theta'') / ratio"),
                   check("power of the first mesh [W]", "mesh1.power", passed_on * rate, 1e-8, "(T - I1 theta'') theta'")],
          gravity=(0, 0, 0),
          couplers=[{"name": f"mesh{k + 1}", "type": "gear", "joint_a": f"axle{k + 1}", "joint_b": f"axle{k + 2}", "ratio": -.5}
                    for k in range(2)],
          forces=[{"name": "motor", "type": "actuator", "joint": "axle1", "size": {"type": "constant", "value": torque}}])


def stops():
    """A rod of 1 m falls from the horizontal on an elastic stop 60 degrees below, and bounces."""
    I, k, upper = 1 / 3, 1e5, math.pi / 3

    def rate(y):
        stop = k * max(0, y[0] - upper)
        return [y[1], (G / 2 * math.cos(y[0]) - stop) / I]

    q, w = integrate(rate, [0, 0], 2, 1e-5)
    why = "one degree of freedom, Runge-Kutta (make.py)"
    scene("stops", "A rod falls from the horizontal on an elastic stop of 1e5 N m/rad, and bounces; the error control finds each "
          "impact.", 2, .01, {"rho_inf": 0.9, "error_tolerance": 1e-8}, [rod("rod", 1, 1, (-1, 0), (0, 0))],
          [joint("hinge", "revolute", "rod", [0, 0, 0], [0, 0, 1],
                 limits={"lower": -10, "upper": upper, "stiffness": k})],
          [check("angle [rad]", "hinge.q", q, 1e-3, why), check("rate [rad/s]", "hinge.rate", w, 1e-2, why), keeps_energy(2e-3)])


# ---------------------------------------------------------------- a realistic machine

def engine():
    """In-line engine: four slider-cranks side by side on one crankshaft. One degree of freedom, the angle of the crankshaft."""
    r, l, big_end = .043, .14, .045  # crank radius, rod length, centre of mass of the rod from its big end [m]
    rod_mass, rod_inertia, piston_mass, shaft_inertia = .6, 2.4e-3, .5, .2
    spacing, throws = .09, [0, math.pi, math.pi, 0]
    start, speed, brake, gas = math.pi / 6, 50 * math.pi, .5, 1000  # [rad], [rad/s], [N m s/rad], [N]

    def tilt(p):
        """Angle of the rod from the axis of the cylinder, which is y; the pin is at r (-sin p, cos p)."""
        return cmath.asin(r / l * cmath.sin(p))

    def heights(p):
        """y of the centre of mass of the rod and of the piston."""
        c = cmath.cos(tilt(p))
        return r * cmath.cos(p) + big_end * c, r * cmath.cos(p) + l * c

    def across(p):
        """x of the centre of mass of the rod."""
        return (big_end / l - 1) * r * cmath.sin(p)

    def inertia(p):
        """J(p): J p'^2 / 2 is the kinetic energy. The derivatives are written out, so that J takes complex angles."""
        sum = shaft_inertia
        for throw in throws:
            s, c = cmath.sin(p + throw), cmath.cos(p + throw)
            turn_rate = r / l * c / cmath.cos(tilt(p + throw))
            sine = r / l * s  # of the tilt
            rod = (big_end / l - 1) * r * c, -r * s - big_end * sine * turn_rate
            piston = -r * s - l * sine * turn_rate
            sum += rod_mass * (rod[0] ** 2 + rod[1] ** 2) + rod_inertia * turn_rate**2 + piston_mass * piston**2
        return sum

    def gas_force(t, throw):
        return gas * (1 + math.sin(speed * t + start + throw))

    def rate(y):
        p, w, t = y
        moment = -brake * w - derivative(inertia, p) * w * w / 2
        for throw in throws:
            moment -= rod_mass * G * derivative(lambda x: heights(x)[0], p + throw)
            moment -= (piston_mass * G + gas_force(t, throw)) * derivative(lambda x: heights(x)[1], p + throw)
        return [w, moment / inertia(p).real, 1]

    seconds = .2  # five turns
    end, end_rate, _ = integrate(rate, [start, speed, 0], seconds, 2e-5)

    z = [0, 0, 1]
    bodies = [body("crankshaft", 15, [.25, .25, shaft_inertia], [0, 0, 0])]
    joints = [joint("main1", "revolute", "crankshaft", [0, 0, -2 * spacing], z, rate=speed, damping=brake)]
    joints += [joint(f"main{k + 1}", "revolute", "crankshaft", [0, 0, (k - 2) * spacing], z) for k in range(1, 5)]
    forces = []
    for k, throw in enumerate(throws):
        p, at = start + throw, (k - 1.5) * spacing
        pin, top = [-r * math.sin(p), r * math.cos(p), at], [0, heights(p)[1].real, at]
        half = tilt(p).real / 2  # rotated about z so that its y axis is along the rod
        bodies.append(body(f"rod{k + 1}", rod_mass, [rod_inertia, 2e-4, rod_inertia], [across(p).real, heights(p)[0].real, at],
                           orientation=[math.cos(half), 0, 0, -math.sin(half)]))
        bodies.append(body(f"piston{k + 1}", piston_mass, [4e-4, 5e-4, 4e-4], top))
        joints += [joint(f"big_end{k + 1}", "revolute", f"rod{k + 1}", pin, z, "crankshaft"),
                   joint(f"small_end{k + 1}", "revolute", f"piston{k + 1}", top, z, f"rod{k + 1}"),
                   joint(f"cylinder{k + 1}", "cylindrical", f"piston{k + 1}", top, [0, 1, 0])]
        forces.append({"name": f"gas{k + 1}", "type": "force", "body": f"piston{k + 1}", "point": top, "direction": [0, -1, 0],
                       "size": {"type": "harmonic", "offset": gas, "amplitude": gas, "frequency": speed / (2 * math.pi),
                                "phase": p}})
    why = "one degree of freedom, Runge-Kutta (make.py)"
    scene("engine", "An in-line engine of four cylinders. Five main bearings, and more joints in each cylinder than it needs: most "
          "equations are redundant.", seconds, .002, {"rho_inf": 0.9, "step": 1e-4}, bodies, joints,
          [check("crank angle [rad]", "main1.q", end - start, 1e-4, why),
           check("its rate [rad/s]", "main1.rate", end_rate, 2e-3, why),
           check("height of the first piston [m]", "piston1.position.y", heights(end)[1].real, 5e-6, why)], forces=forces)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--chain", type=int, default=100, help="links of chain.json")
    parser.add_argument("--windows", type=int, default=2, help="windows of four_bars.json")
    options = parser.parse_args()
    simple_pendulum()
    double_pendulum()
    four_bars(options.windows)
    bricard()
    squeezer()
    governor()
    heavy_top()
    flipping_body()
    chain(options.chain)
    closed_chain()
    mass_ratio()
    dead_point()
    gear_train()
    stops()
    engine()


if __name__ == "__main__":
    main()
