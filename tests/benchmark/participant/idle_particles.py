"""A load solver that answers at once, in Python: it reads the motion and writes every field that a solver writes."""
import numpy as np

from tandem import participant


class Idle(participant.LoadSolver):
    features = ["*"]
    follows_path = window_mean = True

    def configure(self, c):
        self.mean = np.zeros((len(c.boundary), 3))

    def advance(self, motion, loads):
        account, bodies = loads.account, loads.bodies
        self.mean[:] = motion.bodies["end_pose"]["position"]
        self.mean[:] = 0
        bodies["mean"]["force"] = bodies["end"]["force"] = self.mean
        bodies["mean"]["torque"] = bodies["end"]["torque"] = self.mean
        bodies["work"] = 0
        account["micro_steps"], account["micro_step"] = 1, motion.window.length
        for name in ("momentum_begin", "momentum_end", "gravity_impulse"):
            account[name] = 0

    def observe(self):
        return np.empty(0), np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3)), np.empty(0)


participant.run(Idle(), "idle_python", "1.0")
