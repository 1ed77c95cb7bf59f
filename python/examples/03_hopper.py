"""A hopper with a slot: parameters in the scene, a sensor of the flow, and the file for the command line."""
import tandem as td

s = td.Scene("hopper", end_time=.7, window=2e-3, frame_interval=.05, description="Beads run through the slot of a hopper.")
mouth = s.parameter("mouth", .05, unit="m", min=.02, max=.1)       # width of the slot
s.parameter("pitch", 60, unit="deg", min=20, max=80)               # of the two plates
s.parameter("plate", .12, unit="m")                                # their length
glass = s.material("glass", density=2500, young=1.5e8, friction=.4, restitution=.5)
for side, sign in (("left", "-"), ("right", "")):
    s.box(side, ("=plate", .08, .004), material=glass,
          at=(f"={sign}(mouth/2 + plate/2*cos(pitch) + 0.002*sin(pitch))", 0, "=plate/2*sin(pitch) - 0.002*cos(pitch)"),
          orientation={"axis": [0, 1, 0], "angle": "=pitch" if sign else "=-pitch"})
    s.plane(f"{side}_side", at=(f"={sign}(mouth/2 + plate*cos(pitch))", 0, 0), normal="x" if sign else "-x", material=glass)
s.plane("front", at=(0, -.035, 0), normal="y", material=glass)
s.plane("back", at=(0, .035, 0), normal="-y", material=glass)
s.lattice(glass, (-.075, -.034, .13), (.075, .034, .42), radius=(.0055, .0065), seed=1)
s.sensor("mouth", box=(.3, .08, .03), at=(0, 0, -.025), flow="z")
s.outlet("below", below=-.1)
s.domain((-.3, -.04, -.2), (.3, .04, .6))

if __name__ == "__main__":
    s.save("hopper.json")                                           # tandem run hopper.json --set mouth=0.06 --out out/hopper
    r = s.run(picture=False)
    print(f"{-r['mouth.flow'].mean(.25, .4):.3f} kg/s through a slot of 50 mm")
    r = s.run("out/hopper_60", picture=False, mouth=.06)
    print(f"{-r['mouth.flow'].mean(.25, .4):.3f} kg/s through a slot of 60 mm")
    r.plot(["mouth.flow", "mouth.passed"], "hopper.png")
