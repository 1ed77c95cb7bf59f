"""Sweeps: many variants of a scene side by side, resumed where they stopped, with a table and a picture of the response."""
import csv
import itertools
import json
import math
import os
import pathlib
import queue
import signal
import subprocess
import threading
import time
from typing import Any, Callable, Dict, Iterable, List, Optional, Sequence, Union

from tandem.entries import NoSuchName, SceneError, nearest, plain
from tandem.program import find_tandem
from tandem.scenes import Scene
from tandem.sweep_scores import Score, expect_words, score_of
from tandem.variants import Variant, digest_of, state_of, variant_key


class Row:
    """One variant: `values` of its parameters, `status` ("ok", "suspect", "failed", "timed out", "pending"), `scores`, `reason`, `folder`,
    `wall_s`, and its `results`."""

    def __init__(self, values: Dict[str, Any], key: str, folder: pathlib.Path):
        self.values, self.key, self.folder = values, key, folder
        self.status, self.reason, self.wall_s = "pending", "", float("nan")
        self.scores: Dict[str, float] = {}

    @property
    def results(self):
        """The tandem.Results of the run."""
        from tandem.results import Results
        return Results(self.folder)

    @property
    def score(self) -> float:
        """The first score; NaN without one."""
        return next(iter(self.scores.values()), float("nan"))

    def __getitem__(self, name: str) -> Any:
        for values in (self.values, self.scores):
            if name in values:
                return values[name]
        raise NoSuchName(f"a variant has no '{name}'" + nearest(name, list(self.values) + list(self.scores)))

    def __repr__(self) -> str:
        scores = "".join(f", {name} = {value:.6g}" for name, value in self.scores.items())
        return f"<{self.key}: {self.status}{scores}{', ' + self.reason[:90] if self.reason else ''}>"


class Sweep:
    """The variants of a sweep: rows, table(), best(), column("mouth"), picture(), and results.csv in its folder."""

    def __init__(self, folder: pathlib.Path, names: List[str], rows: List[Row]):
        self.folder, self.names, self.rows = folder, names, rows

    @property
    def scores(self) -> List[str]:
        """Names of the scores."""
        return list(dict.fromkeys(name for row in self.rows for name in row.scores))

    def column(self, name: str):
        """A parameter or a score as an array, NaN where a variant has none."""
        import numpy as np
        return np.array([row.values.get(name, row.scores.get(name, float("nan"))) for row in self.rows], float)

    def best(self, score: Optional[str] = None, least: bool = False) -> Row:
        """The variant with the largest (least=True: smallest) score, among those that are ok, or else suspect."""
        name = score or next(iter(self.scores), "")
        for status in ("ok", "suspect"):
            found = [row for row in self.rows if row.status == status and math.isfinite(row.scores.get(name, math.nan))]
            if found:
                return (min if least else max)(found, key=lambda row: row.scores[name])
        raise ValueError(f"no variant has a score '{name}': " + ", ".join(f"{row.key} {row.status}" for row in self.rows[:5]))

    def table(self) -> str:
        """All variants as text, in their order."""
        head = self.names + ["status"] + self.scores + ["wall [s]"]
        lines = [head] + [[_text(row.values[name]) for name in self.names] + [row.status] +
                          [_text(row.scores.get(name, float("nan"))) for name in self.scores] + [_text(row.wall_s)] for row in self.rows]
        widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
        texts = ["  ".join(word.rjust(width) for word, width in zip(line, widths)) for line in lines]
        reasons = [f"{row.key}: {row.reason}" for row in self.rows if row.reason]
        return "\n".join(texts + ([""] + reasons if reasons else []))

    def __getitem__(self, index: int) -> Row:
        return self.rows[index]

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        counts: Dict[str, int] = {}
        for row in self.rows:
            counts[row.status] = counts.get(row.status, 0) + 1
        return f"<Sweep of {', '.join(self.names)}: " + ", ".join(f"{count} {status}" for status, count in counts.items()) + f", {self.folder}>"

    def write(self) -> None:
        """results.csv in the folder of the sweep."""
        draft = self.folder / f".results.{os.getpid()}.new"
        with open(draft, "w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(self.names + ["status"] + self.scores + ["wall_s", "reason", "folder"])
            for row in self.rows:
                rows.writerow([row.values[n] for n in self.names] + [row.status] + [repr(row.scores[n]) if n in row.scores else "" for n in
                              self.scores] + [row.wall_s, row.reason, os.path.relpath(row.folder, self.folder)])
        draft.replace(self.folder / "results.csv")

    def picture(self, file: Optional[str] = None):
        """The response over one or two parameters, as a matplotlib figure; written to `file` if given."""
        from tandem.responses import response
        return response(self, file)

    def _repr_html_(self) -> str:
        from tandem.notebook import image_html, text_html
        from tandem.plots import png
        return text_html(self.table()) + (image_html(png(self.picture())) if any(row.scores for row in self.rows) else "")


def _text(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def sweep(scene: Union[Scene, Callable[..., Scene]], *, score: Score = None, jobs: int = 1, threads: Optional[int] = None,
          out: Optional[str] = None, limit: Optional[float] = None, backend: Optional[str] = None, retry: bool = False,
          share: Optional[str] = None, progress: bool = True, timed: bool = False, arguments: Sequence[str] = (), **values: Iterable[Any]) -> Sweep:
    """Runs all combinations of values, and returns the Sweep.

        best = td.sweep(s, mouth=[.05, .06, .07, .08], score="mouth.flow:mean", jobs=2)       # parameters of the scene
        best = td.sweep(variant, width=[.8, 1, 1.2], pitch=range(-20, 20, 5), score=lambda r: r.mass_in("bucket"))
        print(best.table()); best.picture("response.png"); best.best().results

    scene     a Scene, whose parameters get the values; or a function of the values that returns a Scene
    score     "COLUMN:REDUCTION" as of Results.reduce(), several of them, or a function of the Results: a number or a dict of numbers
    jobs      runs side by side;  threads  of each, by default the cores divided by the jobs
    out       folder, out/sweep_NAME by default. The same sweep again continues where it stopped: a variant whose scene has not changed is not
              run again, also one that failed; retry=True runs those that failed again
    limit     wall time of a run [s], after which it is stopped and "timed out"
    timed     wall times count: what was run with other jobs or threads is run again; otherwise only where other `threads` are given
    share     "2/5": only the second of five parts, for an array job; another call without it collects

    A variant that fails, is suspect or cannot be built is marked in the table, and does not stop the others."""
    expect_limit(limit)
    if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
        raise SceneError(f"jobs is {jobs!r}", hint="give the number of runs side by side, 1 or more")
    if not isinstance(scene, Scene) and not callable(scene):
        raise SceneError(f"{scene!r} is no scene", hint="give a Scene, or a function of the values that returns one")
    names = list(values)
    if not names:
        raise SceneError("a sweep needs values of at least one parameter", hint="for instance td.sweep(s, mouth=[0.05, 0.06])")
    if isinstance(scene, Scene):
        known = scene.data.get("parameters", {})
        for name in names:
            if name not in known:
                raise SceneError(f"the scene has no parameter '{name}'" + nearest(name, known), "parameters")
        build: Callable[..., Scene] = lambda **v: scene.copy().set(**v)  # noqa: E731
        label = scene._file_name()
        expect_words(score, scene.end_time)
    else:
        build, label = scene, getattr(scene, "__name__", "variants")
        expect_words(score, None)
    lists = [[plain(v) for v in ([vs] if isinstance(vs, (int, float, str)) else vs)] for vs in values.values()]
    for name, column in zip(names, lists):
        if not column:
            raise SceneError(f"{name} has no values", hint=f"give one or more: {name}=[0.05, 0.06]")
        twice = [value for i, value in enumerate(column) if value in column[:i]]
        if twice:
            raise SceneError(f"{name} has the value {_text(twice[0])} twice", hint="keep one of them")
    folder = pathlib.Path(out or pathlib.Path("out") / f"sweep_{label}").absolute()
    _claim(folder, names)
    rows = [Row(dict(zip(names, point)), variant_key(names, point), folder / "variants" / variant_key(names, point))
            for point in itertools.product(*lists)]
    wanted = score_of(score, same_columns=isinstance(scene, Scene))
    work = _Work(Sweep(folder, names, rows), build, wanted, max(1, jobs), threads, limit, backend, retry, progress, timed, list(arguments))
    part, parts = (int(word) for word in share.split("/")) if share else (1, 1)
    work.do([row for i, row in enumerate(rows) if i % parts == (part - 1) % parts])
    return work.sweep


def expect_limit(limit: Optional[float]) -> None:
    """Refuses a wall time that a run cannot have."""
    if limit is not None and not (isinstance(limit, (int, float)) and math.isfinite(limit) and limit > 0):
        raise SceneError(f"{limit!r} is no wall time of a run", "limit", "write a finite number of seconds above 0, or leave it out for none")


def _claim(folder: pathlib.Path, names: List[str]) -> None:
    if folder.is_dir() and any(folder.iterdir()) and not (folder / "sweep.json").is_file():
        raise SceneError(f"'{folder}' has files, but is no folder of a sweep", hint="give another out=")
    (folder / "variants").mkdir(parents=True, exist_ok=True)
    (folder / "sweep.json").write_text(json.dumps({"tandem": "sweep", "parameters": names}) + "\n")


class _Work:
    """Runs the variants of one sweep."""

    def __init__(self, swept: Sweep, build, score, jobs, threads, limit, backend, retry, progress, timed, arguments):
        self.sweep, self.build, self.score, self.jobs, self.limit, self.retry = swept, build, score, jobs, limit, retry
        self.progress = progress
        of_each = ["--threads", str(threads or max(1, len(os.sched_getaffinity(0)) // jobs))]
        others = ["--no-picture", "--no-report", "--quiet"] + (["--backend", backend] if backend else []) + arguments
        self.options = of_each + others
        self.known_by = others + (of_each if threads or timed else []) + (["--jobs", str(jobs)] if timed else [])
        self.program = find_tandem()
        self.processes: Dict[str, subprocess.Popen] = {}
        self.stopping = threading.Event()

    def do(self, mine: List[Row]) -> None:
        todo: "queue.Queue[Any]" = queue.Queue()
        done: "queue.Queue[Any]" = queue.Queue()
        for row in self.sweep.rows:
            if row not in mine:
                if state_of(self.program, row.folder) in ("ok", "suspect", "failed"):
                    self._judge(row)
        count = 0
        for row in mine:
            variant = self._prepare(row)
            if variant is not None:
                todo.put((row, variant))
                count += 1
        finished = [row for row in mine if row.status != "pending"]
        self._say(f"{len(mine)} variants, {len(finished)} of them done before, {self.jobs} side by side")
        self.sweep.write()
        workers = [threading.Thread(target=self._work, args=(todo, done), daemon=True) for _ in range(min(self.jobs, count))]
        for worker in workers:
            worker.start()
        try:
            for number in range(count):
                row = done.get()
                self._judge(row)
                self.sweep.write()
                self._say(f"[{len(finished) + number + 1}/{len(mine)}] {row!r}")
        except BaseException:
            self.stopping.set()
            for process in list(self.processes.values()):
                process.send_signal(signal.SIGINT)
            for worker in workers:
                worker.join(60)
            raise

    def _say(self, text: str) -> None:
        if self.progress:
            print(text, flush=True)

    def _prepare(self, row: Row) -> Optional[Variant]:
        """What is to be run; None where it is done, or cannot be built."""
        try:
            scene = self.build(**row.values)
            if not isinstance(scene, Scene):
                raise SceneError(f"the function of the sweep returned {type(scene).__name__}, no Scene", made_at="the sweep")
            text = scene.json() + "\n"
        except Exception as error:  # noqa: B902 (of the user's function)
            if not isinstance(error, SceneError) and len(self.sweep.rows) == 1:
                raise
            row.status, row.reason = "failed", " ".join(f"{type(error).__name__}: {error}".split())
            return None
        variant = Variant(row.folder, text, digest_of(text, self.known_by))
        state = state_of(self.program, row.folder)
        known = variant.is_known()
        if known and (state in ("ok", "suspect") or (state in ("failed", "timed out") and not self.retry)):
            self._judge(row)
            return None
        variant.wait_for = known and state == "running"
        return variant

    def _work(self, todo, done) -> None:
        while not self.stopping.is_set():
            try:
                row, variant = todo.get_nowait()
            except queue.Empty:
                return
            begin = time.monotonic()
            try:
                if variant.wait_for:
                    variant.wait(self.program, self.stopping)
                else:
                    self._run(row, variant)
            except OSError as error:
                row.reason = str(error)
            row.wall_s = time.monotonic() - begin
            done.put(row)

    def _run(self, row: Row, variant: Variant) -> None:
        variant.write()
        with open(variant.log, "w") as log:
            process = subprocess.Popen([self.program, "run", str(variant.scene), "--out", str(row.folder), *self.options], stdout=log, stderr=log,
                                       stdin=subprocess.DEVNULL, start_new_session=True)
            self.processes[row.key] = process
            try:
                process.wait(self.limit)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGINT)
                try:
                    process.wait(30)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
                variant.timed_out(self.limit)
            del self.processes[row.key]

    def _judge(self, row: Row) -> None:
        """Status, reason and scores of a run that has ended."""
        from tandem.results import Results
        variant = Variant(row.folder)
        row.status, row.reason = variant.outcome(self.program)
        if row.status in ("ok", "suspect"):
            results = Results(row.folder)
            row.wall_s = results.summary.get("wall_s") or row.wall_s
            try:
                row.scores = self.score(results)
                odd = [f"{name} is {value}" for name, value in row.scores.items() if not math.isfinite(value)]
                row.reason = "; ".join(filter(None, [row.reason, *odd]))
            except SceneError:
                raise
            except Exception as error:  # noqa: B902 (of the user's score)
                row.reason = " ".join(f"no score: {error.args[0] if isinstance(error, KeyError) else error}".split())
