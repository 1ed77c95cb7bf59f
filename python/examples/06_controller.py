"""A controller in Python: a function of this process is called before each window, and holds a pendulum at 0.5 rad."""
import math

import tandem as td

s = td.Scene("held_pendulum", end_time=3, window=2e-3)
bob = s.body("bob", mass=1, inertia=(.01, .01, .01), at=(0, 0, -1))
hinge = s.revolute("hinge", "ground", bob, at=(0, 0, 0), axis="y")
s.actuator("motor", hinge, input="torque")
s.observe("hinge.q", "hinge.rate")


def hold(time, sensors):
    """Spring and damper about 0.5 rad, and the weight there."""
    return {"torque": 40 * (.5 - sensors["hinge.q"]) - 14 * sensors["hinge.rate"] + 9.81 * math.sin(.5)}


r = s.run(controller=hold, picture=False)
print(f"{r['hinge.q'].last():.6f} rad at the end, {r['hinge.q'].max():.4f} at most; the motor gave {r['motor'].work:.3f} J")
r.plot(["hinge.q", "motor.torque"], "control.png")
