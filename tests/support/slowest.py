#!/usr/bin/env python3
"""What took longest in builds and their tests: usage: slowest.py --since SECONDS BUILD..."""
import argparse
import pathlib
import re


def built(folder, since):
    """{target: seconds} of what ninja has made since then; compilers run side by side, so the sum is not the time by the clock."""
    seconds = {}
    for line in (folder / ".ninja_log").read_text().splitlines()[1:]:
        begin, end, _, output, _ = line.split("\t")
        file = folder / output
        if not file.exists() or file.stat().st_mtime < since:
            continue
        match = re.search(r"CMakeFiles/([^/]+)\.dir/", output)
        seconds.setdefault(match[1] if match else pathlib.Path(output).name, {})[output] = (int(end) - int(begin)) / 1000
    return {target: sum(parts.values()) for target, parts in seconds.items()}


def tested(folder):
    """{test: seconds} of the last run of ctest; of a build without tests none."""
    if not (folder / "ctest.txt").exists():
        return {}
    lines = (folder / "ctest.txt").read_text(errors="replace")
    return {name: float(seconds)
            for name, seconds in re.findall(r"Test +#\d+: (.+?) (?:# GetParam\(\)[^\n]*?)?\.\.+[^\n]*? ([0-9.]+) sec", lines)}


def table(title, seconds, count=10):
    print(f"== {title}: {len(seconds)}, {sum(seconds.values()):.0f} s in all")
    for name in sorted(seconds, key=seconds.get, reverse=True)[:count]:
        print(f"{seconds[name]:8.1f} s  {name}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--since", type=float, required=True, help="targets built after this time [s since 1970]")
    parser.add_argument("builds", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    targets, tests = {}, {}
    for folder in arguments.builds:
        if (folder / ".ninja_log").exists():
            targets.update({f"{folder.name} {name}": value for name, value in built(folder, arguments.since).items()})
        if (folder / "ctest.txt").exists():
            tests.update({f"{folder.name} {name}": value for name, value in tested(folder).items()})
    table("slowest targets", targets)
    table("slowest tests", tests)


main()
