"""What a solver learns of the scene before the first window."""
import ctypes
import json
from types import SimpleNamespace

import numpy as np

from tandem import layout

GROUND = 0xffffffff  # `body` of a wall, or of a load, that belongs to no body
SHAPES = ("plane", "mesh", "cylinder", "sphere")


def _text(address):
    return ctypes.string_at(int(address)).decode()


def _records(address, count, dtype):
    """The elements as objects whose attributes are the fields, with `index` and with the text of `name`."""
    for index, record in enumerate(layout.view(address, count, dtype)):
        fields = SimpleNamespace(index=index)
        for name in dtype.names:
            for inner in [name] if dtype[name].names is None else dtype[name].names:
                value = record[name] if inner == name else record[name][inner]
                setattr(fields, inner, value if value.shape else value.item())
        if "name" in dtype.names:
            fields.name = _text(fields.name)
        yield fields


def _array(address, *shape, dtype="f8"):
    return layout.view(address, int(np.prod(shape)), np.dtype(dtype)).reshape(shape)


class Configuration:
    """The scene, as far as nearly every solver needs it. Arrays lie on memory of the library and may not be written.

    scene            the scene file (dict), with what the attributes below do not contain
    origin           its path, for messages
    solver_options   what the scene has for this solver (dict)
    backend          of a load solver: "auto", "cpu", "cuda"
    threads          0: the solver chooses
    gravity          [m/s2] (3)
    end_time         [s]
    window           length of a window, or of the first one [s]
    micro_step       longest step of the particles or the liquid; 0: the solver chooses [s]
    bodies           list with name, index, mass, inertia (3 x 3, about the centre of mass), position, quaternion,
                     velocity, angular_velocity, is_boundary, is_free
    boundary         indices of the bodies with walls
    joint_count      number of joints; their data are in scene["mbd"]["joints"]
    control_count    number of control inputs
    element_columns  names of the columns of elements.csv
    materials        list with name, index, density, young, poisson
    pairs            list with a, b (indices in materials), restitution, friction, ...; pair(a, b) finds one
    walls            list with name, index, body (or GROUND), material, shape ("plane", "mesh", "cylinder", "sphere"),
                     open, position and quaternion (in the body), point, normal, radius, height, triangles (n x 3 x 3)
    spheres          position, velocity, spin (n x 3), radius, material (n)
    domain_min, domain_max   spheres that leave it are removed and counted; a liquid stays inside [m]
    spacing          of a liquid: edge of the cube that a particle fills at the start [m]
    liquids          list with name, index, density, viscosity, sound_speed (0: the solver chooses), velocity, hydrostatic,
                     boxes (n x 2 x 3: lower and upper corners)
    """

    def __init__(self, c):
        self.scene = json.loads(c.scene)
        self.origin = c.origin.decode()
        self.solver_options = json.loads(c.solver_options)
        self.backend = c.backend.decode()
        for name in ("threads", "end_time", "window", "micro_step", "joint_count", "control_count"):
            setattr(self, name, getattr(c, name))
        self.element_columns = [c.element_columns[i].decode() for i in range(c.element_count)]
        for name in ("gravity", "domain_min", "domain_max"):
            setattr(self, name, np.array(getattr(c, name)))
        self.bodies = list(_records(c.bodies, c.body_count, layout.BODY))
        self.boundary = _array(c.boundary, c.boundary_count, dtype="u4")
        self.materials = list(_records(c.materials, c.material_count, layout.MATERIAL))
        self.pairs = list(_records(c.pairs, c.pair_count, layout.PAIR))
        self.walls = list(_records(c.walls, c.wall_count, layout.WALL))
        for wall in self.walls:
            wall.shape = SHAPES[wall.shape]
            wall.triangles = _array(wall.triangles, wall.triangle_count, 3, 3)
        self.spacing = c.spacing
        self.liquids = list(_records(c.liquids, c.liquid_count, layout.LIQUID))
        for liquid in self.liquids:
            liquid.boxes = _array(liquid.boxes, liquid.box_count, 2, 3)
        n = c.sphere_count
        self.spheres = SimpleNamespace(
            position=_array(c.sphere_position, n, 3), velocity=_array(c.sphere_velocity, n, 3), spin=_array(c.sphere_spin, n, 3),
            radius=_array(c.sphere_radius, n), material=_array(c.sphere_material, n, dtype="u4"))

    def states(self):
        """Positions, quaternions, velocities and angular velocities of all bodies at the start, an array each."""
        return [np.array([getattr(body, name) for body in self.bodies]) for name in
                ("position", "quaternion", "velocity", "angular_velocity")]

    def of_pairs(self, value):
        """A table over two materials of value(pair); not a number where a pair is missing."""
        table = np.full((len(self.materials), len(self.materials)), np.nan)
        for pair in self.pairs:
            table[[pair.a, pair.b], [pair.b, pair.a]] = value(pair)
        return table

    def pair(self, a, b):
        """The constants of the contact of two materials (indices), or None where they never meet."""
        return next((pair for pair in self.pairs if {pair.a, pair.b} == {a, b}), None)
