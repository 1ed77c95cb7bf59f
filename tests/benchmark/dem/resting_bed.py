#!/usr/bin/env python3
"""Continues a settled packed bed from restart files for 100,000 steps and reports whether it stays at rest.
Usage: resting_bed.py TANDEM SPHERES OUT [--backend cpu|cuda] [--first S] [--time S] [--record CSV COMMIT] ...
Needs python3-h5py. At the default stiffness a step is 40 us, so that --time 4 is 100,000 steps."""
import csv
import json
import pathlib
import subprocess
import sys

import stages

given = stages.arguments(__doc__, timed=4).parse_args()
given.out.mkdir(parents=True, exist_ok=True)
bed = given.out / "bed.json"
subprocess.run([sys.executable, pathlib.Path(__file__).with_name("packed_bed.py"), str(given.spheres), bed, "--contact",
                given.contact, "--young", repr(given.young)], check=True)
summary = stages.run(given, json.loads(bed.read_text()), 2, frames=10)

MASS = stages.VOLUME * stages.DENSITY  # [kg]
lift = given.spheres * MASS * stages.GRAVITY * stages.RADIUS  # [J]


def state(frame):
    """Kinetic energy relative to `lift`, mean height [m], largest speed [m/s]."""
    speed2, spin2 = ((frame[of][:].astype(float) ** 2).sum(axis=1) for of in ("velocity", "spin"))
    energy = MASS / 2 * (speed2.sum() + 0.4 * stages.RADIUS**2 * spin2.sum())
    return energy / lift, frame["position"][:, 2].mean(), speed2.max() ** 0.5


print("kinetic energy in parts of what lifts all spheres by a radius R")
states = []
for time, frame in stages.frames(given.out / "timed"):
    states.append(state(frame))
    energy, height, speed = states[-1]
    print(f"  {time:7.3f} s: kinetic energy {energy:.3e}, mean height {height:.6f} m "
          f"({(height - states[0][1]) / stages.RADIUS:+.2e} R), largest speed {speed:.2e} m/s")
with open(given.out / "timed" / "windows.csv", newline="") as file:
    recorded = max(float(row["kinetic_energy"]) for row in csv.DictReader(file))
drift, speed = (states[-1][1] - states[0][1]) / stages.RADIUS, max(s[2] for s in states)
print(f"{given.spheres} spheres, {summary['micro_steps']} steps: kinetic energy {states[0][0]:.3e} at first, "
      f"{states[-1][0]:.3e} in the end, in no window above {recorded / lift:.1e}; mean height moved by {drift:+.2e} R; "
      f"largest speed {speed:.2e} m/s; {summary['lost_particles']} lost")
stages.keep(given, summary, energy_at_first=f"{states[0][0]:.3e}", energy=f"{states[-1][0]:.3e}",
            energy_at_most=f"{recorded / lift:.3e}", height_drift_radii=f"{drift:.3e}",
            largest_speed_m_per_s=f"{speed:.3e}", lost_particles=summary["lost_particles"])
