"""The run of one variant of a sweep: its files, and what became of it."""
import hashlib
import json
import pathlib
import re
import subprocess
import time
from typing import List, Sequence, Tuple


def variant_key(names: Sequence[str], values: Sequence) -> str:
    """"mouth=0.05,pitch=20": the name of its folder."""
    key = ",".join(f"{name}={value}" for name, value in zip(names, values))
    safe = re.sub(r"[^A-Za-z0-9_.=,+-]", "_", key)
    return safe if safe == key and len(key) <= 120 else f"{safe[:100]}-{hashlib.sha256(key.encode()).hexdigest()[:10]}"


def digest_of(text: str, options: List[str]) -> str:
    """Of all that a variant follows from: the scene, the files that it names, the options of the run."""
    digest = hashlib.sha256(text.encode())
    digest.update("\0".join(options).encode())
    for name in sorted(set(re.findall(r'"file": "([^"]+)"', text))):
        try:
            digest.update(pathlib.Path(name).read_bytes())
        except OSError:
            digest.update(b"missing")
    return digest.hexdigest()


def state_of(program: str, folder: pathlib.Path) -> str:
    """"ok", "suspect", "failed", "interrupted", "running", "died", or "" where there is no run."""
    if (folder.with_name(folder.name + ".timed_out")).is_file():
        return "timed out"
    try:
        summary = json.loads((folder / "summary.json").read_text())
    except (OSError, ValueError):
        return "failed" if folder.with_name(folder.name + ".refused").is_file() else ""
    status = summary.get("status", "")
    if status == "running":  # the program finds out whether it still is
        said = subprocess.run([program, "ps", "--status", str(folder)], capture_output=True, text=True, check=False)
        return said.stdout.strip() or "died"
    return "interrupted" if status == "failed" and summary.get("reason") == "interrupted" else status


class Variant:
    """Its scene, log and digest are stored next to the folder of its run."""

    def __init__(self, folder: pathlib.Path, text: str = "", digest: str = ""):
        self.folder, self.text, self.digest, self.wait_for = folder, text, digest, False
        self.scene, self.log = folder.with_name(folder.name + ".json"), folder.with_name(folder.name + ".log")
        self._digest, self._limit = folder.with_name(folder.name + ".digest"), folder.with_name(folder.name + ".timed_out")
        self._refused = folder.with_name(folder.name + ".refused")

    def is_known(self) -> bool:
        """Whether the last run was of the same scene."""
        return self._digest.is_file() and self._digest.read_text().strip() == self.digest

    def write(self) -> None:
        for old in (self._limit, self._refused):
            old.unlink(missing_ok=True)
        self.scene.write_text(self.text)
        self._digest.write_text(self.digest + "\n")

    def timed_out(self, limit: float) -> None:
        self._limit.write_text(f"{limit} s\n")

    def wait(self, program: str, stopping) -> None:
        """For a run of an earlier sweep that was killed."""
        while not stopping.is_set() and state_of(program, self.folder) == "running":
            time.sleep(0.5)

    def outcome(self, program: str) -> Tuple[str, str]:
        """Status and reason."""
        status, reason = self._outcome(program)
        return status, reason.replace(f"{self.scene}: ", "")

    def _outcome(self, program: str) -> Tuple[str, str]:
        state = state_of(program, self.folder)
        if state == "timed out":
            return state, f"stopped after {self._limit.read_text().strip()}"
        if state == "":
            said = self.log.read_text(errors="replace") if self.log.is_file() else ""
            self._refused.touch()
            return "failed", " ".join(re.sub(r"^.*?error:\s*", "", said, flags=re.S).split())[:400] or "the run left no summary.json"
        if state == "failed" and not (self.folder / "summary.json").is_file():
            said = self.log.read_text(errors="replace") if self.log.is_file() else ""
            return "failed", " ".join(re.sub(r"^.*?error:\s*", "", said, flags=re.S).split())[:400]
        summary = json.loads((self.folder / "summary.json").read_text())
        if state in ("failed", "interrupted"):
            error = summary.get("error") or {}
            text = (f"{error['where']}: " if error.get("where") else "") + error.get("what", "") if error else summary.get("reason", "")
            if summary.get("reason") == "checks":
                text = "check failed: " + ", ".join(c["name"] for c in summary.get("checks", []) if not c.get("passed", c.get("ok", True)))
            return state, " ".join(str(text).split())[:400]
        if state == "suspect":
            lines = (summary.get("verdict") or {}).get("lines", [])
            first = lines[0].get("sentence", "") if lines and isinstance(lines[0], dict) else "".join(map(str, lines[:1]))
            return state, " ".join(first.split())[:400]
        return (state, "") if state != "died" else ("died", "its program was killed; the same sweep runs it again")
