"""Frames of a run, read from HDF5 when they are asked for: no more than one array at a time is held."""
import pathlib
from typing import Any, Dict, Iterator

from tandem.entries import NoSuchName, nearest


def _open(file):
    try:
        import h5py
    except ImportError:
        raise ImportError("frames are HDF5 files, which need h5py (Debian: python3-h5py)") from None
    return h5py.File(file, "r")


class FrameData:
    """What one file of a frame holds: each array is read anew when it is asked for, and not kept."""

    def __init__(self, file: pathlib.Path):
        self.file = file

    def keys(self):
        """Names of the arrays."""
        with _open(self.file) as held:
            return [name for name in held if name != "points"]

    def __getitem__(self, name: str):
        with _open(self.file) as held:
            if name not in held:
                raise NoSuchName(f"{self.file.name} has no '{name}'" + nearest(name, held.keys()))
            return held[name][()]

    def __getattr__(self, name: str):
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __len__(self) -> int:
        with _open(self.file) as held:
            return len(held["position"]) if "position" in held else len(held)

    def __repr__(self) -> str:
        return f"<{self.file.name}: {', '.join(self.keys())}>"


class Frame:
    """One frame of a run.

    time       [s]
    spheres    position [m], velocity [m/s], spin [rad/s], speed, radius [m], id, and output.fields, as arrays: frame.spheres.position
    liquid     the same of a liquid
    bodies     corners of each body's surface in the world [m]: frame.bodies["bucket"]
    contacts   point, force, body, sphere, where the scene asks for them"""

    def __init__(self, folder: pathlib.Path, number: int):
        self.folder, self.number = folder, number

    def _data(self, series: str) -> FrameData:
        file = self.folder / "frames" / f"{series}_{self.number:06}.h5"
        if not file.is_file():
            raise AttributeError(f"the frames of this run have no {series}")
        return FrameData(file)

    @property
    def spheres(self) -> FrameData:
        """The spheres."""
        return self._data("particles")

    @property
    def liquid(self) -> FrameData:
        """The particles of the liquid."""
        return self._data("liquid")

    @property
    def bodies(self) -> FrameData:
        """Corners of the surfaces of the bodies."""
        return self._data("bodies")

    @property
    def contacts(self) -> FrameData:
        """Contacts of bodies with spheres."""
        return self._data("contacts")

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        with _open(next(self.folder.glob(f"frames/*_{self.number:06}.h5"))) as held:
            return float(held.attrs["time"])

    def __repr__(self) -> str:
        return f"<Frame {self.number}: t = {self.time:g} s>"


class Frames:
    """The frames of a run: len(r.frames), r.frames[-1], for frame in r.frames, r.frames.at(0.5)."""

    def __init__(self, folder: pathlib.Path):
        self.folder = folder

    def __len__(self) -> int:
        counts: Dict[str, int] = {}
        for file in (self.folder / "frames").glob("*_[0-9]*.h5"):
            series = file.stem.rpartition("_")[0]
            counts[series] = counts.get(series, 0) + 1
        return min(counts.values(), default=0)

    def __getitem__(self, index: int) -> Frame:
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"frame {index} of {count}; output.frame_interval of the scene (Scene(frame_interval=...)) makes more")
        return Frame(self.folder, index % count)

    def __iter__(self) -> Iterator[Frame]:
        return (Frame(self.folder, number) for number in range(len(self)))

    @property
    def times(self):
        """Times of all frames [s]."""
        import numpy as np
        return np.array([frame.time for frame in self])

    def at(self, time: float) -> Frame:
        """The frame that is nearest to a time [s]."""
        return min(self, key=lambda frame: abs(frame.time - time))

    def __repr__(self) -> str:
        return f"<{len(self)} frames>"


def mass_in_hull(frame: Frame, body: str, density: Any) -> float:
    """Mass [kg] of the spheres of a frame whose centres are inside the convex hull of a body's surface."""
    import numpy as np
    from scipy.spatial import ConvexHull
    corners, position = frame.bodies[body], frame.spheres.position
    near = np.all((position >= corners.min(axis=0)) & (position <= corners.max(axis=0)), axis=1)
    if not near.any():
        return 0.0
    planes = np.unique(ConvexHull(corners).equations.round(12), axis=0)
    inside = np.flatnonzero(near)[np.all(position[near] @ planes[:, :3].T + planes[:, 3] <= 0, axis=1)]
    mass = 4 / 3 * np.pi * frame.spheres.radius.astype(float)[inside] ** 3
    return float((mass * (density[inside] if np.ndim(density) else density)).sum())
