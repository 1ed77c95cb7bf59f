"""The command `tandem sweep`."""
import argparse
import math
import pathlib
import re
import sys
from typing import Dict, List, Optional

from tandem.entries import SceneError, nearest
from tandem.scenes import load
from tandem.sweeps import sweep


def finite(word: str, option: str = "--set") -> float:
    """A number that a parameter can have, written as in a scene: Python would also read 1_0 as ten. A ValueError where it is no number."""
    if "_" in word:
        raise ValueError
    value = float(word)
    if not math.isfinite(value):
        raise SceneError(f"'{word.strip()}' is not a finite number", option, "give a number such as 0.05 or 1e-3", made_at="the command line")
    return value


def values_of(text: str) -> "tuple[str, List[float]]":
    """"mouth=0.05:0.08:4" is four values from 0.05 to 0.08, "pitch=10,20,30" a list."""
    name, equals, given = text.partition("=")
    try:
        if not name or not equals:
            raise ValueError
        if ":" in given:
            first, last, count = given.split(":")
            n = int(count)
            if n < 2 or "_" in count:
                raise ValueError
            a, b = finite(first), finite(last)
            return name, [float(f"{a + (b - a) * i / (n - 1):.12g}") for i in range(n)]
        return name, [finite(word) for word in given.split(",")]
    except ValueError:
        raise SceneError(f"'{text}' gives no parameter values", "--set", "write NAME=FIRST:LAST:COUNT or NAME=VALUE,VALUE, as in --set "
                         "mouth=0.05:0.08:4", made_at="the command line") from None


def main(words: Optional[List[str]] = None) -> int:
    """tandem sweep SCENE --set NAME=FIRST:LAST:COUNT --of COLUMN:REDUCTION [--jobs N] [--out DIR]"""
    parser = argparse.ArgumentParser(prog="tandem sweep", allow_abbrev=False)
    parser.add_argument("scene")
    parser.add_argument("--set", action="append", required=True, dest="given")
    parser.add_argument("--of", action="append", default=[])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--out")
    parser.add_argument("--limit", type=float)
    parser.add_argument("--backend")
    parser.add_argument("--share")
    parser.add_argument("--retry", action="store_true")
    options = parser.parse_args(words)
    try:
        if options.share and not re.fullmatch(r"[1-9]\d*/[1-9]\d*", options.share):
            raise SceneError(f"'{options.share}' is no share", "--share", "write PART/PARTS, as in --share 2/5", made_at="the command line")
        values: Dict[str, List[float]] = {}
        for text in options.given:
            name, numbers = values_of(text)
            if name in values:
                raise SceneError(f"'{name}' is set twice", "--set", "leave one of them", made_at="the command line")
            values[name] = numbers
        scene = load(options.scene)
        known = scene.data.get("parameters", {})
        for name in values:
            if name not in known:
                raise SceneError(f"{options.scene} has no parameter '{name}'" + nearest(name, known), "--set", made_at="the command line")
        out = options.out or str(pathlib.Path("out") / f"sweep_{scene._file_name()}")
        done = sweep(scene, score=options.of or None, jobs=options.jobs, threads=options.threads, out=out,
                     limit=options.limit, backend=options.backend, retry=options.retry, share=options.share, **values)
    except SceneError as error:
        said = re.sub("^score(?=[ :])", "--of", str(error).partition("\n")[0])
        print(f"error: {said}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("error: the sweep was interrupted; the same command continues where it stopped", file=sys.stderr)
        return 130
    print("\n" + done.table() + f"\n\n{done.folder / 'results.csv'}")
    if options.of and any(row.scores for row in done.rows):
        try:
            done.picture(str(done.folder / "response.png"))
            print(done.folder / "response.png")
        except ImportError as error:
            print(f"warning: no picture: {error} (Debian: python3-matplotlib)", file=sys.stderr)
    return 0 if all(row.status in ("ok", "suspect", "pending") for row in done.rows) else 1


if __name__ == "__main__":
    sys.exit(main())
