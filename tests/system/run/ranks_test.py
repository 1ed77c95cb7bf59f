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
        keys = ["state_hash", "contacts", "list_rebuilds", "lost_particles", "momentum_residual", "energy_residual"]
        rows = {file.name: file.read_text() for file in out.glob("*.csv") if file.name != "windows.csv"}
        return {key: summary.get(key) for key in keys}, rows, (out / "particles.h5").stat().st_size

    def check_same_results(self, scene, *arguments, ranks=(2, 3)):
        one = self.results(scene, 1, *arguments)
        self.assertGreater(one[0]["contacts"], 0)
        for count in ranks:
            self.assertEqual(self.results(scene, count, *arguments), one, f"{count} ranks")
        print(f"\n  {pathlib.Path(scene).name}: {one[0]['state_hash']} on 1 and {ranks} ranks")

    def test_body_on_a_spring(self):
        self.check_same_results(SHIPPED / "spring_box.json", "--end-time", 0.25)

    def test_implicit_windows(self):
        self.check_same_results(SHIPPED / "spring_box.json", "--end-time", 0.2, "--scheme", "implicit", ranks=(2,))

    def test_double_precision(self):
        self.check_same_results(self.scene("chute.json", precision="double"), "--end-time", 0.3, ranks=(3,))

    def test_inlet_outlet_and_roller(self):
        self.check_same_results(SHIPPED / "roller.json", "--end-time", 0.4, ranks=(2,))


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
                (("--ranks", 2, "--backend", "cuda"), "not on GPUs yet"),
                (("--ranks", 2, "--checkpoint-every", 0.1), "no restart files yet"),
                (("--ranks", 2, "--dem-server", "true"), "another program computes the spheres"),
        ]:
            with self.subTest(sentence):
                said = self.run_scene(SHIPPED / "box_weight.json", *arguments, expect=2, out=self.folder / "refused")
                self.assertRegex(said, r"--ranks: .*" + sentence)
        said = self.run_scene(SHIPPED / "pendulum.json", "--ranks", 2, expect=2, out=self.folder / "refused")
        self.assertRegex(said, "the scene has no spheres")


if __name__ == "__main__":
    harness.main()
