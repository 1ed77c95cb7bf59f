#!/usr/bin/env python3
"""Writes the STEP files of this folder, by cadquery (PyPI; not needed to build or test tandem):

    python3 -m venv /tmp/cad && /tmp/cad/bin/pip install cadquery==2.8.0 && /tmp/cad/bin/python make_step_files.py
"""
import math
import pathlib

import cadquery as cq

HERE = pathlib.Path(__file__).parent


def box(x, y, z):
    """A box between two planes of each axis."""
    return cq.Workplane().box(x[1] - x[0], y[1] - y[0], z[1] - z[0], centered=False).translate((x[0], y[0], z[0]))


def along(axis, radius, begin, end, at=(0, 0)):
    """A cylinder along an axis; `at`: its other two coordinates."""
    start, direction = {
        "x": ((begin, at[0], at[1]), (1, 0, 0)),
        "y": ((at[0], begin, at[1]), (0, 1, 0)),
        "z": ((at[0], at[1], begin), (0, 0, 1)),
    }[axis]
    return cq.Workplane(cq.Solid.makeCylinder(radius, end - begin, cq.Vector(*start), cq.Vector(*direction)))


def at(x=0, y=0, z=0, angle=0, axis=(0, 0, 1)):
    """Pose of a part."""
    return cq.Location(cq.Vector(x, y, z), cq.Vector(*axis), angle)


def write(assembly, name, unit="MM"):
    assembly.export(str(HERE / name), unit="MM", outputUnit=unit, write_pcurves=False)
    text = (HERE / name).read_text()
    begin = text.index("FILE_NAME(")  # no date and no program, so that the same script writes the same file
    text = text[:begin] + f"FILE_NAME('{name}','',(''),(''),'','','');" + text[text.index(";", begin) + 1:]
    (HERE / name).write_text(text)


def slider_crank():
    """8 parts, of which 2 are equal; the crank turns about y, and the slider runs along x. Lengths in mm."""
    radius, length, angle = 50, 200, math.radians(60)
    pin_x, pin_z = radius * math.cos(angle), radius * math.sin(angle)
    slider_x = pin_x + math.sqrt(length**2 - pin_z**2)
    frame = (box((-120, 420), (-60, 130), (-120, -100))
             .union(box((120, 400), (-40, 40), (-100, -20)))
             .union(box((120, 400), (-40, -20), (-20, 20))).union(box((120, 400), (20, 40), (-20, 20))))
    block = box((-30, 30), (70, 110), (-100, 40)).union(box((-60, 60), (70, 110), (-100, -85)))
    block = block.cut(along("y", 15, 70, 110))
    for x in (-45, 45):
        frame = frame.cut(along("z", 5, -120, -100, (x, 90)))
        block = block.cut(along("z", 5, -100, -85, (x, 90)))
    bolt = along("z", 5, -35, 0).union(along("z", 9, 0, 8))
    # Web and pins; the crank at 0 degrees, its arm along x.
    crank = (along("y", 15, 70, 120).union(along("y", 20, 60, 70)).union(box((-20, 70), (40, 60), (-20, 20)))
             .union(along("y", 16, 10, 40, (radius, 0))).union(along("y", 10, -14, 10, (radius, 0))))
    # From the crank pin along x to the gudgeon pin.
    rod = (box((0, length), (-10, 10), (-8, 8)).union(along("y", 18, -10, 10)).union(along("y", 14, -10, 10, (length, 0)))
           .cut(along("y", 10, -10, 10)).cut(along("y", 8, -10, 10, (length, 0))))
    slider = (box((-30, 30), (-20, 20), (-20, 20)).cut(box((-30, 16), (-10, 10), (-20, 20))).cut(along("y", 8, -20, 20)))
    pin = along("y", 8, -18, 18)
    machine = cq.Assembly(name="slider_crank")
    steel, brass, blue = cq.Color(0.6, 0.6, 0.65), cq.Color(0.8, 0.6, 0.2), cq.Color(0.1, 0.3, 0.8)
    machine.add(frame, name="frame", color=cq.Color(0.3, 0.3, 0.3))
    machine.add(block, name="bearing_block", color=blue)
    for k, x in enumerate((-45, 45)):
        machine.add(bolt, name=f"bolt_{k + 1}", loc=at(x, 90, -85), color=steel)
    machine.add(crank, name="crank", loc=at(angle=-60, axis=(0, 1, 0)), color=steel)
    tilt = math.degrees(math.asin(pin_z / length))
    machine.add(rod, name="rod", loc=at(pin_x, 0, pin_z, tilt, (0, 1, 0)), color=steel)
    machine.add(slider, name="slider", loc=at(slider_x), color=brass)
    machine.add(pin, name="gudgeon_pin", loc=at(slider_x), color=steel)
    write(machine, "slider_crank.step")


def bucket():
    """A bucket on an arm with a weight, and with two cylinders of two parts each; the file is in inches. Lengths in mm."""
    mm = 25.4
    arm = box((-4 * mm, 4 * mm), (-20 * mm, -19 * mm), (0, 40 * mm)).union(along("x", mm, -6 * mm, 6 * mm, (-19.5 * mm, 0)))
    for x in (-8, 8):
        arm = arm.union(along("x", 0.75 * mm, (x - 2) * mm, (x + 2) * mm, (-19.5 * mm, 38 * mm)))
    arm = arm.union(box((-6 * mm, 6 * mm), (-20 * mm, -19 * mm), (37 * mm, 39 * mm)))
    outer = box((-12 * mm, 12 * mm), (-16 * mm, 8 * mm), (-10 * mm, 6 * mm))
    shell = outer.cut(box((-11.5 * mm, 11.5 * mm), (-15.5 * mm, 8 * mm), (-9.5 * mm, 5.5 * mm)))
    shell = shell.union(box((-6 * mm, -4.5 * mm), (-21 * mm, -16 * mm), (-2 * mm, 2 * mm)))
    shell = shell.union(box((4.5 * mm, 6 * mm), (-21 * mm, -16 * mm), (-2 * mm, 2 * mm)))
    shell = shell.cut(along("x", mm, -6 * mm, 6 * mm, (-19.5 * mm, 0)))
    for x in (-8, 8):
        shell = shell.union(along("x", 0.75 * mm, (x - 2) * mm, (x + 2) * mm, (-14 * mm, 6.5 * mm)))
    # Barrel: tube with an eye at z = 0; rod: piston, rod and an eye, 24 inches long in this stroke.
    barrel = (along("z", 1.5 * mm, mm, 15 * mm).cut(along("z", 1.25 * mm, 1.5 * mm, 15 * mm))
              .union(along("x", 1.25 * mm, -mm, mm)).cut(along("x", 0.75 * mm, -mm, mm)))
    rod = (along("z", 1.25 * mm, 10 * mm, 12 * mm).union(along("z", 0.7 * mm, 12 * mm, 30 * mm)))
    dy, dz = (-14 + 19.5) * mm, (6.5 - 38) * mm
    span, angle = math.hypot(dy, dz), math.degrees(math.atan2(-dy, dz))
    rod = (rod.union(along("z", 0.7 * mm, 29 * mm, span)).union(along("x", 1.25 * mm, -mm, mm, (0, span)))
           .cut(along("x", 0.75 * mm, -mm, mm, (0, span))))
    weight = box((-5 * mm, 5 * mm), (-24 * mm, -20 * mm), (10 * mm, 13 * mm)).cut(along("y", mm, -24 * mm, -20 * mm, (2 * mm, 11.5 * mm)))
    machine = cq.Assembly(name="bucket_machine")
    machine.add(weight, name="weight", color=cq.Color(0.5, 0.1, 0.1))
    machine.add(arm, name="arm", color=cq.Color(0.9, 0.7, 0.1))
    machine.add(shell, name="bucket", color=cq.Color(0.3, 0.3, 0.3))
    for side, x in (("left", -8), ("right", 8)):
        cylinder = cq.Assembly(name=f"cylinder_{side}")
        cylinder.add(barrel, name="barrel")
        cylinder.add(rod, name="rod")
        machine.add(cylinder, name=f"cylinder_{side}", loc=at(x * mm, -19.5 * mm, 38 * mm, angle, (1, 0, 0)))
    write(machine, "bucket_inch.step", "INCH")


def gearbox():
    """A housing of two halves with three shafts, 60 parts in sub-assemblies of two levels. Lengths in mm."""
    width, depth, height = 400, 200, 100
    shafts = (-120, 0, 120)

    def half():
        part = box((-width / 2, width / 2), (-depth / 2, depth / 2), (0, height))
        part = part.cut(box((-width / 2 + 15, width / 2 - 15), (-depth / 2 + 15, depth / 2 - 15), (0, height - 15)))
        for x in shafts:
            part = part.cut(along("y", 30, -depth / 2, depth / 2, (x, 0)))
        for x, y in holes:
            part = part.cut(along("z", 3, 0, height, (x, y)))
        return part

    # In the walls at y = +-depth/2, between the shafts, and in those at x = +-width/2.
    holes = [(x, y) for y in (-92.5, 92.5) for x in (-180, -60, 60, 180)] + [(x, y) for x in (-192.5, 192.5) for y in (-50, 0, 50)]
    body = half()
    bolt = along("z", 3, -190, 10).union(along("z", 5, 10, 16))
    bearing = along("y", 30, 0, 15).cut(along("y", 15, 0, 15))
    shaft = along("y", 15, -110, 110)
    gear = along("y", 50, -10, 10).cut(along("y", 15, -10, 10))
    key = box((-2, 2), (-8, 8), (-2, 2))
    ring = along("y", 17, 0, 2).cut(along("y", 15, 0, 2))
    gearbox_ = cq.Assembly(name="gearbox")
    housing = cq.Assembly(name="housing")
    housing.add(body, name="upper_half")
    housing.add(body, name="lower_half", loc=at(angle=180, axis=(1, 0, 0)))
    bolts = cq.Assembly(name="bolts")
    for k, (x, y) in enumerate(holes):
        bolts.add(bolt, name=f"bolt_{k + 1}", loc=at(x, y, 90))
    housing.add(bolts, name="bolts")
    gearbox_.add(housing, name="housing")
    for k, x in enumerate(shafts):
        train = cq.Assembly(name=f"train_{k + 1}")
        train.add(shaft, name="shaft")
        for n, y in enumerate((-40, 0, 40)):
            train.add(gear, name=f"gear_{n + 1}", loc=at(y=y))
        bearings = cq.Assembly(name="bearings")
        for n, y in enumerate((-100, 85)):
            bearings.add(bearing, name=f"bearing_{n + 1}", loc=at(y=y))
        train.add(bearings, name="bearings")
        for n, y in enumerate((-102, -82, 60, 100)):
            train.add(ring, name=f"ring_{n + 1}", loc=at(y=y))
        for n, z in enumerate((30, 60, -30, -60)):
            train.add(key, name=f"key_{n + 1}", loc=at(y=70, x=40, z=z))
        gearbox_.add(train, name=f"train_{k + 1}", loc=at(x=x))
    extra = cq.Assembly(name="plugs")
    plug = along("z", 8, 0, 6)
    for k, x in enumerate((-90, 90)):
        extra.add(plug, name=f"plug_{k + 1}", loc=at(x, 0, height))
    gearbox_.add(extra, name="plugs")
    write(gearbox_, "gearbox.step")


def rounds():
    """Solids with poles and an apex, and with none of them: of one face, or two. Lengths in mm."""
    machine = cq.Assembly(name="rounds")
    for k, (name, solid) in enumerate({
        "ball": cq.Solid.makeSphere(25, angleDegrees1=-90, angleDegrees2=90),
        "cone": cq.Solid.makeCone(20, 0, 50),
        "torus": cq.Solid.makeTorus(30, 10),
        "dome": cq.Solid.makeSphere(15, angleDegrees1=0, angleDegrees2=90),
        "bearing_ball": cq.Solid.makeSphere(2, angleDegrees1=-90, angleDegrees2=90),
    }.items()):
        machine.add(cq.Workplane(solid), name=name, loc=at(x=100 * k))
    write(machine, "rounds.step")


def surface():
    """A sheet without thickness: no solid."""
    sheet = cq.Face.makePlane(100, 50)
    cq.exporters.export(cq.Workplane(sheet), str(HERE / "surface.step"))


if __name__ == "__main__":
    slider_crank()
    bucket()
    gearbox()
    rounds()
    surface()
