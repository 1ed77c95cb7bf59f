"""Common parts of drum.py, hopper.py and resting_bed.py. The first stage runs a scene until it is in the state to be
timed; the second stage continues from its restart files and is timed."""
import argparse
import json
import math
import pathlib
import re
import shlex
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from record import record  # noqa: E402

RADIUS, DENSITY, POISSON = 0.01, 2500.0, 0.25  # [m], [kg/m3], [-]
VOLUME = 4 / 3 * math.pi * RADIUS**3           # of a sphere [m3]
SPACING = 2.02 * RADIUS
LATTICE = math.sqrt(2) / SPACING**3            # spheres per volume of a close packing that is not quite closed [1/m3]
BED = 0.6                                      # share of the volume that spheres take in a bed that was poured
GRAVITY, WINDOW = 9.81, 1e-3                   # [m/s2], [s]
MORE_COLUMNS = ["contacts", "list_rebuilds", "rebuild_share", "dem_memory_MB", "bytes_per_sphere",
                "dem_solver_seconds", "dem_solver_cpu_seconds", "sphere_steps_per_s", "from_s"]


def arguments(text, timed=0.2):
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tandem")
    parser.add_argument("spheres", type=int)
    parser.add_argument("out", type=pathlib.Path, help="takes scene.json and the runs `first` and `timed`")
    parser.add_argument("--backend", default="cpu", choices=["cpu", "cuda"])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--contact", default="hertz_mindlin")
    parser.add_argument("--young", type=float, default=1e8, help="Young's modulus [Pa]")
    parser.add_argument("--first", type=float, help="simulated time of the first stage [s]")
    parser.add_argument("--time", type=float, default=timed, help="simulated time of the timed stage [s]")
    parser.add_argument("--record", nargs=2, metavar=("CSV", "COMMIT"), help="adds a row to this file of results")
    return parser


def micro_step(young):
    """The micro step [s]: about 0.15 of the Rayleigh time, and a whole number of steps per window."""
    rayleigh = math.pi * RADIUS * math.sqrt(DENSITY * 2 * (1 + POISSON) / young) / (0.1631 * POISSON + 0.8766)
    return WINDOW / math.ceil(WINDOW / (0.15 * rayleigh))


def scene(given, name, walls, low, high, domain):
    """Spheres of one size, close-packed from `low` upwards, in a box up to `high`."""
    return {
        "tandem": "1.0", "name": f"{name}_{given.spheres}", "end_time": 1.0, "coupling": {"window": WINDOW},
        "dem": {
            "materials": [{"name": "glass", "density": DENSITY, "young": given.young, "poisson": POISSON}],
            "pairs": [{"a": "glass", "b": "glass", "restitution": 0.5,
                       **({} if given.contact == "hertz_frictionless" else {"friction": 0.4})}],
            "contact": given.contact,
            "micro_step": micro_step(given.young),
            "particles": [{"name": "spheres", "material": "glass", "radius": RADIUS,
                           "fill": {"type": "lattice", "lattice": "hexagonal", "min": low, "max": high,
                                    "spacing": SPACING, "jitter": 0.9, "count": given.spheres}}],
            "walls": walls,
            "domain": {"min": domain[0], "max": domain[1]},
        },
    }


def windows(seconds):
    """The nearest whole number of windows [s]."""
    return round(max(1, round(seconds / WINDOW)) * WINDOW, 9)


def tandem_run(given, folder, end, *more):
    subprocess.run([given.tandem, "run", given.out / "scene.json", "--backend", given.backend, "--threads",
                    str(given.threads), "--end-time", repr(end), "--no-report", "--no-picture", "--quiet", "--out",
                    given.out / folder, *more], check=True)
    return json.loads((given.out / folder / "summary.json").read_text())


def run(given, text, first, frames=1):
    """Returns the summary of the timed stage, with the steps and rebuilds of that stage alone. `first`: how long the
    first stage lasts unless the command line says so [s]."""
    first = windows(given.first if given.first is not None else first)
    timed = windows(given.time)
    text["output"] = text.get("output", {}) | {"frame_interval": windows(timed / frames)}
    text["end_time"] = first + timed
    given.out.mkdir(parents=True, exist_ok=True)
    (given.out / "scene.json").write_text(json.dumps(text, indent=1))
    before = tandem_run(given, "first", first, "--checkpoint-every", repr(first))
    summary = tandem_run(given, "timed", windows(first + timed), "--restart", given.out / "first")
    for key in ("micro_steps", "list_rebuilds"):
        summary[key] -= before[key]
    summary["rebuild_share"] = summary["list_rebuilds"] / summary["micro_steps"]
    summary["bytes_per_sphere"] = round(1e6 * summary["dem_memory_MB"] / summary["spheres"])
    summary["from_s"] = first
    print(f"{summary['scene']} on {summary['device']} ({summary['backend']}, {summary['variant']}), "
          f"{first:g} s to {first + timed:g} s: {summary['us_per_micro_step']:.1f} us per step, "
          f"{summary['sphere_steps_per_s']:.3g} sphere-steps/s, {summary['contacts']} contacts "
          f"({2 * summary['contacts'] / summary['spheres']:.1f} touching neighbours), {summary['list_rebuilds']} "
          f"rebuilds in {summary['micro_steps']} steps ({100 * summary['rebuild_share']:.2f} % of the steps), "
          f"{summary['bytes_per_sphere']} B per sphere, {summary['lost_particles']} lost")
    return summary


def keep(given, summary, **found):
    """Adds the row that --record requests, with the figures of the script next to those of the summary."""
    if given.record:
        options = sys.argv[4:]
        at = options.index("--record")
        command = shlex.join([pathlib.Path(sys.argv[0]).name, str(given.spheres), *options[:at], *options[at + 3:]])
        record(given.record[0], summary | found, given.record[1], command, MORE_COLUMNS + list(found))


def frames(folder):
    """The frames of a run: (time [s], group of particles.h5), in order."""
    import h5py
    times = re.findall(r'<Time Value="([^"]*)"', (folder / "particles.xdmf").read_text())
    file = h5py.File(folder / "particles.h5")
    return [(float(time), file[f"frame_{i:06d}"]) for i, time in enumerate(times)]
