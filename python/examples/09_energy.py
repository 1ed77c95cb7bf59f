"""A drum with a lifter, driven by a motor: where the energy goes."""
import tandem as td

s = td.Scene("drum", end_time=1, window=1e-3, frame_interval=.05)
steel = s.material("steel", density=7850, young=3e8, friction=.4, restitution=.5)
drum = s.body("drum", mass=5, inertia=(.1, .2, .1))
shell = s.wall("shell", material=steel, body=drum, cylinder=(.15, .1), orientation=("x", td.deg(90)))
s.wall("lifter", material=steel, body=drum, box=(.03, .09, .01), at=(.13, 0, 0))
axle = s.revolute("axle", "ground", drum, at=(0, 0, 0), axis="y", damping=.05)
motor = s.motor("motor", axle, max_torque=30)
motor.speed = td.ramp(to=6, duration=.4)
s.fill(shell, steel, radius=(.009, .011), mass=1.2)
s.section("output")["dissipation"] = True
r = s.run(picture=False)

lost = r.summary["dem_dissipated_J"]
print(f"the motor gave {r['motor'].work:.2f} J; the axle took {r['axle'].loss_energy.last():.2f} J")
print("the contacts took", {name: round(value, 3) for name, value in lost.items()}, "J")
print(f"mean power of the motor from 0.6 s on: {r['motor.power'].mean(.6):.2f} W")
r.plot(["motor.power", "axle.rate"], "drum.png", start=.05)
