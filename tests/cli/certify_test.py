#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""certify, build --certify and what info says of proved bounds."""
import unittest

from program import ProgramTest

MATERIAL = "oren_nayar"


class Certify(ProgramTest):
    def test_a_saved_sampler_is_upgraded(self):
        self.run_program("-q", "build", MATERIAL, "-o", "it.rfl")
        before = self.json_of("info", "it.rfl")
        self.assertEqual(before["certified_slabs"], 0)
        self.assertIsNone(before["largest_bound_ratio"])
        _, words = self.run_program("certify", "it.rfl", "-o", "proved.rfl")
        self.assertIn("proved", words)
        after = self.json_of("info", "proved.rfl")
        self.assertEqual(after["certified_slabs"], before["exact_slabs"])
        self.assertEqual(after["estimated_slabs"], 0)
        self.assertEqual(after["overshoot_mass"], 0)
        self.assertTrue(1 < after["largest_bound_ratio"] < 1.2)
        self.assertLess(after["expected_trials"], 1.08 * before["expected_trials"])
        self.assertEqual(before, self.json_of("info", "it.rfl"), "the other file stays")
        out, _ = self.run_program("info", "proved.rfl")
        self.assertIn("certified: proved", out)
        self.run_program("-q", "certify", "it.rfl")
        self.assertEqual((self.folder / "it.rfl").read_bytes(), (self.folder / "proved.rfl").read_bytes())

    def test_the_albedo(self):
        self.run_program("-q", "build", MATERIAL, "-o", "it.rfl")
        self.run_program("-q", "certify", "it.rfl", "-o", "bounds.rfl")
        self.assertIsNone(self.json_of("info", "bounds.rfl")["albedo_proved_error"])
        _, words = self.run_program("certify", "it.rfl", "-o", "both.rfl", "--albedo", "0.1")
        self.assertIn("proved the albedo to within", words)
        self.assertLessEqual(self.json_of("info", "both.rfl")["albedo_proved_error"], 0.1)
        out, _ = self.run_program("info", "both.rfl")
        self.assertIn(" proved)", out)
        self.run_program("certify", "it.rfl", "--albedo", "0.9", code=2)

    def test_at_build(self):
        self.run_program("-q", "build", MATERIAL, "-o", "plain.rfl")
        self.run_program("-q", "certify", "plain.rfl")
        self.run_program("-q", "build", MATERIAL, "-o", "at_once.rfl", "--certify")
        self.assertEqual((self.folder / "plain.rfl").read_bytes(), (self.folder / "at_once.rfl").read_bytes())

    def test_what_cannot_be_proved(self):
        _, words = self.run_program("build", "ggx:alpha_y=0.3,alpha_x=0.1..0.5", "-o", "no.rfl", "--certify", code=2)
        self.assertIn("no interval form", words)
        self.assertFalse((self.folder / "no.rfl").exists())
        self.run_program("certify", MATERIAL, code=2)
        self.run_program("certify", "nowhere.rfl", code=2)

    def test_too_few_boxes(self):
        self.run_program("-q", "build", MATERIAL, "-o", "it.rfl")
        before = self.json_of("info", "it.rfl")
        self.run_program("-q", "certify", "it.rfl", "--boxes", "1", code=1)
        after = self.json_of("info", "it.rfl")
        self.assertGreater(after["estimated_slabs"], 0)
        self.assertIn("leaves are open", after["notes"][-1])
        self.assertLessEqual(before["expected_trials"], after["expected_trials"] * 1.0001, "no bound is lowered")


if __name__ == "__main__":
    unittest.main()
