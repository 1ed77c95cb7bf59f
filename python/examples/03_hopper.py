"""A hopper with a slot: parameters in the scene, a sensor of the flow, and the file for the command line."""
import tandem as td

s = td.Scene("hopper", end_time=.7, window=2e-3, frame_interval=.05, description="Beads run through the slot of a hopper.")
mouth = s.parameter("mouth", .05, unit="m", min=.02, max=.1)       # width of the slot
s.parameter("width", .17, unit="m")                                # of the bin
s.parameter("rise", .1, unit="m")                                  # of the two plates below it
glass = s.material("glass", density=2500, young=1.5e8, friction=.4, restitution=.5)
for side, sign, heights in (("left", "-", ["=rise", 0]), ("right", "", [0, "=rise"])):
    s.wall(side, shape={"type": "height_field", "size": ["=(width - mouth)/2", .07], "heights": [heights, heights]},
           at=(f"={sign}(width + mouth)/4", 0, 0), material=glass)
s.box("bin", ("=width", .07, .2), at=(0, 0, "=rise + 0.1"), open=["+y", "-y", "+z", "-z"], material=glass)
s.plane("front", at=(0, -.035, 0), normal="y", material=glass)
s.plane("back", at=(0, .035, 0), normal="-y", material=glass)
s.fill({"type": "between", "walls": ["left", "right", "bin"]}, glass, radius=(.0055, .0065), level="=rise + 0.15")
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
