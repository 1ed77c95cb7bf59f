"""Quaternions w x y z, and arrays of them, that rotate vectors of the body frame into the world."""
import numpy as np


def matrix(quaternion):
    """The rotation matrices (... x 3 x 3)."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion), -1, 0)
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def in_world(quaternion, tensor):
    """Tensors of the body frame (... x 3 x 3), such as inertias, about the axes of the world."""
    R = matrix(quaternion)
    return R @ tensor @ np.swapaxes(R, -1, -2)


def product(p, q):
    """p q: first the rotation q, then p, both seen from the world."""
    p, q = np.asarray(p), np.asarray(q)
    pw, pv, qw, qv = p[..., :1], p[..., 1:], q[..., :1], q[..., 1:]
    return np.concatenate([pw * qw - np.sum(pv * qv, -1, keepdims=True), pw * qv + qw * pv + np.cross(pv, qv)], -1)


def rotated(quaternion, vector):
    """The quaternions after a rotation about the world's `vector` by its length [rad], of norm 1."""
    vector = np.asarray(vector)
    half = 0.5 * np.linalg.norm(vector, axis=-1, keepdims=True)
    turn = np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * vector], -1)
    result = product(turn, quaternion)
    return result / np.linalg.norm(result, axis=-1, keepdims=True)
