# SPDX-License-Identifier: Apache-2.0
"""compare: the same figures whatever the threads or the interruptions; files; every way to go wrong."""
import csv
import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from program import PROGRAM, ProgramTest, environment

TWO = ["compare", "lambert", "ggx:alpha=0.4", "--quick", "--samplers", "exact,one-shot", "--theta-o-deg", "20"]
TIMES = {"sample_ns", "pdf_ns", "floor_ns", "build_seconds"}


def without_times(value):
    if isinstance(value, dict):
        return {k: without_times(v) for k, v in value.items() if k not in TIMES}
    return [without_times(v) for v in value] if isinstance(value, list) else value


class Compare(ProgramTest):
    def assert_error(self, expected, *args):
        out, words = self.run_program(*args, code=2)
        self.assertEqual(out, "")
        self.assertEqual(words.count("\n"), 1, words)
        self.assertTrue(words.startswith("error: ") and "; " in words, words)
        self.assertIn(expected, words)

    @classmethod
    def setUpClass(cls):
        """One run that is kept, with files, for all tests that need a whole one."""
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.first = pathlib.Path(holder.name)
        done = subprocess.run([PROGRAM, "--json", *TWO, "--threads", "1", "--resume", "kept", "--csv", "c.csv", "--html",
                               "c.html"], cwd=cls.first, env=environment(), stdin=subprocess.DEVNULL,
                              capture_output=True, timeout=300, check=True)
        cls.whole = json.loads(done.stdout)

    def keep_first(self):
        return pathlib.Path(shutil.copytree(self.first / "kept", self.folder / "kept"))

    def test_threads_do_not_matter_but_the_seed_does(self):
        a, b, c = self.whole, self.json_of(*TWO, "--threads", 2), self.json_of(*TWO, "--seed", 2)
        self.assertEqual(without_times(a["materials"]), without_times(b["materials"]))
        self.assertNotEqual(without_times(a["materials"]), without_times(c["materials"]))
        self.assertEqual(a["options"]["seed"], 1)
        for key in ("machine", "commit", "version"):
            self.assertTrue(a[key], key)

    def test_resumed_is_uninterrupted(self):
        kept = sorted(self.keep_first().iterdir())
        self.assertEqual(len(kept), 2)
        again = self.json_of(*TWO, "--resume", "kept")
        self.assertEqual(self.whole["materials"], again["materials"])  # the timings, too: nothing was measured
        kept[0].unlink()
        partly = self.json_of(*TWO, "--resume", "kept")
        self.assertEqual(without_times(self.whole["materials"]), without_times(partly["materials"]))
        self.assertNotEqual(self.whole["materials"], partly["materials"])

    def test_kept_results_of_other_settings_are_refused(self):
        path = next(self.keep_first().iterdir())
        self.assert_error("differ in seed;", *TWO, "--resume", "kept", "--seed", "2")
        self.assert_error("differ in samplers;", *TWO[:4], "--theta-o-deg", "20", "--resume", "kept")
        kept = json.loads(path.read_text(encoding="utf-8"))
        other = {setting: "another" for setting in ("commit", "version", "machine")}
        path.write_text(json.dumps({**kept, "made_by": {**kept["made_by"], **other}}), encoding="utf-8")
        self.assert_error("differ in commit, version, machine;", *TWO, "--resume", "kept")
        path.write_text(json.dumps(kept), encoding="utf-8")
        self.run_program(*TWO, "--resume", "kept")  # the twin: unchanged, it is taken up
        path.write_text("{")
        self.assert_error("no result of compare", *TWO, "--resume", "kept")

    def test_files(self):
        with open(self.first / "c.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 2 * 2)
        exact = next(r for r in rows if r["material"] == "lambert" and r["sampler"] == "exact")
        self.assertLess(float(exact["target_variance"]), 1e-9)
        page = (self.first / "c.html").read_text(encoding="utf-8")
        self.assertNotIn("<script", page)
        self.assertNotIn("http", page)
        self.assertIn("ggx:alpha=0.4", page)

    def test_slices(self):
        """In the plane of incidence exact mode's density is the target's, and a uniform one is not."""
        found = self.json_of("compare", "ggx:alpha=0.4", "--quick", "--samplers", "exact,uniform", "--theta-o-deg", "20")
        material = found["materials"][0]
        target = material["slices"][0]
        exact, uniform = (s["slices"][0] for s in material["samplers"])
        self.assertGreater(len(target), 100)
        self.assertEqual((len(exact), len(uniform)), (len(target), len(target)))
        self.assertLess(max(abs(a - b) / b for a, b in zip(exact, target)), 2e-3)
        self.assertGreater(max(abs(a - b) / b for a, b in zip(uniform, target)), 1)

    def test_a_folder_of_files(self):
        folder = self.folder / "measured"
        folder.mkdir()
        self.assert_error("no measured files", "compare", "measured", "--quick")
        self.run_program("bake", "phong", "-o", "measured/baked.binary")
        found = self.json_of("compare", "measured", "--quick", "--samplers", "exact,cosine", "--theta-o-deg", "20")
        self.assertEqual([m["material"] for m in found["materials"]], ["measured/baked.binary"])
        self.assertLess(found["materials"][0]["samplers"][0]["cells"][0]["target_variance"], 1e-4)

    def test_a_measured_light(self):
        # 8 x 4 pixels of (1, .5, .25) and exponent 129: radiances 1, .5, .25, flat records.
        self.write("grey.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + bytes([128, 64, 32, 129]) * 32)
        found = self.json_of(*TWO, "--envmap", "grey.hdr")
        name, mean, mean_square = found["options"]["lights"][-1]
        luminance = 0.2126 + 0.7152 * 0.5 + 0.0722 * 0.25
        self.assertEqual(name, "grey")
        self.assertAlmostEqual(mean, luminance, 4)
        self.assertAlmostEqual(mean_square, luminance**2, 4)
        # Under a light that is the same everywhere only the weight varies, and in exact mode it does not.
        for sampler in found["materials"][0]["samplers"]:
            if sampler["sampler"] == "exact":
                self.assertLess(sampler["cells"][0]["error"][-1], 1e-4)
        lights = len(found["options"]["lights"])
        self.assertEqual(len(found["materials"][0]["samplers"][0]["cells"][0]["error"]), lights)

    def test_errors(self):
        self.assert_error("no sampler 'exat'", "compare", "lambert", "--samplers", "exat")
        self.assert_error("no list of elevations", "compare", "lambert", "--theta-o-deg", "95")
        self.assert_error("did you mean", "compare", "lamber")
        self.write("file", b"x")
        self.assert_error("file", "compare", "lambert", "--envmap", "file")
        self.assert_error("no folder", "compare", "lambert", "--resume", "file")


if __name__ == "__main__":
    unittest.main()
