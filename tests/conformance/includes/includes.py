#!/usr/bin/env python3
"""Reads every #include of the repository and reports those that break the dependency rule.

common <- protocol <- {mbd_server, dem_server, sph_server} <- coordinator <- launch, common <- particles <- {dem_server, sph_server, participant}, and participant <- launch: a part
includes itself and the parts to its left. Tests include all.
In a server only coupling/ and main.cpp include protocol/, in particles only serving/. In a server, in particles and in coordinator each folder is a layer that includes only itself
and the layers below it. CUDA headers appear only in CUDA sources. No two modules include each other; a module is a header and the source
of its name.
common knows neither Boost nor DDS. Our own files are included by their path from the root, in quotes; test helpers may be
included by name.

usage: includes.py ROOT            exit status 1 and one line FILE:LINE per offence
       includes.py --edges ROOT    the edges between the folders of particles, of each server and of the coordinator, those that no order of layers avoids, and the circles
"""
import itertools
import pathlib
import re
import sys

# What each part may include besides itself.
BELOW = {
    "common": set(),
    "protocol": {"common"},
    "mbd_server": {"common", "protocol"},
    "particles": {"common", "protocol"},
    "dem_server": {"common", "protocol", "particles"},
    "sph_server": {"common", "protocol", "particles"},
    "participant": {"common", "protocol", "particles"},
    "coordinator": {"common", "protocol", "mbd_server", "particles", "dem_server", "sph_server"},
    "launch": {"common", "protocol", "mbd_server", "particles", "dem_server", "sph_server", "coordinator"},
    "tests": {"common", "protocol", "mbd_server", "particles", "dem_server", "sph_server", "participant", "coordinator", "launch"},
}
# The layers of particles, of each server and of the coordinator, from the lowest up.
LAYERS = {
    "mbd_server": ["spatial", "state", "joints", "model", "kinematics", "constraints", "forces", "contact", "setup", "solve", "step", "time_stepping", "io",
                   "coupling", "main.cpp"],
    "particles": ["base", "geometry", "grid", "io", "state", "backend", "serving"],
    "dem_server": ["laws", "contact", "neighbours", "step", "backend", "engine", "coupling", "main.cpp"],
    "coordinator": ["mesh_import", "results", "verdict", "run_folder", "report", "scene", "schemes", "watch", "accounts", "start", "window", "run"],
    "sph_server": ["kernel", "equations", "neighbours", "step", "backend", "engine", "io", "coupling", "main.cpp"],
}
# What the coordinator and launch use of a server: its participant, and limits of steps (of contact laws, of a liquid).
ANSWERS = ("coupling", "laws", "equations")
# What the participant kit uses of particles: the spheres of a scene at the start, and paths of bodies.
KIT = ["base", "geometry", "io"]
SOURCES = {".hpp", ".cpp", ".h", ".c", ".cu", ".cuh", ".def", ".idl"}
CUDA_SOURCES = {".cu", ".cuh"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
CUDA_HEADER = re.compile(r"^(cuda|cub/|thrust/|cooperative_groups|device_launch|nvtx|curand|cufft|cublas|nv/)")


def suffix(path):
    """Suffix of a source, that of the generated file for a template: x.cu.in is CUDA."""
    return pathlib.PurePath(path.name.removesuffix(".in")).suffix


def is_generated(root, target):
    """A file that the build makes from another of its name: X by configure_file from X.in, X.h by idlc from X.idl,
    X.inc by CMake from X.def."""
    path = pathlib.PurePath(target)
    sources = (path.name + ".in", path.stem + ".idl", path.stem + ".def")
    return any(any(root.glob(f"*/**/{source}")) for source in sources)


def upward(part, layer, target_layer):
    """Why a file of `part` on `layer` may not include one on `target_layer`; None when it may."""
    layers = LAYERS[part]
    for name in (layer, target_layer):
        if name not in layers:
            return f"{part}/{name} is no layer of {part}"
    if layers.index(target_layer) > layers.index(layer):
        return f"layer {layer} must not include {target_layer}, which is above it"
    return None


def offence(root, path, quote, target):
    """Why `path` (relative to root) may not include `target`; None when it may."""
    part, target_part = path.parts[0], pathlib.PurePath(target).parts[0]

    if target_part in BELOW:
        if quote == "<":
            return "our own files are included in quotes"
        if target_part != part and target_part not in BELOW[part]:
            return f"{part} must not include {target_part}"
        if part in ("coordinator", "launch") and target_part.endswith("_server") and pathlib.PurePath(target).parts[1] not in ANSWERS:
            return f"{part} uses the layers " + ", ".join(ANSWERS) + " of servers only"
        if part == "participant" and target_part == "particles" and pathlib.PurePath(target).parts[1] not in KIT:
            return "participant uses the layers " + ", ".join(KIT) + " of particles only"
        above = ("serving",) if part == "particles" else ("coupling", "main.cpp")
        if part in LAYERS and part != "coordinator" and target_part == "protocol" and path.parts[1] not in above:
            return f"in {part} only " + " and ".join(above) + " may include protocol/"
        if part in LAYERS and target_part == part:
            return upward(part, path.parts[1], pathlib.PurePath(target).parts[1])
    if part != "tests" and quote == '"' and not (root / target).is_file() and not is_generated(root, target):
        return "no such file from the root of the repository"
    if CUDA_HEADER.match(target) and suffix(path) not in CUDA_SOURCES:
        return "CUDA headers belong into CUDA sources"
    if part == "common" and target_part in ("boost", "dds"):
        return f"common must not know {target_part}"
    return None


def module(path):
    """Path without the suffix."""
    return str(pathlib.PurePath(path).with_suffix(""))


def mutual_offences(edges):
    """`edges`: (module, included module) -> "FILE:LINE: #include ..."."""
    pairs = {tuple(sorted(edge)) for edge in edges if edge[::-1] in edges}
    return [f"{edges[a, b]}: {b} includes {a} too ({edges[b, a].split(': ')[0]})" for a, b in sorted(pairs)]


def offences(root):
    """All lines FILE:LINE that break the rule, and the number of includes read."""
    found, count, edges = [], 0, {}
    for part in BELOW:
        for path in sorted((root / part).rglob("*")):
            if suffix(path) not in SOURCES or not path.is_file():
                continue
            relative = path.relative_to(root)
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                count += 1
                if part != "tests" and (root / match[2]).is_file() and module(relative) != module(match[2]):
                    edges.setdefault((module(relative), module(match[2])), f"{relative}:{number}: {line.strip()}")
                why = offence(root, relative, *match.groups())
                if why:
                    found.append(f"{relative}:{number}: {line.strip()}: {why}")
    return found + mutual_offences(edges), count


def edges(root, part):
    """(folder, included folder) -> number of includes, between different folders of a part."""
    found = {}
    for path in sorted((root / part).rglob("*")):
        if suffix(path) not in SOURCES or not path.is_file():
            continue
        folder = path.relative_to(root).parts[1]
        for line in path.read_text(encoding="utf-8").splitlines():
            match = INCLUDE.match(line)
            target = pathlib.PurePath(match[2]).parts if match else ()
            if len(target) > 2 and target[0] == part and target[1] != folder:
                found[folder, target[1]] = found.get((folder, target[1]), 0) + 1
    return found


def fewest_upward(found):
    """The number of edges that lead upward in the best order of the folders: 0 where there is no circle."""
    folders = sorted({folder for edge in found for folder in edge})
    best = {frozenset(): 0}  # lowest layers, as a set -> edges upward from them to each other
    for _ in folders:
        above = {}
        for below, count in best.items():
            for folder in set(folders) - below:
                # Edges from `below` to the folder that is put on top of it.
                total = count + sum((lower, folder) in found for lower in below)
                key = below | {folder}
                above[key] = min(total, above.get(key, total))
        best = above
    return best.popitem()[1]


def circles(found):
    """Groups of folders that include each other, directly or through others."""
    reach = {folder: {folder} for edge in found for folder in edge}
    for _ in reach:
        for folder, target in found:
            reach[folder] |= reach[target]
    groups = {frozenset(other for other in reach[folder] if folder in reach[other]) for folder in reach}
    return sorted(sorted(group) for group in groups if len(group) > 1)


def print_edges(root):
    for part in LAYERS:
        found = edges(root, part)
        print(f"{part}: {len(found)} edges, {fewest_upward(found)} upward in the best order of layers")
        for folder, group in itertools.groupby(sorted(found), key=lambda edge: edge[0]):
            print(f"  {folder} -> " + ", ".join(f"{target} ({found[folder, target]})" for _, target in group))
        for group in circles(found):
            print("  circle: " + ", ".join(group))


def main():
    if sys.argv[1] == "--edges":
        print_edges(pathlib.Path(sys.argv[2]))
        return 0
    found, count = offences(pathlib.Path(sys.argv[1]))
    print("\n".join(found + [f"{count} includes read, {len(found)} offences"]))
    # A check that reads nothing would pass for ever.
    return 1 if found or count < 100 else 0


if __name__ == "__main__":
    sys.exit(main())
