"""Scenes to start from, with all their measures as parameters: s = td.templates.hopper(); s.run(mouth=0.06).

`tandem new scene --template hopper` writes the same as a file. Each function returns a tandem.Scene that runs as it comes."""
import pathlib
import re
import shutil
import sys
from typing import List, Optional

from tandem.entries import SceneError, nearest
from tandem.geometry import cached_mesh
from tandem.scenes import Scene, files_of

__all__ = ["hopper", "round_hopper", "conveyor", "screw", "chute", "tank", "mixer", "bucket", "linkage"]


# Units of sizes and amounts, which are above 0. A value may equal its `min`, which is therefore a number just above 0.
_AMOUNTS = ("m", "kg", "kg/s", "kg/m3", "Pa")


def _parameters(s: Scene, **keys) -> None:
    """Value and unit of each, and what it may be at least and at most."""
    for name, (value, unit, *limits) in keys.items():
        least, most = (*limits, None, None)[:2]
        s.parameter(name, value, unit=unit, min=1e-6 if least is None and unit in _AMOUNTS else least, max=most)


def _material(s: Scene, radius: float, density: float = 2500, friction: float = 0.4):
    """Material, and parameters, of the spheres."""
    _parameters(s, radius=(radius, "m"), friction=(friction, None), density=(density, "kg/m3"), young=(1.5e8, "Pa"))
    return s.material("grain", density="=density", young="=young", friction="=friction", restitution=0.4)


def _radii():
    return ["=0.9*radius", "=1.1*radius"]


def hopper() -> Scene:
    """A hopper with a slot, and a sensor of the flow through it.

    mouth (of the slot, four grain diameters or more), width (of the bin), rise (height of the two plates), depth, height (of the fill above the
    plates); radius, friction, density, young of the grains. Result: mouth.flow, mouth.passed."""
    s = Scene("hopper", end_time=1, window=2e-3, frame_interval=.05, description="Grains run through the slot of a hopper.")
    _parameters(s, mouth=(.05, "m", "=8*radius", "=0.95*width"), width=(.17, "m"), rise=(.1, "m"), depth=(.08, "m", "=3*radius"), height=(.15, "m"))
    grain = _material(s, .006)
    for side, sign, heights in (("left", "-", ["=rise", 0]), ("right", "", [0, "=rise"])):
        s.wall(side, shape={"type": "height_field", "size": ["=(width - mouth)/2", "=depth"], "heights": [heights, heights]},
               at=(f"={sign}(width + mouth)/4", 0, 0), material=grain)
    s.box("bin", ("=width", "=depth", "=1.2*height"), at=(0, 0, "=rise + 0.6*height"), open=["+y", "-y", "+z", "-z"], material=grain)
    s.plane("front", at=(0, "=-depth/2", 0), normal="y", material=grain)
    s.plane("back", at=(0, "=depth/2", 0), normal="-y", material=grain)
    s.fill({"type": "between", "walls": ["left", "right", "bin"]}, grain, radius=_radii(), level="=rise + height")
    return _flow_out(s, ("=2*width", "=depth", "=5*radius"))


def round_hopper() -> Scene:
    """A cone below a round bin, and a sensor of the flow through its mouth.

    mouth (four grain diameters or more), diameter (of the bin), rise (height of the cone), height (of the fill above the cone); radius, friction,
    density, young of the grains. Result: mouth.flow, mouth.passed."""
    s = Scene("round_hopper", end_time=1, window=2e-3, frame_interval=.05, description="Grains run out of a cone.")
    _parameters(s, mouth=(.06, "m", "=8*radius", "=0.95*diameter"), diameter=(.16, "m"), rise=(.07, "m"), height=(.1, "m"))
    grain = _material(s, .006)
    s.wall("cone", cone=("=mouth/2", "=diameter/2", "=rise"), at=(0, 0, "=rise/2"), open=["+z", "-z"], material=grain)
    s.wall("bin", cylinder=("=diameter/2", "=1.2*height"), at=(0, 0, "=rise + 0.6*height"), open=["+z", "-z"], material=grain)
    s.fill({"type": "above", "wall": "cone"}, grain, radius=_radii(), level="=rise + height")
    return _flow_out(s, ("=2*diameter", "=2*diameter", "=5*radius"))


def _flow_out(s: Scene, box) -> Scene:
    """A sensor of the flow below a mouth at z = 0, and an outlet below it."""
    wide, deep, _ = (size.lstrip("=") for size in box)
    s.sensor("mouth", box=box, at=(0, 0, "=-4*radius"), flow="z")
    s.outlet("below", below="=-16*radius")
    s.domain((f"=-{wide}", f"=-{deep}", "=-20*radius"), (f"={wide}", f"={deep}", "=rise + 1.5*height"))
    return s


def conveyor() -> Scene:
    """A belt with skirts that carries grains from an inlet over its end.

    length, width (of the belt), speed, rate (mass per time), skirt (height); radius, friction, density, young. Results: end.flow, end.passed."""
    s = Scene("conveyor", end_time=2, window=1e-3, frame_interval=.05, description="A belt carries grains over its end.")
    # Inlet and sensor lie one after the other along the belt, and the inlet between the skirts.
    _parameters(s, length=(1, "m", "=0.03 + 27*radius"), width=(.2, "m", "=8*radius"), speed=(1, "m/s", 1e-3), rate=(3, "kg/s"),
                skirt=(.08, "m", "=3*radius"))
    grain = _material(s, .01, friction=.5)
    s.box("belt", ("=length", "=width", .01), at=("=length/2", 0, -.005), material=grain, surface_velocity=("=speed", 0, 0))
    for side, sign in (("left", ""), ("right", "-")):
        s.box(side, ("=length", .004, "=skirt"), at=("=length/2", f"={sign}(width/2 + 0.002)", "=skirt/2 + 0.001"), material=grain)
    s.box("tail", (.004, "=width", "=skirt"), at=(-.004, 0, "=skirt/2 + 0.001"), material=grain)
    s.inlet("feed", grain, ("=0.03 + radius", "=-width/2 + 2*radius", "=skirt"), ("=0.03 + 14*radius", "=width/2 - 2*radius", "=skirt + 8*radius"),
            radius=_radii(), mass_rate="=rate", velocity=("=speed/2", 0, -.5))
    s.sensor("end", box=("=10*radius", "=width", "=2*skirt"), at=("=length - 8*radius", 0, "=skirt - 0.005"), flow="x")
    s.outlet("below", below="=-0.3")
    s.domain((-.2, "=-width", -.4), ("=length + 1", "=width", "=skirt + 12*radius"))
    return s


def screw() -> Scene:
    """A screw that a motor turns in a trough moves grains from an inlet to the open end.

    diameter, pitch (of the flight, which has three turns), shaft (its diameter, a fifth of that of the flight or more), gap (between flight and
    trough, a tenth of the diameter at most), speed (of the shaft), rate (mass per time); radius, friction, density, young. Results: end.flow,
    motor.torque, motor.power."""
    s = Scene("screw", end_time=3.5, window=1e-3, frame_interval=.05, description="A screw moves grains along a trough.")
    # The flight reaches inwards to a fifth of its diameter: a thinner shaft would leave it loose.
    _parameters(s, diameter=(.2, "m", "=10*radius"), pitch=(.16, "m", "=4*radius"), shaft=(.05, "m", "=0.2*diameter", "=0.8*diameter"),
                gap=(.004, "m", 0, "=0.1*diameter"), speed=(12, "rad/s", 1e-3), rate=(1.5, "kg/s"))
    grain = _material(s, .008)
    turns = 3
    tube = "(diameter + 2*gap)"
    tool = s.body("screw", mass=4, inertia=(.02, .1, .1), at=(f"={turns}*pitch/2", 0, 0))
    start = (f"=-{turns}*pitch/2", 0, 0)  # of the flight, in the frame of the body
    tool.wall(grain, "flight", shape={"type": "mesh", "file": _flight(turns), "stretch": ["=pitch", "=diameter", "=diameter"]}, at=start)
    tool.wall(grain, "core", shape={"type": "cylinder", "radius": "=shaft/2", "height": f"={turns}*pitch"}, orientation={"axis": [0, 1, 0], "angle_deg": 90})
    shaft = s.revolute("shaft", "ground", tool, at=(0, 0, 0), axis="x")
    motor = s.motor("motor", shaft, max_torque=100, gains={"proportional": 5, "integral": 20})
    motor.speed = {"type": "ramp", "to": "=speed", "duration": .3}
    s.wall("trough", shape={"type": "mesh", "file": _trough(turns), "stretch": ["=pitch", f"={tube}", f"={tube}"]}, material=grain)
    s.box("tail", (.006, f"={tube}", f"=1.6*{tube}"), at=(-.004, 0, f"=0.3*{tube}"), material=grain)
    s.inlet("feed", grain, ("=0.1*pitch + radius", "=-0.25*diameter", "=0.6*diameter"), ("=1.1*pitch + radius", "=0.25*diameter", "=0.6*diameter + 8*radius"),
            radius=_radii(), mass_rate="=rate", velocity=(0, 0, -.5))
    s.sensor("end", box=("=pitch", f"={tube}", f"=1.6*{tube}"), at=(f"={turns - .5}*pitch", 0, 0), flow="x")
    s.outlet("below", below="=-1.5*diameter")
    s.domain(("=-diameter", "=-2*diameter", "=-2*diameter"), (f"={turns + 2}*pitch", "=2*diameter", "=diameter + 12*radius"))
    s.expect("what is fed comes out", "end.flow", "=rate", .15, reduce="mean", start=2.5, stop=3.5,
             why="the steady flow, which this screw has after 2 s; a slower or a longer one needs a later end_time")
    s.expect("no grain is lost", "summary.lost_particles", 0, 0, absolute=True)
    return s


def _flight(turns: int) -> str:
    """The flight of a screw about x that moves grains along x when it turns about x: diameter and pitch are 1, the sheet 0.04 thick."""
    import numpy as np
    angles = np.linspace(0, 2 * np.pi * turns, 64 * turns + 1)
    middle = .02 + angles / (2 * np.pi)
    # Four edges of the sheet: at the shaft and at the rim, behind and in front.
    inner, outer, outer_front, inner_front = (np.stack([middle + side, radius * np.cos(angles), -radius * np.sin(angles)], axis=1)
                                              for radius, side in ((.1, -.02), (.5, -.02), (.5, .02), (.1, .02)))
    triangles = []
    for a, b in ((inner, outer), (outer, outer_front), (inner_front, inner)):
        triangles += [t for k in range(len(angles) - 1) for t in ((a[k], b[k], a[k + 1]), (b[k], b[k + 1], a[k + 1]))]
    # The front is divided along the same diagonals as the back: so the sheet is equally thick everywhere.
    a, b = inner_front, outer_front
    triangles += [t for k in range(len(angles) - 1) for t in ((a[k], a[k + 1], b[k]), (b[k], a[k + 1], b[k + 1]))]
    corners = (inner, outer, outer_front, inner_front)
    for k, order in ((0, (3, 2, 1, 0)), (-1, (0, 1, 2, 3))):
        p, q, r, t = (corners[i][k] for i in order)
        triangles += [(p, q, r), (p, r, t)]
    return cached_mesh("flight", triangles)


def _trough(turns: int) -> str:
    """A tube about x, of diameter 1, with a slot along its top. Upright sides would make a wedge with the rim of the flight, which pulls grains in
    where it comes down."""
    import numpy as np
    profile = [(.5 * np.cos(a), .5 * np.sin(a)) for a in np.radians(np.linspace(-220, 40, 53))]
    triangles = []
    for (y, z), (v, w) in zip(profile, profile[1:]):
        p, q, r, t = (0, y, z), (turns, y, z), (turns, v, w), (0, v, w)
        triangles += [(p, q, r), (p, r, t)]
    return cached_mesh("trough", triangles)


def chute() -> Scene:
    """Grains run down an inclined chute with sides.

    slope, length, width, rate (mass per time); radius, friction, density, young. Results: end.flow, end.momentum over end.mass."""
    s = Scene("chute", end_time=1.5, window=1e-3, frame_interval=.05, description="Grains run down a chute.")
    # Inlet and sensor lie one after the other: the inlet by its place along x, the sensor along the floor.
    _parameters(s, slope=(30, "deg", 0, 80), length=(1, "m", "=(0.05 + 25*radius)/(0.85*cos(slope))"), width=(.12, "m", "=8*radius"), rate=(2, "kg/s"))
    grain = _material(s, .006, friction=.3)
    tilt = {"axis": [0, 1, 0], "angle": "=slope"}
    s.box("floor", ("=length", "=width", .01), at=("=length/2*cos(slope) - 0.005*sin(slope)", 0, "=-length/2*sin(slope) - 0.005*cos(slope)"),
          orientation=tilt, material=grain)
    for side, sign in (("left", ""), ("right", "-")):
        s.box(side, ("=length", .004, .1), at=("=length/2*cos(slope) + 0.051*sin(slope)", f"={sign}(width/2 + 0.002)", "=-length/2*sin(slope) + 0.051*cos(slope)"),
              orientation=tilt, material=grain)
    s.inlet("feed", grain, ("=0.05 + radius", "=-width/2 + 2*radius", .03), ("=0.05 + 20*radius", "=width/2 - 2*radius", "=0.03 + 12*radius"),
            radius=_radii(), mass_rate="=rate", velocity=(.3, 0, -.3))
    s.sensor("end", box=("=10*radius", "=width", .1), at=("=0.85*length*cos(slope) + 0.05*sin(slope)", 0, "=-0.85*length*sin(slope) + 0.05*cos(slope)"),
             orientation=tilt, flow="x")
    s.outlet("below", below="=-length*sin(slope) - 0.1")
    s.domain((-.2, "=-width", "=-length*sin(slope) - 0.2"), ("=length + 0.8", "=width", .3))
    return s


def mixer() -> Scene:
    """A vessel with two blades on a shaft that a motor drives through a bed of grains.

    diameter, fill (mass), speed (of the shaft), blade (height); radius, friction, density, young. Results: motor.torque, motor.power."""
    s = Scene("mixer", end_time=1, window=1e-3, frame_interval=.05, description="Two blades stir a bed of grains.")
    # The upper blade ends below the rim of the vessel, which is as high as wide.
    _parameters(s, diameter=(.2, "m"), fill=(.8, "kg"), speed=(6, "rad/s"), blade=(.03, "m", None, "=(diameter - 0.003 - 2.5*radius)/2.1"))
    grain = _material(s, .006)
    s.wall("vessel", cylinder=("=diameter/2", "=diameter"), at=(0, 0, "=diameter/2"), open="+z", material=grain)
    stirrer = s.body("stirrer", mass=1, inertia=(2e-3, 2e-3, 3e-3), at=(0, 0, "=0.003 + 2.5*radius + blade/2"))
    stirrer.wall(grain, "blade_a", box=("=0.8*diameter", .006, "=blade"))
    stirrer.wall(grain, "blade_b", box=(.006, "=0.7*diameter", "=blade"), at=(0, 0, "=1.1*blade"))
    shaft = s.revolute("shaft", "ground", stirrer, at=(0, 0, 0), axis="z")
    motor = s.motor("motor", shaft, max_torque=20, gains={"proportional": 5, "integral": 20})
    motor.speed = {"type": "ramp", "to": "=speed", "duration": .3}
    s.fill("vessel", grain, radius=_radii(), mass="=fill", settle={"kinetic_energy": 1e-7})
    s.domain(("=-0.6*diameter", "=-0.6*diameter", "=-0.1*diameter"), ("=0.6*diameter", "=0.6*diameter", "=1.5*diameter"))
    return s


def bucket() -> Scene:
    """A bucket on an arm is pulled through a bed of grains.

    width, depth (of the lip under the surface), way, bed (height); radius, friction, density, young. Results: pull.force, bucket.contact_force."""
    s = Scene("bucket", end_time=1.5, window=1e-3, frame_interval=.05, description="A bucket is pulled through a bed.")
    # The bucket stays above the floor and within the trough.
    _parameters(s, width=(.2, "m"), depth=(.06, "m", 0, "=bed - 0.01 - radius"), way=(.5, "m", 0, .75), bed=(.12, "m", None, .4))
    grain = _material(s, .012, friction=.5)
    s.box("trough", (1.2, "=2*width", .5), at=(.3, 0, .25), open="+z", material=grain)
    tool = s.body("bucket", mass=20, inertia=(.3, .3, .3), at=(0, 0, "=bed + 0.13"))
    tool.wall(grain, "shell", box=(.16, "=width", .14), open=["+x", "+z"], orientation=("y", -.2))
    carriage = s.body("carriage", mass=5, inertia=(.1, .1, .1), at=(0, 0, "=bed + 0.3"))
    s.prismatic("pull", "ground", carriage, at=(0, 0, "=bed + 0.3"), axis="x",
                motion={"type": "table", "times": [0, .5, 1.5], "values": [0, 0, "=way"]})
    s.prismatic("lower", carriage, tool, at=(0, 0, "=bed + 0.2"), axis="z",
                motion={"type": "table", "times": [0, .4, 1.5], "values": [0, "=-depth - 0.05", "=-depth - 0.05"]})
    s.fill("trough", grain, radius=_radii(), level="=bed", settle={"kinetic_energy": 1e-6})
    s.domain((-.6, "=-2*width", -.2), (1.2, "=2*width", 1))
    return s


def tank() -> Scene:
    """A tank of water on a slide that is shaken: the load of the liquid on its walls.

    length, width, height (of the tank), level (of the water), amplitude, frequency of the slide, spacing (of the particles).
    Results: sloshing.force, sloshing.axis_torque, gauge.level."""
    s = Scene("tank", end_time=1, window=2e-3, frame_interval=.05, description="Water in a tank that is shaken.")
    _parameters(s, length=(.4, "m"), width=(.12, "m"), height=(.3, "m"), level=(.12, "m", None, "=height"),
                amplitude=(.02, "m", 0, "=0.5*length"), frequency=(1, None), spacing=(.015, "m", None, "=min(level, width)/2"))
    s.add("mbd.bodies", name="tank", mass=5, inertia=(.1, .1, .1), position=(0, 0, "=height/2"),
          shapes=[{"name": "case", "use": "wall", "shape": {"type": "box", "size": ["=length", "=width", "=height"], "open": ["+z"]}}])
    s.prismatic("slide", "ground", "tank", axis="x", motion={"type": "harmonic", "amplitude": "=amplitude", "frequency": "=frequency"})
    water = s.section("sph")
    water["spacing"] = "=spacing"
    water["liquids"] = [{"name": "water", "density": 1000, "viscosity": 1e-3, "artificial_viscosity": 0.02, "expected_speed": 1,
                         "fill": [{"type": "inside", "wall": "case", "level": "=level"}]}]
    s.add("sph.sensors", type="level", name="gauge", body="tank", position=("=length/2 - spacing", 0, "=-height/2"))
    s.add("sph.sensors", type="load", name="sloshing", body="tank", axis=(0, 1, 0))
    return s


def linkage() -> Scene:
    """A four-bar linkage that a motor drives against a load on its rocker.

    crank (which turns round), coupler, rocker, base (lengths), speed (of the crank), load (force on the rocker's end). Results: motor.torque,
    rocker_pin.q."""
    s = Scene("linkage", end_time=2, window=1e-3, frame_interval=.04, description="A crank and rocker.")
    # The bars close where the base is shorter than coupler and rocker together. The crank turns round where it and each other bar are together
    # shorter than the other two (Grashof): at equality the bars fall into line.
    longest = "=0.99*min(coupler + rocker - base, base + rocker - coupler, base + coupler - rocker)"
    _parameters(s, base=(.7, "m", None, "=0.99*(coupler + rocker)"), coupler=(.6, "m"), rocker=(.5, "m"), crank=(.2, "m", None, longest),
                speed=(6.283185, "rad/s"), load=(20, "N"))
    # The crank points along x at the start; law of cosines for the joint of coupler and rocker.
    gap = "(base - crank)"
    cosine = f"(coupler^2 + {gap}^2 - rocker^2)/(2*coupler*{gap})"
    x, z = f"(crank + coupler*{cosine})", f"(coupler*sqrt(1 - ({cosine})^2))"
    for name, length, middle, angle in (("crank_bar", "crank", ("=crank/2", 0, 0), "=0*rad"),
                                        ("coupler_bar", "coupler", (f"=(crank + {x})/2", 0, f"={z}/2"), f"=-atan2({z}, {x} - crank)"),
                                        ("rocker_bar", "rocker", (f"=(base + {x})/2", 0, f"={z}/2"), f"=-atan2({z}, {x} - base)")):
        s.body(name, box=(f"={length}", .02, .03), density=7850, at=middle, orientation={"axis": [0, 1, 0], "angle": angle})
    pin = s.revolute("crank_pin", "ground", "crank_bar", at=(0, 0, 0), axis="y")
    s.revolute("knee", "crank_bar", "coupler_bar", at=("=crank", 0, 0), axis="y")
    s.revolute("joint", "coupler_bar", "rocker_bar", at=(f"={x}", 0, f"={z}"), axis="y")
    s.revolute("rocker_pin", "ground", "rocker_bar", at=("=base", 0, 0), axis="y")
    motor = s.motor("motor", pin, max_torque=500)
    motor.speed = {"type": "ramp", "to": "=speed", "duration": .5}
    s.force("load", "rocker_bar", at=(f"={x}", 0, f"={z}"), direction="-x", size="=load")
    return s


def make(template: str, file: Optional[str] = None, name: Optional[str] = None) -> pathlib.Path:
    """Writes a template as a new file, TEMPLATE.json by default."""
    if template not in __all__:
        raise SceneError(f"there is no template '{template}'" + nearest(template, __all__), made_at="the command line")
    if name and not re.fullmatch("[A-Za-z0-9_-]+", name):
        raise SceneError(f"'{name}' is no name of a scene", hint="write letters, digits, _ and -; a file is given by --out", made_at="the command line")
    scene = globals()[template]()
    if name:
        scene.name = name
    path = pathlib.Path(file or f"{scene.name}.json")
    meshes = [(entry, key, path.with_name(f"{path.stem}_{pathlib.Path(entry[key]).name.split('-')[0]}.stl")) for entry, key in files_of(scene.data)]
    for each in (path, *(own for _, _, own in meshes)):
        if each.exists():
            raise SceneError(f"'{each}' exists", hint="give another name by --out", made_at="the command line")
    for entry, key, own in meshes:
        shutil.copyfile(entry[key], own)
        entry[key] = str(own.resolve())
    scene.save(str(path))
    return path


def main(words: Optional[List[str]] = None) -> int:
    """tandem new scene [NAME] --template TEMPLATE [--out FILE]"""
    import argparse
    parser = argparse.ArgumentParser(prog="tandem new scene", allow_abbrev=False)
    parser.add_argument("name", nargs="?")
    parser.add_argument("--template", required=True)
    parser.add_argument("--out")
    options = parser.parse_args(words)
    try:
        path = make(options.template, options.out, options.name)
    except SceneError as error:
        print(f"error: {str(error).partition(chr(10))[0]}", file=sys.stderr)
        return 2
    scene = globals()[options.template]
    print(f"{path}: {scene.__doc__.partition(chr(10))[0]}\n  tandem preview {path}\n  tandem run {path} --out out/{path.stem}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
