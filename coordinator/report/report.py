#!/usr/bin/python3
"""Writes report.html, one self-contained page about a finished run: report.py FOLDER.

Reads summary.json, bodies.csv, joints.csv, elements.csv, sensors.csv, windows.csv and picture.png of the folder; the page leaves out what a missing
file would show. tandem.report_page of the Python package makes it; it is beside this file where tandem is installed, and at the root of the
sources otherwise.
"""
import pathlib
import sys

here = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(folder) for folder in (here / "python", here / "../../python") if (folder / "tandem").is_dir()][:1]

from tandem.report_page import write  # noqa: E402 (of the folder above)


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    if not (folder / "summary.json").exists():
        sys.exit(f"{folder}: no summary.json; give the folder of a finished run")
    write(folder, pathlib.Path(__file__).parent / "../../bin/tandem")


if __name__ == "__main__":
    main()
