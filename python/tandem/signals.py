"""Columns of results as arrays over time, with units, read from CSV when they are asked for."""
import difflib
import itertools
import math
import pathlib
from typing import Any, Dict, List, Optional

import numpy as np

from tandem.entries import NoSuchName, nearest

# Files with a row per window, in the order in which a column is looked for.
FILES = ("elements", "bodies", "joints", "sensors", "control", "windows", "border")
UNITS = {"position": "m", "velocity": "m/s", "angular_velocity": "rad/s", "contact_force": "N", "contact_torque": "N m", "reaction_force": "N",
         "reaction_torque": "N m", "orientation": "-"}


def _trapezoid(values, time):
    """Integral over time (numpy's own function has changed its name)."""
    return np.tensordot(np.diff(time), 0.5 * (values[1:] + values[:-1]), 1)


class Signal(np.lib.mixins.NDArrayOperatorsMixin):
    """A result over time: `time` [s], `values` (rows, or rows x 3 of a vector), `unit`, `name`.

    It computes as an array: r["lift.force"] * r["lift.velocity"], numpy.abs(signal), signal[-1]. mean(0.4, 0.7) is the mean over time from
    0.4 to 0.7 s; so are rms(), mean_abs(), min(), max(), range(), last(), integral(), at(t), period(). Checks of scenes have the same reductions."""

    def __init__(self, name: str, time, values, unit: str = "", axes: tuple = ()):
        self.name, self.time, self.values, self.unit, self.axes = name, time, values, unit, axes

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.values, dtype)

    def __array_ufunc__(self, ufunc, method, *inputs, **keys):
        return getattr(ufunc, method)(*[part.values if isinstance(part, Signal) else part for part in inputs], **keys)

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, index):
        return self.values[index]

    def __iter__(self):
        return iter(self.values)

    @property
    def shape(self):
        """Rows, and components of a vector."""
        return self.values.shape

    def _part(self, start: float, stop: Optional[float]):
        end = math.inf if stop is None else stop
        rows = (self.time >= start - 0.5e-9) & (self.time <= end + 0.5e-9)
        if not rows.any():
            raise ValueError(f"{self.name}: no window ends between {start} s and {'the end' if stop is None else f'{stop} s'}; the results go "
                             f"from {self.time[0]:g} to {self.time[-1]:g} s" if len(self.time) else f"{self.name} has no rows yet")
        return self.time[rows], self.values[rows]

    def between(self, start: float = 0, stop: Optional[float] = None) -> "Signal":
        """The part from `start` to `stop` [s]."""
        time, values = self._part(start, stop)
        return Signal(self.name, time, values, self.unit, self.axes)

    def mean(self, start: float = 0, stop: Optional[float] = None):
        """Mean over time, by the trapezoidal rule."""
        time, values = self._part(start, stop)
        return values[0] if len(time) == 1 else _trapezoid(values, time) / (time[-1] - time[0])

    def rms(self, start: float = 0, stop: Optional[float] = None):
        """Root of the mean square over time, by the trapezoidal rule."""
        return Signal(self.name, self.time, self.values**2).mean(start, stop) ** 0.5

    def mean_abs(self, start: float = 0, stop: Optional[float] = None):
        """Mean of the absolute value over time, by the trapezoidal rule."""
        return Signal(self.name, self.time, np.abs(self.values)).mean(start, stop)

    def integral(self, start: float = 0, stop: Optional[float] = None):
        """Integral over time, by the trapezoidal rule: of a power [W], the energy [J]."""
        time, values = self._part(start, stop)
        return _trapezoid(values, time)

    def min(self, start: float = 0, stop: Optional[float] = None):
        """Smallest value."""
        return self._part(start, stop)[1].min(axis=0)

    def max(self, start: float = 0, stop: Optional[float] = None):
        """Largest value."""
        return self._part(start, stop)[1].max(axis=0)

    def range(self, start: float = 0, stop: Optional[float] = None):
        """Largest less smallest value."""
        return self.max(start, stop) - self.min(start, stop)

    def last(self, start: float = 0, stop: Optional[float] = None):
        """The last value."""
        return self._part(start, stop)[1][-1]

    def at(self, time: float):
        """The value at a time [s], linear between windows."""
        columns = self.values if self.values.ndim == 1 else self.values.T
        return np.interp(time, self.time, columns) if self.values.ndim == 1 else np.array([np.interp(time, self.time, c) for c in columns])

    def period(self, start: float = 0, stop: Optional[float] = None) -> float:
        """Mean distance of upward crossings of the mean [s]; NaN with fewer than two."""
        time, values = self._part(start, stop)
        above = values - self.mean(start, stop)
        up = np.flatnonzero((above[:-1] < 0) & (above[1:] >= 0))
        when = time[up] + above[up] / (above[up] - above[up + 1]) * (time[up + 1] - time[up])
        return float((when[-1] - when[0]) / (len(when) - 1)) if len(when) > 1 else math.nan

    @property
    def norm(self) -> "Signal":
        """The length of a vector."""
        return self if self.values.ndim == 1 else Signal(f"|{self.name}|", self.time, np.linalg.norm(self.values, axis=1), self.unit)

    def __getattr__(self, name: str):
        if name in self.__dict__.get("axes", ()):
            return Signal(f"{self.name}.{name}", self.time, self.values[:, self.axes.index(name)], self.unit)
        raise AttributeError(f"a signal has no '{name}'")

    def plot(self, **keys: Any):
        """A chart of the signal; r.plot([...]) draws several."""
        from tandem.plots import chart
        return chart([self], **keys)

    def __repr__(self) -> str:
        unit = f" [{self.unit}]" if self.unit else ""
        if len(self.values) == 0:
            return f"<Signal {self.name}{unit}: no rows yet>"
        return f"<Signal {self.name}{unit}: {len(self)} rows to {self.time[-1]:g} s, last {np.array2string(self.values[-1], precision=6)}>"

    def _repr_png_(self) -> bytes:
        from tandem.plots import png
        return png(self.plot())


class Columns:
    """The columns of all CSV files of a run. A file is read for the columns that are asked for."""

    def __init__(self, folder: pathlib.Path):
        self.folder = folder
        self._read: Dict[tuple, Any] = {}

    def header(self, file: str) -> List[str]:
        try:
            with open(self.folder / f"{file}.csv") as rows:
                return rows.readline().strip().split(",")
        except OSError:
            return []

    def names(self) -> List[str]:
        """All columns, without the time."""
        return list(dict.fromkeys(name for file in FILES for name in self.header(file) if name != "time"))

    def read(self, file: str, names: List[str]):
        """Time and the columns (rows x columns) of a file; a row that is being written is left out."""
        header = self.header(file)
        wanted = ["time"] + names
        size = (self.folder / f"{file}.csv").stat().st_size
        missing = [name for name in wanted if (file, name, size) not in self._read]
        if missing:
            with open(self.folder / f"{file}.csv") as rows:
                rows.readline()
                whole = (row for row in rows if row.endswith("\n"))
                first = next(whole, None)
                values = np.zeros((0, len(missing))) if first is None else np.loadtxt(
                    itertools.chain([first], whole), delimiter=",", usecols=[header.index(name) for name in missing], ndmin=2)
            for i, name in enumerate(missing):
                column = np.ascontiguousarray(values[:, i])
                self._read = {key: kept for key, kept in self._read.items() if key[:2] != (file, name)}
                self._read[file, name, size] = column
        columns = [self._read[file, name, size] for name in wanted]
        length = min(map(len, columns))
        return columns[0][:length], np.stack([c[:length] for c in columns[1:]], axis=1)

    def signal(self, name: str, units) -> Optional[Signal]:
        """A column, or the vector of its components."""
        for file in FILES:
            header = self.header(file)
            if name in header and name != "time":
                time, values = self.read(file, [name])
                return Signal(name, time, values[:, 0], units(name))
            axes = tuple(axis for axis in "wxyz" if f"{name}.{axis}" in header)
            if len(axes) >= 3:
                time, values = self.read(file, [f"{name}.{axis}" for axis in axes])
                return Signal(name, time, values, units(name), axes)
        return None

    def missing(self, name: str) -> KeyError:
        """What there is instead: channels of the same owner, or else names of the same kind."""
        names = self.names()
        vectors = {column.rpartition(".")[0] for column in names if column.rpartition(".")[2] in ("w", "x", "y", "z")}
        stems = vectors | {column for column in names if column.rpartition(".")[0] not in vectors}
        owner, dot, channel = name.partition(".")
        own = sorted(column for column in stems if column.startswith(owner + "."))
        what = f"the results have no '{name}'"
        if dot and own:
            close = difflib.get_close_matches(channel, [column[len(owner) + 1:] for column in own], 1, 0.6)
            return NoSuchName(what + (f"; did you mean '{owner}.{close[0]}'?" if close else "; '" + owner + "' has " + ", ".join(f"'{c}'" for c in own)))
        return NoSuchName(what + nearest(name, vectors | set(names) if dot else {column.partition(".")[0] for column in names}) +
                        " (r.names lists all)")
