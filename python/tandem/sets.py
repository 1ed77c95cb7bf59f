"""Motion and loads of a window, and the frames of the results, as a solver sees them."""
import ctypes
import functools
from typing import NamedTuple

import numpy as np

from tandem import layout
from tandem.configuration import GROUND
from tandem.library import Reported, library
from tandem.rotations import matrix

# An array of the library has the same address in most windows; its view is made once.
view = functools.lru_cache(maxsize=64)(layout.view)


class Frame(NamedTuple):
    """Where a body is and how it moves: centre of mass, rotation matrix into the world, velocity, angular velocity."""
    position: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray


_GROUND = Frame(np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))


class MotionSet:
    """The motion of the boundary bodies over a window: `window`, and `bodies`, an array of tandem_body_motion."""
    __slots__ = ("window", "bodies", "_address", "_window")

    def __init__(self, pointer, writeable):
        c = pointer.contents
        self.window, self._address = c.window, c.bodies
        self.bodies = view(c.bodies, c.count, layout.BODY_MOTION, writeable)

    def pose_at(self, row, seconds):
        """Pose and twist of the body of this row, `seconds` after the window's begin: cubic in time, as tandem's own
        particle solver follows it."""
        pose, twist = np.empty((), layout.POSE), np.empty((), layout.TWIST)
        status = library().tandem_pose_at(self._address + row * layout.BODY_MOTION.itemsize,
                                          ctypes.byref(self.window), seconds, pose.ctypes.data, twist.ctypes.data)
        if status:
            raise Reported(status)
        return pose, twist

    def frames(self, seconds):
        """The Frame of each of these bodies, and of GROUND, `seconds` after the window's begin."""
        frames = {GROUND: _GROUND}
        for row, body in enumerate(self.bodies["body"].tolist()):
            pose, twist = self.pose_at(row, seconds)
            frames[body] = Frame(pose["position"], matrix(pose["quaternion"]), twist["velocity"], twist["angular_velocity"])
        return frames

    def set_begin(self, *state):
        """Fills in the begin of the window from arrays of all bodies of the scene: positions, quaternions, velocities
        and angular velocities, and accelerations and angular accelerations where they are known."""
        self._set("begin", *state)

    def set_end(self, *state):
        """The same for the end of the window."""
        self._set("end", *state)

    def _set(self, end, position, quaternion, velocity, spin, acceleration=None, angular_acceleration=None):
        body = self.bodies["body"]
        pose, twist = self.bodies[end + "_pose"], self.bodies[end + "_twist"]
        pose["position"], pose["quaternion"] = position[body], quaternion[body]
        twist["velocity"], twist["angular_velocity"] = velocity[body], spin[body]
        for name, value in (("acceleration", acceleration), ("angular_acceleration", angular_acceleration)):
            if value is not None:
                self.bodies[f"{end}_{name}"] = value[body]

    def set_applied(self, impulse, angular_impulse, work):
        """Fills in what the loads of the window have given to the bodies, from arrays of all bodies of the scene."""
        body = self.bodies["body"]
        applied = self.bodies["applied_impulse"]
        applied["force"], applied["torque"] = impulse[body], angular_impulse[body]
        self.bodies["applied_work"] = work[body]


class LoadSet:
    """The loads over a window: `window`, `account` (tandem_particle_account) and `bodies`, an array of
    tandem_body_load, one of them of GROUND where the ground has walls."""
    __slots__ = ("window", "account", "bodies")

    def __init__(self, pointer, writeable):
        c = pointer.contents
        self.window = c.window
        account = ctypes.addressof(c) + layout.LoadSet.account.offset
        self.account = view(account, 1, layout.PARTICLE_ACCOUNT, writeable)[0]
        self.bodies = view(c.bodies, c.count, layout.BODY_LOAD, writeable)

    def mean(self, count):
        """Mean force and torque on each of the `count` bodies of the scene (count x 3 each); 0 where there is no load."""
        rows = self.bodies[self.bodies["body"] != GROUND]
        force, torque = np.zeros((count, 3)), np.zeros((count, 3))
        force[rows["body"]], torque[rows["body"]] = rows["mean"]["force"], rows["mean"]["torque"]
        return force, torque


class WindowSum:
    """The loads of the steps of a window, summed up to what a load solver returns: the mean, the first moment, the load
    at the end, and the work along the path of the bodies."""

    def __init__(self, loads):
        self.loads, self.length = loads, loads.window.length
        self.rows = {body: row for row, body in enumerate(loads.bodies["body"].tolist())}
        self.impulse, self.moment = np.zeros((2, len(self.rows), 2, 3))
        self.work = np.zeros(len(self.rows))
        self.clear()

    def clear(self):
        """Before the loads of each step."""
        self.load = np.zeros((len(self.rows), 2, 3))

    def add(self, body, point, force):
        """Forces on a body at points of the world relative to its centre of mass (n x 3 each)."""
        load = self.load[self.rows[body]]
        load += force.sum(0), np.cross(point, force).sum(0)

    def step(self, seconds, share, frames):
        """The loads added since clear(), `seconds` after the window's begin, count for `share` [s] of the window."""
        self.impulse += share * self.load
        self.moment += share * (seconds - self.length / 2) * self.load
        for body, row in self.rows.items():
            self.work[row] += share * np.sum(self.load[row] * frames[body][2:])

    def write(self):
        """Into the LoadSet."""
        for name, value in (("mean", self.impulse / self.length), ("first_moment", self.moment / self.length), ("end", self.load)):
            self.loads.bodies[name]["force"], self.loads.bodies[name]["torque"] = value[:, 0], value[:, 1]
        self.loads.bodies["work"] = self.work


class BodiesFrame:
    """For the results: `time` [ns], `bodies` and `joints` of the scene (tandem_body_state, tandem_joint_state), and
    `energy`, kinetic and potential, of bodies and springs [J]; where the solver observes elements, `elements`: the values of
    configuration.element_columns."""

    def __init__(self, pointer):
        c = pointer.contents
        self.time, self.energy = c.time, 0.0
        self.bodies = view(c.bodies, c.body_count, layout.BODY_STATE, True)
        self.joints = view(c.joints, c.joint_count, layout.JOINT_STATE, True)
        self.elements = view(c.elements, c.element_count, np.dtype("f8"), True)

    def set_bodies(self, position, quaternion, velocity, spin):
        """Fills in the bodies from arrays of all bodies of the scene."""
        pose, twist = self.bodies["pose"], self.bodies["twist"]
        pose["position"], pose["quaternion"] = position, quaternion
        twist["velocity"], twist["angular_velocity"] = velocity, spin
