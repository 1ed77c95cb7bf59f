"""A run that is watched while it runs, and stopped once enough has passed."""
import time

import tandem as td

s = td.load("hopper.json", mouth=.06)
run = s.start("out/watched", picture=False)
while run.running:
    passed = run["mouth.passed"] if run.time > 0 else []
    if len(passed):
        print(f"t = {run.time:.3f} s: {-passed[-1]:.3f} kg")
        if -passed[-1] > .15:
            run.stop()
            break
    time.sleep(.5)
r = run.wait()
print(r.verdict.reason, f"after {-r['mouth.passed'].last():.3f} kg: {r.summary['simulated_s']:.3f} s of {s.end_time} s were simulated")
