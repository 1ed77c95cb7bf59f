#!/usr/bin/env python3
"""Reports headers that name a type of the standard library and reach its header neither themselves nor through our headers. Precompiled
headers hide that from the builds of the tests; the build `release` has none.

usage: standard.py ROOT    exit status 1 and one line FILE: std::NAME needs <HEADER> per offence
"""
import pathlib
import re
import sys

HEADER_OF = {"array": "array", "filesystem": "filesystem", "function": "functional", "map": "map", "optional": "optional", "set": "set",
             "shared_ptr": "memory", "span": "span", "string": "string", "string_view": "string_view", "unique_ptr": "memory",
             "variant": "variant", "vector": "vector"}
PARTS = ("common", "protocol", "mbd_server", "particles", "dem_server", "sph_server", "participant", "coordinator", "launch")
INCLUDE = re.compile(r'#include [<"]([^>"]+)[>"]')


def reached(header, included, seen):
    """Adds all that `header` includes, directly or through others, to `seen`."""
    for target in included.get(header, ()):
        if target not in seen:
            seen.add(target)
            reached(target, included, seen)
    return seen


def offences(root):
    texts = {path.relative_to(root).as_posix(): path.read_text() for part in PARTS for path in sorted((root / part).rglob("*.hpp"))}
    included = {name: INCLUDE.findall(text) for name, text in texts.items()}
    found = []
    for name, text in texts.items():
        code, has = re.sub(r"//.*", "", text), reached(name, included, set())
        found += [f"{name}: std::{word} needs <{header}>" for word, header in HEADER_OF.items()
                  if header not in has and re.search(rf"\bstd::{word}\b", code)]
    return found, len(texts)


if __name__ == "__main__":
    faults, count = offences(pathlib.Path(sys.argv[1]))
    print("\n".join(faults + [f"{count} headers read, {len(faults)} offences"]))
    # A check that reads nothing would pass for ever.
    sys.exit(1 if faults or count < 100 else 0)
