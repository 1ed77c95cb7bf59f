"""The particles of a scene: materials, walls, fills, sensors. A part of Scene."""
import math
from typing import Any, Optional, Sequence, Union

from tandem import geometry
from tandem.entries import SceneError, calling_line, plain
from tandem.parts import Part, Wall
from tandem.values import Expression, formula, has_formula
from tandem.values import axis as direction


class Grains:
    """Methods of Scene for materials, walls and spheres."""

    def material(self, name: str, *, density: Any = None, young: Any = None, poisson: Any = None, friction: Any = None, restitution: Any = None,
                 rolling_friction: Any = None, **keys: Any) -> Part:
        """A material of spheres and walls: density [kg/m3], Young's modulus [Pa], and per pair of materials the geometric mean of
        friction and restitution; pair() overrides that. `poisson` is 0.25 by default. s.material("glass") takes from the library of
        docs/materials.md what is not given."""
        if rolling_friction is not None:
            self.section("dem").setdefault("rolling", "elastic_plastic")
        if poisson is None and young is not None:
            poisson = 0.25
        return self.add("dem.materials", name=name, density=density, young=young, poisson=poisson, friction=friction,
                        restitution=restitution, rolling_friction=rolling_friction, **keys)

    def pair(self, a: Any, b: Any, **keys: Any) -> Part:
        """Constants of two materials, in place of those that follow from them: friction=, restitution=, ..."""
        return self.add("dem.pairs", a=a, b=b, **keys)

    def wall(self, name: str, *, material: Any, body: Any = None, mesh=None, scale=None, box=None, sphere=None, cylinder=None,
             cone=None, shape: Optional[dict] = None, at: Sequence[Any] = None, orientation: Any = None, open: Union[str, Sequence[str], None] = None,
             **keys: Any) -> Wall:
        """A wall for the particles, on the ground or on a body: mesh= file, box=(x, y, z), sphere=radius, cylinder=(radius, height) about
        z, cone=(lower radius, upper radius, height) about z in 64 flat faces, or shape={...}. `at` and `orientation` are those of the shape, in the frame of the body; `open` lists faces that are left out:
        "+z" or ["+z", "-x"]. surface_velocity=(1, 0, 0) makes it a conveyor belt."""
        found = geometry.shape_of(mesh, scale, box, sphere, cylinder, shape, open, cone=cone)
        if found is None:
            raise SceneError("has no shape", f"wall '{name}'", "give mesh=, box=, sphere=, cylinder=, cone= or shape=")
        return self.add("dem.walls", name=name, body=None if body in (None, "ground") else body, material=material, position=at,
                        orientation=geometry.quaternion(orientation), shape=found, **keys)

    def box(self, name: str, size: Sequence[Any], *, at: Sequence[Any] = (0, 0, 0), material: Any, open: Union[str, Sequence[str], None] = None,
            body: Any = None, orientation: Any = None, **keys: Any) -> Wall:
        """A box as a wall: full edge lengths [m] about `at`; open="+z" leaves the lid out. Spheres may be inside or outside."""
        return self.wall(name, material=material, body=body, box=size, at=at, orientation=orientation, open=open, **keys)

    def plane(self, name: str, *, at: Sequence[Any] = (0, 0, 0), normal: Any = "z", material: Any, **keys: Any) -> Wall:
        """An endless plane through `at`; the normal points out of the solid, to the spheres."""
        return self.wall(name, material=material, shape={"type": "plane", "point": plain(at), "normal": direction(normal)}, **keys)

    def mesh(self, name: str, file: str, *, material: Any, scale: Optional[float] = None, at: Sequence[Any] = None, orientation: Any = None,
             body: Any = None, **keys: Any) -> Wall:
        """A mesh as a wall: STL or OBJ, `scale` is the length of its unit [m]."""
        return self.wall(name, material=material, body=body, mesh=file, scale=scale, at=at, orientation=orientation, **keys)

    def fill(self, region: Any, material: Any, *, radius: Any, height: Optional[float] = None, level: Optional[float] = None,
             mass: Any = None, count: Any = None, settle: Union[bool, dict] = False, name: Optional[str] = None,
             void_fraction: Any = None, velocity: Any = None, seed: Optional[int] = None, fixed: Optional[bool] = None) -> Part:
        """Fills a region with spheres at random places, without overlaps.

        region   a closed wall or its name (a box or cylinder with open faces counts as closed), a shape of a body by its name, a region
                 such as {"type": "above", "wall": "cone"} with a level or {"type": "between", "walls": ["left", "right"]}, or a pair of corners ((x, y, z), (x, y, z))
        radius   [m]: a number, a pair (smallest, largest), or a distribution: td.normal, td.log_normal, td.sieve
        height   [m] of the fill above the lowest point of the wall; or `level` above the world's origin; or `mass` [kg]; or `count`;
                 without any, the region is filled up
        settle   True: the spheres come to rest before the run starts (all of the scene); or {"kinetic_energy": J, "at_most": s}"""
        made_at = calling_line()
        group = name or self._free_group(f"{plain(material)}_spheres")
        where = f"fill of '{group}'"
        region = plain(region)
        if isinstance(region, list) and len(region) == 2:
            region = {"type": "box", "min": region[0], "max": region[1]}
        elif isinstance(region, str):
            if region not in self.shape_names():
                from tandem.entries import nearest
                raise SceneError(f"there is no wall '{region}'" + nearest(region, self.shape_names()), where, made_at=made_at)
            region = {"type": "inside", "wall": region}
        if height is not None:
            if level is not None:
                raise SceneError("height and level are given", where, "give one of them", made_at)
            height = formula(height)
            if not isinstance(height, (int, float, Expression)) or (not isinstance(height, Expression) and not height > 0):
                raise SceneError(f"the height is {height!r}", where, "give m above the lowest point of the region, above 0", made_at)
            level = self._lowest(region, where, made_at) + height
        if not isinstance(settle, (bool, dict)):
            raise SceneError(f"settle is {settle!r}", where, 'give True, False or {"kinetic_energy": 1e-6} [J]', made_at)
        sizes = plain(radius)
        rest = plain(settle) if isinstance(settle, dict) else {"kinetic_energy": self._rest_energy(sizes, material)} if settle else None
        pack = {"type": "packing", "region": region, "level": level, "mass": plain(mass), "count": plain(count),
                "void_fraction": void_fraction, "seed": seed}
        part = self.add("dem.particles", name=group, material=material, fixed=fixed, velocity=velocity,
                        fill={key: value for key, value in pack.items() if value is not None},
                        **({"sizes": sizes} if isinstance(sizes, dict) else {"radius": sizes}))
        if rest is not None:
            self.section("dem")["settle"] = rest
        return part

    def lattice(self, material: Any, low: Sequence[Any], high: Sequence[Any], *, radius: Any, spacing: Any = None, jitter: float = 0.5,
                count: Any = None, name: Optional[str] = None, velocity: Any = None, seed: Optional[int] = None) -> Part:
        """Spheres on a regular lattice in the box from `low` to `high`, displaced a little at random; `spacing` is 2.2 of the largest
        radius by default."""
        radius = plain(radius)
        if spacing is None:
            spacing = 2.2 * formula(radius[-1] if isinstance(radius, list) else radius)  # of the larger one
        fill = {"type": "lattice", "min": plain(low), "max": plain(high), "spacing": plain(spacing),
                "jitter": jitter, "count": plain(count), "seed": seed}
        return self.add("dem.particles", name=name or self._free_group(f"{plain(material)}_spheres"), material=material, radius=radius, velocity=velocity,
                        fill={key: value for key, value in fill.items() if value is not None})

    def inlet(self, name: str, material: Any, low: Sequence[Any], high: Sequence[Any], *, radius: Any, mass_rate: Any = None, rate: Any = None,
              velocity: Any = None, start: Any = None, count: Any = None) -> Part:
        """Spheres that come in during the run, within the box from `low` to `high`: mass_rate [kg/s] or rate [1/s]."""
        fill = {"type": "inlet", "min": low, "max": high, "rate": rate, "mass_rate": mass_rate, "start": start, "count": count}
        return self.add("dem.particles", name=name, material=material, radius=radius, velocity=velocity,
                        fill={key: plain(value) for key, value in fill.items() if value is not None})

    def outlet(self, name: str, *, below: Optional[Any] = None, low: Any = None, high: Any = None, region: Optional[dict] = None) -> Part:
        """Takes spheres out, between windows: all below a height z, or in the box from `low` to `high`, or region={...}."""
        if region is None and below is not None:
            region = {"type": "plane", "point": [0, 0, plain(below)], "normal": [0, 0, -1]}
        elif region is None:
            region = {"type": "box", "min": plain(low), "max": plain(high)}
        return self.add("dem.outlets", name=name, region=region)

    def sensor(self, name: str, *, box: Any = None, cylinder: Any = None, wall: Any = None, at: Any = None, body: Any = None,
               orientation: Any = None, flow: Optional[str] = None) -> Part:
        """Measures the spheres in a box=(x, y, z) or cylinder=(radius, height) about `at`, in the frame of `body`: r["NAME.mass"],
        r["NAME.count"], ...; with flow="z", also r["NAME.flow"] [kg/s] and r["NAME.passed"] [kg] along that axis. With wall=, it measures
        the forces on a wall."""
        shape = geometry.shape_of(box=box, cylinder=cylinder)
        return self.add("dem.sensors", name=name, wall=wall, body=None if body in (None, "ground") else body, position=at,
                        orientation=geometry.quaternion(orientation), shape=shape, flow=flow)

    def domain(self, low: Sequence[Any], high: Sequence[Any], *, periodic: Union[str, Sequence[str], None] = None, follows: Any = None) -> None:
        """The box in which spheres exist: those that leave it are counted as lost. Without it, it is a box around all walls, shapes and
        fills, larger by half its longest edge on each side."""
        box = {"min": plain(low), "max": plain(high), "periodic": list(periodic) if periodic else None, "follows": plain(follows)}
        self.section("dem")["domain"] = {key: value for key, value in box.items() if value is not None}

    def _free_group(self, name: str) -> str:
        taken = {entry.get("name") for entry in self.entries("dem.particles")}
        return next(n for n in [name] + [f"{name}_{k}" for k in range(2, 1000)] if n not in taken)

    def _placed_wall(self, name: str):
        """Shape, position and orientation in the world of a wall of the ground or of a body at the start."""
        import numpy as np
        for wall in self.entries("dem.walls"):
            if wall.get("name") == name:
                body = next((b for b in self.entries("mbd.bodies") if b.get("name") == wall.get("body")), {})
                return self._in_world(wall, body)
        for body in self.entries("mbd.bodies"):
            for shape in body.get("shapes", []):
                if shape.get("name") == name:
                    return self._in_world(shape, body)
        return None, np.zeros(3), np.eye(3)

    @staticmethod
    def _in_world(part: dict, body: dict):
        import numpy as np
        if "relative_to" in body or part.get("relative_to", "ground") != "ground" and body:
            return None, np.zeros(3), np.eye(3)
        frame = geometry.rotation(body.get("orientation"))
        return (part["shape"], np.array(body.get("position", [0, 0, 0]), float) + frame @ np.array(part.get("position", [0, 0, 0]), float),
                frame @ geometry.rotation(part.get("orientation")))

    def _lowest(self, region: dict, where: str, made_at) -> float:
        """Height of the lowest point of a region, against gravity."""
        import numpy as np
        gravity = np.array(self.data.get("gravity", [0, 0, -9.81]), float)
        up = -gravity / np.linalg.norm(gravity)
        if region.get("type") == "box":
            return float(sum(min(a * u, b * u) for a, b, u in zip(region["min"], region["max"], up)))
        shape, position, frame = self._placed_wall(region.get("wall", ""))
        points = geometry.corners(shape) if shape else None
        if points is None:
            raise SceneError("the lowest point of the region is not known", where, "give level= in place of height=", made_at)
        if shape["type"] == "cylinder":
            axis = abs(float(up @ frame[:, 2]))
            return float(up @ position) - shape["height"] / 2 * axis - shape["radius"] * math.sqrt(max(0.0, 1 - axis * axis))
        return float(((position + points @ frame.T) @ up).min())

    def _rest_energy(self, sizes: Any, material: Any) -> Any:
        """A thousandth of the energy of a mean sphere that falls by its radius, at most a twentieth of that of the smallest."""
        density = next((m.get("density") for m in self.entries("dem.materials") if m.get("name") == plain(material)), None)
        gravity = self.data.get("gravity", [0, 0, -9.81])
        if not (isinstance(density, (int, float)) or has_formula(density)) or has_formula([sizes if isinstance(sizes, dict) else 0, gravity]):
            raise SceneError(f"the energy at rest of '{plain(material)}' does not follow: density, distribution of sizes or gravity is no number",
                             hint='give settle={"kinetic_energy": 1e-6} [J]')
        if isinstance(sizes, dict):
            listed = sizes.get("radius") or [size / 2 for size in sizes.get("size", [])[1:]] or [0]
            small = sizes.get("min", min(listed))
            mean = sizes.get("mean", sizes.get("median", small))
        elif isinstance(sizes, list):
            small, mean = sizes[0], (formula(sizes[0]) + formula(sizes[-1])) / 2
        else:
            small = mean = sizes
        g = math.sqrt(sum(x * x for x in gravity))
        if has_formula([density, small]) or isinstance(mean, Expression):
            of = [f"{share * 4 / 3 * math.pi * g:.6g}*({_term(density)})*({_term(r)})^4" for share, r in ((1e-3, mean), (.05, small))]
            return f"=min({', '.join(of)})"
        energy = [density * 4 / 3 * math.pi * r ** 3 * g * r for r in (mean, small)]
        return float(f"{min(1e-3 * energy[0], 0.05 * energy[1]):.3g}")

    def _automatic_domain(self) -> dict:
        """A box around all that is there, larger by half its longest edge on each side."""
        import numpy as np
        boxes = []
        bodies = {b.get("name"): b for b in self.entries("mbd.bodies")}
        parts = [(wall, bodies.get(wall.get("body"), {})) for wall in self.entries("dem.walls")]
        parts += [(shape, body) for body in bodies.values() for shape in body.get("shapes", [])]
        for part, body in parts:
            if part.get("shape", {}).get("type") != "plane" and has_formula([part.get("shape"), part.get("position"), part.get("orientation"), body.get("position"), body.get("orientation")]):
                self._no_domain(f"'{part.get('name', '')}' has a formula")
            try:
                shape, position, frame = self._in_world(part, body)
                points = geometry.corners(shape) if shape else None
            except (TypeError, ValueError):
                points = None
            if points is not None:
                placed = position + points @ frame.T
                boxes += [placed.min(axis=0), placed.max(axis=0)]
        for group in self.entries("dem.particles"):
            fill = group.get("fill", {})
            region = fill.get("region", fill)
            if has_formula([region.get("min"), region.get("max")]):
                self._no_domain(f"the region of '{group.get('name', '')}' has a formula")
            boxes += [np.array(region[key], float) for key in ("min", "max") if len(region.get(key, [])) == 3]
        if not boxes:
            self._no_domain("there is no wall, shape or region of a known size")
        low, high = np.min(boxes, axis=0), np.max(boxes, axis=0)
        margin = 0.5 * float((high - low).max())
        return {"min": plain((low - margin).round(6)), "max": plain((high + margin).round(6))}

    @staticmethod
    def _no_domain(why: str) -> None:
        raise SceneError(f"the domain does not follow from the scene: {why}", "dem.domain", "give it: s.domain(low, high), also in formulas")


def _term(value: Any) -> str:
    """Part of a formula."""
    return formula(value).text if isinstance(formula(value), Expression) else repr(value)
