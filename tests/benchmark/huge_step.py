#!/usr/bin/env python3
"""Writes a STEP file as large as you like: copies of a small one, each with numbers of its own.

    huge_step.py tests/unit/import/step/gearbox.step huge.step --megabytes 200
    /usr/bin/time -v tandem import huge.step -o huge.json --material steel
"""
import argparse
import pathlib
import re


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("target", type=pathlib.Path)
    parser.add_argument("--megabytes", type=float, default=200)
    options = parser.parse_args()
    text = options.source.read_text()
    begin = text.index("DATA;") + len("DATA;")
    head, data, foot = text[:begin], text[begin:text.index("ENDSEC;", begin)], text[text.index("ENDSEC;", begin):]
    numbers = re.compile(r"#(\d+)")
    step = max(int(number) for number in numbers.findall(data)) + 1
    written = copies = 0
    with open(options.target, "w") as out:
        out.write(head)
        while written < options.megabytes * 1e6:
            written += out.write(numbers.sub(lambda found: f"#{int(found[1]) + copies * step}", data))
            copies += 1
        out.write(foot)
    print(f"{options.target}: {copies} copies, {options.target.stat().st_size / 1e6:.0f} MB")


main()
