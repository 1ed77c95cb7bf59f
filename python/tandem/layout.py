"""The records of tandem/participant.h, as numpy and as ctypes see them.

The numpy types lie on arrays of the library without copies; a test compares them with the C header.
"""
import ctypes

import numpy as np
from ctypes import c_char_p, c_double, c_int, c_int64, c_size_t, c_uint32, c_uint64, c_void_p

VECTOR = ("f8", 3)

POSE = np.dtype([("position", *VECTOR), ("quaternion", "f8", 4)])
TWIST = np.dtype([("velocity", *VECTOR), ("angular_velocity", *VECTOR)])
WRENCH = np.dtype([("force", *VECTOR), ("torque", *VECTOR)])
BODY_MOTION = np.dtype([
    ("body", "u4"), ("reserved", "u4"), ("begin_pose", POSE), ("end_pose", POSE), ("begin_twist", TWIST),
    ("end_twist", TWIST), ("begin_acceleration", *VECTOR), ("end_acceleration", *VECTOR),
    ("begin_angular_acceleration", *VECTOR), ("end_angular_acceleration", *VECTOR),
    ("applied_impulse", WRENCH), ("applied_work", "f8")])
BODY_LOAD = np.dtype([
    ("body", "u4"), ("reserved", "u4"), ("mean", WRENCH), ("first_moment", WRENCH), ("end", WRENCH), ("work", "f8")])
BODY_TANGENT = np.dtype([("body", "u4"), ("reserved", "u4"), ("stiffness", "f8", (6, 6)), ("damping", "f8", (6, 6))])
BODY_RESPONSE = np.dtype([("body", "u4"), ("reserved", "u4"), ("time", "f8"), ("impulse", "f8", (6, 6))])
PARTICLE_ACCOUNT = np.dtype([
    ("micro_steps", "u8"), ("micro_step", "f8"), ("momentum_begin", *VECTOR), ("momentum_end", *VECTOR),
    ("gravity_impulse", *VECTOR), ("lost_momentum", *VECTOR), ("kinetic_energy", "f8"),
    ("largest_overlap_ratio", "f8"), ("lost_particles", "u8"), ("contacts", "u8"), ("neighbour_list_builds", "u8")])
BODY_STATE = np.dtype([("body", "u4"), ("reserved", "u4"), ("pose", POSE), ("twist", TWIST)])
JOINT_STATE = np.dtype([
    ("joint", "u4"), ("undetermined", "u4"), ("coordinate", "f8"), ("rate", "f8"), ("reaction", WRENCH)])

# Elements of the configuration: `name` is a pointer to text.
BODY = np.dtype([
    ("name", "u8"), ("mass", "f8"), ("inertia", "f8", (3, 3)), ("pose", POSE), ("twist", TWIST), ("is_boundary", "u4"),
    ("is_free", "u4")])
MATERIAL = np.dtype([("name", "u8"), ("density", "f8"), ("young", "f8"), ("poisson", "f8")])
PAIR = np.dtype([
    ("a", "u4"), ("b", "u4"), ("restitution", "f8"), ("friction", "f8"), ("rolling_friction", "f8"),
    ("rolling_damping", "f8"), ("spring_stiffness", "f8"), ("spring_ratio", "f8"), ("work_of_adhesion", "f8"),
    ("cohesion_energy_density", "f8"), ("normal_stiffness", "f8"), ("normal_damping", "f8"),
    ("tangential_stiffness", "f8"), ("tangential_damping", "f8")])
LIQUID = np.dtype([
    ("name", "u8"), ("density", "f8"), ("viscosity", "f8"), ("sound_speed", "f8"), ("velocity", *VECTOR),
    ("hydrostatic", "u4"), ("reserved", "u4"), ("box_count", "u8"), ("boxes", "u8")])
WALL = np.dtype([
    ("name", "u8"), ("body", "u4"), ("material", "u4"), ("shape", "u4"), ("open", "u4"), ("pose", POSE),
    ("point", *VECTOR), ("normal", *VECTOR), ("radius", "f8"), ("height", "f8"), ("triangle_count", "u8"),
    ("triangles", "u8")])


class Window(ctypes.Structure):
    """A window of the coupling: `index` counts accepted windows; `begin` and `end` are in ns since the start."""
    _fields_ = [("index", c_uint64), ("begin", c_int64), ("end", c_int64)]

    @property
    def length(self):
        """In seconds."""
        return (self.end - self.begin) * 1e-9


Account = ctypes.c_byte * PARTICLE_ACCOUNT.itemsize


class MotionSet(ctypes.Structure):
    _fields_ = [("window", Window), ("count", c_size_t), ("bodies", c_void_p)]


class LoadSet(ctypes.Structure):
    # The account is 8-byte aligned, as the window before it is.
    _fields_ = [("window", Window), ("account", Account), ("count", c_size_t), ("bodies", c_void_p)]


class TangentSet(ctypes.Structure):
    _fields_ = [("time", c_int64), ("count", c_size_t), ("bodies", c_void_p), ("response_count", c_size_t),
                ("responses", c_void_p)]


class BodiesFrame(ctypes.Structure):
    _fields_ = [("time", c_int64), ("body_count", c_size_t), ("joint_count", c_size_t), ("bodies", c_void_p),
                ("joints", c_void_p), ("energy", c_double), ("element_count", c_size_t), ("elements", c_void_p)]


class ParticlesFrame(ctypes.Structure):
    _fields_ = [("time", c_int64), ("count", c_size_t), ("id", c_void_p), ("position", c_void_p),
                ("velocity", c_void_p), ("spin", c_void_p), ("radius", c_void_p), ("pressure", c_void_p),
                ("density", c_void_p)]


class ControlSet(ctypes.Structure):
    _fields_ = [("time", c_int64), ("count", c_size_t), ("values", c_void_p)]


class StateFile(ctypes.Structure):
    _fields_ = [("windows", c_uint64), ("time", c_int64), ("path", c_char_p)]


class Configuration(ctypes.Structure):
    _fields_ = [
        ("scene", c_char_p), ("origin", c_char_p), ("solver_options", c_char_p), ("backend", c_char_p),
        ("threads", c_uint32), ("reserved", c_uint32), ("gravity", c_double * 3), ("end_time", c_double),
        ("window", c_double), ("micro_step", c_double), ("body_count", c_size_t), ("bodies", c_void_p),
        ("joint_count", c_size_t), ("boundary_count", c_size_t), ("boundary", c_void_p), ("material_count", c_size_t),
        ("materials", c_void_p), ("pair_count", c_size_t), ("pairs", c_void_p), ("wall_count", c_size_t),
        ("walls", c_void_p), ("sphere_count", c_size_t), ("sphere_position", c_void_p), ("sphere_velocity", c_void_p),
        ("sphere_radius", c_void_p), ("sphere_material", c_void_p), ("domain_min", c_double * 3),
        ("domain_max", c_double * 3), ("control_count", c_size_t), ("element_count", c_size_t),
        ("element_columns", ctypes.POINTER(c_char_p)), ("sphere_spin", c_void_p), ("spacing", c_double),
        ("liquid_count", c_size_t), ("liquids", c_void_p)]


def _function(*arguments):
    return ctypes.CFUNCTYPE(c_int, c_void_p, *arguments)


_P = ctypes.POINTER
_NOTHING = _function()
_REPORT = _function(c_void_p)
_FILE = _function(_P(StateFile))


class MotionTable(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t), ("capabilities", c_uint64), ("features", _P(c_char_p)),
        ("configure", _function(_P(Configuration), _P(MotionSet), c_void_p)),
        ("advance", _function(_P(LoadSet), _P(MotionSet))), ("observe", _function(_P(BodiesFrame))),
        ("report", _REPORT), ("predict", _function(_P(Window), _P(MotionSet))), ("save", _NOTHING),
        ("restore", _NOTHING), ("extrapolate", _function(_P(Window), _P(MotionSet))),
        ("control", _function(_P(ControlSet))), ("checkpoint", _FILE), ("resume", _FILE)]


class LoadTable(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t), ("capabilities", c_uint64), ("features", _P(c_char_p)),
        ("configure", _function(_P(Configuration), c_void_p)), ("advance", _function(_P(MotionSet), _P(LoadSet))),
        ("observe", _function(_P(ParticlesFrame))), ("report", _REPORT), ("save", _NOTHING), ("restore", _NOTHING),
        ("linearise", _function(_P(TangentSet))), ("checkpoint", _FILE), ("resume", _FILE)]


RECORDS = {  # name in C: layout here
    "tandem_pose": POSE, "tandem_twist": TWIST, "tandem_wrench": WRENCH, "tandem_body_motion": BODY_MOTION,
    "tandem_body_load": BODY_LOAD, "tandem_body_tangent": BODY_TANGENT,
    "tandem_body_response": BODY_RESPONSE, "tandem_particle_account": PARTICLE_ACCOUNT,
    "tandem_body_state": BODY_STATE, "tandem_joint_state": JOINT_STATE, "tandem_body": BODY,
    "tandem_material": MATERIAL, "tandem_liquid": LIQUID, "tandem_pair": PAIR, "tandem_wall": WALL, "tandem_window": Window,
    "tandem_motion_set": MotionSet, "tandem_load_set": LoadSet, "tandem_tangent_set": TangentSet,
    "tandem_bodies_frame": BodiesFrame, "tandem_particles_frame": ParticlesFrame, "tandem_control_set": ControlSet,
    "tandem_state_file": StateFile, "tandem_configuration": Configuration, "tandem_motion_solver": MotionTable,
    "tandem_load_solver": LoadTable}


def view(address, count, dtype, writeable=False):
    """The `count` records at this address, not copied."""
    if not count:
        return np.empty(0, dtype)
    records = np.frombuffer((ctypes.c_byte * (count * dtype.itemsize)).from_address(address), dtype)
    records.flags.writeable = writeable
    return records
