"""The JSON objects of a scene, which know the line of Python that made them, and the errors that name it."""
import difflib
import math
import pathlib
import sys
from typing import Any, Iterable, Optional

_HERE = str(pathlib.Path(__file__).resolve().parent)


def calling_line() -> Optional[str]:
    """FILE:LINE of the innermost caller outside of this package."""
    frame = sys._getframe(1)
    while frame is not None:
        file = frame.f_code.co_filename
        if not (file.startswith(_HERE) or str(pathlib.Path(file).resolve().parent) == _HERE):
            return f"{file}:{frame.f_lineno}"
        frame = frame.f_back
    return None


def nearest(word: str, words: Iterable[str]) -> str:
    """'; did you mean 'x'?', or what there is instead."""
    words = sorted(set(map(str, words)))
    close = difflib.get_close_matches(str(word), words, 1, 0.6)
    if close:
        return f"; did you mean '{close[0]}'?"
    if not words:
        return "; there is none"
    return "; there is " + ", ".join(f"'{w}'" for w in words[:12]) + (", ..." if len(words) > 12 else "")


class SceneError(Exception):
    """A scene is wrong: `what` is wrong, `where` in the scene, what to write instead (`hint`), and the line of Python that
    made the object (`made_at`)."""

    def __init__(self, what: str, where: Optional[str] = None, hint: Optional[str] = None, made_at: Optional[str] = None):
        self.what, self.where, self.hint = what, where, hint
        self.made_at = made_at or calling_line()
        text = (f"{where}: " if where else "") + what + (f" ({hint})" if hint else "")
        super().__init__(text + (f"\n  made at {self.made_at}" if self.made_at else ""))


class NoSuchName(KeyError):
    """A KeyError that prints as the sentence that it is."""

    def __str__(self) -> str:
        return str(self.args[0]) if self.args else ""


class Entry(dict):
    """A JSON object of a scene."""
    made_at: Optional[str] = None

    def __init__(self, *arguments, made_at: Optional[str] = None, **keys):
        super().__init__(*arguments, **keys)
        self.made_at = made_at


def plain(value: Any) -> Any:
    """The JSON that a value stands for: objects of a scene by their name, tuples, ranges and arrays as lists."""
    if isinstance(value, float) and not math.isfinite(value):
        raise SceneError(f"{value!r} is not a finite number", hint="a scene has no other numbers")
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if hasattr(value, "as_json"):
        return plain(value.as_json())
    if isinstance(value, Entry):
        return value
    if isinstance(value, dict):
        return {str(key): plain(part) for key, part in value.items()}
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, (list, tuple, range)):
        return [plain(part) for part in value]
    if isinstance(value, pathlib.PurePath):
        return str(value)
    raise SceneError(f"{value!r} is no value that a scene can hold", hint="give a number, a text, a list, a dict or an object "
                     "of the scene")


def text_of(value: Any, indent: int = 0, width: int = 120) -> str:
    """JSON with one line for what fits into it."""
    import json
    line = json.dumps(value)
    if len(line) + indent <= width or not isinstance(value, (dict, list)) or not value:
        return line
    pad = "\n" + " " * (indent + 1)
    if isinstance(value, dict):
        inner = [f"{json.dumps(k)}: {text_of(v, indent + 1, width)}" for k, v in value.items()]
        return "{" + pad + ("," + pad).join(inner) + pad[:-1] + "}"
    return "[" + pad + ("," + pad).join(text_of(v, indent + 1, width) for v in value) + pad[:-1] + "]"
