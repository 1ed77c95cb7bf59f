"""The command `tandem soften`."""
import argparse
import sys
from typing import List, Optional

from tandem.entries import SceneError, nearest
from tandem.scenes import Scene, load
from tandem.softening import soften
from tandem.sweep_command import finite


def numbers(text: Optional[str], option: str) -> List[float]:
    """"1,2,4" as numbers."""
    try:
        return [finite(word, option) for word in text.split(",")] if text else []
    except ValueError:
        raise SceneError(f"'{text}' is no list of numbers", option, f"for instance {option} 0.1,0.2", made_at="the command line") from None


def scene_of(file: str, given: List[str]) -> Scene:
    """The scene with other values of its parameters."""
    scene = load(file)
    known = scene.data.get("parameters", {})
    for text in given:
        name, equals, value = text.partition("=")
        if name not in known:
            raise SceneError(f"{file} has no parameter '{name}'" + nearest(name, known), "--set", made_at="the command line")
        try:
            scene.set(**{name: finite(value)})
        except ValueError:
            raise SceneError(f"'{text}' gives no value", "--set", "write NAME=NUMBER", made_at="the command line") from None
    return scene


def main(words: Optional[List[str]] = None) -> int:
    """tandem soften SCENE --error 1% --of COLUMN [--of ...] [--starts N] [--jobs N] [--out DIR] [-o FILE]"""
    parser = argparse.ArgumentParser(prog="tandem soften", allow_abbrev=False)
    parser.add_argument("scene")
    parser.add_argument("--error", required=True)
    parser.add_argument("--of", action="append", default=[])
    parser.add_argument("--set", action="append", default=[], dest="given")
    for option, kind in (("--starts", int), ("--overlap", float), ("--most", int), ("--jobs", int), ("--threads", int), ("--limit", float)):
        parser.add_argument(option, type=kind)
    for option in ("--modulus", "--step", "--window", "--out", "--backend"):
        parser.add_argument(option)
    parser.add_argument("-o", dest="file")
    parser.add_argument("--retry", action="store_true")
    options = parser.parse_args(words)
    try:
        keys = {key: getattr(options, key) for key in ("starts", "overlap", "most", "jobs", "threads", "limit", "backend", "out", "file")}
        levels = {key: numbers(getattr(options, key), f"--{key}") for key in ("modulus", "step", "window")}
        found = soften(scene_of(options.scene, options.given), options.error, options.of, retry=options.retry, **levels,
                       **{key: value for key, value in keys.items() if value is not None})
    except SceneError as error:
        print(f"error: {str(error).partition(chr(10))[0]}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("error: the search was interrupted; the same command continues where it stopped", file=sys.stderr)
        return 130
    print("\n" + found.reading() + f"\n\n{found.folder / 'results.csv'}")
    if found.candidates:
        try:
            found.picture(str(found.folder / "soften.png"))
            print(found.folder / "soften.png")
        except ImportError as error:
            print(f"warning: no picture: {error} (Debian: python3-matplotlib)", file=sys.stderr)
    return 0 if found.scene is not None else 1


if __name__ == "__main__":
    sys.exit(main())
