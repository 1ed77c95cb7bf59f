"""The keys of scenes, from the schema of the project."""
import functools
import json
import os
import pathlib
from typing import List, Optional

from tandem.entries import SceneError, nearest


@functools.lru_cache(maxsize=None)
def schema() -> dict:
    """The JSON schema of scenes; empty where it is not found, and `tandem validate` alone knows the keys."""
    here = pathlib.Path(os.path.abspath(__file__))
    for file in (here.parents[2] / "schema.json", here.resolve().parents[2] / "common/scene/schema.json"):
        if file.is_file():
            return json.loads(file.read_text())
    import subprocess

    from tandem.program import find_tandem
    try:
        return json.loads(subprocess.run([find_tandem(), "schema"], capture_output=True, check=True).stdout)
    except (OSError, subprocess.SubprocessError, ValueError, RuntimeError):
        return {}


def keys_of(kind: str) -> Optional[List[str]]:
    """Keys of a definition of the schema, of all its kinds together; None if it is not known."""
    if kind == "scene":
        return list(schema().get("properties", [])) or None
    found: List[str] = []
    stack = [schema().get("definitions", {}).get(kind)]
    while stack:
        rule = stack.pop()
        if not rule:
            continue
        found += [key for key in rule.get("properties", {}) if key not in found]
        for part in rule.get("oneOf", []) + rule.get("anyOf", []):
            stack.append(schema()["definitions"][part["$ref"].rsplit("/", 1)[1]] if "$ref" in part else part)
    return found or None


def expect_keys(kind: str, keys, where: str, made_at: Optional[str] = None) -> None:
    """Raises SceneError for the first key that no such object has."""
    known = keys_of(kind)
    for key in keys:
        if known is not None and key not in known:
            raise SceneError(f"there is no key '{key}'" + nearest(key, known), where, made_at=made_at)
