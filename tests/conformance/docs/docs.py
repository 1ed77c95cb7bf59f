#!/usr/bin/env python3
"""Checks what the pages say against the project. Each command prints one line per fault, and exits with status 1 if there is one.

usage: docs.py links ROOT         every link and anchor of the pages leads somewhere, every page of docs is linked from another one,
                                  every page that a source names exists, every cited key is in docs/references.md
       docs.py json ROOT TANDEM   every ```json block is a scene that `TANDEM validate` accepts, or is marked
                                  ```json fragment DEFINITION: then its keys are those of that definition of the schema;
                                  ```json lines: one JSON value per line
       docs.py keys ROOT [--write]  the tables of docs/scene_format.md and docs/scene_format/ have every key of the schema, with its unit
                                  and default, and the defaults are those of common/scene/model.hpp. Rows of plain keys begin with the
                                  sentence of the schema: --write makes them
       docs.py codes ROOT         docs/troubleshooting.md has every error code, exit status and violation
       docs.py kit ROOT           docs/participant.md has every feature, capability and function of the participant kit
       docs.py words ROOT         the pages use the words of the field (table WORDS)
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

from pages import Page, cells, marked_tables, pages, place

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
CITED = re.compile(r"\[([A-Z][A-Za-z]+(?:19|20)\d\d|MbdDem)\](?!\()")
PAGE_NAME = re.compile(r"\bdocs/[A-Za-z0-9_/-]+\.md\b")
SOURCES = {".md", ".h", ".c", ".f90", ".hpp", ".cpp", ".cu", ".cuh", ".def", ".py", ".json", ".txt", ".cmake", ".sh"}

# What the pages do not say, and what they say instead.
WORDS = {
    r"\bbooks\b|\bbooked\b": "balance, or recorded",
    r"\bled along\b|\bpath led\b|\bwere led\b|\bare led\b": "prescribed motion",
    r"\bborders?\b": "interface (of the solvers), or end of a window",
    r"\bthe seed\b|\bthe design\b|\bthe notes\b": "a key of docs/references.md",
    r"\bthe paper\b|\bpaper's\b": "[MbdDem]",
    r"\b(is|are|be) told\b": "receives, or is reported",
    r"\breckons? with\b": "assumes, or treats as",
    r"\bput aside\b|\bputs aside\b|\bbrings? along\b|\blies? beside\b": "saved, carries, is stored next to",
}


# ---- links

def links(root):
    faults, count, linked = [], 0, set()
    references = root / "docs/references.md"
    keys = set(re.findall(r"^(?:\| |\*\*)\[(\w+)\]", references.read_text(), re.MULTILINE)) if references.is_file() else set()
    for page in pages(root):
        for number, line in page.prose:
            faults += [f"{place(root, page, number)}: docs/references.md has no [{key}]" for key in CITED.findall(line) if key not in keys]
            for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
                if re.match(r"[a-z]+:", target):
                    continue  # another site
                count += 1
                name, _, anchor = target.partition("#")
                path = (page.path.parent / name if name else page.path).resolve()
                if not path.exists() or root.resolve() not in [path, *path.parents]:
                    faults.append(f"{place(root, page, number)}: there is no {target}")
                    continue
                if path != page.path.resolve():
                    linked.add(path)
                if anchor and anchor not in Page(path).anchors():
                    faults.append(f"{place(root, page, number)}: {name or 'this page'} has no heading for #{anchor}")
    # A folder that is linked is a list of its pages.
    for path in sorted((root / "docs").rglob("*.md")):
        if path.resolve() not in linked and path.parent.resolve() not in linked:
            faults.append(f"{path.relative_to(root)}: no page links to it")
    # All folders of the repository, also those to come.
    parts = [part for part in sorted(root.iterdir()) if part.is_dir() and part.name != "build" and not part.name.startswith(".")]
    for part in parts:
        for path in sorted(part.rglob("*")):
            if path.suffix not in SOURCES or not path.is_file() or "results" in path.parts:
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
                for name in PAGE_NAME.findall(line):
                    if not (root / name).is_file() and "conformance/docs" not in path.as_posix():
                        faults.append(f"{path.relative_to(root)}:{number}: there is no {name}")
    return faults, count


# ---- JSON blocks

def rules_of(rule, schema):
    """The alternatives of a rule of the schema, with references resolved."""
    if "$ref" in rule:
        return rules_of(schema["definitions"][rule["$ref"].rsplit("/", 1)[1]], schema)
    parts = rule.get("oneOf") or rule.get("anyOf")
    return [found for part in parts for found in rules_of(part, schema)] if parts else [rule]


def strange(value, rules, schema, where=""):
    """What of `value` no alternative of `rules` knows."""
    if isinstance(value, dict):
        fitting = [rule for rule in rules if "type" not in value or value["type"] in
                   (rule.get("properties", {}).get("type", {}).get("enum") or
                    [rule.get("properties", {}).get("type", {}).get("const", value["type"])])]
        for key, part in value.items():
            below = [rule["properties"][key] for rule in fitting if key in rule.get("properties", {})]
            if below:
                yield from strange(part, [found for rule in below for found in rules_of(rule, schema)], schema, f"{where}.{key}")
            else:
                yield f"{where}.{key} is no key of the schema"
    elif isinstance(value, list):
        items = [found for rule in rules if "items" in rule for found in rules_of(rule["items"], schema)]
        for index, part in enumerate(value):
            yield from strange(part, items, schema, f"{where}[{index}]")
    elif isinstance(value, str):
        words = [rule.get("enum") or [rule["const"]] for rule in rules if "enum" in rule or "const" in rule]
        if words and not any(value in some for some in words) and not any(rule.get("type") == "string" and "const" not in rule
                                                                          for rule in rules):
            yield f"{where} is '{value}', which the schema does not have"


def read_schema(root):
    return json.loads((root / "common/scene/schema.json").read_text())


def block_faults(info, text, schema, validate):
    """Faults of a block whose info begins with `json`; `validate` gives the complaint about a whole scene, or ''."""
    kind = info.split()[1:]
    try:
        if kind == ["lines"]:
            for line in text.splitlines():
                json.loads(line)
            return []
        value = json.loads(text)
    except ValueError as error:
        return [f"no JSON: {error}"]
    if not kind:
        complaint = validate(text)
        return [complaint] if complaint else []
    if kind[0] != "fragment" or len(kind) != 2 or kind[1] not in schema["definitions"]:
        return [f"'{info}' is none of: json, json lines, json fragment DEFINITION"]
    return list(strange(value, rules_of(schema["definitions"][kind[1]], schema), schema))


def validated_by(tandem):
    def validate(text):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "scene.json"
            scene.write_text(text)
            run = subprocess.run([tandem, "validate", scene], capture_output=True, text=True, timeout=60)
            return "" if run.returncode == 0 else f"tandem validate: {run.stderr.strip() or run.stdout.strip()}"
    return validate


def json_blocks(root, validate):
    schema, faults, count = read_schema(root), [], 0
    for page in pages(root):
        for number, info, text in page.blocks:
            if info.split()[:1] == ["json"]:
                count += 1
                faults += [f"{place(root, page, number)}: {fault}" for fault in block_faults(info, text, schema, validate)]
            elif text.lstrip().startswith("{"):
                faults.append(f"{place(root, page, number)}: mark this block as json")
    return faults, count


# ---- tables of keys

def objects(schema):
    """Name -> rule of everything in the schema that has keys: `body`, and `fill:lattice` where a definition has several kinds."""
    found = {"scene": schema}
    for name, definition in schema["definitions"].items():
        if "properties" in definition:
            found[name] = definition
        for part in definition.get("oneOf", []):
            if "properties" in part:
                found[f"{name}:{part['properties']['type']['const']}"] = part
    return found


def words_of(rule):
    return rule.get("enum") or ([rule["const"]] if "const" in rule else []) or rule.get("items", {}).get("enum", [])


def literal(cell):
    """The default in a cell of the column: a JSON value, a word in backquotes as a text, or None where it is described in words."""
    text = cell.strip("`") if re.fullmatch(r"`[^`]*`", cell) else cell
    try:
        return json.loads(text)
    except ValueError:
        return text if text != cell and re.fullmatch(r"[\w.]+", text) else None


# The structs of common/scene/model*.hpp that are not named as the definition of the schema is.
STRUCTS = {"particle_group": "ParticleGroup", "fill:lattice": "LatticeFill", "fill:inlet": "InletFill", "shape:mesh": "MeshShape",
           "constant_function": "ConstantMotion", "harmonic_function": "HarmonicMotion", "motion:ramp": "RampMotion",
           "size:ramp": "RampMotion", "motion:table": "TableMotion", "size:table": "TableMotion", "body_force": "BodyLoad",
           "body_torque": "BodyLoad"}


def model_defaults(root):
    """(struct, member) -> its initial value in common/scene/model*.hpp, as JSON has it."""
    found = {}
    text = "".join(path.read_text() for path in sorted((root / "common/scene").glob("model*.hpp")))
    for struct, body in re.findall(r"^struct (\w+) \{(.*?)^\};", text, re.DOTALL | re.MULTILINE):
        body = re.sub(r"//.*", "", body)
        for member, value in re.findall(r"(\w+)\s*=\s*([^,;{}]+)[,;]", body):
            name = re.fullmatch(r"\w+::(\w+)", value)
            try:
                found[struct, member] = name[1] if name else json.loads(value)
            except ValueError:
                continue  # computed, or a value that JSON has not
        for member, values in re.findall(r"(\w+)\{([-0-9., ]+)\}", body):
            found[struct, member] = json.loads(f"[{values}]")
    return found


def default_faults(here, key, row, having, model):
    """`having`: the names and rules of the objects with this key."""
    told = literal(row["default"])
    for name, rule in having:
        property_ = rule["properties"][key]
        if key in rule.get("required", []):
            if "default" in property_:
                yield f"{here}: '{key}' of {name} must be given, and the schema has a default"
            continue
        if row["default"] in ("-", ""):
            continue  # which is a fault of its own
        if property_.get("default") != told or isinstance(property_.get("default"), bool) != isinstance(told, bool):
            yield (f"{here}: the default of '{key}' of {name} is {row['default']} here and "
                   f"{json.dumps(property_['default']) if 'default' in property_ else 'absent'} in the schema")
        struct = STRUCTS.get(name, "Joint" if name.endswith("_joint") else name.title().replace("_", ""))
        given = property_.get("default")
        initial = model.get((struct, key), given)
        if isinstance(initial, bool) and isinstance(given, str):
            continue  # a word of two, which the model has as a switch
        if given is not None and initial != given:
            yield f"common/scene/schema.json: the default of '{key}' of {name} is {given} here and {initial} in common/scene/model.hpp"


def declared_by_schema(root):
    """Definitions whose plain keys, numbers, switches and vectors, are described by the schema only (cmake/scene_keys.cmake)."""
    text = (root / "common/scene/CMakeLists.txt").read_text() if (root / "common/scene/CMakeLists.txt").is_file() else ""
    found = re.search(r'tandem_scene_keys\(\w+ "[^"]*"([^)]*)\)', text)
    return found[1].split() if found else []


def is_plain(key, rule):
    is_value = rule.get("type") in ("number", "integer", "boolean") or rule.get("$ref", "").endswith("/vec3")
    return is_value and not re.search("_deg$|^local$", key)


def row_of(key, rule, required):
    """The row of a plain key."""
    described = re.fullmatch(r"(.*?)(?: \[([^\]]*)\])?", rule["description"])
    default = "-" if required else json.dumps(rule["default"]) if "default" in rule else "none"
    return {"key": f"`{key}`", "unit": described[2] or "", "default": f"`{default}`" if default[0] == "[" else default, "meaning": described[1]}


def says(row, sentence):
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", row.get("meaning", "")).replace("`", "")
    return text.startswith(sentence)


def write_rows(root):
    """Brings the rows of plain keys up to date: their sentence, and rows that are missing, at the end of the table."""
    schema = read_schema(root)["definitions"]
    for path in sorted((root / "docs/scene_format").glob("*.md")):
        lines = path.read_text().split("\n")
        for name in declared_by_schema(root):
            mark = next((i for i, line in enumerate(lines) if re.match(rf"<!-- keys: (.* )?{name}( .*)? -->$", line)), None)
            if mark is None:
                continue
            begin = next(i for i in range(mark, len(lines)) if lines[i].startswith("|"))
            for key, rule in schema[name]["properties"].items():
                if not is_plain(key, rule):
                    continue
                end = next(i for i in range(begin, len(lines)) if not lines[i].startswith("|"))
                at = next((i for i in range(begin, end) if f"`{key}`" in cells(lines[i])[0]), end)
                wanted = row_of(key, rule, key in schema[name].get("required", []))
                head = cells(lines[begin])
                if at < end and says(dict(zip(head, cells(lines[at]))), wanted["meaning"]):
                    continue
                lines[at:at + (at < end)] = ["| " + " | ".join(wanted.get(column, "") for column in head) + " |"]
        path.write_text("\n".join(lines))


def key_tables(root):
    schema = read_schema(root)
    known, model, described = objects(schema), model_defaults(root), declared_by_schema(root)
    scene_pages = [root / "docs/scene_format.md", *sorted((root / "docs/scene_format").glob("*.md"))]
    faults, seen, count = [], {}, 0
    for page, table in [(page, table) for page in map(Page, scene_pages) for table in marked_tables(page, "keys")]:
        number, names, rows, wrong, section = table
        here = place(root, page, number)
        faults += [f"{here}: a row has another number of cells than the head: {row}" for row in wrong]
        unknown = [name for name in names if name not in known]
        if unknown or not rows:
            faults.append(f"{here}: {', '.join(unknown) or 'no table'} is not there")
            continue
        of_key = {}
        for row in rows:
            for key in re.findall(r"`([^`]+)`", row.get("key", "")):
                of_key[key] = row
        for name in names:
            if name in seen:
                faults.append(f"{here}: {name} has a table already at {seen[name]}")
            seen[name] = here
        rules = [known[name] for name in names]
        expected = {key for rule in rules for key in rule["properties"]}
        count += len(expected)
        faults += [f"{here}: {' '.join(names)} has no key '{key}'" for key in of_key if key not in expected]
        for key in sorted(expected):
            if key not in of_key:
                faults.append(f"{here}: the key '{key}' of {' '.join(names)} is missing")
                continue
            row, having = of_key[key], [rule for rule in rules if key in rule["properties"]]
            faults += default_faults(here, key, row, [(name, known[name]) for name in names if key in known[name]["properties"]], model)
            required = [key in rule.get("required", []) for rule in having]
            if all(required) and row["default"] != "-":
                faults.append(f"{here}: '{key}' must be given: its default is '-'")
            if not any(required) and row["default"] in ("-", ""):
                faults.append(f"{here}: '{key}' may be left out: what is its default?")
            if not row.get("meaning"):
                faults.append(f"{here}: '{key}' has no meaning")
            told = {unit for rule in having for unit in re.findall(r"\[([^\],][^\]]*)\]", rule["properties"][key].get("description", ""))}
            given = {unit.strip() for unit in row["unit"].split(",") if unit.strip()}
            if given - told or (told and not given):
                faults.append(f"{here}: the unit of '{key}' is '{row['unit']}' here and '{', '.join(sorted(told))}' in the schema")
            for name in names:
                rule = known[name]["properties"].get(key)
                if rule and name in described and is_plain(key, rule) and not says(row, row_of(key, rule, False)["meaning"]):
                    faults.append(f"{here}: '{key}' of {name} begins otherwise than in the schema: docs.py keys --write")
            for rule in having:
                for word in words_of(rule["properties"][key]):
                    if f"`{word}`" not in section:
                        faults.append(f"{here}: the value `{word}` of '{key}' is missing in this section")
    faults += [f"docs/scene_format: there is no table of '{name}'" for name in known if name not in seen]
    return faults, count


# ---- codes

def declared(root):
    """Everything that a run can end or be marked with, read from the sources that define it."""
    error = (root / "common/error.cpp").read_text()
    naming, _, status = error.partition("int exit_status(")
    return {
        "error": set(re.findall(r'return "(\w+)";', naming)) - {"unknown"},
        "exit": set(re.findall(r"return (\d+);", status)) | {"0", "1"},
        "violation": set(re.findall(r'return "(\w+)";', (root / "protocol/violation.cpp").read_text())) - {"unknown"},
    }


def code_tables(root):
    page, faults, count = Page(root / "docs/troubleshooting.md"), [], 0
    told = {}
    for number, names, rows, wrong, _ in marked_tables(page, "codes"):
        faults += [f"{place(root, page, number)}: a row has another number of cells than the head: {row}" for row in wrong]
        for row in rows:
            told.setdefault(names[0], set()).update(re.findall(r"`(\w+)`", next(iter(row.values()))))
            if not all(row.values()):
                faults.append(f"{place(root, page, number)}: an empty cell: {row}")
    for kind, codes in declared(root).items():
        count += len(codes)
        faults += [f"docs/troubleshooting.md: {kind} {code} is missing" for code in sorted(codes - told.get(kind, set()))]
        faults += [f"docs/troubleshooting.md: there is no {kind} {code}" for code in sorted(told.get(kind, set()) - codes)]
    return faults, count


# ---- the participant kit

def declared_by_kit(root):
    """Names of features in the source that finds them in a scene; capabilities and functions of the tables in the header."""
    features = (root / "participant/library/features.cpp").read_text()
    header = (root / "participant/include/tandem/participant.h").read_text()
    named = re.findall(r'(?:\breturn|\badd\(|[?:])\s*"([a-z_]+(?:[.:][a-z_]+)?)"', features)
    forces = root / "common/scene/model_forces.hpp"
    types = re.findall(r'constexpr const char\* type = "([a-z_]+)"', forces.read_text()) if forces.is_file() else []
    named += [f"force:{name}" for name in types]
    return {
        "features": {name for name in named if not name.endswith(":unknown")},
        "capabilities": set(re.findall(r"^#define (TANDEM_CAN_\w+)", header, re.MULTILINE)),
        "calls": set(re.findall(r"\(\*(\w+)\)\(void \*self", header)),
    }


def kit_tables(root):
    page, faults, count = Page(root / "docs/participant.md"), [], 0
    told = {}
    for number, names, rows, wrong, _ in marked_tables(page, "kit"):
        faults += [f"{place(root, page, number)}: a row has another number of cells than the head: {row}" for row in wrong]
        for row in rows:
            told.setdefault(names[0], set()).update(re.findall(r"`([^`]+)`", next(iter(row.values()))))
            if not all(row.values()):
                faults.append(f"{place(root, page, number)}: an empty cell: {row}")
    for kind, names in declared_by_kit(root).items():
        count += len(names)
        faults += [f"docs/participant.md: {kind}: {name} is missing" for name in sorted(names - told.get(kind, set()))]
        faults += [f"docs/participant.md: {kind}: there is no {name}" for name in sorted(told.get(kind, set()) - names)]
    return faults, count


# ---- words

def word_faults(root):
    """Quoted code, and tables that are generated from sources, may say what they like."""
    faults, count = [], 0
    for page in pages(root):
        generated = False
        for number, line in page.prose:
            if re.match(r"<!-- (begin|end) ", line):
                generated = line.startswith("<!-- begin")
            count += 1
            text = re.sub(r"`[^`]*`|\]\([^)]*\)", "", line)
            for word, instead in WORDS.items():
                match = None if generated else re.search(word, text, re.IGNORECASE)
                if match:
                    faults.append(f"{place(root, page, number)}: '{match[0]}' (write: {instead})")
    return faults, count


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    command, root = sys.argv[1], pathlib.Path(sys.argv[2])
    if sys.argv[3:] == ["--write"]:
        write_rows(root)
    checks = {"links": links, "json": lambda root: json_blocks(root, validated_by(sys.argv[3])), "keys": key_tables,
              "codes": code_tables, "kit": kit_tables, "words": word_faults}
    faults, count = checks[command](root)
    print("\n".join(faults + [f"{command}: {count} checked, {len(faults)} faults"]))
    # A check that reads nothing would pass for ever.
    return 1 if faults or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
