#!/usr/bin/env python3
"""Seconds from a saved line to its unit tests, for the changes that contributors make most often.

Adds a comment to a source, builds the programs that test it, runs their tests, and puts the source back.
usage: edit_loop.py [--preset dev] [--csv FILE] [CHANGE...]      (build the preset first: launch/build dev)
"""
import argparse
import csv
import os
import pathlib
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
# name: (source, programs to build, tests: program with a filter or a command), limit [s] on two idle cores
CHANGES = {
    "contact law": ("dem_server/laws/hertz.hpp", ["dem_law_test"], ["dem_law_test"], 60),
    "pair term of the liquid": ("sph_server/equations/pair_terms.hpp", ["sph_equations_test"], ["sph_equations_test"], 60),
    "force element": ("mbd_server/forces/spring_damper.cpp", ["mbd_unit"], ["mbd_unit"], 60),
    "scene key": ("common/scene/model.hpp", ["scene_test"], ["scene_test"], 180),
    "verdict rule": ("coordinator/verdict/particle_rules.cpp", ["coordinator_tests"],
                     ["coordinator_tests --gtest_filter=Verdict.*:*EachRule*:Status.*"], 60),
    "coordinator": ("coordinator/schemes/schemes.cpp", ["coordinator_tests"],
                    ["coordinator_tests --gtest_filter=Schemes.*:*Order*"], 60),
    "python": ("python/tandem/spheres.py", [], ["ctest -R spheres_test|python.(Layout|Helpers)"], 60),
}


def run(command, build):
    # ccache sees through a comment.
    done = subprocess.run(command, cwd=build, capture_output=True, text=True, check=False, env={**os.environ, "CCACHE_DISABLE": "1"})
    if done.returncode != 0:
        sys.exit(f"edit_loop: {' '.join(map(str, command))}: {done.stdout[-2000:]}{done.stderr[-2000:]}")


def once(build, change):
    source, programs, tests, _ = CHANGES[change]
    file = ROOT / source
    text, stamp = file.read_text(), file.stat()
    comment = "#" if file.suffix == ".py" else "//"
    begin = time.monotonic()
    try:
        file.write_text(f"{text}{comment} {time.time_ns()}\n")
        if programs:
            run(["ninja", *programs], build)
        built = time.monotonic()
        for test in tests:
            program, *arguments = test.split()
            run([program if program == "ctest" else build / "tests" / program, *arguments], build)
        return built - begin, time.monotonic() - built
    finally:
        file.write_text(text)
        os.utime(file, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--preset", default="dev")
    parser.add_argument("--csv", type=pathlib.Path, help="writes the rows to this file")
    parser.add_argument("changes", nargs="*", metavar="CHANGE", help=", ".join(CHANGES))
    arguments = parser.parse_args()
    if unknown := set(arguments.changes) - set(CHANGES):
        parser.error(f"unknown change {sorted(unknown)[0]!r}; known are {', '.join(CHANGES)}")
    build = ROOT / "build" / arguments.preset
    if not (build / "build.ninja").exists():
        parser.error(f"nothing is built in {build}: ./launch/build {arguments.preset}")
    # The source that is being changed is put back.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    rows = []
    for change in arguments.changes or CHANGES:
        programs = CHANGES[change][1]
        if programs:
            print(f"{change}: brings {' '.join(programs)} up to date first", flush=True)
            run(["ninja", *programs], build)
        compile_s, test_s = once(build, change)
        rows.append([change, CHANGES[change][0], f"{compile_s:.1f}", f"{test_s:.1f}", f"{compile_s + test_s:.1f}", CHANGES[change][3]])
        print(f"{change:26}{compile_s:7.1f} s build {test_s:6.1f} s tests {compile_s + test_s:7.1f} s of {CHANGES[change][3]} s", flush=True)
    if arguments.csv:
        with open(arguments.csv, "w", newline="", encoding="utf-8") as out:
            csv.writer(out).writerows([["change", "source", "build_s", "tests_s", "total_s", "limit_s"], *rows])


main()
