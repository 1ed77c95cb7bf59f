#!/usr/bin/env python3
"""The include check catches each planted violation, and lets lawful includes pass."""
import pathlib
import tempfile
import unittest

import standard
from includes import circles, edges, fewest_upward, offences

FILES = ["common/a.hpp", "protocol/b.hpp", "protocol/version.hpp.in", "protocol/wire.idl", "protocol/list.def",
         "mbd_server/solve/c.hpp", "dem_server/contact/d.hpp", "dem_server/coupling/e.hpp", "launch/f.hpp",
         "particles/state/g.hpp", "particles/io/h.hpp"]


class Includes(unittest.TestCase):
    def verdict(self, path, line):
        """The offences of a small repository with one more file, which has `line` as its second line."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in FILES + [path]:
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text("#pragma once\n" + (line + "\n" if name == path else ""))
            return offences(root)[0]

    def caught(self, path, line, why):
        self.assertEqual(self.verdict(path, line), [f"{path}:2: {line}: {why}"])

    def passes(self, path, line):
        self.assertEqual(self.verdict(path, line), [])

    def test_upward(self):
        self.caught("common/x.hpp", '#include "protocol/b.hpp"', "common must not include protocol")
        self.caught("protocol/x.cpp", '#include "mbd_server/solve/c.hpp"', "protocol must not include mbd_server")
        self.caught("dem_server/coupling/x.cpp", '#include "launch/f.hpp"', "dem_server must not include launch")
        self.caught("coordinator/run/x.cpp", '#include "launch/f.hpp"', "coordinator must not include launch")
        self.caught("launch/x.cpp", '#include "tests/x.hpp"', "launch must not include tests")

    def test_server_to_server(self):
        self.caught("mbd_server/coupling/x.hpp", '#include "dem_server/contact/d.hpp"',
                    "mbd_server must not include dem_server")
        self.caught("dem_server/x.cu", '#include "mbd_server/solve/c.hpp"', "dem_server must not include mbd_server")

    def test_particles(self):
        self.caught("particles/io/x.cpp", '#include "dem_server/contact/d.hpp"', "particles must not include dem_server")
        self.caught("particles/io/x.cpp", '#include "protocol/b.hpp"', "in particles only serving may include protocol/")
        self.caught("mbd_server/solve/x.cpp", '#include "particles/io/h.hpp"', "mbd_server must not include particles")
        self.caught("protocol/x.cpp", '#include "particles/io/h.hpp"', "protocol must not include particles")
        self.caught("participant/x.cpp", '#include "particles/state/g.hpp"',
                    "participant uses the layers base, geometry, io of particles only")
        self.caught("participant/x.cpp", '#include "dem_server/contact/d.hpp"', "participant must not include dem_server")
        for part in ("dem_server/laws", "dem_server/coupling", "participant", "launch"):
            self.passes(part + "/x.cpp", '#include "particles/io/h.hpp"')

    def test_what_a_server_answers(self):
        self.caught("coordinator/run/x.cpp", '#include "mbd_server/solve/c.hpp"', "coordinator uses the layers coupling, laws, equations of servers only")
        self.caught("launch/x.cpp", '#include "dem_server/contact/d.hpp"', "launch uses the layers coupling, laws, equations of servers only")
        self.passes("coordinator/run/x.cpp", '#include "dem_server/coupling/e.hpp"')

    def test_protocol_inside_a_server(self):
        why = "in {} only coupling and main.cpp may include protocol/"
        self.caught("mbd_server/solve/x.hpp", '#include "protocol/b.hpp"', why.format("mbd_server"))
        self.caught("dem_server/x.cpp", '#include "protocol/b.hpp"', why.format("dem_server"))
        self.passes("particles/serving/x.cpp", '#include "protocol/b.hpp"')
        self.passes("mbd_server/main.cpp", '#include "protocol/b.hpp"')
        self.passes("dem_server/coupling/x.cpp", '#include "protocol/b.hpp"')

    def test_mutual(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "common").mkdir()
            (root / "common/m.hpp").write_text("#pragma once\n")
            (root / "common/n.hpp").write_text('#include "common/m.hpp"\n')
            self.assertEqual(offences(root)[0], [])
            (root / "common/m.cpp").write_text('#include "common/m.hpp"\n#include "common/n.hpp"\n')
            self.assertEqual(offences(root)[0], ['common/m.cpp:2: #include "common/n.hpp": common/n includes common/m too (common/n.hpp:1)'])

    def test_layers(self):
        self.caught("particles/base/x.hpp", '#include "particles/state/g.hpp"',
                    "layer base must not include state, which is above it")
        self.caught("dem_server/laws/x.hpp", '#include "dem_server/contact/d.hpp"',
                    "layer laws must not include contact, which is above it")
        self.caught("mbd_server/state/x.cpp", '#include "mbd_server/solve/c.hpp"',
                    "layer state must not include solve, which is above it")
        self.caught("dem_server/attic/x.hpp", '#include "dem_server/contact/d.hpp"', "dem_server/attic is no layer of dem_server")
        self.caught("particles/attic/x.hpp", '#include "particles/io/h.hpp"', "particles/attic is no layer of particles")
        self.passes("dem_server/contact/x.cpp", '#include "dem_server/contact/d.hpp"')
        self.passes("dem_server/neighbours/x.hpp", '#include "dem_server/contact/d.hpp"')
        self.passes("particles/state/x.hpp", '#include "particles/io/h.hpp"')
        self.passes("mbd_server/io/x.hpp", '#include "mbd_server/solve/c.hpp"')

    def test_cuda(self):
        why = "CUDA headers belong into CUDA sources"
        self.caught("particles/state/x.hpp", "#include <cuda_runtime.h>", why)
        self.caught("launch/x.cpp", "#include <cub/cub.cuh>", why)
        self.passes("dem_server/backend/cuda/x.cuh", "#include <cuda_runtime.h>")
        self.passes("dem_server/step/x.cu", "#include <cuda_runtime.h>")
        self.passes("dem_server/engine/x.cu.in", "#include <cuda_runtime.h>")

    def test_common_is_lean(self):
        self.caught("common/x.cpp", "#include <boost/any.hpp>", "common must not know boost")
        self.caught("common/x.cpp", "#include <dds/dds.h>", "common must not know dds")
        self.passes("protocol/x.cpp", "#include <dds/dds.h>")

    def test_spelling(self):
        self.caught("protocol/x.cpp", '#include "b.hpp"', "no such file from the root of the repository")
        self.caught("protocol/x.cpp", '#include "../common/a.hpp"', "no such file from the root of the repository")
        self.caught("protocol/x.cpp", "#include <common/a.hpp>", "our own files are included in quotes")
        self.caught("protocol/x.cpp", '#  include   "launch/f.hpp"', "protocol must not include launch")
        self.passes("protocol/x.cpp", '#include "protocol/version.hpp"')
        self.passes("protocol/x.cpp", '#include "wire.h"')
        self.passes("protocol/x.cpp", '#include "list.inc"')
        self.passes("coordinator/run/x.cpp", '#include "protocol/b.hpp"')
        self.passes("tests/unit/x.cpp", '#include "helper.hpp"')

    def test_lawful(self):
        self.passes("protocol/x.cpp", '#include "common/a.hpp"')
        self.passes("launch/x.cpp", '#include "dem_server/coupling/e.hpp"')
        self.passes("tests/x.cpp", '#include "mbd_server/solve/c.hpp"')
        self.passes("mbd_server/solve/x.cpp", '// #include "launch/f.hpp"')


class Standard(unittest.TestCase):
    def test_types_need_their_headers(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "common").mkdir()
            (root / "common/a.hpp").write_text("#include <vector>\n")
            (root / "common/b.hpp").write_text('#include "common/a.hpp"\nstd::vector<int> all;  // std::map\nstd::optional<int> some;\n')
            self.assertEqual(standard.offences(root), (["common/b.hpp: std::optional needs <optional>"], 2))


class Edges(unittest.TestCase):
    def test_are_read_with_their_number(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            files = {"dem_server/io/a.hpp": ["state/b.hpp", "state/c.hpp", "io/d.hpp"], "dem_server/state/b.hpp": ["base/e.hpp"]}
            for name, lines in files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text("".join(f'#include "dem_server/{line}"\n' for line in lines) + '#include "common/error.hpp"\n')
            self.assertEqual(edges(root, "dem_server"), {("io", "state"): 2, ("state", "base"): 1})

    def test_layers_have_no_circle(self):
        found = {("c", "b"): 3, ("c", "a"): 1, ("b", "a"): 2}
        self.assertEqual((fewest_upward(found), circles(found)), (0, []))

    def test_circles_are_found_and_their_edges_counted(self):
        found = {("a", "b"): 1, ("b", "c"): 1, ("c", "a"): 1, ("b", "a"): 1, ("d", "a"): 1, ("e", "f"): 1, ("f", "e"): 9}
        # One of the edges between e and f leads upward; in a, b, c the edge a -> b, or two others.
        self.assertEqual(fewest_upward(found), 2)
        self.assertEqual(circles(found), [["a", "b", "c"], ["e", "f"]])


if __name__ == "__main__":
    unittest.main()
