#!/usr/bin/env python3
"""dem_server on several ranks of MPI: the files of a run are those of one process, and every fault ends the run at once."""
import json
import os
import pathlib
import re
import signal
import time

import harness
from harness import Case, until

SHIPPED = pathlib.Path(__file__).resolve().parents[3] / "launch" / "scenes"


class CaseOfRanks(Case):
    def setUp(self):
        if not (harness.options.bin / "dem_server_mpi").exists():
            self.skipTest("this build has no MPI: several ranks are NOT tested")
        super().setUp()


class Ranks(CaseOfRanks):
    def scene(self, name, **dem):
        """A shipped scene, with other values of its `dem`."""
        scene = json.loads((SHIPPED / name).read_text())
        scene["dem"].update(dem)
        path = self.folder / name
        path.write_text(json.dumps(scene))
        return path

    def results(self, scene, ranks, *arguments):
        out = self.folder / f"out{ranks}"
        self.run_scene(scene, "--ranks", ranks, "--threads", 1, *arguments, out=out)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary.get("ranks", 1), ranks)
        keys = ["state_hash", "contacts", "list_rebuilds", "lost_particles", "momentum_residual", "energy_residual", "went_out",
                "dem_dissipated_J"]
        files = {file.name: file.read_bytes() for file in [*out.glob("*.csv"), *out.glob("frames/*")]}
        return {key: summary.get(key) for key in keys}, files

    def expect_same(self, found, expected, ranks):
        self.assertEqual(found[0], expected[0], f"{ranks} ranks")
        self.assertFalse([name for name in expected[1] if found[1].get(name) != expected[1][name]], f"{ranks} ranks")

    def check_same_results(self, scene, *arguments, ranks=(2, 3)):
        one = self.results(scene, 1, *arguments)
        self.assertGreater(one[0]["contacts"], 0)
        for count in ranks:
            self.expect_same(self.results(scene, count, *arguments), one, count)
        print(f"\n  {pathlib.Path(scene).name}: {one[0]['state_hash']} on 1 and {ranks} ranks")

    def test_body_on_a_spring(self):
        self.check_same_results(SHIPPED / "spring_box.json", "--end-time", 0.14)

    def test_implicit_windows(self):
        self.check_same_results(SHIPPED / "spring_box.json", "--end-time", 0.13, "--scheme", "implicit", ranks=(2,))

    def test_double_precision(self):
        self.check_same_results(self.scene("chute.json", precision="double"), "--end-time", 0.3, ranks=(3,))

    def test_restart_with_inlet_outlet_contacts_and_dissipation(self):
        """Checkpoints are the same files for any number of ranks above 1. Any number continues from them to the same bits."""
        scene = self.scene("roller.json")
        contents = json.loads(scene.read_text())
        contents["output"].update({"contacts": ["ground", "roller"], "fields": ["contact_count", "mean_stress"], "dissipation": True})
        contents["dem"]["particles"][0]["fill"]["count"] = 250
        scene.write_text(json.dumps(contents))
        whole = self.results(scene, 1, "--end-time", 0.4)
        self.assertGreater(whole[0]["dem_dissipated_J"]["friction"], 0)
        self.assertGreater(whole[0]["went_out"], 0)
        halves = {ranks: self.folder / f"half{ranks}" for ranks in (1, 2, 3)}
        for ranks, half in halves.items():
            self.run_scene(scene, "--ranks", ranks, "--threads", 1, "--end-time", 0.3, "--checkpoint-every", 1, out=half)
        states = {ranks: next(half.glob("checkpoint/*/dem*.h5")).read_bytes() for ranks, half in halves.items()}
        self.assertEqual(states[3], states[2])
        rest = self.results(scene, 1, "--end-time", 0.4, "--restart", halves[3])
        self.assertEqual(rest[0], whole[0])
        self.assertGreater(len([name for name in rest[1] if name.startswith("contacts_")]), 1)
        for ranks, half in ((2, 1), (3, 2)):
            self.expect_same(self.results(scene, ranks, "--end-time", 0.4, "--restart", halves[half]), rest, ranks)


class RankFaults(CaseOfRanks):
    def ranks_of(self, process):
        """The processes of the ranks."""
        found = []
        for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                words = path.read_bytes().split(b"\0")
                environment = (path.parent / "environ").read_bytes()
            except OSError:
                continue
            if words[0].endswith(b"/dem_server_mpi") and str(self.folder).encode() in environment:
                found.append((int(re.search(rb"OMPI_COMM_WORLD_RANK=(\d+)", environment)[1]), int(path.parent.name)))
        return dict(found)

    def start_ranks(self):
        self.out = self.folder / f"out{time.monotonic_ns()}"
        process = self.start(SHIPPED / "box_weight.json", "--ranks", 3, "--threads", 1)
        self.assertTrue(until(lambda: self.windows() > 3, 20 * harness.options.slack), "the run does not begin")
        return process, self.ranks_of(process)

    def test_a_rank_dies(self):
        for rank in (0, 2):
            with self.subTest(rank=rank):
                process, ranks = self.start_ranks()
                self.assertEqual(sorted(ranks), [0, 1, 2])
                os.kill(ranks[rank], signal.SIGKILL)
                seconds, status, said = self.finish(process)
                self.assertEqual(status, 4, said)
                self.assertRegex(said, r"dem_server (on 3 ranks )?\(pid \d+\) .*in window \d+")
                self.assertLess(seconds, 1 * harness.options.slack)
                self.assertTrue(until(lambda: not self.ranks_of(process), 1), "ranks are left")
                print(f"\n  rank {rank}: all left after {seconds:.3f} s")

    def test_the_coordinator_dies(self):
        process, ranks = self.start_ranks()
        os.kill(process.pid, signal.SIGKILL)
        self.assertTrue(until(lambda: not self.ranks_of(process), 1.5 * harness.options.slack), "ranks are left")

    def test_refusals(self):
        for arguments, sentence in [
                (("--ranks", 0), "0 is no number of ranks"),
                (("--ranks", 27), "1331 spheres are too few for 27 ranks .use at most 26"),
                (("--ranks", 2, "--transport", "inproc"), "reached over shared memory so far"),
                (("--ranks", 2, "--backend", "cuda"), "each rank needs a CUDA device"),
                (("--ranks", 2, "--dem-server", "true"), "another program computes the spheres"),
        ]:
            with self.subTest(sentence):
                said = self.run_scene(SHIPPED / "box_weight.json", *arguments, expect=2, out=self.folder / "refused")
                self.assertRegex(said, r"--ranks: .*" + sentence)
        said = self.run_scene(SHIPPED / "pendulum.json", "--ranks", 2, expect=2, out=self.folder / "refused")
        self.assertRegex(said, "the scene has no spheres")


if __name__ == "__main__":
    harness.main()
