"""An excavator digs in a bed of gravel: two cylinders move boom and bucket, and the gravel answers.

Run `python3 excavator_meshes.py` first, which writes boom.stl and bucket.stl into this folder. The run is `suspect`: the lip of the bucket
presses soft gravel by more than a twentieth of its radius. The verdict says which modulus would do, and what that costs."""
import tandem as td

s = td.Scene("excavator", end_time=4)
gravel = s.material("gravel", density=2600, young=5e7, friction=0.6, restitution=0.3)
steel = s.material("steel", density=7850, young=1e9, friction=0.4, restitution=0.3)
boom = s.body("boom", mesh="boom.stl", scale=1e-3, density=7850)
bucket = s.body("bucket", mesh="bucket.stl", scale=1e-3, density=7850)
s.revolute("pivot", "ground", boom, at=(0, 0, .7), axis="y")
s.revolute("tip", boom, bucket, at=(1, 0, .7), axis="y")
lift = s.cylinder("lift", "ground", boom, a=(.1, 0, .2), b=(.55, 0, .65), max_force=40e3)
curl = s.cylinder("curl", boom, bucket, a=(.35, 0, .85), b=(1, 0, .85), max_force=25e3)
lift.stroke = td.table([0, .5, 1.5, 3], [0, 0, -.11, .06])
curl.stroke = td.table([0, 1, 2, 3], [0, 0, .12, .12])
bed = s.box("bed", (1.4, .5, .8), at=(1.1, 0, .4), open="+z", material=steel)
bucket.wall(material=steel)
s.fill(bed, gravel, radius=td.normal(.02, .003), height=.3, settle=True)

if __name__ == "__main__":
    r = s.run(progress=True)
    print(r, *r.verdict.lines, f"{r.mass_in('bucket'):.1f} kg in the bucket", sep="\n")
    r.plot(["lift.force", "lift.power", "bucket.contact_force"], "excavator.png")
    r.movie("dig.mp4", fps=30)
