"""Results of a run, read when they are asked for."""
import json
import pathlib
import subprocess
from typing import Any, Dict, List, Optional, Sequence, Union

import numpy as np

from tandem.entries import NoSuchName, nearest
from tandem.frames import Frame, Frames, mass_in_hull
from tandem.reductions import REDUCTIONS
from tandem.signals import FILES, UNITS, Columns, Signal


class Named(dict):
    """A dict whose missing keys are said with what there is instead."""

    def __init__(self, has_no: str, *arguments):
        super().__init__(*arguments)
        self.has_no = has_no

    def __missing__(self, key: Any) -> Any:
        raise NoSuchName(f"{self.has_no} '{key}'" + nearest(key, self))


class Verdict(str):
    """The status of a run, "ok", "suspect" or "failed" (docs/verdict.md), with why: verdict.lines, verdict.reason."""
    lines: List[str] = []
    reason: str = ""

    def __repr__(self) -> str:
        return "\n  ".join([str(self) + (f" ({self.reason})" if self.reason else "")] + [str(line) for line in self.lines])


class Element:
    """The channels of a drive, joint, sensor or other element: r["lift"].force is r["lift.force"]; `work` [J] is what it has given the
    machine until the end."""

    def __init__(self, results: "Results", name: str, channels: List[str]):
        self._results, self.name, self.channels = results, name, channels

    def __getattr__(self, channel: str) -> Any:
        if channel.startswith("_"):
            raise AttributeError(channel)
        if channel in self.channels:
            return self._results[f"{self.name}.{channel}"]
        raise AttributeError(f"'{self.name}' has no '{channel}'" + nearest(channel, self.channels))

    @property
    def work(self) -> float:
        """Energy [J] that the element has given the machine until the end of the run."""
        if "energy" not in self.channels:
            raise AttributeError(f"'{self.name}' has no energy" + nearest("energy", self.channels))
        return float(self._results[f"{self.name}.energy"].last())

    def __repr__(self) -> str:
        return f"<{self.name}: {', '.join(self.channels)}>"


class Pose:
    """Where a body is over time: time [s], position [m] (rows x 3), orientation (rows x 4, quaternions w, x, y, z); matrices() for rotations."""

    def __init__(self, position: Signal, orientation: Signal):
        self.time, self.position, self.orientation = position.time, position.values, orientation.values

    def matrices(self):
        """Rotation matrices, body to world (rows x 3 x 3)."""
        w, x, y, z = self.orientation.T
        rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
        return np.moveaxis(np.array(rows), 2, 0)

    def __repr__(self) -> str:
        return f"<Pose: {len(self.time)} rows, last at {self.position[-1]} with {self.orientation[-1]}>"


class BodyResults:
    """A body: pose, position, velocity, angular_velocity, contact_force, contact_torque over time."""

    def __init__(self, results: "Results", name: str):
        self._results, self.name = results, name

    @property
    def pose(self) -> Pose:
        """Position and orientation over time."""
        return Pose(self._results[f"{self.name}.position"], self._results[f"{self.name}.orientation"])

    def __getattr__(self, name: str) -> Signal:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._results[f"{self.name}.{name}"]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None


class Results:
    """Results of a run: what Scene.run() returns, or td.Results("out/hopper") of any run's folder, also of one in progress.

        r["lift.force"]                       a Signal over time, with unit; a vector where it has components: r["bucket.contact_force"]
        r["mouth.flow"].mean(0.4, 0.7)        its mean from 0.4 to 0.7 s; r["lift"].force and r["lift"].work of an element
        r.bodies["boom"].pose                 position and orientation over time
        r.frames[-1].spheres.position         arrays of a frame
        r.verdict, r.checks, r.warnings, r.summary     whether it can be trusted, and summary.json as a dict
        r.mass_in("bucket")                   kg at the end
        r.plot(["lift.force", "*.power"]), r.movie("dig.mp4", fps=30), r.picture, r.report
        r.names                               all columns
        r.dataframe("elements")               a file as a pandas.DataFrame, where pandas is installed"""

    def __init__(self, folder: Union[str, pathlib.Path]):
        self.folder = pathlib.Path(folder).absolute()
        if not self.folder.is_dir():
            raise FileNotFoundError(f"{folder}: there is no such folder; give that of a run, its --out")
        self._columns = Columns(self.folder)
        self._summary: Optional[tuple] = None

    # ---- figures

    @property
    def summary(self) -> Dict[str, Any]:
        """summary.json (docs/results.md)."""
        file = self.folder / "summary.json"
        if not file.is_file():
            raise FileNotFoundError(f"{self.folder} has no summary.json: it holds no run")
        when = file.stat().st_mtime_ns
        if self._summary is None or self._summary[0] != when:
            self._summary = (when, Named("summary.json has no", json.loads(file.read_text())))
        return self._summary[1]

    @property
    def verdict(self) -> Verdict:
        """"ok", "suspect", "failed" or "running", with its reasons."""
        summary = self.summary
        verdict = Verdict(summary.get("status", ""))
        verdict.reason = summary.get("reason") or ""
        lines = (summary.get("verdict") or {}).get("lines", [])
        verdict.lines = [line.get("sentence", str(line)) if isinstance(line, dict) else str(line) for line in lines]
        return verdict

    @property
    def warnings(self) -> List[str]:
        """Warnings of the run."""
        return self.summary.get("warnings", [])

    @property
    def checks(self) -> List[dict]:
        """The scene's checks with their values."""
        return self.summary.get("checks", [])

    @property
    def names(self) -> List[str]:
        """Names of all columns."""
        return self._columns.names()

    def _unit(self, name: str) -> str:
        owner, _, channel = name.partition(".")
        for part in ("elements", "sensors"):
            found = self.summary.get(part, {}).get(owner, {})
            unit = (found.get(channel) or found.get(channel + ".x") or {}) if isinstance(found, dict) else {}
            if isinstance(unit, dict) and "unit" in unit:
                return unit["unit"]
        if channel in ("q", "rate") and owner in self.summary.get("joint_units", {}):
            return self.summary["joint_units"][owner] + ("/s" if channel == "rate" else "")
        return UNITS.get(channel, UNITS.get(channel.partition(".")[0], ""))

    def __getitem__(self, name: str) -> Any:
        if not isinstance(name, str):
            raise NoSuchName(f"{name!r} is no name of a column; write r[\"hinge.q\"], or r[\"hinge.q\"].values[3] for a value (r.names lists all)")
        if name.partition(".")[0] == "summary" and "summary" not in {column.partition(".")[0] for column in self.names}:
            raise self._no_column(name)
        signal = self._columns.signal(name, self._unit)
        if signal is not None:
            return signal
        channels = list(dict.fromkeys(self._channel(column[len(name) + 1:]) for column in self.names if column.startswith(name + ".")))
        if channels:
            return Element(self, name, channels)
        raise self._columns.missing(name)

    def _no_column(self, name: str) -> KeyError:
        """Figures of summary.json are not over time."""
        key = name.partition(".")[2]
        first = key.partition(".")[0]
        if key and first not in self.summary:
            return NoSuchName(f"the results have no '{name}', and summary.json has no '{first}'" + nearest(first, self.summary))
        value = self.summary.get(first)
        ways = ["r.summary" + (f"[\"{first}\"]" if key else "")]
        ways += [f"r.reduce(\"{name}\")"] if isinstance(value, (int, float)) and not isinstance(value, bool) and "." not in key else []
        return NoSuchName(f"'{name}' is no column over time: write " + " or ".join(ways))

    @staticmethod
    def _channel(column: str) -> str:
        stem, _, axis = column.rpartition(".")
        return stem if stem and axis in ("w", "x", "y", "z") else column

    def __contains__(self, name: str) -> bool:
        return name in self.names or any(column.startswith(name + ".") for column in self.names)

    @property
    def time(self):
        """Ends of the windows [s]."""
        return self._columns.read("windows", ["time"])[0]

    @property
    def bodies(self) -> Dict[str, BodyResults]:
        """The bodies by name."""
        names = dict.fromkeys(column.partition(".")[0] for column in self._columns.header("bodies") if column.endswith(".position.x"))
        return Named("the run has no body", {name: BodyResults(self, name) for name in names})

    @property
    def frames(self) -> Frames:
        """The frames; each array is read when it is asked for."""
        return Frames(self.folder)

    @property
    def scene(self):
        """The scene that was run, as a tandem.Scene."""
        from tandem.scenes import load
        return load(str(self.folder / "scene" / "scene.json"))

    def reduce(self, of: str) -> float:
        """One number: "COLUMN:REDUCTION", such as "mouth.flow:mean", "lift.force:max" or with a range of time "mouth.flow:mean:0.4:0.7"; or
        "summary.KEY". Reductions: last (the default), mean, rms, mean_abs, min, max, range, period, integral. Of a vector its length is taken."""
        column, *rest = of.split(":")
        if column.startswith("summary."):
            value: Any = self.summary
            for key in column.split(".")[1:]:
                if not isinstance(value, dict) or key not in value:
                    raise NoSuchName(f"summary.json has no '{column[8:]}'" + nearest(key, value if isinstance(value, dict) else []))
                value = value[key]
            if value is None:
                raise ValueError(f"'{column[8:]}' of summary.json is null")
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise NoSuchName(f"'{column[8:]}' of summary.json is no number, but {json.dumps(value)[:60]}")
            return float(value)
        how = rest[0] if rest else "last"
        if how not in REDUCTIONS:
            raise NoSuchName(f"there is no reduction '{how}' in '{of}'" + nearest(how, REDUCTIONS))
        signal = self[column]
        if isinstance(signal, Element):
            raise NoSuchName(f"'{column}' in '{of}' is no column; it has " + ", ".join(f"'{column}.{c}'" for c in signal.channels))
        try:
            times = [float(word) for word in rest[1:]]
        except ValueError:
            raise ValueError(f"'{of}' has a time that is no number; write COLUMN:REDUCTION:FROM:TO, as in \"mouth.flow:mean:0.4:0.7\"") from None
        if len(times) > 2:
            raise ValueError(f"'{of}' has more than two times; write COLUMN:REDUCTION:FROM:TO, as in \"mouth.flow:mean:0.4:0.7\"")
        return float(getattr(signal.norm, how)(*times))

    def mass_in(self, name: str, time: Optional[float] = None) -> float:
        """Mass [kg] at the end of the run (or in the frame nearest to `time`): of a sensor with this name, or of the spheres whose centres are
        inside the convex hull of this body's surface in the frame."""
        if f"{name}.mass" in self.names:
            mass = self[f"{name}.mass"]
            return float(mass.last() if time is None else mass.at(time))
        frame = self.frames[-1] if time is None else self.frames.at(time)
        if name not in frame.bodies.keys():
            raise NoSuchName(f"there is neither a sensor nor a body '{name}'" + nearest(name, frame.bodies.keys()))
        return mass_in_hull(frame, name, self._density(frame))

    def _density(self, frame: Frame) -> Any:
        data = self.scene.data["dem"]
        of_material = {material["name"]: material["density"] for material in data["materials"]}
        groups = [of_material[group["material"]] for group in data["particles"]]
        if len(set(groups)) == 1:
            return groups[0]
        if "group" not in frame.spheres.keys():
            raise ValueError("the spheres have several densities: write s.section(\"output\")[\"fields\"] = [\"group\"] before the run")
        return np.array(groups)[frame.spheres.group.astype(int)]

    # ---- pictures and tables

    def plot(self, columns: Union[str, Sequence[str]], file: Optional[str] = None, start: float = 0, stop: Optional[float] = None):
        """Charts of columns over time, one for each unit; `*` in a name stands for any characters. Of a vector all components are drawn. Written
        to `file` if given; returns the matplotlib figure."""
        from tandem.plots import chart
        wanted = [columns] if isinstance(columns, str) else list(columns)
        signals: List[Signal] = []
        for name in wanted:
            import fnmatch
            names = fnmatch.filter(self.names, name) if "*" in name else [name]
            if not names:
                raise self._columns.missing(name)
            for each in names:
                found = self[each]
                if isinstance(found, Element):
                    raise NoSuchName(f"'{each}' is no column; it has " + ", ".join(f"'{each}.{c}'" for c in found.channels))
                signals.append(found.between(start, stop))
        return chart(signals, file, title=str(self.summary.get("scene", "")), status=str(self.verdict))

    def movie(self, file: Optional[str] = None, *, fps: float = 25, size: str = "1280x720", colour_by: str = "speed"):
        """A film of the frames (MP4), movie.mp4 in the folder of the run by default; returns its path. colour_by: "speed", "radius", "spin" or
        one of output.fields."""
        from tandem.program import find_tandem
        target = pathlib.Path(file).absolute() if file else self.folder / "movie.mp4"
        said = subprocess.run([find_tandem(), "movie", str(self.folder), "-o", str(target), "--fps", str(fps), "--size", size, "--colour-by",
                               colour_by], capture_output=True, text=True, check=False)
        if said.returncode != 0 or not target.is_file():
            raise RuntimeError((said.stderr or said.stdout).strip())
        return target

    @property
    def picture(self):
        """picture.png, which notebooks show."""
        from tandem.notebook import Picture
        return Picture(self.folder / "picture.png")

    @property
    def report(self) -> pathlib.Path:
        """Path of report.html."""
        return self.folder / "report.html"

    def dataframe(self, file: str):
        """A file as a pandas.DataFrame with the time as its index: "bodies", "joints", "elements", "sensors", "windows", "control", "border"."""
        if file not in FILES:
            raise NoSuchName(f"there is no file '{file}'" + nearest(file, FILES))
        try:
            import pandas
        except ImportError:
            raise ImportError("a DataFrame needs pandas (Debian: python3-pandas); r[\"COLUMN\"] works without it") from None
        return pandas.read_csv(self.folder / f"{file}.csv").set_index("time")

    def __repr__(self) -> str:
        s = self.summary
        return (f"<Results of {s.get('scene')}: {self.verdict!s}, {s.get('simulated_s', 0):g} s in {s.get('windows', 0)} windows, "
                f"{s.get('wall_s', 0):.3g} s wall time, {self.folder}>")

    def _repr_html_(self) -> str:
        import html

        from tandem.notebook import image_html
        colour = {"ok": "#3f8f5f", "suspect": "#b7791f"}.get(str(self.verdict), "#b03a3a")
        rows = "".join(f"<tr><td>{html.escape(str(c.get('name')))}</td><td>{c.get('value')}</td><td>{c.get('expected')}</td></tr>" for c in self.checks)
        table = f"<table><tr><th>check</th><th>value</th><th>expected</th></tr>{rows}</table>" if rows else ""
        lines = "".join(f"<li>{html.escape(str(line))}</li>" for line in self.verdict.lines)
        return f'<p style="color:{colour}"><b>{html.escape(str(self.verdict))}</b></p><p>{html.escape(repr(self))}</p><ul>{lines}</ul>{table}' + (
            image_html(file.read_bytes()) if (file := self.folder / "picture.png").is_file() else "")
