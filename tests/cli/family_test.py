# SPDX-License-Identifier: Apache-2.0
"""A parameter with a range: built, told of, drawn from, judged; and refused where one member is meant."""
import unittest

from program import ProgramTest

COARSE = ["--trials", "2", "--variance", "0.2"]
FAMILY = "ggx:alpha=0.1..1"


class Family(ProgramTest):
    def test_from_text_to_samples(self):
        self.run_program("build", FAMILY, "-o", "f.rfl", *COARSE)
        info = self.json_of("info", "f.rfl")
        self.assertEqual(info["parameters"], [{"name": "alpha", "from": 0.1, "to": 1, "logarithmic": True}])
        self.assertEqual(info["material"], "ggx:alpha=0.1..1,f0=1/0.8/0.3")
        out, _ = self.run_program("info", "f.rfl")
        self.assertRegex(out, r"(?m)^family +alpha from 0.1 to 1")
        out, _ = self.run_program("sample", "f.rfl", "--at", "alpha=0.3", "-n", "20")
        self.assertEqual(len(out.splitlines()), 21)
        out, _ = self.run_program("eval", "f.rfl", "--at", "alpha=0.3", "--wo", "0,0,1", "--wi", "0.6,0,0.8")
        alone, _ = self.run_program("eval", "ggx:alpha=0.3", "--no-pdf", "--wo", "0,0,1", "--wi", "0.6,0,0.8")
        self.assertEqual(out.splitlines()[1].split(",")[:12], alone.splitlines()[1].split(","))
        self.run_program("draw", "f.rfl", "--at", "alpha=0.3", "--theta-o-deg", "30", "-o", "f.html")
        self.assertTrue((self.folder / "f.html").exists())
        result = self.json_of("verify", "f.rfl", "--members", "1", "--effort", "0.3", "--theta-o-deg", "45",
                              "--random", "0")
        self.assertTrue(result["passed"])
        result = self.json_of("verify", "f.rfl", "--members", "1", "--effort", "0.3", "--theta-o-deg", "45",
                              "--random", "0", "--plant", "halved-bound", code=1)
        self.assertFalse(result["passed"])

    def test_errors(self):
        self.run_program("build", FAMILY, "-o", "f.rfl", *COARSE)
        for args, words in ((("sample", "f.rfl"), "is a family"),
                            (("sample", "f.rfl", "--at", "alpha=2"), "outside of its range"),
                            (("sample", "f.rfl", "--at", "beta=2"), "no parameter 'beta'"),
                            (("sample", "f.rfl", "--at", "alpha"), "no parameter 'alpha'"),
                            (("sample", "f.rfl", "--at", "alpha=0.3,alpha=0.3"), "one number"),
                            (("draw", "f.rfl", "-o", "x.html"), "is a family"),
                            (("sample", "lambert", "--at", "alpha=0.3"), "is no family"),
                            (("list", FAMILY), "a parameter has a range"),
                            (("build", "ggx:alpha=1..0.1", "-o", "g.rfl"), "smaller number first")):
            _, err = self.run_program(*args, code=2)
            self.assertIn(words, err, args)
            self.assertEqual(len(err.strip().splitlines()), 1, err)


if __name__ == "__main__":
    unittest.main()
