"""Spheres fall into a box and come to rest: particles without a machine, and their frames as arrays."""
import numpy as np

import tandem as td

s = td.Scene("grains", end_time=.6)
glass = s.material("glass", density=2500, young=5e7, friction=.3, restitution=.5)
s.box("box", (.2, .2, .2), at=(0, 0, .1), open="+z", material=glass)
s.lattice(glass, (-.09, -.09, .02), (.09, .09, .3), radius=(.009, .011), count=400)
r = s.run(picture=False)

for frame in r.frames:
    speed = frame.spheres.speed                                     # read from the file now, and not kept
    print(f"t = {frame.time:5.3f} s: fastest sphere {speed.max():.3f} m/s, mean {speed.mean():.3f} m/s")
z, radius = r.frames[-1].spheres.position[:, 2], r.frames[-1].spheres.radius
print(f"{len(z)} spheres, the highest at {z.max():.3f} m, {np.mean(z < .1):.0%} below 0.1 m")
print("the box bears", r["ground.contact_force.z"].mean(.5), "N, the spheres weigh", -9.81 * 2500 * 4 / 3 * np.pi * (radius.astype(float)**3).sum(), "N")
