"""A scene of the gallery, changed: another friction, and twice the gate's speed."""
import pathlib

import tandem as td
from tandem.program import data_folder

hopper = pathlib.Path(data_folder()) / "scenes" / "gallery" / "hopper.json"
for friction in (.1, .4):
    s = td.load(hopper)
    s["glass"].friction = friction
    s["slide"].motion = td.table([0, .05, .1], [0, 0, .1])
    s.end_time = .4
    del s.data["checks"]                                            # they are for the friction of the file
    r = s.run(f"out/gallery_{friction}", picture=False)
    print(f"friction {friction}: {-r['hole.flow'].mean(.2):.3f} kg/s, {r.verdict}")
