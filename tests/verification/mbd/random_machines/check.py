#!/usr/bin/env python3
"""Random machines through the solver, each judged against an independent integration.

A machine is right when, at eight times, no body is further from its reference than ten times the error tolerance and at least
1e-4 of the machine's size (or rad), and no speed is off by more than a hundred times that share of the fastest one (speeds of
vibrations of stiff machines are not judged). A run with fixed steps may be three times as wrong as it says itself
(mbd_position_error_estimate, or mbd_local_error_sum where that is not known). Machines written with few digits may add ten units of the last digit, times the
measured growth of small errors. Not judged is what comes after small errors have grown more than tenfold, or after a
position near which the machine may go on in more than one way. A machine that scipy cannot integrate within --seconds is judged
against the solver's own run at a quarter of the step in another frame.
Exit status 1: some machine is silently wrong, or more than 2 % are refused.
"""
import argparse
import collections
import json
import multiprocessing
import os
import pathlib
import subprocess
import sys
import tempfile

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402, after the number of threads

import machines  # noqa: E402
import pose  # noqa: E402
from reference import CannotGo, angle_between, growth, reference, size_of  # noqa: E402

BAR = 1e-4
GROWN = 10.0
# Singular values of the constraints that have become smaller than this share of those at the start.
SINGULAR = 0.05
REFUSED = 0.02
ROUND_OFF = 1e-7  # of the references and of data: smaller errors are not compared with what a run says
TRIED = {"ok": "ok", "refused": "refused", "too slow": "refused", "died": "died", "untyped error": "died"}


def solve(program, scene, seconds, folder, name="scene"):
    """The solver's answer to a scene, as run_machines prints it."""
    file = pathlib.Path(folder) / f"{name}.json"
    file.write_text(json.dumps(scene, indent=1))
    done = subprocess.run([program, str(seconds)], input=f"{file}\n", capture_output=True, text=True, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    return json.loads(lines[-1]) if lines else {"status": "died", "what": done.stderr[-300:]}


def motion_of(answer):
    """Positions, quaternions, velocities and angular velocities over time and bodies."""
    frames = [[np.array(part, float) for part in zip(*frame["bodies"])] for frame in answer["frames"]]
    return tuple(np.array([frame[k] for frame in frames]) for k in range(4))


def own_run(program, scene, seconds, folder, finer):
    """The solver's motion at a finer step, in another frame, moved back into the scene's own."""
    rng = np.random.default_rng(7)
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    R, t = pose.matrix(q), size_of(scene) * rng.normal(size=3)
    other = machines.plain(pose.moved(scene, q, t))
    settings = other["mbd"]["integrator"]
    if "step" in settings:
        settings["step"] /= finer
    else:
        settings["error_tolerance"] /= finer**3  # the local error is of third order
    answer = solve(program, other, 4 * seconds, folder, "other")
    if answer["status"] != "ok":
        raise CannotGo(f"the fine run is {answer['status']}: {answer.get('what')}")
    x, p, v, w = motion_of(answer)
    back = np.concatenate([[q[0]], -q[1:]])
    turned = np.array([[pose.product(back, one) for one in row] for row in p])
    return (x - t) @ R, turned, v @ R, w @ R


def own_reference(program, scene, seconds, folder):
    """A run at a quarter of the step that agrees with one at half of it."""
    motion = own_run(program, scene, seconds, folder, 4)
    spread = distances(motion, own_run(program, scene, seconds, folder, 2), size_of(scene)).max()
    if spread > BAR:
        raise CannotGo(f"the solver's own fine runs differ by {spread:.2g} of the size")
    return motion


def own_growth(program, scene, seconds, folder, motion):
    """How far masses and gravity that are wrong by 1e-5 move the machine, as a multiple of that."""
    other, share, rng = machines.plain(scene), 1e-5, np.random.default_rng(3)
    other["gravity"] = [g * (1 + share) for g in other["gravity"]]
    for body in other["mbd"]["bodies"]:
        factor = 1 + share * rng.normal()
        body["mass"] *= factor
        body["inertia"] = [J * factor for J in body["inertia"]]
    near = own_run(program, other, seconds, folder, 4)
    return np.maximum(1, np.maximum.accumulate(distances(motion, near, size_of(scene)) / share))


def distances(a, b, size):
    """Largest over the bodies at each time, of positions as a share of the size, and of angles."""
    return np.maximum(np.linalg.norm(a[0] - b[0], axis=-1).max(1) / size, angle_between(a[1], b[1]).max(1))


def judge(scene, facts, answer, motion, grown):
    """Largest share of the bar that any body is off at, and where."""
    size, T = size_of(scene), scene["end_time"]
    x, p, v, w = motion_of(answer)
    X, P, V, W = motion
    settings = scene["mbd"]["integrator"]
    bar = max(BAR, 10 * settings.get("error_tolerance", 0))
    unit = 10.0 ** -facts["digits"] * 10 * max(1, facts["length"] / size) if facts["digits"] < 17 and facts["loops"] else 0.0
    fast = max(size / T, np.linalg.norm(V, axis=-1).max(), size * np.linalg.norm(W, axis=-1).max())
    position = distances((x, p), motion, size)
    speed = np.maximum(np.linalg.norm(v - V, axis=-1).max(1), size * np.linalg.norm(w - W, axis=-1).max(1)) / fast
    counts = grown <= GROWN
    counts[0] = True
    # What the run itself says of its error counts, to a factor of three. The sum of the local errors does not
    # contain how they grow. Beyond 0.01 the verdict objects.
    said, factor = answer["report"].get("mbd_position_error_estimate"), 3
    if not isinstance(said, float):
        said, factor = answer["report"].get("mbd_local_error_sum"), 3 * np.sqrt(6 * len(scene["mbd"]["bodies"]))
    if said is not None and said < 0.01:
        bar = max(bar, factor * said)
    allowed = bar + 10 * unit * np.minimum(grown, GROWN)
    # A vibration whose way is below the bar may be out of phase, with speeds to match.
    speed_share = 0 if facts["class"] == "stiff" else speed / (100 * allowed)
    share = np.where(counts, np.maximum(position / allowed, speed_share), 0)
    k = int(np.argmax(share))
    return {"share": float(share.max()), "position": float(position[counts].max()), "speed": float(speed[counts].max()),
            "window": k, "judged": int(counts.sum()), "said": said, "at end": float(position[-1]) if counts[-1] else None}


def judge_as_written(written, facts, answer, times, grown, options):
    """Where rounded data still close the loops: the machine of these data, which may move it more than small errors
    of its start do."""
    try:
        found = reference(written, times, options.seconds)
    except CannotGo:
        return {}
    return judge(written, facts | {"digits": 17}, answer, found["motion"], grown) | {"reference": "as written"}


def say_of_statements(rows):
    """How many runs are off at their end by more than they say themselves, of those over which the verdict is content.

    Loops of rounded data are left out: their reference is the machine before rounding, of which the run knows nothing."""
    said = [r for r in rows if r.get("said") is not None and r.get("at end") is not None and r["said"] < 0.01
            and (r["digits"] == 17 or not r["loops"])]
    off = {factor: sum(r["at end"] > max(ROUND_OFF, factor * r["said"]) for r in said) for factor in (3, 10)}
    print(f"stated errors: {len(said)} runs; {off[3]} are off by more than three times what they say, {off[10]} by more than ten times")
    for r in said:
        if r["at end"] > max(ROUND_OFF, 3 * r["said"]):
            print(f"  {r['number']:5d} {r['class']:16s} off by {r['at end']:.2g}, says {r['said']:.2g}")


def verdict_of_run(tandem, scene, seconds, folder):
    """What `tandem run` says of a machine; nothing if it is content."""
    file, out = pathlib.Path(folder) / "judged.json", pathlib.Path(folder) / "judged"
    file.write_text(json.dumps(scene))
    ended = subprocess.run([tandem, "run", str(file), "--out", str(out), "--quiet"], capture_output=True, text=True,
                           timeout=20 * seconds)
    if ended.returncode:
        return [ended.stderr.strip()]
    summary = json.loads((out / "summary.json").read_text())
    lines = summary["verdict"]["lines"]
    return [line["sentence"] for line in lines] if summary["status"] == "suspect" else []


def energy_of(answer):
    return [f["energy"] for f in [answer["start"], *answer["frames"]]]


def examine(task):
    """One machine from its number to its verdict."""
    number, options = task
    written, meant, facts = machines.make(options.seed, number, options.elements)
    row = dict(facts)
    with tempfile.TemporaryDirectory() as folder:
        answer = solve(options.program, written, options.seconds, folder)
        row |= {"status": answer["status"], "what": answer.get("what", ""), "code": answer.get("code", "")}
        row["dof"] = answer.get("facts", {}).get("dof")
        row["redundant"] = len(answer.get("facts", {}).get("mbd_redundant_equations") or [])
        row["warnings"] = answer.get("report", {}).get("warnings", [])
        row["verdict"] = TRIED[answer["status"]]
        if row["verdict"] == "ok" or options.all_references:
            try:
                times = [w * meant["coupling"]["window"] for w in range(1, machines.WINDOWS + 1)]
                found = reference(meant, times, options.seconds)
                motion, grown = found["motion"], np.ones(machines.WINDOWS)
                grown[found["condition"] < SINGULAR * found["condition"][0]] = np.inf
                row |= {"reference": found["method"].__name__, "right dof": found["dof"], "right redundant": found["redundant"],
                        "drift": found["drift"], "condition": float(found["condition"].min()), "took": found["seconds"]}
            except CannotGo as why:
                row |= {"reference": "own", "why": str(why)}
                try:
                    motion, grown = own_reference(options.program, meant, options.seconds, folder), np.ones(machines.WINDOWS)
                except CannotGo as why_not:
                    row |= {"reference": "none", "why": f"{why}; {why_not}"}
            if row["verdict"] == "ok" and row["reference"] == "none":
                row["verdict"] = "no reference"
            elif row["verdict"] == "ok":
                row |= judge(meant, facts, answer, motion, grown)
                if not row["share"] <= 1:
                    try:
                        own = row["reference"] == "own"
                        grown = np.maximum(grown, own_growth(options.program, meant, options.seconds, folder, motion) if own
                                           else growth(found, times, options.seconds))
                    except CannotGo as why:
                        row["why"] = f"small errors could not be followed: {why}"
                    row |= judge(meant, facts, answer, motion, grown) | {"growth": float(grown[-1])}
                if not row["share"] <= 1 and facts["digits"] < 17:
                    row |= judge_as_written(written, facts, answer, times, grown, options)
                row["energy"] = energy_of(answer)
                if row["share"] > 1 or not np.isfinite(row["share"]):
                    row["warnings"] += verdict_of_run(options.tandem, written, options.seconds, folder)
                    row["verdict"] = "warned" if row["warnings"] else "wrong"
        if options.keep and row["verdict"] != "ok":
            keep = pathlib.Path(options.keep)
            keep.mkdir(parents=True, exist_ok=True)
            name = f"{row['verdict'].replace(' ', '_')}_{options.seed}_{number}"
            (keep / f"{name}.json").write_text(json.dumps(written, indent=1))
            (keep / f"{name}.facts.json").write_text(json.dumps(row, indent=1, default=float))
    return row


def say(row):
    line = f"  {row['number']:5d} {row['class']:16s} {'+'.join(row['parts'])[:60]}; {row['stand']}; {row['digits']} digits; "
    line += f"{row['step']} step; masses 1:{row['mass_ratio']:.0f}; {row['length']:.3g} m; "
    if "share" in row:
        line += (f"{row['share']:.3g} of the bar ({row['position']:.2g} of the size, {row['speed']:.2g} of the speed, window "
                 f"{row['window'] + 1}; {row['reference']}); ")
    if row.get("right dof") is not None and row.get("dof") is not None:
        line += f"dof {row['dof']} (reference {row['right dof']}), redundant {row['redundant']} ({row['right redundant']}); "
    return line + row["what"] + ("; ".join(map(str, row["warnings"]))) + (f" [{row['why']}]" if "why" in row else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/dev/tests/run_machines", help="of the build to be judged")
    parser.add_argument("--tandem", default="build/dev/bin/tandem", help="that says what it thinks of a run which is not right")
    parser.add_argument("--count", type=int, default=100, help="number of machines")
    parser.add_argument("--seed", type=int, default=1, help="of the generator")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of the machines to run, of this seed")
    parser.add_argument("--elements", action="store_true", help="machines with motors, cylinders, ropes and couplers")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes at once")
    parser.add_argument("--seconds", type=int, default=20, help="processor time for each reference, and for each run")
    parser.add_argument("--keep", help="folder for scenes that are not right")
    parser.add_argument("--all-references", action="store_true", help="integrate refused machines as well")
    parser.add_argument("--rows", help="file for one line of JSON per machine, as they come")
    options = parser.parse_args()
    numbers = options.only or range(options.count)
    with multiprocessing.Pool(options.jobs) as pool, open(options.rows or os.devnull, "w") as file:
        rows = []
        for row in pool.imap_unordered(examine, [(n, options) for n in numbers], chunksize=1):
            rows.append(row)
            print(json.dumps(row, default=float), file=file, flush=True)
            if row["verdict"] != "ok":
                print(f"{row['verdict']}:\n{say(row)}", flush=True)
    rows.sort(key=lambda r: r["number"])
    verdicts = ["ok", "refused", "warned", "wrong", "died", "no reference"]
    count = collections.Counter((r["class"], r["verdict"]) for r in rows)
    print(f"\n{'class':18s}{'machines':>9s}" + "".join(f"{('right' if v == 'ok' else v):>14s}" for v in verdicts))
    for kind in (*(machines.ELEMENT_CLASSES if options.elements else machines.CLASSES), "all"):
        line = [sum(n for (k, v), n in count.items() if kind in (k, "all") and v == verdict) for verdict in verdicts]
        print(f"{kind:18s}{sum(line):9d}" + "".join(f"{n:14d}" for n in line))
    references = collections.Counter(r.get("reference", "not needed") for r in rows)
    print("references: " + ", ".join(f"{k} {n}" for k, n in references.items()))
    say_of_statements(rows)
    bad = [r for r in rows if r["verdict"] in ("wrong", "died")]
    refused = sum(r["verdict"] in ("refused", "warned", "no reference") for r in rows)
    if bad:
        print(f"silently wrong: {len(bad)}")
    if refused > REFUSED * len(rows):
        print(f"refused: {refused} of {len(rows)}, more than {100 * REFUSED:g} %")
    return 1 if bad or refused > REFUSED * len(rows) else 0


if __name__ == "__main__":
    sys.exit(main())
