#!/usr/bin/python3
"""Draws study.png, error against processor time: study.py FOLDER.

Reads results.csv and plot.json of the folder. tandem.study_picture of the Python package draws; it is beside this file where tandem is
installed, and at the root of the sources otherwise.
"""
import pathlib
import sys

here = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(folder) for folder in (here / "python", here / "../../python") if (folder / "tandem").is_dir()][:1]

from tandem.study_picture import draw  # noqa: E402 (of the folder above)

if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    draw(pathlib.Path(sys.argv[1]))
