#!/usr/bin/env python3
"""The checks of the pages catch each planted fault, and let a right page pass."""
import json
import pathlib
import tempfile
import unittest

import docs

SCHEMA = {
    "properties": {"name": {"type": "string", "description": "name"}},
    "required": ["name"],
    "definitions": {
        "body": {"properties": {"mass": {"type": "number", "description": "mass [kg]"},
                                "kind": {"enum": ["soft", "hard"], "default": "soft", "description": "kind"}}, "required": ["mass"]},
        "fill": {"oneOf": [{"properties": {"type": {"const": "box"}, "size": {"type": "number", "default": 1, "description": "edge [m]"}}}]},
        "group": {"properties": {"fill": {"$ref": "#/definitions/fill"},
                                 "bodies": {"type": "array", "items": {"$ref": "#/definitions/body"}}}},
    },
}
TABLES = """# Page

<!-- keys: scene -->

| key | unit | default | meaning |
|---|---|---|---|
| `name` | | - | name |

## Body

<!-- keys: body -->

| key | unit | default | meaning |
|---|---|---|---|
| `mass` | kg | - | mass |
| `kind` | | `soft` | `soft` or `hard` |

<!-- keys: fill:box -->

| key | unit | default | meaning |
|---|---|---|---|
| `type` | | none | `box` |
| `size` | m | 1 | edge |

<!-- keys: group -->

| key | unit | default | meaning |
|---|---|---|---|
| `fill` | | none | where |
| `bodies` | | none | which |
"""
CODES = """<!-- codes: error -->

| code | meaning |
|---|---|
| `usage` | wrong command line |

<!-- codes: exit -->

| status | meaning |
|---|---|
| `0` | done |
| `1` | a check failed |
| `2` | wrong command line |

<!-- codes: violation -->

| violation | meaning |
|---|---|
| `truncated` | cut off |
"""
KIT = """<!-- kit: features -->

| feature | asked for by |
|---|---|
| `joint:fixed`, `joint.cut` | joints |

<!-- kit: capabilities -->

| capability | promise |
|---|---|
| `TANDEM_CAN_PREDICT` | `predict` |

<!-- kit: calls -->

| function | what it does |
|---|---|
| `predict` | predicts |
"""
SOURCES = {
    "common/scene/schema.json": json.dumps(SCHEMA),
    "common/scene/model.hpp": "struct Body {\n  double mass = 0;\n  Kind kind = Kind::soft;  // hard\n};\n",
    "common/error.cpp": 'case usage: return "usage";\nint exit_status(ErrorCode code) {\n  return 2;\n}',
    "protocol/violation.cpp": 'return "truncated";',
    "participant/library/features.cpp": 'return "joint:fixed";\n return "joint:unknown";\n features.add("joint.cut", "mbd.joints");',
    "participant/include/tandem/participant.h": "#define TANDEM_CAN_PREDICT 1\n  int (*predict)(void *self);",
    "docs/scene_format.md": TABLES,
    "docs/participant.md": KIT,
    "docs/troubleshooting.md": CODES,
    "docs/README.md": "[a](scene_format.md) [b](troubleshooting.md) [c](references.md) [d](../docs) [e](participant.md)\n",
    "docs/references.md": "**[MbdDem]** a work\n\n| key | work |\n|---|---|\n| [Gear1985] | another |\n",
}


class Planted(unittest.TestCase):
    def faults(self, check, files):
        """What `check` finds in a small project with `files` in it (name -> text)."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in {**SOURCES, **files}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            return check(root)[0]

    def caught(self, check, files, why):
        found = self.faults(check, files)
        self.assertEqual(len(found), 1, found)
        self.assertIn(why, found[0])

    def passes(self, check, files):
        self.assertEqual(self.faults(check, files), [])


class Links(Planted):
    def test_files(self):
        self.passes(docs.links, {"README.md": "[a](docs/scene_format.md) `[b](c)` [d](https://e.f)\n```\n[g](h)\n```\n"})
        self.caught(docs.links, {"README.md": "[a](docs/other.md)"}, "README.md:1: there is no docs/other.md")
        self.caught(docs.links, {"README.md": "one\n\n![a](b.png)"}, "README.md:3: there is no b.png")
        self.caught(docs.links, {"docs/a.md": "[a](../../../etc)"}, "there is no ../../../etc")

    def test_lonely_pages(self):
        self.caught(docs.links, {"docs/adr/1.md": "text"}, "docs/adr/1.md: no page links to it")
        self.caught(docs.links, {"docs/adr/1.md": "[a](1.md)"}, "docs/adr/1.md: no page links to it")
        self.passes(docs.links, {"docs/adr/1.md": "text", "docs/a.md": "[a](adr/1.md)"})
        self.passes(docs.links, {"docs/adr/1.md": "text", "docs/a.md": "[a](adr)"})

    def test_references(self):
        self.passes(docs.links, {"docs/a.md": "As in [Gear1985], [MbdDem] and [Unit2Test]."})
        self.caught(docs.links, {"docs/a.md": "\nAs in [Gear1986]."}, "docs/a.md:2: docs/references.md has no [Gear1986]")

    def test_anchors(self):
        self.passes(docs.links, {"README.md": "[a](#on-to-it)\n[b](docs/scene_format.md#body)\n\n## `On` to it!\n"})
        self.passes(docs.links, {"README.md": "[a](#twice-1)\n## Twice\n## Twice\n"})
        self.caught(docs.links, {"README.md": "[a](#b)"}, "no heading for #b")
        self.caught(docs.links, {"README.md": "[a](docs/scene_format.md#b)\n# b"}, "no heading for #b")
        self.caught(docs.links, {"README.md": "[a](#b)\n```\n# b\n```\n"}, "no heading for #b")

    def test_pages_that_sources_name(self):
        self.passes(docs.links, {"common/a.hpp": "// docs/scene_format.md says why"})
        self.caught(docs.links, {"common/a.hpp": "\n// docs/why.md says why"}, "common/a.hpp:2: there is no docs/why.md")


class Blocks(Planted):
    def check(self, root):
        return docs.json_blocks(root, lambda text: "" if "good" in text else "bad scene")

    def page(self, info, text):
        return {"docs/page.md": f"```{info}\n{text}\n```\n"}

    def test_scenes(self):
        self.passes(self.check, self.page("json", '{"name": "good"}'))
        self.caught(self.check, self.page("json", '{"name": "evil"}'), "docs/page.md:1: bad scene")
        self.caught(self.check, self.page("json", '{"name": '), "no JSON")
        self.caught(self.check, self.page("", '{"name": "good"}'), "mark this block as json")

    def test_fragments(self):
        self.passes(self.check, self.page("json fragment body", '{"mass": 1, "kind": "soft"}'))
        self.passes(self.check, self.page("json fragment group", '{"fill": {"type": "box", "size": 1}, "bodies": [{"mass": 1}]}'))
        self.caught(self.check, self.page("json fragment body", '{"mas": 1}'), ".mas is no key")
        self.caught(self.check, self.page("json fragment body", '{"kind": "wet"}'), ".kind is 'wet'")
        self.caught(self.check, self.page("json fragment group", '{"bodies": [{"size": 1}]}'), ".bodies[0].size is no key")
        self.caught(self.check, self.page("json fragment group", '{"fill": {"type": "box", "mass": 1}}'), ".fill.mass is no key")
        self.caught(self.check, self.page("json fragment bodies", "{}"), "is none of")
        self.caught(self.check, self.page("json something", "{}"), "is none of")

    def test_lines(self):
        self.passes(self.check, self.page("json lines", '{"a": 1}\n{"b": 2}'))
        self.caught(self.check, self.page("json lines", '{"a": 1}\n{"b": '), "no JSON")


class Keys(Planted):
    def table(self, old, new):
        self.assertIn(old, TABLES)
        return {"docs/scene_format.md": TABLES.replace(old, new)}

    def test_tables(self):
        self.passes(docs.key_tables, {})
        self.caught(docs.key_tables, self.table("| `mass` | kg | - | mass |\n", ""), "the key 'mass' of body is missing")
        self.caught(docs.key_tables, self.table("`name`", "`name`, `nome`"), "scene has no key 'nome'")
        self.caught(docs.key_tables, self.table("<!-- keys: group -->", ""), "no table of 'group'")
        self.caught(docs.key_tables, self.table("# Page", "<!-- keys: scenery -->"), "scenery is not there")
        self.caught(docs.key_tables, self.table("# Page", "# Page\n\n<!-- keys: group -->\n\n" + TABLES[TABLES.rindex("| key"):]), "group has a table already")

    def test_sentences_of_plain_keys(self):
        cmake = {"common/scene/CMakeLists.txt": 'tandem_scene_keys(KEYS "${SCHEMA}"\n  body)\n'}
        self.passes(docs.key_tables, cmake)
        self.caught(docs.key_tables, {**cmake, **self.table("| - | mass |", "| - | weight |")}, "'mass' of body begins otherwise than in the schema")
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in {**SOURCES, **cmake, "docs/scene_format/body.md": "<!-- keys: body -->\n\n| key | unit | default | meaning |\n|---|---|---|---|\n"}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            docs.write_rows(root)
            self.assertIn("|---|---|---|---|\n| `mass` | kg | - | mass |\n", (root / "docs/scene_format/body.md").read_text())

    def test_cells(self):
        self.caught(docs.key_tables, self.table("| kg |", "| g |"), "the unit of 'mass' is 'g' here and 'kg'")
        self.caught(docs.key_tables, self.table("| kg |", "| |"), "the unit of 'mass' is ''")
        self.caught(docs.key_tables, self.table("| kg | - |", "| kg | 1 |"), "'mass' must be given")
        self.caught(docs.key_tables, self.table("| m | 1 |", "| m | - |"), "'size' may be left out")
        self.caught(docs.key_tables, self.table("| edge |", "| |"), "'size' has no meaning")
        self.caught(docs.key_tables, self.table(" or `hard`", ""), "the value `hard` of 'kind' is missing")
        self.caught(docs.key_tables, self.table("| m | 1 | edge |", "| m | 1 | edge | more |"), "another number of cells")

    def test_defaults(self):
        self.caught(docs.key_tables, self.table("| m | 1 | edge |", "| m | 2 | edge |"), "'size' of fill:box is 2 here and 1 in the schema")
        self.caught(docs.key_tables, self.table("| m | 1 | edge |", "| m | true | edge |"), "is true here and 1 in the schema")
        self.caught(docs.key_tables, self.table("| m | 1 | edge |", "| m | of the file | edge |"), "is of the file here and 1 in the schema")
        self.caught(docs.key_tables, self.table("| `soft` | `soft`", "| `hard` | `soft`"), "is `hard` here and \"soft\" in the schema")
        self.caught(docs.key_tables, self.table("| | none | which |", "| | `[]` | which |"), "is `[]` here and absent in the schema")
        with_default = json.dumps(SCHEMA).replace('"mass [kg]"', '"mass [kg]", "default": 1')
        self.caught(docs.key_tables, {"common/scene/schema.json": with_default}, "'mass' of body must be given, and the schema has a default")
        self.passes(docs.key_tables, {"common/scene/model.hpp": "struct Body {\n  Kind kind = Kind::soft;\n};\n"})
        self.caught(docs.key_tables, {"common/scene/model.hpp": "struct Body {\n  Kind kind = Kind::hard;\n};\n"},
                    "'kind' of body is soft here and hard in common/scene/model.hpp")


class Codes(Planted):
    def test_codes(self):
        self.passes(docs.code_tables, {})
        for kind, code in (("error", "usage"), ("exit", "2"), ("violation", "truncated")):
            without = "\n".join(line for line in CODES.splitlines()
                                if f"`{code}`" not in line)
            self.caught(docs.code_tables, {"docs/troubleshooting.md": without}, f"{kind} {code} is missing")
        self.caught(docs.code_tables, {"docs/troubleshooting.md": CODES.replace("`truncated`", "`truncated`, `found`")}, "no violation found")
        self.caught(docs.code_tables, {"docs/troubleshooting.md": CODES.replace("| cut off |", "| |")}, "an empty cell")


class Kit(Planted):
    def test_names(self):
        self.passes(docs.kit_tables, {})
        for old, new, why in (("`joint:fixed`, ", "", "features: joint:fixed is missing"), ("`joint.cut`", "`joint.cute`, `joint.cut`", "there is no joint.cute"),
                              ("`TANDEM_CAN_PREDICT`", "nothing", "capabilities: TANDEM_CAN_PREDICT is missing"),
                              ("| `predict` | predicts", "| nothing | predicts", "calls: predict is missing"), ("| predicts |", "| |", "an empty cell")):
            self.assertIn(old, KIT)
            self.caught(docs.kit_tables, {"docs/participant.md": KIT.replace(old, new)}, why)


class Words(Planted):
    def test_words(self):
        self.passes(docs.word_faults, {"docs/page.md": "In `border.csv` [it](books.md) is recorded.\n```\nthe books\n```\n"})
        self.passes(docs.word_faults, {"docs/page.md": "<!-- begin records -->\nthe books\n<!-- end records -->\n"})
        self.caught(docs.word_faults, {"docs/page.md": "<!-- begin a -->\n<!-- end a -->\nThe books close."}, "page.md:3: 'books'")
        self.caught(docs.word_faults, {"README.md": "at the border"}, "'border' (write: interface")


if __name__ == "__main__":
    unittest.main()
