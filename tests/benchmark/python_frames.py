#!/usr/bin/env python3
"""Memory and time of reading frames lazily: python_frames.py [SPHERES] [FRAMES] [FOLDER]; PYTHONPATH=python.

Writes frames as a run does (position, velocity, radius), then takes the mean height of each, one by one."""
import json
import pathlib
import resource
import sys
import tempfile
import time

import h5py
import numpy as np

import tandem as td


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # [MiB]


def main(spheres=1_000_000, frames=100, folder=None):
    with tempfile.TemporaryDirectory(dir=folder) as held:
        run = pathlib.Path(held)
        (run / "frames").mkdir()
        (run / "summary.json").write_text(json.dumps({"status": "ok"}))
        position = np.zeros((spheres, 3))
        for number in range(frames):
            position[:, 2] = number
            with h5py.File(run / "frames" / f"particles_{number:06}.h5", "w") as file:
                file.attrs["time"] = number
                file["position"], file["radius"] = position, np.full(spheres, .1, np.float32)
        del position
        r = td.Results(run)
        r.frames[0].spheres.position[:, 2].mean()
        before, begin = peak(), time.monotonic()
        heights = [frame.spheres.position[:, 2].mean() for frame in r.frames]
        seconds = time.monotonic() - begin
        assert heights == list(range(frames))
        print(f"{frames} frames of {spheres} spheres, {spheres * 24 / 2**20:.1f} MiB of positions each: {seconds:.2f} s, "
              f"{1e3 * seconds / frames:.1f} ms per frame; peak memory grew by {peak() - before:.1f} MiB over that of the first frame ({before:.0f} MiB)")


main(*map(int, sys.argv[1:3]), *sys.argv[3:4])
