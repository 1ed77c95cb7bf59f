"""The surface of a liquid around its particles, as a mesh for pictures.

usage: liquid_surface.py PARTICLES.h5 SURFACE.h5

PARTICLES.h5 has position (n x 3) and spacing (1) [m], and value (n), of any unit. SURFACE.h5 receives vertices (m x 3) [m],
normals (m x 3), triangles (k x 3), value (m), and drops: indices of the particles that have too few neighbours to
be inside.

The surface is where the sum of the particles' kernels (1 - r^2/R^2)^2, of range R = 2 spacings, is a given share of the
sum inside a liquid [Blinn1982]; marching cubes by scikit-image.
"""
import sys

import h5py
import numpy as np
from scipy.ndimage import map_coordinates, maximum_filter
from skimage.measure import marching_cubes

RANGE = 2.0  # of the kernel, in spacings
PITCH = 0.5  # of the grid, in spacings
# Of the sum inside a liquid. 0.5 would be half a spacing outside the last particles of a plane surface, just where walls are; more
# is between them and the wall.
SHARE = 0.6
INSIDE = RANGE**3 * 32 * np.pi / 105  # the integral of the kernel, over one spacing cubed
MOST_CELLS = 60_000_000


def kernel_sums(position, value, low, shape):
    """Sums of the kernels, and of kernel times value, at the points of the grid; positions in pitches of the grid."""
    reach = int(np.ceil(RANGE / PITCH))
    offsets = np.stack(np.meshgrid(*3 * [np.arange(-reach, reach + 1)], indexing="ij"), axis=-1).reshape(-1, 3)
    offsets = offsets[np.linalg.norm(offsets, axis=1) < RANGE / PITCH + 1]
    cells = int(np.prod(shape))
    sums, weighted = np.zeros(cells), np.zeros(cells)
    for first in range(0, len(position), 20_000):
        part = position[first:first + 20_000]
        nearest = np.rint(part).astype(np.int64)
        points = nearest[:, None, :] + offsets[None, :, :]
        squares = ((points - part[:, None, :])**2).sum(axis=2) * (PITCH / RANGE)**2
        kernels = np.maximum(1 - squares, 0)**2
        at = np.ravel_multi_index(tuple(np.moveaxis(points - low, 2, 0)), shape)
        sums += np.bincount(at.ravel(), kernels.ravel(), cells)
        weighted += np.bincount(at.ravel(), (kernels * value[first:first + 20_000, None]).ravel(), cells)
    return sums.reshape(shape), weighted.reshape(shape)


def surface(position, value, spacing):
    pitch = PITCH * spacing
    scaled = position / pitch
    margin = int(np.ceil(RANGE / PITCH)) + 2
    low = np.floor(scaled.min(axis=0)).astype(np.int64) - margin
    shape = tuple(np.ceil(scaled.max(axis=0)).astype(np.int64) + margin + 1 - low)
    if float(shape[0]) * shape[1] * shape[2] > MOST_CELLS:
        sys.exit(f"the liquid is spread over {shape[0]} x {shape[1]} x {shape[2]} cells of half a spacing, more than {MOST_CELLS:,}")
    sums, weighted = kernel_sums(scaled, value, low, shape)
    level = SHARE * INSIDE
    # Edges and corners of the liquid are rounded: a particle there is none of the drops while the surface is within a spacing.
    near = maximum_filter(sums, 2 * int(1 / PITCH) + 1)
    drops = np.flatnonzero(near[tuple((np.rint(scaled).astype(np.int64) - low).T)] < level)
    if sums.max() <= level:
        none = np.empty((0, 3))
        return none, none, none.astype(np.uint32), np.empty(0), drops
    vertices, triangles, normals, _ = marching_cubes(sums, level, gradient_direction="ascent")
    values = map_coordinates(weighted, vertices.T, order=1) / map_coordinates(sums, vertices.T, order=1)
    return (vertices + low) * pitch, normals, triangles, values, drops


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with h5py.File(sys.argv[1]) as file:
        found = surface(file["position"][:], file["value"][:], float(file["spacing"][0]))
    with h5py.File(sys.argv[2], "w") as file:
        for name, data, kind in zip(("vertices", "normals", "triangles", "value", "drops"), found, "ddIdI"):
            file.create_dataset(name, data=np.asarray(data, dtype=kind))


if __name__ == "__main__":
    main()
