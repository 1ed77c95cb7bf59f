"""Triangles of mesh files, bounds and volumes of shapes, rotations. numpy is loaded when it is needed."""
import hashlib
import math
import os
import pathlib
import tempfile
from typing import Any, Optional, Tuple

from tandem.entries import SceneError, plain


def read_triangles(file: str):
    """Corners of the triangles of an STL or OBJ file, as in the file: array (triangles x 3 x 3)."""
    import numpy as np
    path = pathlib.Path(file)
    data = path.read_bytes()
    if path.suffix.lower() == ".obj":
        corners, triangles = [], []
        for line in data.decode("utf-8", "replace").splitlines():
            words = line.split()
            if words[:1] == ["v"]:
                corners.append([float(x) for x in words[1:4]])
            elif words[:1] == ["f"]:
                face = [int(word.split("/")[0]) for word in words[1:]]
                face = [index - 1 if index > 0 else len(corners) + index for index in face]
                triangles += [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]
        return np.array(corners, float)[np.array(triangles, int).reshape(-1, 3)]
    if len(data) >= 84 and len(data) >= 84 + 50 * int.from_bytes(data[80:84], "little") and not data[:512].lstrip().startswith(b"solid "):
        count = int.from_bytes(data[80:84], "little")
        return np.frombuffer(data, np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")]), count, 84)["c"].astype(float)
    numbers = [[float(x) for x in line.split()[1:4]] for line in data.decode("utf-8", "replace").splitlines()
               if line.strip().startswith("vertex")]
    return np.array(numbers, float).reshape(-1, 3, 3)


def write_stl(file, triangles) -> None:
    """A binary STL file of corners (triangles x 3 x 3)."""
    import numpy as np
    corners = np.asarray(triangles, float)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    record = np.zeros(len(corners), np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")]))
    record["n"], record["c"] = normals / np.where(lengths > 0, lengths, 1), corners
    pathlib.Path(file).write_bytes(b"made by tandem".ljust(80, b"\0") + len(corners).to_bytes(4, "little") + record.tobytes())


def transformed_mesh(file: str, matrix, about) -> str:
    """A file with the mesh after x -> about + matrix (x - about), in units of the file, in the cache of tandem."""
    import numpy as np
    triangles = about + (read_triangles(file) - about) @ np.asarray(matrix).T
    if np.linalg.det(matrix) < 0:
        triangles = triangles[:, ::-1]
    return cached_mesh(pathlib.Path(file).stem.split("-")[0], triangles)


def cached_mesh(name: str, triangles) -> str:
    """A file of these triangles in the cache of tandem."""
    import numpy as np
    triangles = np.asarray(triangles, float)
    digest = hashlib.sha256(np.ascontiguousarray(triangles).tobytes()).hexdigest()[:16]
    base = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    folder = pathlib.Path(base) / "tandem" / "meshes"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = pathlib.Path(tempfile.gettempdir()) / f"tandem-meshes-{os.getuid()}"
        folder.mkdir(mode=0o700, exist_ok=True)
    target = folder / f"{name}-{digest}.stl"
    if not target.exists():
        draft = target.with_suffix(f".{os.getpid()}.part")
        write_stl(draft, triangles)
        draft.replace(target)
    return str(target)


def volume(shape: dict) -> Optional[float]:
    """Volume [m3] of a solid shape; None where it has no closed form here."""
    kind, pi = shape.get("type"), math.pi
    try:
        if kind == "box":
            return shape["size"][0] * shape["size"][1] * shape["size"][2]
        if kind == "sphere":
            return 4 / 3 * pi * shape["radius"] ** 3
        if kind == "cylinder":
            return pi * shape["radius"] ** 2 * shape["height"]
        if kind == "capsule":
            return pi * shape["radius"] ** 2 * (shape["height"] + 4 / 3 * shape["radius"])
        if kind == "cone":
            a, b = shape["radius"], shape.get("top_radius", 0)
            return pi * shape["height"] * (a * a + a * b + b * b) / 3
        if kind == "mesh":
            import numpy as np
            a, b, c = np.moveaxis(read_triangles(shape["file"]) * units_of(shape), 1, 0)
            return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6
    except (IndexError, KeyError, TypeError, ValueError):
        return None
    return None


def units_of(shape: dict):
    """Length of a unit of the mesh file along each of its axes [m]."""
    import numpy as np
    return float(shape.get("scale") or 1) * np.array(shape.get("stretch") or (1, 1, 1), float)


def corners(shape: dict):
    """Points whose hull contains the shape, in its own frame: array (points x 3); None for endless shapes and formulas."""
    import numpy as np
    kind = shape.get("type")
    try:
        if kind == "mesh" or (kind == "convex_hull" and "file" in shape):
            return read_triangles(shape["file"]).reshape(-1, 3) * units_of(shape)
        if kind == "convex_hull":
            return np.array(shape["points"], float)
        if kind == "box":
            half = np.array(shape["size"], float) / 2
        elif kind == "sphere":
            half = np.full(3, float(shape["radius"]))
        elif kind == "cylinder":
            half = np.array([shape["radius"], shape["radius"], shape["height"] / 2], float)
        elif kind == "capsule":
            half = np.array([shape["radius"], shape["radius"], shape["height"] / 2 + shape["radius"]], float)
        elif kind == "cone":
            wide = max(shape["radius"], shape.get("top_radius", 0))
            half = np.array([wide, wide, shape["height"] / 2], float)
        elif kind == "height_field":
            heights = np.array(shape["heights"], float)
            low = min(float(heights.min()), float(shape.get("base", heights.min())))
            x, y = np.array(shape["size"], float) / 2
            return np.array([[a, b, c] for a in (-x, x) for b in (-y, y) for c in (low, float(heights.max()))])
        else:
            return None
    except (KeyError, TypeError, ValueError):
        return None
    return np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]) * half


def quaternion(orientation: Any) -> Any:
    """An orientation of a scene: ('y', angle) means an angle [rad] about an axis; all others stay."""
    from tandem.values import axis
    if isinstance(orientation, tuple) and len(orientation) == 2:
        return {"axis": axis(orientation[0]), "angle": plain(orientation[1])}
    return plain(orientation)


def rotation(orientation: Any):
    """Rotation matrix (3 x 3) of an orientation as scenes write it: quaternion w, x, y, z, Euler angles, axis and angle, axes."""
    import numpy as np
    if orientation is None:
        return np.eye(3)
    if isinstance(orientation, (list, tuple)):
        w, x, y, z = orientation
        return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]], float)

    def about(direction, angle):
        k = np.array([[0, -direction[2], direction[1]], [direction[2], 0, -direction[0]], [-direction[1], direction[0], 0]], float)
        return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k

    if "axis" in orientation:
        angle = orientation["angle"] if "angle" in orientation else math.radians(orientation["angle_deg"])
        return about(orientation["axis"], angle)
    if "euler" in orientation or "euler_deg" in orientation:
        angles = orientation.get("euler") or [math.radians(a) for a in orientation["euler_deg"]]
        result = np.eye(3)
        for name, angle in zip(orientation["order"], angles):
            result = result @ about([float(name == other) for other in "xyz"], angle)
        return result
    axes = {name: np.array(orientation[f"{name}_axis"], float) for name in "xyz" if f"{name}_axis" in orientation}
    axes = {name: v / np.linalg.norm(v) for name, v in axes.items()}
    for name, (a, b) in {"x": "yz", "y": "zx", "z": "xy"}.items():
        if name not in axes:
            axes[name] = np.cross(axes[a], axes[b])
    return np.column_stack([axes["x"], axes["y"], axes["z"]])


def bounds_in(shape: dict, position: Any, orientation: Any) -> Optional[Tuple[Any, Any]]:
    """Lowest and highest corner of a shape at a pose; None where it is endless or given by formulas."""
    import numpy as np
    points = corners(shape)
    if points is None:
        return None
    try:
        placed = np.array(position or [0, 0, 0], float) + points @ rotation(orientation).T
    except (TypeError, ValueError, KeyError):
        return None
    return placed.min(axis=0), placed.max(axis=0)


def _several(value, argument: str, wanted: str, made_at: Optional[str]):
    value = value.tolist() if hasattr(value, "tolist") else value
    if not isinstance(value, (list, tuple)) or len(value) != wanted.count(",") + 1:
        raise SceneError(f"{argument}= is {value!r}", hint=f"give {wanted}", made_at=made_at)
    return value


def _found_mesh(mesh, made_at: Optional[str]) -> str:
    """The full name of a mesh file, whose name starts at the current folder."""
    if not isinstance(mesh, (str, os.PathLike)):
        raise SceneError(f"mesh= is {mesh!r}", hint="give the name of an STL or OBJ file", made_at=made_at)
    file = os.path.abspath(os.fspath(mesh))
    if not os.path.isfile(file):
        raise SceneError(f"there is no mesh file '{mesh}'", hint=f"looked in {os.path.dirname(file)}", made_at=made_at)
    return file


def shape_of(mesh=None, scale=None, box=None, sphere=None, cylinder=None, shape=None, open=None, made_at=None, cone=None) -> Optional[dict]:
    """The one shape that the arguments describe, or None."""
    given = [name for name, value in dict(mesh=mesh, box=box, sphere=sphere, cylinder=cylinder, cone=cone, shape=shape).items()
             if value is not None]
    if len(given) > 1:
        raise SceneError(" and ".join(f"{name}=" for name in given) + " are given", hint="give one shape", made_at=made_at)
    if mesh is not None:
        result = {"type": "mesh", "file": _found_mesh(mesh, made_at), "scale": plain(scale)}
    elif box is not None:
        result = {"type": "box", "size": plain(box)}
    elif sphere is not None:
        result = {"type": "sphere", "radius": plain(sphere)}
    elif cylinder is not None:
        radius, height = _several(cylinder, "cylinder", "(radius, height)", made_at)
        result = {"type": "cylinder", "radius": plain(radius), "height": plain(height)}
    elif cone is not None:
        low, high, height = _several(cone, "cone", "(lower radius, upper radius, height)", made_at)
        result = {"type": "cone", "radius": plain(low), "top_radius": plain(high), "height": plain(height), "segments": 64}
    elif shape is not None:
        if not isinstance(shape, dict):
            raise SceneError(f"shape= is {shape!r}", hint='give a dict, as {"type": "sphere", "radius": 0.1}', made_at=made_at)
        result = dict(plain(shape))
        if isinstance(result.get("file"), str) and not result["file"].startswith("="):
            result["file"] = _found_mesh(result["file"], made_at)
    else:
        return None
    if open is not None:
        faces = [open] if isinstance(open, str) else list(open)
        result["open"] = faces
    return {key: value for key, value in result.items() if value is not None}
