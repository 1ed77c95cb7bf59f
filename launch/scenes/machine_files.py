"""What the programs that write scenes share: JSON, command lines, OBJ files, sheets with round holes."""
import argparse
import json
import math
import os
import pathlib
import sys


def text(value, indent=0, width=170):
    """JSON with one line for what fits into it."""
    line = json.dumps(value)
    if len(line) + indent <= width or not isinstance(value, (dict, list)) or not value:
        return line
    pad = "\n" + " " * (indent + 1)
    if isinstance(value, dict):
        inner = [f"{json.dumps(k)}: {text(v, indent + 1, width)}" for k, v in value.items()]
        return "{" + pad + ("," + pad).join(inner) + pad[:-1] + "}"
    return "[" + pad + ("," + pad).join(text(v, indent + 1, width) for v in value) + pad[:-1] + "]"


class Mesh:
    """Triangles and quadrilaterals with common corners."""

    def __init__(self):
        self.corners, self.faces, self._index = [], [], {}

    def corner(self, point):
        key = tuple(round(x * 1e6) for x in point)
        if key not in self._index:
            self._index[key] = len(self.corners)
            self.corners.append(tuple(x / 1e6 for x in key))
        return self._index[key]

    def face(self, *points):
        corners = [self.corner(p) for p in points]
        self.faces.append([c for k, c in enumerate(corners) if c != corners[k - 1]])

    def fan(self, middle, outline):
        for k, b in enumerate(outline):
            self.face(middle, outline[k - 1], b)

    def plate(self, outline, centre, radius, place):
        """A part of a sheet: a convex outline (x, y), counterclockwise, with a hole whose corners are at the radius, opposite to those
        of the outline; place(x, y) is the point in space."""
        hole = []
        for x, y in outline:
            angle = math.atan2(y - centre[1], x - centre[0])
            hole.append((centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)))
        for k in range(len(outline)):
            self.face(place(*outline[k - 1]), place(*outline[k]), place(*hole[k]), place(*hole[k - 1]))

    def prism(self, outline, low, high, place):
        """A closed solid: a convex outline (x, y), counterclockwise as seen against z, from z = low to high."""
        self.face(*(place(x, y, high) for x, y in outline))
        self.face(*(place(x, y, low) for x, y in reversed(outline)))
        for k, b in enumerate(outline):
            a = outline[k - 1]
            self.face(place(*a, low), place(*b, low), place(*b, high), place(*a, high))

    def obj(self, made_by):
        lines = [f"# {made_by} wrote this file"]
        lines += ["v " + " ".join(f"{x + 0.0:.6g}" for x in corner) for corner in self.corners]
        lines += ["f " + " ".join(str(c + 1) for c in face) for face in self.faces]
        return "\n".join(lines) + "\n"


def eccentric_ring(radius, offset, segments):
    """Corners of a circle about (0, offset), as seen from the origin in equal angles."""
    corners = []
    for k in range(segments):
        angle = 2 * math.pi * (k + 0.5) / segments
        way = offset * math.sin(angle) + math.sqrt(radius ** 2 - (offset * math.cos(angle)) ** 2)
        corners.append((way * math.cos(angle), way * math.sin(angle)))
    return corners


def number(x):
    return float(f"{x:.7g}")


def vector(*values):
    return [number(x) for x in values]


def add_check(checks, name, of, expected, tolerance, why, reduce="mean", absolute=False, **times):
    checks.append({"name": name, "of": of, "reduce": reduce, **times,
                   "expected": expected if isinstance(expected, dict) else number(expected), "tolerance": tolerance,
                   **({"absolute": True} if absolute else {}), "why": why})


def write_or_check(folder, files, check):
    """files: text by name."""
    folder = pathlib.Path(folder)
    for name, content in files.items():
        path = folder / name
        if not check:
            path.write_text(content, encoding="utf-8")
        elif not path.is_file() or path.read_text(encoding="utf-8") != content:
            sys.exit(f"{name} is not what the program of its folder writes: run it")


def rounded(value):
    """The same with numbers of nine digits."""
    if isinstance(value, dict):
        return {key: rounded(of) for key, of in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(of) for of in value]
    return float(f"{value:.9g}") + 0.0 if isinstance(value, float) else value


def write_scenes(description, folder, scenes):
    """The command line of a program that writes scenes to its folder. scenes: by name."""
    arguments = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true", help="say whether the files are what it would write")
    check = arguments.parse_args().check
    write_or_check(folder, {f"{name}.json": text(rounded(scene)) + "\n" for name, scene in scenes.items()}, check)


def write_variant(scene, folder, output):
    """A scene of `folder` into the file `output`, which may be elsewhere: the files of its shapes stay where they are."""

    def refer(value):
        if isinstance(value, dict):
            if "file" in value:
                value["file"] = os.path.relpath(folder / value["file"], output.parent)
            value = list(value.values())
        if isinstance(value, list):
            for inner in value:
                refer(inner)

    refer(scene)
    output.write_text(text(scene) + "\n", encoding="utf-8")
