"""stability_map.py MAP.csv PICTURE.png: where a window is stable, by scheme, mass of the bed and omega H."""

import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROUND_OFF = 1e-6  # growth of an undamped mode that comes out as one

rows = list(csv.DictReader(open(sys.argv[1])))
schemes = list(dict.fromkeys(row["scheme"] for row in rows))
ratios = sorted({float(row["mass_ratio"]) for row in rows})
steps = sorted({float(row["omega_H"]) for row in rows})
growth = {(r["scheme"], float(r["mass_ratio"]), float(r["omega_H"])): float(r["growth"]) for r in rows}

# The wall (no mass) has a place of its own at the left of the logarithmic axis.
places = [ratios[1] / 4 if ratio == 0 else ratio for ratio in ratios]
figure, panels = plt.subplots(2, (len(schemes) + 1) // 2, figsize=(13, 6.2), sharex=True, sharey=True)
for scheme, panel in zip(schemes, panels.flat):
    field = np.array([[growth[scheme, ratio, step] for ratio in ratios] for step in steps])
    excess = np.where(field < 0, np.nan, np.log10(np.maximum(field - 1, 1e-7)))
    colours = plt.get_cmap("YlOrRd").copy()
    colours.set_bad("0.6")
    shown = np.ma.masked_invalid(np.where(field <= 1 + ROUND_OFF, -7, excess))
    mesh = panel.pcolormesh(places, steps, shown, cmap=colours, vmin=-3, vmax=1, shading="nearest")
    stable = np.where(field < 0, 2, field)
    if stable.max() > 1 + ROUND_OFF:
        panel.contour(places, steps, stable, levels=[1 + ROUND_OFF], colors="tab:blue", linewidths=1.5)
    panel.set(xscale="log", yscale="log", title=scheme)
for panel in panels[-1]:
    panel.set_xlabel("mass of bed / of body")
for panel in panels[:, 0]:
    panel.set_ylabel("omega H")
ticks = [places[0], 1e-2, 1, 1e2]
panels[0][0].set_xticks(ticks, ["wall", "0.01", "1", "100"])
bar = figure.colorbar(mesh, ax=panels, shrink=0.8)
bar.set_label("log10(growth per window - 1); grey: the iteration does not converge")
figure.savefig(sys.argv[2], dpi=110, bbox_inches="tight")
