#!/usr/bin/env python3
"""Whole runs with solvers of others beside tandem's own: errors and times, a row per run.

usage: foreign.py SOURCES BIN CSV COMMIT DEVICE [SCENE...]

spring_box: static elongation over the last 2 s and period of the first oscillations, against their closed forms; scheme
implicit ends after 4 s and has the period alone. box_weight: mean force on the box over the last second, against the
weight. chain (bodies alone): largest difference of a position or reaction to tandem's solver with steps of 0.1 ms, over
the largest value. small_waterfall: angle of the wheel at the end, against tandem's own solvers with windows of 0.25 ms;
the flow is chaotic, and tandem's own runs with other windows show how far that alone goes.
A run that is refused has the sentence instead of figures.
"""
import csv
import datetime
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

COLUMNS = ["date", "commit", "device", "command", "scene", "scheme", "mbd", "dem", "quantity", "value", "reference",
           "relative_error", "simulated_s", "windows", "wall_us_per_window", "mbd_us_per_window", "dem_us_per_window",
           "energy_residual", "momentum_balance", "status"]
SOURCES, BIN = (pathlib.Path(path) for path in sys.argv[1:3])
FOREIGN = SOURCES / "foreign"
MBD = {"tandem": None, "mujoco": f"{FOREIGN}/mujoco/venv/bin/python {FOREIGN}/mujoco/mujoco_bodies.py",
       "simbody": f"{FOREIGN}/simbody/build/simbody_bodies"}
DEM = {"tandem": None, "liggghts": f"/usr/bin/python3 {FOREIGN}/liggghts/liggghts_spheres.py"}
PAIRS = [("tandem", "tandem"), ("mujoco", "tandem"), ("simbody", "tandem"), ("tandem", "liggghts"), ("mujoco", "liggghts")]
SPRING_BOX, BOX_WEIGHT = (SOURCES / f"launch/scenes/{name}.json" for name in ("spring_box", "box_weight"))
CHAIN, WATERFALL = (FOREIGN / f"scenes/{name}.json" for name in ("chain", "small_waterfall"))


def run(scene, mbd, dem, folder, *arguments):
    """Summary and folder of a run, or the sentence with which it was refused."""
    out = pathlib.Path(folder) / f"{scene.stem}_{mbd}_{dem}_{'_'.join(arguments)}"
    servers = [word for side, command in (("mbd", MBD[mbd]), ("dem", DEM[dem])) if command
               for word in (f"--{side}-server", command)]
    said = subprocess.run([BIN / "tandem", "run", scene, "--out", out, "--threads", "1", "--no-picture", "--no-report",
                           *servers, *arguments], capture_output=True, text=True, check=False)
    text = said.stdout + said.stderr
    if said.returncode not in (0, 1):
        return None, re.search(r"error:? (.*)", text)[1][:300]
    return json.loads((out / "summary.json").read_text()), out


def columns(out, file):
    with open(out / file, newline="", encoding="utf-8") as rows:
        table = list(csv.DictReader(rows))
    return {name: [float(row[name]) for row in table] for name in table[0]}


def of_checks(*names):
    def figures(summary, _):
        return [(check["name"], check["value"], check["expected"]) for check in summary["checks"] if check["name"] in names]
    return figures


def period(_, out):
    """Mean distance of upward passes through the middle between 0.5 and 3.5 s, as of the scene's check."""
    joint = columns(out, "joints.csv")
    points = [(t, q) for t, q in zip(joint["time"], joint["slide.q"]) if 0.5 <= t <= 3.5]
    middle = sum(q for _, q in points) / len(points)
    passes = [t0 + (t1 - t0) * (middle - q0) / (q1 - q0) for (t0, q0), (t1, q1) in zip(points, points[1:]) if q0 < middle <= q1]
    return [("period [s]", (passes[-1] - passes[0]) / (len(passes) - 1), 0.424448)]


def angle(reference):
    return lambda _, out: [("angle of the wheel [rad]", columns(out, "joints.csv")["hinge.q"][-1], reference)]


def difference(reference):
    def figures(_, out):
        worst = []
        for file in ("bodies.csv", "joints.csv"):
            theirs, ours = columns(out, file), columns(reference, file)
            kind = {"bodies.csv": ".position.", "joints.csv": ".reaction_force."}[file]
            names = [name for name in ours if kind in name]
            largest = max(abs(value) for name in names for value in ours[name])
            gap = max(abs(a - b) for name in names for a, b in zip(ours[name], theirs[name]))
            worst.append((f"largest difference of {kind.strip('.')}", gap / largest, 0))
        return worst
    return figures


def main():
    if len(sys.argv) < 6:
        sys.exit(__doc__)
    table, commit, device = sys.argv[3:6]
    chosen = sys.argv[6:] or ["chain", "small_waterfall", "spring_box", "spring_box_half", "box_weight"]
    with tempfile.TemporaryDirectory() as folder:
        def record(scene, scheme, mbd, dem, figures, *arguments):
            summary, out = run(scene, mbd, dem, folder, *(["--scheme", scheme] if scheme else []), *arguments)
            row = dict.fromkeys(COLUMNS, "") | {
                "date": datetime.date.today().isoformat(), "commit": commit, "device": device,
                "command": f"foreign.py {scene.stem}", "scene": scene.stem, "scheme": scheme, "mbd": mbd, "dem": dem}
            if summary is None:
                row["status"] = f"refused: {out}"
                results = [("", "", "")]
            else:
                n, split = summary["windows"], summary["time_split"]
                # A solver's own time, where it reports one: where cores are few, it may run while the coordinator is still sending.
                own = {side: summary.get(f"{side}_solver_seconds") or split[side] for side in ("mbd", "dem")}
                row |= {"simulated_s": summary["end_time_s"] if "end_time_s" in summary else summary["simulated_s"], "windows": n,
                        "wall_us_per_window": f"{1e6 * summary['wall_s'] / n:.1f}",
                        "mbd_us_per_window": f"{1e6 * own['mbd'] / n:.1f}", "dem_us_per_window": f"{1e6 * own['dem'] / n:.1f}",
                        "energy_residual": summary.get("energy_residual"), "momentum_balance": summary.get("momentum_balance"),
                        "status": summary["status"]}
                results = figures(summary, out)
            fresh = not os.path.exists(table)
            with open(table, "a", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
                if fresh:
                    writer.writeheader()
                for quantity, value, reference in results:
                    error = "" if value == "" else value if reference == 0 else value / reference - 1
                    writer.writerow(row | {"quantity": quantity, "value": value, "reference": reference, "relative_error": error})
                    print(scene.stem, scheme, mbd, dem, quantity, value, error, row["wall_us_per_window"], row["status"][:150], flush=True)

        if "chain" in chosen:
            _, reference = run(CHAIN, "tandem", "tandem", folder)
            for mbd in ("mujoco", "simbody"):
                record(CHAIN, "", mbd, "tandem", difference(reference))
        if "small_waterfall" in chosen:
            _, out = run(WATERFALL, "tandem", "tandem", folder, "--window", "0.00025")
            reference = columns(out, "joints.csv")["hinge.q"][-1]
            record(WATERFALL, "dem_first", "tandem", "tandem", angle(reference), "--window", "0.0005")
            for pair in PAIRS:
                record(WATERFALL, "dem_first", *pair, angle(reference))
            for pair in PAIRS:
                record(WATERFALL, "implicit", *pair, angle(reference))
        if "spring_box_half" in chosen:  # windows of 0.5 ms, which LIGGGHTS needs
            record(SPRING_BOX, "dem_first", "tandem", "liggghts", of_checks("static elongation [m]", "period [s]"), "--window", "0.0005")
        if "spring_box" in chosen:
            for pair in PAIRS:
                record(SPRING_BOX, "dem_first", *pair, of_checks("static elongation [m]", "period [s]"))
            for pair in PAIRS:
                record(SPRING_BOX, "implicit", *pair, period, "--end-time", "4")
        if "box_weight" in chosen:
            for pair in PAIRS:
                record(BOX_WEIGHT, "dem_first", *pair, of_checks("mean force on the box [N]"))
            for pair in PAIRS:
                record(BOX_WEIGHT, "implicit", *pair, of_checks("mean force on the box [N]"))


if __name__ == "__main__":
    main()
