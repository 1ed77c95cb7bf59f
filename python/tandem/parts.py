"""The objects of a scene: views on its JSON, which print as that JSON."""
import copy
from typing import Any, List, Optional

from tandem import geometry, reshaping
from tandem.entries import Entry, NoSuchName, SceneError, calling_line, nearest, plain, text_of
from tandem.schema import keys_of
from tandem.values import Expression, formula, function_of_time


class Part:
    """One object of a scene: a body, joint, drive, wall, material, group of spheres, sensor, ...

    Its keys are those of the scene format (docs/scene_format.md), as items and as attributes: part["friction"] = 0.5 and
    part.friction = 0.5 do the same, a key that there is not is refused with the nearest one, and del part["friction"] removes it.
    print(part) shows the JSON.
    """

    def __init__(self, scene, entry: Entry, kind: str):
        object.__setattr__(self, "scene", scene)
        object.__setattr__(self, "entry", entry)
        object.__setattr__(self, "kind", kind)

    @property
    def name(self) -> str:
        """Its name in the scene."""
        return self.entry.get("name", "")

    @property
    def made_at(self) -> Optional[str]:
        """FILE:LINE of the Python that made it."""
        return self.entry.made_at

    def as_json(self) -> str:
        return self.name

    def _expect(self, key: str) -> None:
        known = keys_of(self.kind)
        if known is not None and key not in known:
            raise SceneError(f"{self.kind.replace('_', ' ')} '{self.name}' has no key '{key}'" + nearest(key, known))

    def __getitem__(self, key: str) -> Any:
        if key not in self.entry:
            self._expect(key)
            raise NoSuchName(f"'{key}' of '{self.name}' is not given")
        return self.entry[key]

    def __setitem__(self, key: str, value: Any) -> None:
        self._expect(key)
        self.entry[key] = copy.deepcopy(plain(value))

    def __delitem__(self, key: str) -> None:
        if key not in self.entry:
            raise NoSuchName(f"'{key}' of '{self.name}' is not given" + nearest(key, self.entry))
        del self.entry[key]

    def __contains__(self, key: str) -> bool:
        return key in self.entry

    def __getattr__(self, key: str) -> Any:
        if key.startswith("_"):
            raise AttributeError(key)
        if key in self.entry:
            return self.entry[key]
        raise AttributeError(f"'{key}' of '{self.name}' is not given" +
                             ("" if key in (keys_of(self.kind) or [key]) else ", and is no key" + nearest(key, keys_of(self.kind) or [])))

    def __setattr__(self, key: str, value: Any) -> None:
        if isinstance(getattr(type(self), key, None), property):
            return object.__setattr__(self, key, value)
        self[key] = value

    def __eq__(self, other: Any) -> bool:
        return isinstance(other, Part) and self.entry is other.entry

    def __hash__(self) -> int:
        return id(self.entry)

    def __str__(self) -> str:
        return text_of(self.entry)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self}>"


class Body(Part):
    """A rigid body. Scene.body() makes it."""

    def wall(self, material: Any = None, name: Optional[str] = None, *, mesh=None, scale=None, box=None, sphere=None, cylinder=None,
             shape=None, at=None, orientation=None, open=None, density: Optional[float] = None) -> "Body":
        """Makes the body touch the particles: without a shape, all its shapes that are graphics become walls of this material;
        with one (as in Scene.body), it is added, without mass unless `density` is given. Returns the body."""
        return self._use("wall", material, name, dict(mesh=mesh, scale=scale, box=box, sphere=sphere, cylinder=cylinder, shape=shape,
                                                      open=open), at, orientation, density)

    def contact(self, material: Any = None, name: Optional[str] = None, *, mesh=None, scale=None, box=None, sphere=None, cylinder=None,
                shape=None, at=None, orientation=None, density: Optional[float] = None) -> "Body":
        """Makes the body touch other bodies; as wall(), but each shape is added as a shape of contact besides what it is, and
        `material` is one of Scene.surface(). Returns the body."""
        return self._use("contact", material, name, dict(mesh=mesh, scale=scale, box=box, sphere=sphere, cylinder=cylinder, shape=shape),
                         at, orientation, density)

    def show(self, name: Optional[str] = None, *, mesh=None, scale=None, box=None, sphere=None, cylinder=None, shape=None, at=None,
             orientation=None, density: Optional[float] = None) -> "Body":
        """Adds a shape that is seen, and has a mass if `density` is given, but touches nothing. Returns the body."""
        return self._use("graphics", None, name, dict(mesh=mesh, scale=scale, box=box, sphere=sphere, cylinder=cylinder, shape=shape),
                         at, orientation, density)

    def _use(self, use, material, name, given, at, orientation, density) -> "Body":
        shape = geometry.shape_of(**given)
        shapes: List[Entry] = self.entry.setdefault("shapes", [])
        made_at = calling_line()
        shaped = self.entry.get("mass") == "from_shapes"
        density = 0 if density is None and shaped else density
        if use != "graphics" and material is None:
            raise SceneError(f"{use}() of '{self.name}' needs a material", hint=f"give material=, as in {self.name}.{use}(material=steel)")
        if shape is None:
            mine = [s for s in shapes if s.get("use") == "graphics"] if use == "wall" else list(shapes)
            if not mine:
                raise SceneError(f"body '{self.name}' has no shape that could become a {use}",
                                 hint="give mesh=, box=, sphere=, cylinder= or shape=")
            for old in mine:
                if use == "wall":
                    old.update(use="wall", material=plain(material))
                else:
                    new = copy.deepcopy(old)
                    new.update({"density": 0} if shaped else {}, use=use, material=plain(material), name=self._free_name(f"{old['name']}_contact"))
                    shapes.append(new)
            return self
        entry = {"name": name or self._free_name(self.name), "use": use, "material": plain(material), "density": density,
                 "position": plain(at), "orientation": geometry.quaternion(orientation), "shape": shape}
        shapes.append(Entry({k: v for k, v in entry.items() if v is not None}, made_at=made_at))
        return self

    def _free_name(self, name: str) -> str:
        taken = set(self.scene.shape_names())
        return next(n for n in [name] + [f"{name}_{k}" for k in range(2, 100000)] if n not in taken)

    def _pivot(self, what: str):
        """The point of the joint that carries the body, in its frame; without one, the middle of its shapes."""
        import numpy as np
        joint = next((j for j in self.scene.entries("mbd.joints") if j.get("child") == self.name and "position" in j), None)
        try:
            if joint is not None and "relative_to" not in joint and "relative_to" not in self.entry:
                offset = np.array(joint["position"], float) - np.array(self.entry.get("position", [0, 0, 0]), float)
                return geometry.rotation(self.entry.get("orientation")).T @ offset
        except (TypeError, ValueError):  # formulas
            raise SceneError(f"the point that {self.name}.{what}() keeps does not follow: body or joint '{joint['name']}' has a formula for its place",
                             hint="give about=, a point in the frame of the body that stays") from None
        boxes = [geometry.bounds_in(s["shape"], s.get("position"), s.get("orientation")) for s in self.entry.get("shapes", [])]
        boxes = [b for b in boxes if b is not None]
        return sum(low + high for low, high in boxes) / (2 * len(boxes)) if boxes else np.zeros(3)

    def scale(self, factor: float = 1, *, x: float = 1, y: float = 1, z: float = 1, about=None) -> "Body":
        """Scales the shapes of the body along the axes of its frame: bucket.scale(y=1.2). `about` is the point, in the frame of the
        body, that stays; by default that of the joint that carries the body. The mass follows where it comes from shapes. Boxes
        that are rotated, spheres, cylinders, capsules and cones are scaled by one factor only. Returns the body."""
        import numpy as np
        factors = [reshaping.factor(value, f"{key} of {self.name}.scale()") for key, value in (("factor", factor), ("x", x), ("y", y), ("z", z))]
        return self._transform(np.diag([factors[0] * each for each in factors[1:]]), about, "scale")

    def rotate(self, about_axis: Any, angle: float, *, about=None) -> "Body":
        """Rotates the shapes of the body by an angle [rad] (td.deg(10) is ten degrees) about an axis of its frame through the point
        `about`, as in scale(). Joints and drives stay where they are. Returns the body."""
        turn = {"axis": reshaping.turning_axis(about_axis, f"{self.name}.rotate()"),
                "angle": reshaping.finite(angle, f"angle of {self.name}.rotate()", "a number, such as td.deg(10)")}
        return self._transform(geometry.rotation(turn), about, "rotate")

    def _transform(self, matrix, about, what) -> "Body":
        import numpy as np
        shapes = self.entry.get("shapes")
        if not shapes:
            raise SceneError(f"body '{self.name}' has no shapes to {what}")
        point = self._pivot(what) if about is None else np.array(reshaping.vector(about, "about", f"{self.name}.{what}()"))
        changed = copy.deepcopy(shapes)  # all shapes or none
        reshaping.transform(changed, self.name, matrix, point, what)
        for old, new in zip(shapes, changed):
            old.update(new)
        return self


class Joint(Part):
    """A joint. Its coordinate is r["NAME.q"] of the results, its rate r["NAME.rate"]."""

    @property
    def motion(self):
        """Prescribed coordinate: a function of time, such as td.table([0, 1], [0, 0.5])."""
        return self.entry.get("motion")

    @motion.setter
    def motion(self, value):
        self.entry["motion"] = function_of_time(value)


class Drive(Part):
    """A cylinder, motor or actuator. What it controls is set by one of `stroke`, `force`, `valve` (cylinders), `speed`, `position`,
    `throttle` (motors), `size` (actuators): a number, or a function of time such as td.table(times, values); or `input`, the name of a
    control input, which a controller then gives in each window."""

    def _control(self, control: str, value: Any) -> None:
        if value is None:
            raise SceneError(f"{control} of '{self.name}' is None", hint="give a number, a function of time or the name of a control input")
        if isinstance(value, str) and not value.startswith("="):
            self.entry["input"] = value
            self.entry.pop("target", None)
        else:
            self.entry["target"] = function_of_time(value)
            self.entry.pop("input", None)
        self.entry["control"] = control
        if control in ("stroke", "speed", "position") and "gains" not in self.entry:
            self._default_gains(control)

    def _default_gains(self, control: str) -> None:
        limit = self.entry.get("max_force", self.entry.get("max_torque"))
        if limit is None:
            if "torque_speed" in self.entry:
                limit = max(self.entry["torque_speed"]["values"]) * self.entry.get("gear_ratio", 1)
            else:
                raise SceneError(f"'{self.name}' has neither gains nor a largest force or torque, from which they would follow",
                                 hint="give max_force= or max_torque=, or gains={\"proportional\": ..., \"derivative\": ...}")
        limit = formula(limit)
        if not isinstance(limit, Expression) and (not isinstance(limit, (int, float)) or not limit > 0):
            raise SceneError(f"the gains of '{self.name}' do not follow: its largest force or torque is {limit!r}",
                             hint="give a number above 0, or gains={\"proportional\": ..., \"derivative\": ...}")
        if control == "stroke":  # all of the force at an error of 2 mm; the rate counts as the error 20 ms later
            self.entry["gains"] = plain({"proportional": limit / 2e-3, "derivative": limit / 2e-3 * 0.02})
        elif control == "position":  # all of the torque at 0.02 rad
            self.entry["gains"] = plain({"proportional": limit / 0.02, "derivative": limit / 0.02 * 0.02})
        else:  # all of the torque at 0.1 rad/s
            self.entry["gains"] = plain({"proportional": limit / 0.1})


def _control_property(name: str, text: str) -> property:
    def get(self):
        return self.entry.get("target", self.entry.get("input")) if self.entry.get("control") == name else None

    return property(get, lambda self, value: self._control(name, value), doc=text)


for _name, _text in (("stroke", "Target of a cylinder's length less that at the start [m]."),
                     ("force", "Force of a cylinder [N], which pushes its ends apart."),
                     ("valve", "Opening of a hydraulic cylinder's valve, -1 to 1."),
                     ("speed", "Target of a motor's joint rate [rad/s]."),
                     ("position", "Target of a motor's joint coordinate [rad]."),
                     ("throttle", "Share of a motor's torque curve, -1 to 1.")):
    setattr(Drive, _name, _control_property(_name, _text))


def _set_size(self, value):
    self.entry["size"] = function_of_time(value)
    self.entry.pop("input", None)


Drive.size = property(lambda self: self.entry.get("size"), _set_size, doc="Torque [N m] or force [N] of an actuator over time.")


class Wall(Part):
    """A wall for the particles. Scene.box(), Scene.plane(), Scene.mesh() and Scene.wall() make it."""
