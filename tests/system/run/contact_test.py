#!/usr/bin/env python3
"""Bodies that touch each other and particles, in one scene."""
import json

import harness
from harness import Case

SCENE = "box_on_floor.json"
SECOND_ORDER = {"scheme": "dem_first", "load": "linear", "path": "quadratic", "window": 5e-4}


class BodiesAndParticles(Case):
    def scene(self, **coupling):
        scene = json.loads((harness.SCENES / SCENE).read_text())
        scene["coupling"] = {"window": scene["coupling"]["window"], **coupling}
        path = self.folder / "scene.json"
        path.write_text(json.dumps(scene))
        return path

    def judged(self, scene, *arguments, out=None):
        self.run_scene(scene, *arguments, out=out)
        return self.summary(out)

    def test_the_energy_of_the_bodies_closes_with_every_scheme(self):
        """Grains make the tray vibrate on its contacts: steps resolve that, and the balance has what the points take."""
        for scheme in ["dem_first", "mbd_first", "parallel", "linear_implicit", "implicit"]:
            with self.subTest(scheme):
                summary = self.judged(self.scene(scheme=scheme))
                share = abs(summary["mbd_largest_energy_balance_J"]) / summary["mbd_energy_scale_J"]
                print(f"\n  {scheme}: balance {share:.2e} of the energy that moves (limit 0.01)")
                self.assertLess(share, 0.01)
                # The other rules judge the coupling: explicit schemes do not know that the tray stands.
                self.assertLessEqual({line["rule"] for line in summary["verdict"]["lines"]},
                                     {"energy_coupling", "window_stability"})

    def test_a_good_scheme_is_ok(self):
        for coupling in [{"scheme": "implicit"}, SECOND_ORDER]:
            with self.subTest(**coupling):
                self.assertEqual(self.judged(self.scene(**coupling), "--strict")["verdict"]["lines"], [])

    def test_threads_and_restart_keep_the_bits(self):
        for coupling in [{"scheme": "implicit"}, SECOND_ORDER]:
            with self.subTest(**coupling):
                scene = self.scene(**coupling)
                run = lambda out, *arguments: self.judged(scene, *arguments, out=self.folder / f"{coupling['scheme']}_{out}")
                whole = run("whole", "--threads", "1")["state_hash"]
                self.assertEqual(run("threads", "--threads", "2")["state_hash"], whole)
                half = run("half", "--end-time", "0.1", "--checkpoint-every", "1")
                self.assertNotEqual(half["state_hash"], whole)
                again = run("again", "--end-time", "0.2", "--restart", self.folder / f"{coupling['scheme']}_half")
                self.assertEqual(again["state_hash"], whole)


if __name__ == "__main__":
    harness.main()
