"""Parts as a CAD program exports them: sheets without thickness, plates and round holes in one binary STL file."""
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

    def panel_with_hole(self, point, us, vs, radius):
        """The surface point(u, v) with corners on its rim at all us and vs, and a round hole in its middle."""
        middle = (0.5 * (us[0] + us[-1]), 0.5 * (vs[0] + vs[-1]))
        rim = [(u, vs[0]) for u in us[:-1]] + [(us[-1], v) for v in vs[:-1]]
        rim += [(u, vs[-1]) for u in reversed(us[1:])] + [(us[0], v) for v in reversed(vs[1:])]
        hole = []
        for u, v in rim:
            angle = math.atan2(v - middle[1], u - middle[0])
            hole.append((middle[0] + radius * math.cos(angle), middle[1] + radius * math.sin(angle)))
        for k in range(len(rim)):
            n = (k + 1) % len(rim)
            self.quad(point(*rim[k]), point(*rim[n]), point(*hole[n]), point(*hole[k]))

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
