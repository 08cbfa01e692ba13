# SPDX-License-Identifier: Apache-2.0
"""A good sampler passes every check; each planted fault is caught by one; threads do not matter."""
import unittest

from program import ProgramTest

QUICK = ["--theta-o-deg", "45", "--random", "1", "--bound-trials", "1000000"]
SMALL = [*QUICK, "--samples", "300000"]  # for what is seen in any number of samples
LARGE = [*QUICK, "--samples", "1000000"]  # for two per cent, and for what must hold


class Verify(ProgramTest):
    def setUp(self):
        super().setUp()
        self.run_program("build", "ggx:alpha=0.3", "-o", "g.rfl")

    def test_good_samplers_pass(self):
        for subject in ("g.rfl", "lambert", "retro_reflector"):
            result = self.json_of("verify", subject, *LARGE)
            self.assertTrue(result["passed"])
            names = {check["name"] for check in result["checks"]}
            self.assertLessEqual({"chi_square", "chi_square_pdf", "chi_square_weights", "mean_weight", "pdf_agrees",
                                  "weight_agrees", "alive", "finite", "pdf_integral", "albedo_table",
                                  "sample_once", "overshoot_mass", "isotropy", "channel_weights", "lanes", "target", "support",
                                  "mode_agrees", "round_trip", "leaf_slope_y", "leaf_shape", "leaf_distinct",
                                  "packed_albedo", "packed_slabs", "packed_leaves", "packed_choice",
                                  "packed_descent", "acceptance", "giving_up"}, names)
            ways = {check["way"] for check in result["checks"]} - {""}
            self.assertEqual(ways, {"exact", "exact, n", "exact, batch", "one-shot", "one-shot, points",
                                    "one-shot, n", "one-shot, batch", "one-shot, batch of points",
                                    "one-shot, propose"})

    def test_planted_faults_are_caught(self):
        caught_by = {"bent": "chi_square", "halved-bound": "overshoot_mass", "swapped-pdf": "pdf_agrees",
                     "lost-support": "chi_square", "scaled-pdf": "pdf_integral", "scaled-weight": "mean_weight",
                     "dying": "alive"}
        for fault, name in caught_by.items():
            samples = LARGE if fault == "bent" else SMALL
            result = self.json_of("verify", "g.rfl", "--plant", fault, *samples, code=1)
            failed = {check["name"] for check in result["checks"] if not check["passed"]}
            self.assertIn(name, failed, fault)

    def test_lines_say_what_failed(self):
        out, _ = self.run_program("verify", "g.rfl", "--plant", "dying", *SMALL, code=1)
        self.assertRegex(out, r"(?m)^  FAIL  alive ")
        self.assertRegex(out, r"(?m)^  pass  albedo_table ")
        self.assertRegex(out.splitlines()[-1], r"^FAIL  \d+ checks hold, \d+ fail, with the planted fault 'dying'$")

    def test_threads_do_not_matter(self):
        results = [self.json_of("verify", "g.rfl", "--threads", n, *SMALL) for n in (1, 2)]
        self.assertEqual(results[0], results[1])


if __name__ == "__main__":
    unittest.main()
