"""Scaling and rotation of the shapes of a body, which change their numbers and meshes at once."""
import math
from typing import Any, List

from tandem import geometry
from tandem.entries import SceneError, plain
from tandem.values import axis, has_formula

def finite(value: Any, what: str, example: str) -> float:
    """The number that an argument is; `what` names it, as in "angle of bucket.rotate()"."""
    value = plain(value) if hasattr(value, "tolist") or hasattr(value, "as_json") else value
    if isinstance(value, str) and value.startswith("="):
        raise SceneError(f"{what} is the formula '{value}', but shapes change at once", hint=f"give {example}")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise SceneError(f"{what} is {value!r}, which is no number", hint=f"give {example}")
    if not math.isfinite(value):
        raise SceneError(f"{what} is {value!r}, which is not a finite number", hint=f"give {example}")
    return float(value)


def factor(value: Any, what: str) -> float:
    """A factor along an axis."""
    found = finite(value, what, 'a number such as 1.2; for a parameter write it into the shape, as in box=("=a", 1, 1) or '
                   'shape={"type": "mesh", "file": "bucket.stl", "stretch": ["=a", 1, 1]}')
    if found == 0:
        raise SceneError(f"{what} is 0, which leaves nothing of the shape", hint="give another factor: 1 leaves the shape as it is, -1 mirrors it")
    return found


def vector(value: Any, argument: str, of: str) -> List[float]:
    """Three numbers."""
    value = value.tolist() if hasattr(value, "tolist") else value
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        raise SceneError(f"{argument} of {of} is {value!r}", hint="give three numbers, such as (0, 0, 0.5)")
    return [finite(x, f"{argument}[{k}] of {of}", "a number, such as 0.5") for k, x in enumerate(value)]


def turning_axis(value: Any, of: str) -> List[float]:
    """A direction as a unit vector."""
    found = vector(axis(value), "axis", of)
    if not any(found):
        raise SceneError(f"axis of {of} is {value!r}, which has no direction", hint="give 'x', 'y', 'z' or three numbers, such as (0, 1, 0)")
    return found


def transform(shapes: list, body: str, matrix, point, what: str) -> None:
    """Applies x -> point + matrix (x - point), in the frame of the body, to its shapes; `what` is "scale" or "rotate"."""
    import numpy as np
    for part in shapes:
        shape, name = part["shape"], f"{part['shape']['type']} '{part.get('name', '')}' of body '{body}'"
        if has_formula([part.get("position"), part.get("orientation"), shape]):
            raise SceneError(f"{name} has a formula, and {what}() needs numbers", hint="change the parameter instead, or the formula")
        frame = geometry.rotation(part.get("orientation"))
        here = np.array(part.get("position", [0, 0, 0]), float)
        if "file" in shape:
            unit = geometry.units_of(shape)
            local = (frame.T @ matrix @ frame) * unit / unit[:, None]  # in units of the file
            shape["file"] = geometry.transformed_mesh(shape["file"], local, (frame.T @ (point - here)) / unit)
            continue
        if what == "scale":
            _scale(shape, name, frame.T @ matrix @ frame)
        else:
            part["orientation"] = {"x_axis": plain((matrix @ frame)[:, 0]), "z_axis": plain((matrix @ frame)[:, 2])}
        part["position"] = plain(point + matrix @ (here - point))


def _scale(shape: dict, name: str, matrix) -> None:
    """Scales the numbers of a shape about its origin; the matrix is in the frame of the shape."""
    import numpy as np
    kind, size = shape["type"], abs(float(matrix[0, 0]))
    diagonal = np.allclose(matrix, np.diag(np.diag(matrix)), rtol=0, atol=1e-9 * np.abs(matrix).max())
    # Mirrored or not, these look the same.
    alike = diagonal and np.allclose(np.abs(np.diag(matrix)), size) and kind in ("sphere", "cylinder", "capsule")
    if kind == "box" and diagonal:
        shape["size"] = plain(np.abs(np.diag(matrix)) * np.array(shape["size"], float))
    elif kind == "convex_hull":
        shape["points"] = plain(np.array(shape["points"], float) @ matrix.T)
    elif alike or (kind == "cone" and np.allclose(matrix, size * np.eye(3))):
        for key in ("radius", "top_radius", "height"):
            if key in shape:
                shape[key] *= size
    elif kind in ("sphere", "cylinder", "capsule", "cone"):
        raise SceneError(f"{name} cannot be scaled along one axis", hint="scale it by one factor above 0, or use a mesh")
    elif kind == "box":
        raise SceneError(f"{name} is rotated, so it cannot be scaled along one axis of the body", hint="scale it by one factor, or use a mesh")
    else:
        raise SceneError(f"{name} cannot be scaled", hint="give the shape in the size that it shall have, or use a mesh")
