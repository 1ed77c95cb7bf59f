"""Variants that are built by a function: width and pitch of the excavator's bucket, by kilograms per joule.

Run `python3 excavator_meshes.py` first."""
import tandem as td
from excavator import s


def variant(width, pitch):
    v = s.copy()
    v["bucket"].scale(y=width).rotate("y", td.deg(pitch))
    return v


best = td.sweep(variant, width=[.8, 1], pitch=range(-10, 11, 10), jobs=2,
                score=lambda r: r.mass_in("bucket") / (r["lift"].work + r["curl"].work))
print(best.table())
print("the best:", best.best())
best.picture("bucket.png")
