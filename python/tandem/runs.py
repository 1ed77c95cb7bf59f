"""A run of a scene: started, watched, stopped."""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
from typing import TYPE_CHECKING, Any, Optional, Sequence

from tandem.entries import SceneError
from tandem.program import find_tandem

if TYPE_CHECKING:
    from tandem.results import Results


class RunError(RuntimeError):
    """A run ended by an error: `code`, `what`, `where` and `hint` as in summary.json, and the folder of its results."""

    def __init__(self, what: str, code: str = "", where: str = "", hint: str = "", folder: Optional[pathlib.Path] = None):
        self.what, self.code, self.where, self.hint, self.folder = what, code, where, hint, folder
        text = (f"{where}: " if where else "") + what + (f" ({hint})" if hint else "")
        super().__init__(text + (f"\n  results until then, and run.log: {folder}" if folder else ""))


class Run:
    """A run in progress. Scene.start() makes it, and returns while it runs:

        run = s.start()
        while run.running:
            print(run.time, run["hinge.q"].last())
            time.sleep(1)
        r = run.wait()

    run["COLUMN"] has the values so far; run.stop() ends it after its window, and keeps the results."""

    def __init__(self, scene, out: Optional[str] = None, *, progress: Any = False, controller: Any = None, threads: Optional[int] = None,
                 backend: Optional[str] = None, picture: bool = True, report: bool = True, restart: Optional[str] = None,
                 checkpoint_every: Optional[float] = None, strict: bool = False, arguments: Sequence[str] = (), **parameters: float):
        if out is not None and not isinstance(out, (str, os.PathLike)):
            raise SceneError(f"out= is {out!r}", hint='give the folder of the results, as out="out/hopper"')
        if isinstance(arguments, str):
            raise SceneError(f"arguments= is {arguments!r}", hint=f"give a list of texts: arguments={arguments.split()!r}")
        if controller is not None and not callable(controller) and not isinstance(controller, (str, os.PathLike)):
            raise SceneError(f"controller= is {controller!r}", hint="give a function (time, sensors) -> inputs, or the command of a program")
        self.scene, self.progress, self.stopped = scene, progress, False
        self.folder = pathlib.Path(out or pathlib.Path("out") / scene._file_name())
        plain = scene.copy().set(**parameters) if parameters else scene
        self._files = tempfile.TemporaryDirectory(prefix="tandem_run_")
        self._file = pathlib.Path(self._files.name) / f"{scene._file_name()}.json"
        self._file.write_text(plain.json() + "\n")
        self._said = open(pathlib.Path(self._files.name) / "said", "w+")
        command = [find_tandem(), "run", str(self._file), "--out", str(self.folder), "--quiet"]
        for name, value in (("--threads", threads), ("--backend", backend), ("--restart", restart), ("--checkpoint-every", checkpoint_every)):
            command += [] if value is None else [name, str(value)]
        for name, wanted in (("--no-picture", not picture), ("--no-report", not report), ("--strict", strict)):
            command += [name] if wanted else []
        self._controller = None
        if controller is not None:
            if callable(controller):
                from tandem.control import FunctionController
                self._controller = FunctionController(controller)
                controller = self._controller.command
            command += ["--controller", str(controller)]
        self.begin = time.monotonic()
        # A session of its own: Ctrl-C reaches this process, which passes it on once.
        self.process = subprocess.Popen(command + [str(word) for word in arguments], stdout=self._said, stderr=self._said,
                                        stdin=subprocess.DEVNULL, start_new_session=True)

    @property
    def running(self) -> bool:
        """Whether the run is in progress."""
        return self.process.poll() is None

    @property
    def time(self) -> float:
        """Simulated time so far [s]."""
        try:
            with open(self.folder / "windows.csv", "rb") as file:
                column = file.readline().decode().strip().split(",").index("time")
                size = file.seek(0, os.SEEK_END)
                file.seek(max(0, size - 4096))
                rows = file.read().split(b"\n")[:-1]
            return float(rows[-1].split(b",")[column])
        except (OSError, ValueError, IndexError):
            return 0.0

    @property
    def results(self) -> "Results":
        """The results so far."""
        from tandem.results import Results
        return Results(self.folder)

    def __getitem__(self, name: str) -> Any:
        return self.results[name]

    def stop(self) -> None:
        """Ends the run after its window, as Ctrl-C does; wait() returns the results up to then."""
        if self.running and not self.stopped:
            self.stopped = True
            self.process.send_signal(signal.SIGINT)

    def wait(self) -> "Results":
        """Waits for the end and returns the Results; raises RunError or SceneError where an error ended the run."""
        from tandem.notebook import ProgressLine
        line = ProgressLine(self) if self.progress is True else None
        try:
            if not self.progress:
                self.process.wait()
            while self.running:
                try:
                    self.process.wait(0.5)
                except subprocess.TimeoutExpired:
                    line.update() if line else self.progress(self)
        except BaseException:
            self.stop()
            self.process.wait()
            raise
        finally:
            if line:
                line.close()
            self._finish()
        return self._outcome()

    def _finish(self) -> None:
        if self._controller is not None:
            self._controller.close()
        if not self._said.closed:
            self._said.seek(0)
            self.said = self._said.read()
            self._said.close()
        self._files.cleanup()

    def _outcome(self):
        if self._controller is not None and self._controller.error is not None:
            raise self._controller.error
        status = self.process.returncode
        if status != 0 and not (self.stopped and status == 130):
            self._raise(status)
        warnings = [text for text in self.said.splitlines() if "warning" in text.lower()]
        for text in warnings[:5]:
            print(text, file=sys.stderr)
        return self.results

    def _raise(self, status: int) -> None:
        try:
            summary = json.loads((self.folder / "summary.json").read_text())
        except (OSError, ValueError):
            summary = {}
        error = summary.get("error") if summary.get("exit_status") == status else None
        if error and error.get("code") != "scene":
            raise RunError(error.get("what", ""), error.get("code", ""), error.get("where", ""), error.get("hint", ""), self.folder)
        if summary.get("exit_status") == status and not error:
            if summary.get("status") == "suspect":
                raise RunError("the run is suspect: " + "; ".join(self.results.verdict.lines), "suspect", folder=self.folder)
            return  # checks that failed: the results say so
        if status < 0:
            raise RunError(f"the program ended by signal {-status}", "signal", folder=self.folder)
        said = "\n".join(text for text in self.said.splitlines() if "error" in text) or self.said
        if status == 2 and not re.match(r"^(.*error:\s*)?--", said, flags=re.S):  # an option is none of the scene
            raise self.scene.error_of(re.sub(r"^.*?error:\s*", "", said, flags=re.S), str(self._file))
        raise RunError(re.sub(r"^.*?error:\s*", "", said.strip(), flags=re.S), str(status), folder=self.folder)

    def _repr_html_(self) -> str:
        from tandem.notebook import progress_html
        return progress_html(self)
