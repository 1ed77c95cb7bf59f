"""Writes boom.stl and bucket.stl of excavator.py, in mm: python3 excavator_meshes.py [FOLDER]"""
import pathlib
import sys

import numpy as np

from tandem.geometry import write_stl


def fan(points):
    """Triangles of a convex polygon."""
    return [[points[0], points[k], points[k + 1]] for k in range(1, len(points) - 1)]


def at(profile, y):
    """The points (x, z) of a profile at y."""
    return [(x, y, z) for x, z in profile]


def prism(profile, width):
    """A solid: a convex profile (x, z), clockwise as seen against y, and its width along y."""
    a, b = at(profile, -width / 2), at(profile, width / 2)
    sides = [t for k in range(len(a)) for t in fan([a[k - 1], a[k], b[k], b[k - 1]])]
    return fan(a[::-1]) + fan(b) + sides


def inset(profile, thickness):
    """The profile with all edges but the last one moved inwards; the last one, from the last to the first point, is open."""
    points = np.array(profile, float)
    edges = np.roll(points, -1, axis=0) - points
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1)[:, None]
    middle = points.mean(axis=0)
    normals *= np.sign(np.einsum("ij,ij->i", middle - points, normals))[:, None]
    offset = np.einsum("ij,ij->i", points, normals) + np.array([thickness] * (len(points) - 1) + [0])
    return [tuple(np.linalg.solve(normals[[k - 1, k]], offset[[k - 1, k]])) for k in range(len(points))]


def bucket(profile, width, thickness):
    """A solid bucket: the profile with an open last edge as a shell of this thickness, with two sides."""
    outer, inner = profile, inset(profile, thickness)
    wide, narrow = width / 2, width / 2 - thickness
    a, b, c, d = at(outer, -wide), at(outer, wide), at(inner, -narrow), at(inner, narrow)
    triangles = fan(a[::-1]) + fan(b) + fan(c) + fan(d[::-1])
    for k in range(1, len(outer)):
        triangles += fan([a[k - 1], a[k], b[k], b[k - 1]]) + fan([d[k - 1], d[k], c[k], c[k - 1]])
    for p, q, r, s in ((a[-1], a[0], c[0], c[-1]), (b[0], b[-1], d[-1], d[0]), (a[0], b[0], d[0], c[0]), (b[-1], a[-1], c[-1], d[-1])):
        triangles += fan([p, q, r, s])
    return triangles


def main(folder="."):
    # The boom from its pivot at x = 0 to its tip at x = 1 m, both at z = 0.7 m.
    write_stl(pathlib.Path(folder) / "boom.stl", prism([(-40, 660), (-40, 740), (350, 860), (1030, 740), (1030, 680)], 90))
    # The bucket hangs on the tip; its mouth looks back to the machine, and its lip is the lowest point.
    corners = [(-120, -20), (80, 30), (120, -150), (50, -300), (-100, -360)]
    profile = [(1000 + x, 700 + z) for x, z in corners]
    write_stl(pathlib.Path(folder) / "bucket.stl", bucket(profile, 360, 15))


if __name__ == "__main__":
    main(*sys.argv[1:2])
