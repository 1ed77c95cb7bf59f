"""An optimiser of scipy on top: the damper of a wheel suspension that shakes the car least on a bump."""
import numpy as np
from scipy.optimize import minimize_scalar

import tandem as td

s = td.Scene("suspension", end_time=2, frame_interval=0)
damping = s.parameter("damping", 1000, unit="N s/m")
wheel = s.body("wheel", mass=40, inertia=(1, 1, 1), at=(0, 0, .3))
car = s.body("car", mass=350, inertia=(50, 50, 50), at=(0, 0, .8))
bump = td.table([0, .5, .6, .7, 2], [0, 0, .05, 0, 0])
s.prismatic("road", "ground", wheel, at=(0, 0, .3), axis="z", motion=bump)
s.prismatic("guide", "ground", car, at=(0, 0, .8), axis="z")
s.spring("spring", wheel, car, a=(0, 0, .3), b=(0, 0, .8), length=.5 + 350 * 9.81 / 20e3, stiffness=20e3, damping=damping)


def shaking(value):
    """Root mean square of the car's acceleration [m/s2], with this damper."""
    r = s.run("out/suspension", picture=False, report=False, damping=value)
    rate = r["guide.rate"]
    a = np.gradient(rate.values, rate.time)
    print(f"damping {value:7.1f} N s/m: {np.sqrt(np.mean(a**2)):.4f} m/s2")
    return np.sqrt(np.mean(a**2))


best = minimize_scalar(shaking, bounds=(100, 8000), method="bounded", options={"maxiter": 12, "xatol": 20})
print(f"the best damper has {best.x:.0f} N s/m")
