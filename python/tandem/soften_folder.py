"""The folder of `tandem soften`, which one softening at a time works in, and the file of the softened scene."""
import fcntl
import hashlib
import json
import os
import pathlib
from typing import Any, Dict, Optional

from tandem.entries import SceneError
from tandem.scenes import Scene

RESULTS = ("results.csv", "reading.txt", "soften.png")  # and soften.json, which says what the folder is


class Folder:
    """Claimed until release(). `path`, and `file` of the softened scene."""

    def __init__(self, scene: Scene, out: Optional[str], file: Optional[str]):
        self.path = pathlib.Path(out or pathlib.Path("out") / f"soften_{scene._file_name()}").absolute()
        self.file = pathlib.Path(file).absolute() if file else self.path / f"{scene._file_name()}_soft.json"
        self._about = self.path / "soften.json"
        if self.path.exists() and not self.path.is_dir():
            self._refuse(f"'{self.path}' is no folder", "--out", "give another --out")
        if self.path.is_dir() and any(self.path.iterdir()) and not self._about.is_file():
            self._refuse(f"'{self.path}' has files, but is no folder of a softening", None, "give another --out")
        self._earlier = self._read()
        self._expect_input(scene._source)
        self._expect_file()
        self.path.mkdir(parents=True, exist_ok=True)
        self._lock = open(self.path / ".lock", "w")  # pylint: disable=consider-using-with
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self._lock.close()
            self._refuse(f"another softening works in '{self.path}'", "--out", "wait for it, or give another --out")
        self._write({**self._earlier, "tandem": "soften", "scene": scene.name})

    def release(self) -> None:
        """Another softening may work here."""
        self._lock.close()

    def forget_earlier_results(self) -> None:
        """Removes what an earlier call found: the softened scene, unless it has been changed since, table, text and picture."""
        for name in RESULTS:
            (self.path / name).unlink(missing_ok=True)
        written = pathlib.Path(self._earlier.get("written") or self.path / "none")
        if written.is_file() and _digest(written) == self._earlier.get("digest"):
            written.unlink()
        self._write({"tandem": "soften", "scene": self._earlier.get("scene")})

    def write_scene(self, scene: Scene) -> None:
        """The softened scene, as a whole or not at all."""
        draft = self.file.with_name(f".{self.file.name}.{os.getpid()}.new")
        draft.write_text(scene.json(str(self.file.parent)) + "\n")
        draft.replace(self.file)
        self._write({"tandem": "soften", "scene": scene.name, "written": str(self.file), "digest": _digest(self.file)})

    def _expect_input(self, source: Optional[pathlib.Path]) -> None:
        """The scene that is read must not be overwritten, nor be one that this folder's runs made."""
        if source is None:
            return
        if source == self.file.resolve() or self.file.exists() and source.exists() and self.file.samefile(source):
            self._refuse(f"'{self.file}' is the scene itself, which the softened scene would overwrite", "-o", "give another -o FILE or --out")
        if self.path.resolve() in source.parents or str(source) == str(pathlib.Path(self._earlier.get("written") or "").resolve()):
            self._refuse(f"'{source}' was made by the softening in '{self.path}'", "--out", "give another --out")

    def _expect_file(self) -> None:
        if self.file.is_dir():
            self._refuse(f"'{self.file}' is a folder", "-o", "name a file")
        if self.file.parent == self.path:
            if self.file.name in (*RESULTS, self._about.name, ".lock", "runs"):
                self._refuse(f"'{self.file}' is a file of the softening", "-o", "give another name")
        elif not self.file.parent.is_dir():
            self._refuse(f"there is no folder '{self.file.parent}'", "-o", "make it first")

    def _read(self) -> Dict[str, Any]:
        try:
            about = json.loads(self._about.read_text())
            return about if isinstance(about, dict) else {}
        except (OSError, ValueError):
            return {}

    def _write(self, about: Dict[str, Any]) -> None:
        self._about.write_text(json.dumps(about) + "\n")
        self._earlier = about

    @staticmethod
    def _refuse(what: str, where: Optional[str], hint: str) -> None:
        raise SceneError(what, where, hint, made_at="the command line")


def _digest(file: pathlib.Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()
