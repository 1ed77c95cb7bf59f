"""Parts as a CAD program exports them: sheets without thickness, holes, lifters, in one binary STL file."""
import math
import struct


class Part:
    """Triangles of one part [m]. Corners that are meant to be one have the same numbers."""

    def __init__(self):
        self.triangles = []

    def quad(self, a, b, c, d):
        self.triangles += [(a, b, c), (a, c, d)]

    def grid(self, point, us, vs):
        """The surface point(u, v) with corners at all us and vs."""
        for u, u1 in zip(us, us[1:]):
            for v, v1 in zip(vs, vs[1:]):
                self.quad(point(u, v), point(u1, v), point(u1, v1), point(u, v1))

    def panel_with_hole(self, point, us, vs, radius, u_scale=1.0):
        """The surface point(u, v) with corners on its rim at all us and vs, and a round hole in its middle. u_scale:
        length of one unit of u [m]. Returns the area of the hole, which is a polygon [m2]."""
        middle = (0.5 * (us[0] + us[-1]), 0.5 * (vs[0] + vs[-1]))
        rim = [(u, vs[0]) for u in us[:-1]] + [(us[-1], v) for v in vs[:-1]]
        rim += [(u, vs[-1]) for u in reversed(us[1:])] + [(us[0], v) for v in reversed(vs[1:])]
        hole = []
        for u, v in rim:
            angle = math.atan2(v - middle[1], (u - middle[0]) * u_scale)
            hole.append((middle[0] + radius / u_scale * math.cos(angle), middle[1] + radius * math.sin(angle)))
        for k in range(len(rim)):
            n = (k + 1) % len(rim)
            self.quad(point(*rim[k]), point(*rim[n]), point(*hole[n]), point(*hole[k]))
        return 0.5 * u_scale * sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(hole, hole[1:] + hole[:1]))

    def write(self, path, scale=1.0):
        """scale: lengths in the file per metre."""
        with open(path, "wb") as file:
            file.write(b"part of a test".ljust(80) + struct.pack("<I", len(self.triangles)))
            for triangle in self.triangles:
                a, b, c = triangle
                u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
                n = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
                length = math.hypot(*n)
                file.write(struct.pack("<3f", *(x / length for x in n)))
                for corner in triangle:
                    file.write(struct.pack("<3f", *(scale * x for x in corner)))
                file.write(struct.pack("<H", 0))


def steps(begin, end, count):
    return [begin + (end - begin) * k / count for k in range(count)] + [end]


class Drum:
    """A can about a vertical axis, open at the top: a bottom, a shell with a ring of round holes, lifters inside."""

    around, per_hole, rows = 8, 4, 4  # holes around, edges of the shell per hole, edges of a panel along the axis

    def __init__(self, radius, height, hole_low, hole_diameter, lifter):
        """hole_low: lower end of the ring of panels with holes above the bottom; lifter: radial width [m]."""
        self.radius, self.height, self.hole_low, self.hole_diameter, self.lifter = radius, height, hole_low, hole_diameter, lifter
        self.panel = 1.3 * hole_diameter  # height of the ring

    def add_to(self, part, at=(0, 0, 0)):
        def on(radius, u, v):
            return (at[0] + radius * math.cos(u), at[1] + radius * math.sin(u), at[2] + v)

        def shell(u, v):
            # Chords between the corners of the shell, so that neighbours of a panel meet it.
            edge = 2 * math.pi / (self.around * self.per_hole)
            k = math.floor(u / edge + 1e-9)
            t = u / edge - k
            if t < 1e-9:
                return on(self.radius, k * edge, v)
            a, b = on(self.radius, k * edge, v), on(self.radius, (k + 1) * edge, v)
            return tuple(x + t * (y - x) for x, y in zip(a, b))

        low, high = self.hole_low, self.hole_low + self.panel
        self.hole_area = 0  # of all holes [m2]
        for k in range(self.around):
            us = [2 * math.pi * (k * self.per_hole + j) / (self.around * self.per_hole) for j in range(self.per_hole + 1)]
            part.grid(shell, us, [0, low])
            self.hole_area += part.panel_with_hole(shell, us, steps(low, high, self.rows), self.hole_diameter / 2, self.radius)
            part.grid(shell, us, steps(high, self.height, 2))
            for u, u1 in zip(us, us[1:]):
                part.triangles.append((on(0, 0, 0), on(self.radius, u, 0), on(self.radius, u1, 0)))
        for k in range(0, self.around, self.around // 4):  # lifters stand between two holes
            u = 2 * math.pi * k / self.around
            inner = self.radius - self.lifter
            part.quad(on(self.radius, u, low), on(inner, u, low), on(inner, u, self.height), on(self.radius, u, self.height))


def sheet(part, x, width, height, thickness=0.0):
    """A bulkhead across x, width along y about 0, from z = 0 on: one sheet, or two with edges between them."""
    y0, y1 = -0.5 * width, 0.5 * width
    a, b = x - 0.5 * thickness, x + 0.5 * thickness
    corners = [(y0, 0), (y1, 0), (y1, height), (y0, height)]
    part.quad(*[(a, *c) for c in corners])
    if thickness > 0:
        part.quad(*[(b, *c) for c in reversed(corners)])
        for c, d in zip(corners, corners[1:] + corners[:1]):
            part.quad((a, *d), (a, *c), (b, *c), (b, *d))
