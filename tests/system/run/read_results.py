"""Reads what a run left, as another program would: read_results.py FOLDER.

Fails unless all rows are whole, each frame is readable in full, and particles.h5, particles.xdmf, bodies.h5, bodies.xdmf
and summary.json are what they are called or not there. Prints one JSON object: rows, frames, frames that the index does
not tell of yet, checkpoints, and files that were being written.
"""
import json
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

import h5py


def read_all(group):
    for name in group:
        item = group[name]
        if isinstance(item, h5py.Group):
            read_all(item)
        else:
            item[()]


def main():
    folder = pathlib.Path(sys.argv[1])
    rows = {}
    for name in ("bodies", "joints", "windows"):
        file = folder / f"{name}.csv"
        if file.exists() and file.stat().st_size > 0:
            lines = file.read_text().split("\n")
            assert lines.pop() == "", f"{name}.csv ends within a row"
            assert {line.count(",") for line in lines} == {lines[0].count(",")}, f"{name}.csv has a cut row"
            rows[name] = len(lines) - 1
    frames, told = 0, 0
    for series in ("particles", "bodies"):
        files = sorted(file.name for file in folder.glob(f"frames/{series}_*.h5"))
        assert files == [f"{series}_{i:06}.h5" for i in range(len(files))], files
        for file in files:
            with h5py.File(folder / "frames" / file) as frame:
                read_all(frame)
                assert "time" in frame.attrs
        if (folder / f"{series}.h5").exists():
            with h5py.File(folder / f"{series}.h5") as index:
                read_all(index)
                names = [name for name in index if name != "bodies"]
            assert names == [f"frame_{i:06}" for i in range(len(names))], names
            assert len(names) <= len(files)
            told = len(names)
        if (folder / f"{series}.xdmf").exists():
            ElementTree.parse(folder / f"{series}.xdmf")
        frames = max(frames, len(files))
    if (folder / "summary.json").exists():
        json.loads((folder / "summary.json").read_text())
    print(json.dumps({"rows": rows, "frames": frames, "not_told": frames - told,
                      "checkpoints": len(list(folder.glob("checkpoint/*/run.h5"))),
                      "drafts": sorted(file.name for file in folder.rglob("*") if file.suffix in (".new", ".part"))}))


main()
