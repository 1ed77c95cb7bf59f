"""A pendulum: build a machine, run it, compare its period with the formula, draw a chart."""
import math

import tandem as td

s = td.Scene("pendulum", end_time=4)
rod = s.body("rod", box=(1, .04, .04), mass=2, at=(.5, 0, 0))      # mass, centre and inertia follow from the box
s.revolute("hinge", "ground", rod, at=(0, 0, 0), axis="y")
r = s.run(picture=False)

print(r)
print("columns of the hinge:", [name for name in r.names if name.startswith("hinge")])
print(f"a swing from the horizontal takes {r['hinge.q'].period():.4f} s")
small = 2 * math.pi * math.sqrt(2 * 1 / (3 * 9.81))                # of a thin rod, at small angles
print(f"from 90 degrees, 1.1803 times as long as at small angles: {1.1803 * small:.4f} s")
r.plot(["hinge.q", "hinge.rate"], "pendulum.png")
