#!/usr/bin/env python3
"""MuJoCo as tandem's multibody solver: README.md says what it maps and what it refuses."""
import json
import os

import mujoco
import numpy as np

from tandem import participant
from tandem.participant import GROUND, Error
from tandem.rotations import matrix

JOINTS = {"revolute": mujoco.mjtJoint.mjJNT_HINGE, "prismatic": mujoco.mjtJoint.mjJNT_SLIDE,
          "spherical": mujoco.mjtJoint.mjJNT_BALL, "free": mujoco.mjtJoint.mjJNT_FREE}
INTEGRATORS = {"rk4": mujoco.mjtIntegrator.mjINT_RK4, "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT}
STATE = mujoco.mjtState.mjSTATE_INTEGRATION


def linear(constant):  # MuJoCo's springs and dampers are polynomials
    return [constant, 0, 0]


class MuJoCo(participant.MotionSolver):
    features = ["joint:fixed", "joint:revolute", "joint:prismatic", "joint:spherical", "joint:free", "joint.damping",
                "joint.rate", "force:spring_damper", "force:rotational_spring_damper"]

    def configure(self, c, initial):
        options = dict(c.solver_options)
        integrator, self.step = options.pop("integrator", "rk4"), options.pop("step", np.inf)
        if options or integrator not in INTEGRATORS or not self.step > 0:
            raise Error(f"is {json.dumps(c.solver_options)}", "mbd.solver_options",
                        '"integrator" is "rk4" or "implicit", "step" a time in s above 0; there are no other options')
        mbd = c.scene["mbd"]
        self.joints = mbd.get("joints", [])
        self.index = {"ground": -1, **{body.name: body.index for body in c.bodies}}
        spec = mujoco.MjSpec()
        spec.compiler.degree = False
        spec.option.gravity, spec.option.integrator = c.gravity, INTEGRATORS[integrator]
        spec.option.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_AUTORESET
        spec.option.enableflags = mujoco.mjtEnableBit.mjENBL_ENERGY
        self.add_bodies(spec, c)
        for force in mbd.get("forces", []):
            if force["type"] == "spring_damper":
                self.add_spring(spec, c, force)
        self.model = spec.compile()
        # MuJoCo numbers bodies and joints by its tree, tandem by the scene.
        self.bodies = np.array([self.model.body(f"b{body.index}").id for body in c.bodies])
        self.data, self.ahead = mujoco.MjData(self.model), mujoco.MjData(self.model)
        self.points = []  # of the joints, in the frames of their children
        for joint in self.joints:
            child = c.bodies[self.index[joint["child"]]]
            self.points.append(matrix(child.quaternion).T @ (joint.get("position", child.position) - child.position))
        self.set_rates(c)
        self.state = np.empty(mujoco.mj_stateSize(self.model, STATE))
        self.update(self.data)
        for end in ("begin", "end"):
            self.write(self.data, initial.bodies, end)
        return {"mujoco": mujoco.__version__}

    def add_bodies(self, spec, c):
        carried = {}
        for joint in self.joints:
            if joint["child"] in carried:
                raise Error(f"is carried by '{carried[joint['child']]['name']}' and by '{joint['name']}'",
                            f"mbd.bodies '{joint['child']}'", "this solver takes trees; use one joint per child")
            carried[joint["child"]] = joint
        added = {"ground": spec.worldbody}

        def add(body, waiting):
            if body.name in waiting:
                raise Error("closes a loop of joints", f"mbd.bodies '{body.name}'", "this solver takes trees")
            joint = carried.get(body.name, {"type": "free", "name": None})
            parent = joint.get("parent", "ground")
            if parent not in added:
                add(c.bodies[self.index[parent]], [*waiting, body.name])
            position, R = np.zeros(3), np.eye(3)
            if parent != "ground":
                holder = c.bodies[self.index[parent]]
                position, R = holder.position, matrix(holder.quaternion)
                if joint["type"] == "free":
                    raise Error("is free of a body that moves", f"mbd.joints '{joint['name']}'",
                                "leave the joint out: a body without joints is free")
            relative = added[parent].add_body(name=f"b{body.index}", pos=R.T @ (body.position - position))
            frame = R.T @ matrix(body.quaternion)
            quaternion = np.empty(4)
            mujoco.mju_mat2Quat(quaternion, frame.ravel())
            relative.quat, relative.mass, relative.ipos = quaternion, body.mass, np.zeros(3)
            relative.explicitinertial = True
            (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
            relative.fullinertia = [xx, yy, zz, xy, xz, yz]
            if joint["type"] != "fixed":
                self.add_joint(relative, body, joint, c.scene["mbd"].get("forces", []))
            added[body.name] = relative

        for body in c.bodies:
            if body.name not in added:
                add(body, [])

    def add_joint(self, relative, body, joint, forces):
        made = relative.add_joint(name=f"j{body.index}", type=JOINTS[joint["type"]])
        if joint["type"] == "free":
            return
        R = matrix(body.quaternion)
        made.pos = R.T @ (np.array(joint["position"]) - body.position)
        if "axis" in joint:
            made.axis = R.T @ np.array(joint["axis"])
        damping = joint.get("damping", 0)
        springs = [f for f in forces if f["type"] == "rotational_spring_damper" and f["joint"] == joint["name"]]
        if len(springs) > 1:
            raise Error("is the second spring of its joint", f"mbd.forces '{springs[1]['name']}'",
                        "add up their stiffness and damping")
        for spring in springs:
            made.stiffness, made.springref = linear(spring.get("stiffness", 0)), spring.get("angle", 0)
            damping += spring.get("damping", 0)
        made.damping = linear(damping)

    def add_spring(self, spec, c, force):
        name = force["name"]
        for end in ("a", "b"):
            index = self.index[force.get("body_" + end, "ground")]
            body, point = spec.worldbody, np.array(force["point_" + end])
            if index >= 0:
                body = spec.body(f"b{index}")
                point = matrix(c.bodies[index].quaternion).T @ (point - c.bodies[index].position)
            body.add_site(name=f"{name} {end}", pos=point)
        tendon = spec.add_tendon(name=name, stiffness=linear(force.get("stiffness", 0)),
                                 damping=linear(force.get("damping", 0)), springlength=[force["length"]] * 2)
        tendon.wrap_site(f"{name} a")
        tendon.wrap_site(f"{name} b")

    def set_rates(self, c):
        for joint in self.joints:
            if joint["type"] in ("revolute", "prismatic"):
                dof = self.model.joint(f"j{self.index[joint['child']]}").dofadr[0]
                self.data.qvel[dof] = joint.get("rate", 0)
        for body in c.bodies:
            if body.is_free:
                dof = self.model.joint(f"j{body.index}").dofadr[0]
                self.data.qvel[dof:dof + 3] = body.velocity
                self.data.qvel[dof + 3:dof + 6] = matrix(body.quaternion).T @ body.angular_velocity

    def update(self, data):  # poses and velocities of the bodies from the coordinates and rates
        mujoco.mj_kinematics(self.model, data)
        mujoco.mj_comPos(self.model, data)
        mujoco.mj_comVel(self.model, data)

    def twist(self, data, id):
        velocity = np.empty(6)
        mujoco.mj_objectVelocity(self.model, data, mujoco.mjtObj.mjOBJ_BODY, id, velocity, 0)
        return velocity[3:], velocity[:3]

    def write(self, data, records, end):
        ids = self.bodies[records["body"]]
        pose, twist = records[end + "_pose"], records[end + "_twist"]
        pose["position"], pose["quaternion"] = data.xpos[ids], data.xquat[ids]
        for row, id in enumerate(ids):
            twist["velocity"][row], twist["angular_velocity"][row] = self.twist(data, id)

    def predict(self, motion):
        self.write(self.data, motion.bodies, "begin")
        self.ahead.qpos, self.ahead.qvel = self.data.qpos, self.data.qvel
        mujoco.mj_integratePos(self.model, self.ahead.qpos, self.ahead.qvel, motion.window.length)
        self.update(self.ahead)
        self.write(self.ahead, motion.bodies, "end")

    def advance(self, loads, motion):
        model, data, H, bodies = self.model, self.data, motion.window.length, motion.bodies
        steps = max(1, int(np.ceil(H / self.step * (1 - 1e-12))))
        model.opt.timestep = H / steps
        data.xfrc_applied[:] = 0
        load = loads.bodies[loads.bodies["body"] != GROUND]
        ids = self.bodies[load["body"]]
        data.xfrc_applied[ids, :3], data.xfrc_applied[ids, 3:] = load["mean"]["force"], load["mean"]["torque"]
        self.write(data, bodies, "begin")
        ids = self.bodies[bodies["body"]]
        force = data.xfrc_applied[ids]
        work, before = np.zeros(len(ids)), self.rates(ids)
        for _ in range(steps):
            mujoco.mj_step(model, data)
            self.update(data)
            after = self.rates(ids)
            work += H / steps * np.sum(force * (before + after) / 2, axis=1)
            before = after
        bad = [warning.number for warning in data.warning]
        if any(bad) or not np.all(np.isfinite(data.qpos)):
            raise Error("became unstable in a window", "MuJoCo", 'give a shorter mbd.solver_options "step", or the '
                        '"integrator" "implicit"', participant.NUMERICS)
        self.write(data, bodies, "end")
        for kind, rate in (("acceleration", "velocity"), ("angular_acceleration", "angular_velocity")):
            mean = (bodies["end_twist"][rate] - bodies["begin_twist"][rate]) / H
            bodies["begin_" + kind] = bodies["end_" + kind] = mean
        bodies["applied_impulse"]["force"], bodies["applied_impulse"]["torque"] = H * force[:, :3], H * force[:, 3:]
        bodies["applied_work"] = work

    def rates(self, ids):
        return np.array([np.concatenate(self.twist(self.data, id)) for id in ids]).reshape(-1, 6)

    def observe(self, frame):
        model, data = self.model, self.data
        mujoco.mj_forward(model, data)
        mujoco.mj_rnePostConstraint(model, data)
        pose, twist = frame.bodies["pose"], frame.bodies["twist"]
        pose["position"], pose["quaternion"] = data.xpos[self.bodies], data.xquat[self.bodies]
        for row, id in enumerate(self.bodies):
            twist["velocity"][row], twist["angular_velocity"][row] = self.twist(data, id)
        wrench = data.cfrc_int  # springs are not in it: MuJoCo counts them as external
        for row, joint in enumerate(self.joints):
            child = self.bodies[self.index[joint["child"]]]
            record = frame.joints[row]
            if joint["type"] in ("revolute", "prismatic"):
                made = model.joint(f"j{self.index[joint['child']]}")
                record["coordinate"], record["rate"] = data.qpos[made.qposadr[0]], data.qvel[made.dofadr[0]]
            point = data.xpos[child] + data.xmat[child].reshape(3, 3) @ self.points[row]
            torque, force = wrench[child, :3], wrench[child, 3:]
            record["reaction"]["force"] = force
            record["reaction"]["torque"] = torque + np.cross(data.subtree_com[model.body_rootid[child]] - point, force)
        frame.energy = data.energy.sum()

    def save(self):
        mujoco.mj_getState(self.model, self.data, self.state, STATE)

    def restore(self):
        mujoco.mj_setState(self.model, self.data, self.state, STATE)
        self.update(self.data)

    def checkpoint(self, path, windows, time):
        self.save()
        with open(path + ".part", "wb") as file:
            np.save(file, self.state)
        os.replace(path + ".part", path)

    def resume(self, path, windows, time):
        with open(path, "rb") as file:
            self.state[:] = np.load(file)
        self.restore()


participant.run(MuJoCo(), "mujoco_bodies", "1.0")
