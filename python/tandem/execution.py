"""What the program does with a scene: checks, runs, pictures, and the errors that it reports. A part of Scene."""
import pathlib
import re
import subprocess
import tempfile
from typing import TYPE_CHECKING, Any, Optional, Sequence

from tandem.entries import SceneError

if TYPE_CHECKING:
    from tandem.notebook import Picture
    from tandem.results import Results
    from tandem.runs import Run


class Execution:
    """Methods of Scene that start the program `tandem`."""

    def check(self, files_only: bool = False) -> str:
        """Checks the scene as `tandem validate` does, which starts the solvers: raises SceneError with the path in the scene and the line of
        Python, or returns the remarks. files_only=True starts no solver."""
        return self._ask("validate", *(["--files-only"] if files_only else []))

    def describe(self) -> str:
        """What the scene consists of, as `tandem describe` says it."""
        return self._ask("describe")

    def _ask(self, verb: str, *arguments: str) -> str:
        from tandem.program import find_tandem
        with tempfile.TemporaryDirectory(prefix="tandem_") as folder:
            file = pathlib.Path(folder) / f"{self._file_name()}.json"
            file.write_text(self.json() + "\n")
            said = subprocess.run([find_tandem(), verb, str(file), *arguments], capture_output=True, text=True, check=False)
        if said.returncode != 0:
            raise self.error_of(said.stderr or said.stdout, str(file))
        return said.stdout.replace(str(file), self.name)

    def preview(self, file: Optional[str] = None) -> "Picture":
        """Draws the start of the scene into a PNG file, NAME_preview.png by default, and returns the picture, which notebooks show."""
        from tandem.notebook import Picture
        target = pathlib.Path(file or f"{self._file_name()}_preview.png").resolve()
        self._ask("preview", "-o", str(target))
        return Picture(target)

    def _file_name(self) -> str:
        return re.sub(r"[^A-Za-z0-9_-]", "_", self.name) or "scene"

    def start(self, out: Optional[str] = None, **options: Any) -> "Run":
        """Starts a run and returns a tandem.Run at once; see run() for the options."""
        from tandem.runs import Run
        return Run(self, out, **options)

    def run(self, out: Optional[str] = None, *, progress: Any = False, controller: Any = None, threads: Optional[int] = None,
            backend: Optional[str] = None, picture: bool = True, report: bool = True, restart: Optional[str] = None,
            checkpoint_every: Optional[float] = None, strict: bool = False, arguments: Sequence[str] = (), **parameters: float) -> "Results":
        """Runs the scene and returns its tandem.Results.

        out         folder of the results, out/NAME by default; it replaces those of an earlier run there
        progress    True: a line of progress; or a function that gets the tandem.Run twice a second, and may call its stop()
        controller  a function (time, sensors) -> inputs, called in this process before each window: `sensors` is a dict of the columns of
                    s.observe(), the answer a dict of the scene's control inputs, or a number if there is one
        threads     of the particle solver;  backend "cpu" or "cuda";  picture, report: whether picture.png and report.html are made
        restart     folder of a run to continue;  checkpoint_every [s];  strict: a suspect run raises RunError
        arguments   more options of `tandem run`, as texts
        parameters  values of the scene's parameters: s.run(mouth=0.08)

        An error that ends the run raises tandem.RunError, or tandem.SceneError where the scene is wrong. A run that is suspect, or whose
        checks failed, returns: look at its `verdict`."""
        run = self.start(out, progress=progress, controller=controller, threads=threads, backend=backend, picture=picture, report=report,
                         restart=restart, checkpoint_every=checkpoint_every, strict=strict, arguments=arguments, **parameters)
        return run.wait()

    def error_of(self, said: str, file: str = "") -> SceneError:
        """What the program said about this scene, with the line of Python that made the object it names."""
        text = " ".join(line for line in said.strip().splitlines() if line.strip()) or "the program said nothing"
        text = re.sub(r"^error:\s*", "", text).replace(f"{file}: ", "").replace(file, self.name) if file else text
        if "no pair of" in text:
            text += "; or give both materials friction= and restitution="
        return SceneError(text, made_at=self._origin(text) or self.data.made_at)

    def _origin(self, text: str) -> Optional[str]:
        """The line that made what a message names: by its path in the scene, or else by its name."""
        for path in re.findall(r"[a-z_]+(?:\.[a-z_0-9]+|\[\d+\])+", text):
            here, found = self.data, None
            for key, index in re.findall(r"([a-z_0-9]+)|\[(\d+)\]", path):
                try:
                    here = here[int(index)] if index else here[key]
                except (KeyError, IndexError, TypeError):
                    break
                found = getattr(here, "made_at", None) or found
            if found:
                return found
        names = set(re.findall(r"'([^']+)'", text))
        return next((part.made_at for part in self.parts() if part.name in names and part.made_at), None)
