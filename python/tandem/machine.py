"""The machine of a scene: bodies, joints, drives, springs. A part of Scene."""
from typing import Any, Optional, Sequence

from tandem import geometry
from tandem.entries import Entry, SceneError, calling_line, plain
from tandem.parts import Body, Drive, Joint, Part
from tandem.schema import expect_keys
from tandem.values import axis as direction
from tandem.values import function_of_time


class Machine:
    """Methods of Scene for bodies, joints, drives and forces."""

    def body(self, name: str, mass: Optional[Any] = None, inertia: Optional[Sequence[Any]] = None, *, at: Sequence[Any] = (0, 0, 0),
             orientation: Any = None, mesh: Optional[str] = None, scale: Optional[float] = None, box: Optional[Sequence[Any]] = None,
             sphere: Optional[Any] = None, cylinder: Optional[Sequence[Any]] = None, shape: Optional[dict] = None,
             density: Optional[float] = None, velocity: Optional[Sequence[Any]] = None,
             angular_velocity: Optional[Sequence[Any]] = None, **keys: Any) -> Body:
        """A rigid body.

        mass, inertia  [kg], [kg m2]: numbers; inertia is (xx, yy, zz) or (xx, yy, zz, xy, xz, yz) about the centre of mass, which `at` is
        mesh           STL or OBJ file, `scale` is the length of its unit (1e-3 for mm); or box=(x, y, z), sphere=radius,
                       cylinder=(radius, height) about z, or shape={...} as in docs/scene_format.md. Mass, centre and inertia then follow
                       from `density` [kg/m3], or from `mass`; `at` is the origin of the shape
        orientation    quaternion (w, x, y, z), ("y", angle in rad), or a dict such as {"euler_deg": [0, 20, 0], "order": "xyz"}
        velocity, angular_velocity   of a free body, in the world

        The shape is seen and touches nothing: body.wall(material) makes it a wall for the particles, body.contact(surface) lets it
        touch other bodies. Without a joint the body is free."""
        made_at = calling_line()
        found = geometry.shape_of(mesh, scale, box, sphere, cylinder, shape, made_at=made_at)
        where = f"body '{name}'"
        expect_keys("body", keys, where, made_at)
        if isinstance(mass, (int, float)) and not mass > 0:
            raise SceneError(f"the mass is {mass!r}", where, "give kg above 0", made_at)
        if found is None and (mass is None or inertia is None):
            raise SceneError("has neither mass and inertia nor a shape", where, "give mass= and inertia=, or a shape such as mesh= or box= "
                             "with density=", made_at)
        shapes = None
        if found is not None:
            if inertia is None and mass is not None:
                solid = geometry.volume(found)
                if not solid or not isinstance(mass, (int, float)):
                    raise SceneError("the density does not follow from mass and shape", where, "give density=, or inertia=", made_at)
                density = float(f"{mass / solid:.15g}")  # 2 kg in 0.0025 m3 read as 800 kg/m3
            elif inertia is None and density is None:
                raise SceneError("has a shape, but no mass", where, "give density= or mass=", made_at)
            shapes = [Entry({"name": name, "use": "graphics", "shape": found}, made_at=made_at)]
            if inertia is None:
                mass = "from_shapes"
                shapes[0]["density"] = plain(density)
        return self.add("mbd.bodies", name=name, mass=mass, inertia=inertia, position=at, orientation=geometry.quaternion(orientation),
                        velocity=velocity, angular_velocity=angular_velocity, shapes=shapes, **keys)

    def _joint(self, kind: str, name: str, parent: Any, child: Any, keys: dict) -> Joint:
        if keys.get("motion") is not None:
            keys["motion"] = function_of_time(keys["motion"])
        parent = plain(parent)
        return self.add("mbd.joints", name=name, type=kind, parent=None if parent == "ground" else parent, child=child, **keys)

    def revolute(self, name: str, parent: Any, child: Any, *, at: Sequence[Any], axis: Any, motion: Any = None,
                 damping: Optional[Any] = None, rate: Optional[Any] = None, **keys: Any) -> Joint:
        """A hinge between `parent` (a body or "ground") and `child`, at a point and about an axis of the world: "y" or three numbers.
        motion prescribes the angle [rad] over time; damping [N m s/rad]; rate [rad/s] at the start; also limits={...}, friction={...}."""
        return self._joint("revolute", name, parent, child, dict(position=at, axis=direction(axis), motion=motion, damping=damping,
                                                                 rate=rate, **keys))

    def prismatic(self, name: str, parent: Any, child: Any, *, at: Sequence[Any] = (0, 0, 0), axis: Any, motion: Any = None,
                  damping: Optional[Any] = None, rate: Optional[Any] = None, **keys: Any) -> Joint:
        """A slide along `axis`; motion [m], damping [N s/m], rate [m/s]; also limits={...}, friction={...}."""
        return self._joint("prismatic", name, parent, child, dict(position=at, axis=direction(axis), motion=motion, damping=damping,
                                                                  rate=rate, **keys))

    def fixed(self, name: str, parent: Any, child: Any, *, at: Sequence[Any] = (0, 0, 0), **keys: Any) -> Joint:
        """Ties `child` to `parent`."""
        return self._joint("fixed", name, parent, child, dict(position=at, **keys))

    def spherical(self, name: str, parent: Any, child: Any, *, at: Sequence[Any], damping: Optional[Any] = None, **keys: Any) -> Joint:
        """A ball joint at a point."""
        return self._joint("spherical", name, parent, child, dict(position=at, damping=damping, **keys))

    def cylindrical(self, name: str, parent: Any, child: Any, *, at: Sequence[Any], axis: Any, **keys: Any) -> Joint:
        """Rotation about an axis and translation along it."""
        return self._joint("cylindrical", name, parent, child, dict(position=at, axis=direction(axis), **keys))

    def universal(self, name: str, parent: Any, child: Any, *, at: Sequence[Any], axis: Any, axis2: Any, **keys: Any) -> Joint:
        """Rotation about `axis` of the parent and `axis2` of the child, which are perpendicular."""
        return self._joint("universal", name, parent, child, dict(position=at, axis=direction(axis), axis2=direction(axis2), **keys))

    def planar(self, name: str, parent: Any, child: Any, *, at: Sequence[Any], axis: Any, **keys: Any) -> Joint:
        """Translation in the plane across `axis`, and rotation about it."""
        return self._joint("planar", name, parent, child, dict(position=at, axis=direction(axis), **keys))

    def cylinder(self, name: str, body_a: Any, body_b: Any, *, a: Sequence[Any], b: Sequence[Any], max_force: Optional[Any] = None,
                 gains: Optional[dict] = None, input: Optional[str] = None, **keys: Any) -> Drive:
        """A linear drive between point `a` of body_a and point `b` of body_b, in the world at the start. Set what it does afterwards:
        lift.stroke = td.table([0, 1], [0, 0.1]) [m], lift.force = 500 [N], or lift.valve with hydraulics={...}.

        max_force  [N], of a controlled stroke
        gains      {"proportional": N/m, "integral": N/(m s), "derivative": N s/m}; by default all of max_force at an error of 2 mm, and
                   a derivative of 20 ms
        input      name of a control input: a controller gives the stroke, or the force where there is neither max_force nor gains

        r["lift.force"], r["lift.stroke"], r["lift.power"], r["lift.energy"] are its results."""
        drive = self.add("mbd.forces", name=name, type="cylinder", body_a=None if plain(body_a) == "ground" else body_a, body_b=body_b,
                         point_a=a, point_b=b, control="force", max_force=max_force, gains=gains, **keys)
        target = 0 if input is None else input
        if max_force is not None or gains is not None:  # which only a controlled stroke has
            drive.stroke = target
        else:
            drive.force = target
        return drive

    def motor(self, name: str, joint: Any, *, max_torque: Optional[Any] = None, gains: Optional[dict] = None, **keys: Any) -> Drive:
        """A motor on a revolute joint. Set what it does afterwards: motor.speed = 3 [rad/s], motor.position [rad], or motor.throttle with
        torque_speed={"arguments": [...], "values": [...]}; the value is a number, a function of time, or the name of a control input.

        max_torque  [N m];  gains  as of docs/scene_format.md, by default all of max_torque at 0.1 rad/s or 0.02 rad;  gear_ratio,
        rotor_inertia, brake as there. r["NAME.torque"], r["NAME.power"], r["NAME.energy"] are its results."""
        drive = self.add("mbd.forces", name=name, type="motor", joint=joint, max_torque=max_torque, gains=gains, control="throttle"
                         if max_torque is None else "speed", **keys)
        if max_torque is not None:
            drive.speed = 0
        return drive

    def actuator(self, name: str, joint: Any, *, size: Any = None, input: Optional[str] = None, **keys: Any) -> Drive:
        """A torque [N m] or force [N] on the coordinate of a joint: `size` is a number or a function of time, `input` the name of a
        control input that a controller gives."""
        if (size is None) == (input is None):
            raise SceneError("needs size= or input=", f"actuator '{name}'")
        return self.add("mbd.forces", name=name, type="actuator", joint=joint, input=input,
                        size=None if size is None else function_of_time(size), **keys)

    def spring(self, name: str, body_a: Any, body_b: Any, *, a: Sequence[Any], b: Sequence[Any], length: Any, stiffness: Any = 0,
               damping: Any = 0, **keys: Any) -> Part:
        """A spring and damper between two points: free length [m], stiffness [N/m], damping [N s/m]."""
        return self.add("mbd.forces", name=name, type="spring_damper", body_a=None if plain(body_a) == "ground" else body_a, body_b=body_b,
                        point_a=a, point_b=b, length=length, stiffness=stiffness, damping=damping, **keys)

    def rotational_spring(self, name: str, joint: Any, *, stiffness: Any = 0, damping: Any = 0, angle: Any = 0, **keys: Any) -> Part:
        """A torque on a revolute joint: stiffness [N m/rad] from `angle` [rad], damping [N m s/rad]."""
        return self.add("mbd.forces", name=name, type="rotational_spring_damper", joint=joint, stiffness=stiffness, damping=damping,
                        angle=angle, **keys)

    def force(self, name: str, body: Any, *, at: Sequence[Any], direction: Any, size: Any, **keys: Any) -> Part:
        """A force [N] on a point of a body, given in the world at the start; `size` is a number or a function of time."""
        from tandem.values import axis
        return self.add("mbd.forces", name=name, type="force", body=body, point=at, direction=axis(direction), size=function_of_time(size),
                        **keys)

    def gear(self, name: str, joint_a: Any, joint_b: Any, ratio: Any, kind: str = "gear") -> Part:
        """Couples two joints, q_b = ratio q_a; `kind` is "gear", "belt" or "rack_and_pinion"."""
        return self.add("mbd.couplers", name=name, type=kind, joint_a=joint_a, joint_b=joint_b, ratio=ratio)

    def surface(self, name: str, *, stiffness: Any = None, restitution: Any = 0.3, friction: Any = 0.4, **keys: Any) -> Part:
        """A material of contacts between bodies, for body.contact(surface) and Scene.ground_contact(): stiffness [N/m] of one point, or
        young= and poisson= for spheres (docs/body_contact.md)."""
        return self.add("mbd.contact.materials", name=name, stiffness=stiffness, restitution=restitution, friction=friction, **keys)

    def ground_contact(self, name: str, surface: Any, *, mesh=None, scale=None, box=None, sphere=None, cylinder=None, shape=None,
                       plane: Optional[Any] = None, at: Sequence[Any] = (0, 0, 0), orientation: Any = None) -> Part:
        """A shape of the ground that bodies touch; plane="z" is the floor through `at`."""
        if plane is not None:
            return self.add("mbd.contact.ground", name=name, material=surface,
                            shape={"type": "plane", "point": plain(at), "normal": direction(plane)})
        found = geometry.shape_of(mesh, scale, box, sphere, cylinder, shape)
        return self.add("mbd.contact.ground", name=name, material=surface, position=at, orientation=geometry.quaternion(orientation),
                        shape=found)

    def observe(self, *columns: str) -> None:
        """Columns of the results that a controller gets before each window: s.observe("hinge.q", "hinge.rate")."""
        self.section("mbd").setdefault("sensors", [])
        self.section("mbd")["sensors"] += [column for column in columns if column not in self.section("mbd")["sensors"]]
