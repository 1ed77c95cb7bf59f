"""Rigid motions and rounding of scenes of multibody systems."""
import copy
import math

import numpy as np

POINTS = ("position", "child_position", "point", "point_a", "point_b")
DIRECTIONS = ("axis", "axis2", "direction", "velocity", "angular_velocity")


def matrix(q):
    w, x, y, z = np.asarray(q, float) / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def product(p, q):
    return np.concatenate([[p[0] * q[0] - np.dot(p[1:], q[1:])], p[0] * np.array(q[1:]) + q[0] * np.array(p[1:])
                           + np.cross(p[1:], q[1:])])


def parts(scene, group):
    """Everything of a group that has positions: also the points of ropes."""
    for thing in scene["mbd"].get(group, []):
        yield thing
        yield from thing.get("points", [])


def moved(scene, q, t):
    """The scene after a rotation by the quaternion q and a translation t."""
    R = matrix(q)
    new = copy.deepcopy(scene)
    new["gravity"] = R @ np.asarray(scene.get("gravity", [0, 0, -9.81]), float)
    for body in new["mbd"]["bodies"]:
        body.setdefault("position", [0, 0, 0])
        turned = product(q, body.get("orientation", [1, 0, 0, 0]))
        body["orientation"] = turned / np.linalg.norm(turned)
    for group in ("bodies", "joints", "forces"):
        for thing in parts(new, group):
            for key in POINTS:
                if key in thing:
                    thing[key] = R @ np.asarray(thing[key], float) + t
            for key in DIRECTIONS:
                if key in thing:
                    thing[key] = R @ np.asarray(thing[key], float)
                    if key in ("axis", "axis2", "direction"):
                        thing[key] /= np.linalg.norm(thing[key])
            if thing.get("type") == "bushing":
                Q = np.kron(np.eye(2), R)
                for key in ("stiffness", "damping"):
                    if key in thing:
                        K = np.diag(thing[key]) if len(thing[key]) == 6 else np.reshape(thing[key], (6, 6))
                        thing[key] = (Q @ K @ Q.T).ravel()
    return new


def rounded(scene, digits, length):
    """Lengths to so many digits of a machine of this length, directions and quaternions to so many decimals."""
    decimals = digits - 1 - math.floor(math.log10(length))
    new = copy.deepcopy(scene)
    for group in ("bodies", "joints", "forces"):
        for thing in parts(new, group):
            for key in POINTS + ("length",):
                if key in thing:
                    thing[key] = np.round(np.asarray(thing[key], float), decimals)
                    if thing[key].ndim == 0:
                        thing[key] = float(thing[key])
            for key in ("axis", "axis2", "direction", "orientation"):
                if key in thing:
                    thing[key] = np.round(np.asarray(thing[key], float), digits)
    return new
