#!/usr/bin/env python3
"""Each rule of the verdict: a scene just inside its limit, and one that differs by one number just outside.

rules.json has the scenes and, per rule, what changes. `faulty` names the server that has a fault (tests/doubles), for
rules that the servers of this version do not come to; `why` says how that is known. The rest are honest runs.
"""
import copy
import json
import os
import re
import shutil
import subprocess
import time

import harness
from harness import Case, options

TABLE = json.loads((harness.SCENES / "rules.json").read_text())


def put(scene, path, value):
    keys = [int(key) if key.isdigit() else key for key in path.split("/")]
    for key in keys[:-1]:
        scene = scene[key] if isinstance(scene, list) else scene.setdefault(key, {})
    scene[keys[-1]] = value


class Rules(Case):
    def judged(self, rule, case, value):
        """Summary of the run with that value."""
        scene = copy.deepcopy(TABLE["scenes"][case["scene"]])
        for path, other in case.get("set", {}).items():
            put(scene, path, other)
        environment, server = dict(os.environ), []
        if "faulty" in case:
            server = [f"--{case['faulty']}-server", str(options.faulty / f"{case['faulty']}_server")]
            environment["TANDEM_FAULT"] = json.dumps({case["change"]: value})
        else:
            put(scene, case["change"], value)
        path = self.folder / f"{rule}.json"
        path.write_text(json.dumps(scene))
        shutil.rmtree(self.out, ignore_errors=True)
        process = subprocess.Popen([str(options.bin / "tandem"), "run", str(path), "--out", str(self.out), "--no-picture", "--no-report",
                                    "--quiet", *server, *case.get("arguments", [])],
                                   env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.started.append(process)
        stdout, stderr = process.communicate(timeout=30 * options.slack)
        self.assertEqual(process.returncode, 0, stdout + stderr)
        return self.summary()

    def test_each_is_silent_inside_its_limit_and_speaks_outside_it(self):
        begin = time.monotonic()
        for rule, case in TABLE["rules"].items():
            with self.subTest(rule=rule):
                inside = self.judged(rule, case, case["inside"])
                self.assertEqual((inside["status"], inside["verdict"]["lines"]), ("ok", []))
                self.assertIn(rule, inside["verdict"]["judged"])
                if case.get("faulty") != "dem":  # single spheres of our own server are not watched
                    self.assertNotIn("contact_load", inside["verdict"]["judged"])
                outside = self.judged(rule, case, case["outside"])
                self.assertEqual(outside["status"], "suspect")
                lines = {line["rule"]: line for line in outside["verdict"]["lines"]}
                self.assertIn(rule, lines)
                line = lines[rule]
                self.assertGreater(line["value"], line["limit"])
                self.assertRegex(line["sentence"], r"(use|give|check) ", "a line says what to do")
                others = sorted(set(lines) - {rule})
                print(f"\n  {rule}: {case['change']} {case['inside']} ok, {case['outside']}: {line['value']:.3g} (limit {line['limit']:.3g})"
                      + (f", with {', '.join(others)}" if others else ""), end="")
        print(f"\n  {2 * len(TABLE['rules'])} runs in {time.monotonic() - begin:.1f} s")

    def test_none_is_left_out(self):
        table = (harness.SCENES.parents[2] / "docs/verdict.md").read_text().split("## Rules")[1]
        names = re.findall(r"^\| ([a-z_]+) \| `", table, re.MULTILINE)
        self.assertGreater(len(names), 20)
        self.assertEqual(sorted(names), sorted(TABLE["rules"]))


if __name__ == "__main__":
    harness.main()
