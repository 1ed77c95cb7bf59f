#!/usr/bin/python3
"""Stands in for the program in tests of sweeps: `run SCENE --out DIR` writes results whose score is x squared, `ps --status DIR` says died.
x below 0 fails, x above 10 is suspect, x = 7 takes a minute."""
import json
import pathlib
import sys
import time

words = sys.argv[1:]
if words[0] == "ps":
    print("died")
    sys.exit(0)
if words[0] == "schema":
    sys.exit(1)
scene, out = json.loads(pathlib.Path(words[1]).read_text()), pathlib.Path(words[words.index("--out") + 1])
x = scene["parameters"]["x"]["value"]
with open(out.parent.parent / "runs", "a") as file:
    file.write(f"{x}\n")
out.mkdir(exist_ok=True)
summary = {"status": "running", "wall_s": .1, "scene": "s"}
(out / "summary.json").write_text(json.dumps(summary))
if x == 7:
    try:
        time.sleep(60)
    except KeyboardInterrupt:
        (out / "summary.json").write_text(json.dumps({**summary, "status": "failed", "reason": "interrupted"}))
        sys.exit(130)
(out / "elements.csv").write_text(f"time,lift.force\n0,{x * x}\n1,{x * x}\n")
if x < 0:
    summary.update(status="failed", reason="numerics", error={"what": "x is negative", "where": "x"})
else:
    summary.update(status="suspect" if x > 10 else "ok", verdict={"lines": ["x is large"] if x > 10 else []})
(out / "summary.json").write_text(json.dumps(summary))
sys.exit(7 if x < 0 else 0)
