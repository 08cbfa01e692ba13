# SPDX-License-Identifier: Apache-2.0
"""The doctor by name and on a pipe: sound ones pass, faults are named, and what is no client gives a line."""
import os
import pathlib
import sys
import unittest

from program import ProgramTest

CLIENT = os.environ["REFLECTREE_CLIENT"]
PYTHON_CLIENT = f"'{sys.executable}' -B '{pathlib.Path(os.environ['REFLECTREE_EXAMPLES']) / 'doctor' / 'client.py'}'"
QUICK = ["--effort", "quick"]


class Named(ProgramTest):
    def test_a_sound_sampler_is_healthy(self):
        result = self.json_of("doctor", "ggx:alpha=0.3", "--sampler", "cosine", *QUICK)
        self.assertTrue(result["healthy"])
        self.assertEqual(result["findings"], [])
        names = {check["name"] for check in result["checks"]}
        self.assertLessEqual({"finite", "not_negative", "repeatable", "pdf_agrees", "weight_agrees", "pdf_integral",
                              "chi_square_pdf", "light", "support", "above", "independent", "spread"}, names)
        figures = {figure["name"] for figure in result["figures"]}
        self.assertLessEqual({"relative_variance", "worst_weight_over_mean", "lost_share", "nanoseconds_per_draw",
                              "our_one_shot_relative_variance"}, figures)

    def test_a_sampler_file(self):
        self.run_program("build", "lambert", "-o", "l.rfl")
        out, _ = self.run_program("doctor", "l.rfl", *QUICK)
        self.assertEqual(out.splitlines()[-1], "pass  no fault was found")

    def test_threads_do_not_matter(self):
        results = [self.json_of("doctor", "lambert", "--sampler", "uniform", *QUICK, "--threads", n) for n in (1, 2)]
        for result in results:
            result["figures"] = [f for f in result["figures"] if f["name"] != "nanoseconds_per_draw"]
        self.assertEqual(*results)

    def test_the_page_opens_offline(self):
        self.run_program("doctor", "lambert", "--sampler", "cosine", *QUICK, "--html", "page.html")
        page = (self.folder / "page.html").read_text()
        self.assertIn("healthy", page)
        self.assertIn("<svg", page)
        for link in ("src=\"http", "href=\"http", "<script", "@import"):
            self.assertNotIn(link, page)

    def test_errors(self):
        for expected, *args in (("no sampler 'fast'; choose of exact,", "lambert", "--sampler", "fast"),
                                ("does not serve this material", "retro_reflector", "--sampler", "textbook"),
                                ("one subject is wanted",),
                                ("one subject is wanted", "lambert", "--exec", "true"),
                                ("--effort", "lambert", "--effort", "great"),
                                ("did you mean", "lambrt")):
            _, words = self.run_program("doctor", *args, code=2)
            self.assertIn(expected, words)
            self.assertEqual(words.count("\n"), 1, words)


class Pipe(ProgramTest):
    def test_the_client_in_cpp(self):
        result = self.json_of("doctor", "--exec", f"'{CLIENT}'", *QUICK)
        self.assertTrue(result["healthy"])
        self.assertEqual(result["subject"], "cosine")
        twin = self.json_of("doctor", "--exec", f"'{CLIENT}' --faulty", *QUICK, code=1)
        self.assertEqual([f["cause"] for f in twin["findings"]], ["projected_solid_angle"])

    def test_the_client_in_python(self):
        """One finding and no other; that the sound one has none takes as long again: doctor_python_test.py."""
        twin = self.json_of("doctor", "--exec", PYTHON_CLIENT + " --faulty", *QUICK, code=1)
        self.assertEqual([f["cause"] for f in twin["findings"]], ["half_vector_density"])

    def test_what_is_no_client_gives_one_line(self):
        answer = "printf 'reflectree-doctor 1 channels=1 format=text\\n'; read line; "
        for expected, command in (
                ("exit code 127", "no-such-program 2>&-"),
                ("exit code 3 before its greeting", "exit 3"),
                ("its greeting is not understood: 'hello'", "echo hello; sleep 9"),
                ("its greeting is longer than what was asked for", "yes 2>&- | tr -d '\\n' 2>&-"),
                ("did not come within 0.5 s", "sleep 9"),
                ("channels from 1 to 256", "echo reflectree-doctor 1 channels=0"),
                ("'eval=maybe', which means nothing", "echo reflectree-doctor 1 eval=maybe"),
                ("not 5 numbers: 'rubbish'", answer + "echo rubbish; sleep 9"),
                ("not 5 numbers: '1 2 3 4'", answer + "echo 1 2 3 4; sleep 9"),
                ("not 5 numbers: '0 0 1 1 1 1'", answer + "echo 0 0 1 1 1 1; sleep 9"),
                ("has more rows than were asked for", answer + "yes 0 0 1 1 1 2>&-"),
                ("did not come within 0.5 s", answer + "sleep 9"),
                ("exit code 7 before the answer to 'sample", answer + "exit 7"),
                ("signal 9 ended it", answer + "kill -9 $$")):
            _, words = self.run_program("doctor", "--exec", command, "--timeout", "0.5", "-q", code=2)
            self.assertIn(expected, words, command)
            self.assertEqual(words.count("\n"), 1, words)


if __name__ == "__main__":
    unittest.main()
