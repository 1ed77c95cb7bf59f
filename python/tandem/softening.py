"""Softer grains at a stated error: runs, judges and writes what soften_search chooses."""
import csv
import math
import pathlib
from typing import Dict, List, Optional, Sequence, Union

from tandem import soften_checks as checks, soften_scene as changes
from tandem.entries import SceneError
from tandem.scenes import Scene
from tandem.soften_candidates import Candidate, Setting
from tandem.soften_errors import Measure, error_of_text
from tandem.soften_folder import Folder
from tandem.soften_search import MODULUS, STEP, WINDOW, Outcome, Point, Search
from tandem.soften_words import doubts, percent, reading, shortened, stiff_mark, table
from tandem.sweeps import Row, expect_limit, sweep

AXES = {MODULUS: "modulus", STEP: "micro step", WINDOW: "window"}


class Softening:
    """What soften() found: `scene`, the softened one, or None; `chosen` and all `candidates`, `stiff`, `scatter` of each result; table(),
    picture(), reading()."""

    def __init__(self, folder: pathlib.Path, measures: List[Measure], wanted: float):
        self.folder, self.measures, self.wanted = folder, measures, wanted
        self.stiff: Candidate
        self.scatter: Dict[str, float] = {}
        self.candidates: List[Candidate] = []
        self.chosen: Optional[Candidate] = None
        self.scene: Optional[Scene] = None
        self.file: Optional[pathlib.Path] = None
        self.limits: List[str] = []
        self.overlap_limit = math.nan

    def table(self) -> str:
        """All settings that were run, as text."""
        return table(self)

    def reading(self) -> str:
        """What was found, and what limits, as text."""
        return reading(self)

    def picture(self, file: Optional[str] = None):
        """Error against wall time of all settings, as a matplotlib figure; written to `file` if given."""
        from tandem.soften_picture import draw
        return draw(self, file)

    def write(self) -> None:
        """results.csv and reading.txt in the folder."""
        with open(self.folder / "results.csv", "w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            names = [measure.of for measure in self.measures]
            rows.writerow(["setting", "divisor", "share", "micro_step_s", "window_s", "starts", "status"] + [f"error {n}" for n in names] + [
                "wall_s", "wall_low_s", "wall_high_s", "dem_s", "mbd_s", "exchange_s", "output_s", "micro_steps", "windows", "overlap", "reason"])
            for each in [self.stiff] + self.candidates:
                errors = self.scatter if each is self.stiff else each.errors
                kind = "stiff" if each is self.stiff else "chosen" if each is self.chosen else "tried"
                rows.writerow([kind, each.setting.divisor, f"{each.share:.4g}", f"{each.step_s:.6g}", each.setting.window, len(each.rows), each.status] +
                              [f"{errors[n]:.4g}" if math.isfinite(errors.get(n, math.nan)) else "" for n in names] +
                              [f"{t:.4g}" for t in (each.wall_s, min(each.times, default=math.nan), max(each.times, default=math.nan))] +
                              [f"{each.parts.get(p, math.nan):.4g}" for p in ("dem", "mbd", "exchange", "output")] +
                              [each.steps, each.windows, f"{each.overlap:.3g}", each.fault or (stiff_mark(each) if each is self.stiff else "")])
        (self.folder / "reading.txt").write_text(self.reading() + "\n")

    def __repr__(self) -> str:
        return f"<Softening: {self.chosen.setting if self.chosen else 'nothing'}, {len(self.candidates)} settings run, {self.folder}>"


def soften(scene: Scene, error: Union[float, str], of: Union[str, Sequence[str]], *, starts: int = 3, jobs: int = 1, threads: Optional[int] = None,
           out: Optional[str] = None, file: Optional[str] = None, limit: Optional[float] = None, backend: Optional[str] = None, retry: bool = False,
           overlap: float = 0.5, modulus: Sequence[float] = (), step: Sequence[float] = (), window: Sequence[float] = (), most: int = 30,
           progress: bool = True) -> Softening:
    """Finds the cheapest modulus, micro step and window that keep the wanted error, and writes the softened scene.

        soft = td.soften(s, error=0.01, of=["hinge.q", "mouth.flow:mean"])
        print(soft.reading()); r = soft.scene.run()

    error    wanted, relative to the scene as it is: 0.01 or "1%"
    of       results that keep it: "COLUMN" for a course, "COLUMN:REDUCTION" as of Results.reduce() for a number
    starts   random starts of each setting, whose scatter is the least error that means anything, and whose median time counts; 1: no scatter
    overlap  largest overlap that is accepted, relative to the smaller radius
    modulus  divisors to try;  step  shares of the critical time to try;  window  windows to try [s]; by default twice as large each
    file     of the softened scene, NAME_soft.json in the folder by default
    most     settings that are run at most;  jobs, threads, out, limit, backend, retry  as of sweep()"""
    expect_limit(limit)
    checks.expect_numbers({"modulus": modulus, "step": step, "window": window}, overlap)
    work = _Work(scene, error_of_text(str(error)), [of] if isinstance(of, str) else list(of), starts, overlap, window, out, file, progress,
                 dict(jobs=jobs, threads=threads, limit=limit, backend=backend, retry=retry, progress=False, timed=True))
    try:
        return work.do(modulus, step, window, most)
    finally:
        work.folder.release()


class _Work:
    """Runs one softening."""

    def __init__(self, scene, wanted, of, starts, overlap, window, out, file, progress, options):
        checks.expect_scene(scene, starts)
        checks.expect_results(of, scene.end_time)
        self.scene, self.starts, self.largest_overlap, self.options, self.progress = scene, starts, overlap, options, progress
        for each in window:
            changes.expect_window(scene, each)
        self.folder = Folder(scene, out, file)
        self.found = Softening(self.folder.path, [Measure(name) for name in of], wanted)
        self.taken: Dict[str, float] = {}

    def do(self, modulus, step, window, most) -> Softening:
        self._probe()
        self.levels = [[1.0] + sorted(float(d) for d in modulus) if modulus else changes.moduli(),
                       [self.share] + sorted(map(float, step)) if step else changes.shares(self.share),
                       [self.scene.window] + sorted(map(float, window)) if window else changes.windows(self.scene, self.scene.window)]
        self._expect_levels()
        self.folder.forget_earlier_results()
        self._run_stiff()
        found = self.found
        if not any(found.scatter[m.of] > found.wanted for m in found.measures):
            scatter = max((s / found.wanted for s in found.scatter.values() if math.isfinite(s)), default=0.0)
            self.search = Search(tuple(map(len, self.levels)), self._outcome, self._counts, scatter, most)
            best = self.search.run()
            found.limits = [self._limit(axis) for axis in AXES]
            if best != (0, 0, 0):
                found.chosen = self.by_point[best]
                self._write_scene()
        found.write()
        return found

    # ---- runs

    def _say(self, text: str) -> None:
        if self.progress:
            print(text, flush=True)

    def _swept(self, build, **values) -> List[Row]:
        return sweep(build, out=str(self.found.folder / "runs"), **self.options, **values).rows

    def _probe(self) -> None:
        """One window of the scene: names of the results, critical time, moduli of the library."""
        def first_window(probe: int) -> Scene:
            short = self.scene.copy()
            short.end_time = short.window
            short.section("output")["frame_interval"] = 0
            short.data.pop("checks", None)
            return short
        checks.expect_summary_keys(self.scene, [measure.of for measure in self.found.measures])
        row = self._swept(first_window, probe=[1])[0]
        if row.status not in ("ok", "suspect"):
            raise SceneError(f"the scene does not run: {row.reason}", self.scene.name)
        results = row.results
        for measure in self.found.measures:
            measure.expect_in(results)
        if not {"micro_step_s", "critical_time_s"} <= set(results.summary):
            raise SceneError("the particle solver does not report its micro step and the critical time", self.scene.name,
                             "soften the scene with dem_server, and run the result with the other solver")
        self.step, self.critical = results.summary["micro_step_s"], results.summary["critical_time_s"]
        self.share = self.step / self.critical
        self.taken = changes.moduli_of_library(results.summary.get("parameters", {}))

    def _expect_levels(self) -> None:
        for (name, what), level in zip((("--modulus", "divisors above 1"), ("--step", f"shares of the critical time above {self.share:.3g}"),
                                        ("--window", f"windows above {self.scene.window:g} s")), self.levels):
            if any(b <= a * (1 + 1e-9) for a, b in zip(level, level[1:])):
                raise SceneError(f"{', '.join(f'{value:g}' for value in level[1:])} has a value that is no step up from that of the scene", name,
                                 f"write different {what}", made_at="the command line")
        if self.levels[1][-1] > changes.LONGEST_STEP:
            raise SceneError(f"{self.levels[1][-1]:g} of the critical time is above {changes.LONGEST_STEP:g}, beyond which steps are refused", "--step",
                             made_at="the command line")

    def _run_stiff(self) -> None:
        found = self.found
        self._say(f"{self.scene.name}: micro step {self.share:.3g} of the critical time, window {1e3 * self.scene.window:g} ms; "
                  f"{self.starts} run{'s' if self.starts > 1 else ''} as it is")
        rows = self._swept(lambda start: changes.softened(self.scene, self.taken, 1, 0, self.scene.window, start), start=list(range(1, self.starts + 1)))
        found.stiff = Candidate(Setting(1, self.share, self.scene.window), rows)
        if found.stiff.fault:
            raise SceneError(f"the scene as it is does not come to a good end: {found.stiff.fault}", self.scene.name)
        results = [row.results for row in rows]
        self.critical = min(r.summary["critical_time_s"] for r in results)  # radii, too, depend on the start
        pairs = [(a, b) for i, a in enumerate(results) for b in results[:i]]
        for measure in found.measures:
            measure.expect_to_change(results)
            found.scatter[measure.of] = _rms([measure.error(a, b) for a, b in pairs])
        self._say(f"stiff: {found.stiff.wall_s:.3g} s" + "".join(f", {name} scatters by {percent(s)}" for name, s in found.scatter.items() if pairs))
        for line in doubts(found.stiff)[:-1]:
            self._say(line)
        self.by_point: Dict[Point, Candidate] = {(0, 0, 0): found.stiff}

    def _setting(self, point: Point) -> Setting:
        return Setting(*(level[i] for level, i in zip(self.levels, point)))

    def _counts(self, point: Point):
        setting = self._setting(point)
        longest = changes.longest_window(self.scene, setting.window)
        steps = round(longest / self.step) if point == (0, 0, 0) else self._steps_in(setting)
        return self.scene.end_time / longest * steps, self.scene.end_time / setting.window

    def _outcome(self, point: Point) -> Outcome:
        found = self.found
        if point == (0, 0, 0):
            return self._judged(found.stiff, {measure.of: 0.0 for measure in found.measures})
        setting = self._setting(point)
        candidate = self._run(setting, [1])
        if not candidate.fault and all(error <= 1.5 * found.wanted for error in candidate.errors.values()) and self.starts > 1:
            candidate = self._run(setting, list(range(1, self.starts + 1)))
        found.candidates.append(candidate)
        self.by_point[point] = candidate
        self._say(f"[{len(found.candidates)}] {candidate.setting}: " + (shortened(candidate.fault, 100) or ", ".join(f"{n} {percent(e)}" for n, e in candidate.errors.items())) +
                  (f"; {candidate.wall_s:.3g} s" if candidate.times else ""))
        return self._judged(candidate, candidate.errors)

    def _judged(self, candidate: Candidate, errors: Dict[str, float]) -> Outcome:
        parts = candidate.parts
        windows = parts.get("mbd", 0) + parts.get("exchange", 0)
        return Outcome([error / self.found.wanted for error in errors.values()], parts.get("dem", 0), windows,
                       max(0.0, (candidate.wall_s if candidate.times else math.inf) - parts.get("dem", 0) - windows), candidate.fault)

    def _steps_in(self, setting: Setting) -> int:
        """Micro steps of the longest window."""
        critical = self.critical * math.sqrt(setting.divisor)
        return changes.steps_in(changes.longest_window(self.scene, setting.window), setting.share * critical, changes.LONGEST_STEP * critical)

    def _step_of(self, setting: Setting) -> float:
        """[s]: of a window that holds whole steps."""
        return min(changes.longest_window(self.scene, setting.window) / self._steps_in(setting), setting.window)

    def _run(self, setting: Setting, starts: List[int]) -> Candidate:
        rows = self._swept(lambda modulus, step, window, start: changes.softened(self.scene, self.taken, modulus, step, window, start, 1.0),
                           modulus=[setting.divisor], step=[self._step_of(setting)], window=[setting.window], start=starts)
        candidate = Candidate(setting, rows)
        self._find_errors(candidate)
        return candidate

    def _find_errors(self, candidate: Candidate) -> None:
        stiff = [row.results for row in self.found.stiff.rows]
        fresh = {rule: text for rule, text in candidate.rules.items() if rule != "overlap" and rule not in self.found.stiff.rules}
        if not candidate.fault:
            for measure in self.found.measures:
                errors = [measure.error(row.results, right) for row, right in zip(candidate.rows, stiff)]
                candidate.errors[measure.of], candidate.first_errors[measure.of] = _rms(errors), errors[0]
            lost = [name for name, error in candidate.errors.items() if not math.isfinite(error)]
            if lost:
                candidate.fault = f"{', '.join(lost)} is not a finite number"
            elif fresh:
                candidate.fault = "suspect by " + "; ".join(f"{rule}: {text}" for rule, text in fresh.items())
            elif candidate.overlap > self.largest_overlap:
                candidate.fault = f"overlaps up to {candidate.overlap:.2g} of the radius, more than {self.largest_overlap:g}"

    # ---- what was found

    def _limit(self, axis: int) -> str:
        """Why the next level of an axis is not taken."""
        shown, why = self.search.limit(axis)
        if why == "last":
            return f"{AXES[axis]}: the last level"
        if why == "untried":
            return f"{AXES[axis]}: not examined further, {len(self.search.tried)} settings were run"
        candidate = self.by_point[shown]
        names = [m.of for m in self.found.measures if candidate.errors.get(m.of, 0) > self.found.wanted]
        because = {"fault": candidate.fault, "cost": f"no faster ({candidate.wall_s:.3g} s)",
                   "error": ", ".join(f"{name} {percent(candidate.errors[name])}" for name in names)}[why]
        return f"{AXES[axis]}: {candidate.setting} has {because}" if why == "error" else f"{AXES[axis]}: {candidate.setting}: {because}"

    def _write_scene(self) -> None:
        """The softened scene, which is run once: with its overlap_limit it must not be suspect for another reason than the stiff one."""
        found, chosen = self.found, self.found.chosen
        own = self.scene.data["dem"].get("overlap_limit", 0.05)
        limit = own if isinstance(own, str) or chosen.overlap <= own else min(1.0, math.ceil(120 * chosen.overlap) / 100)
        scene = changes.softened(self.scene, self.taken, chosen.setting.divisor, self._step_of(chosen.asked), chosen.setting.window, 1, limit)
        evidence = ", ".join(f"{name} {percent(error)} (scatter {percent(found.scatter[name])})" if len(chosen.rows) > 1 else f"{name} {percent(error)}"
                             for name, error in chosen.errors.items())
        scene.description = (self.scene.description + " " if self.scene.description else "") + (
            f"Softened by tandem soften: {chosen.setting}; error against the stiff scene: {evidence}; overlaps up to {chosen.overlap:.2g}." +
            " ".join([""] + [line.strip() for line in doubts(found.stiff)]).rstrip())
        row = self._swept(lambda written: scene, written=[1])[0]
        again = Candidate(chosen.asked, [row])
        self._find_errors(again)
        if again.fault or "overlap" in again.rules and "overlap" not in found.stiff.rules or again.errors != chosen.first_errors:
            raise SceneError(f"the softened scene does not repeat what was found: {again.fault or 'its errors differ'}", str(row.folder),
                             "a bug of tandem: please report it")
        found.scene, found.overlap_limit = scene, limit
        found.file = self.folder.file
        self.folder.write_scene(scene)


def _rms(values: List[float]) -> float:
    return math.sqrt(sum(v * v for v in values) / len(values)) if values else math.nan

