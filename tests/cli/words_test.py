# SPDX-License-Identifier: Apache-2.0
"""Help, lists, JSON, streams, colours, seeds."""
import os
import pty
import subprocess
import unittest

from program import PROGRAM, ProgramTest, environment

SUBCOMMANDS = ["list", "build", "info", "eval", "sample", "verify", "doctor", "draw", "bake", "export", "demo"]


def on_terminal(args, **changes):
    """What the program writes where stdout and stderr are a terminal."""
    master, slave = pty.openpty()
    child = subprocess.Popen([PROGRAM, *args], stdin=subprocess.DEVNULL, stdout=slave, stderr=slave,
                             env=environment(**changes))
    os.close(slave)
    written = b""
    while True:
        try:
            block = os.read(master, 4096)
        except OSError:  # the terminal is gone: the program has ended
            break
        if not block:
            break
        written += block
    os.close(master)
    return child.wait(), written.decode()


class Help(ProgramTest):
    def test_names_every_subcommand_and_exit_code(self):
        text, words = self.run_program("--help")
        self.assertEqual(words, "")
        for word in (*SUBCOMMANDS, "--seed", "--threads", "--json", "--data", "0 success", "130 interrupted"):
            self.assertIn(word, text)

    def test_of_each_subcommand_says_what_it_does_and_gives_an_example(self):
        for name in SUBCOMMANDS:
            text, words = self.run_program(name, "--help")
            self.assertEqual(words, "", name)
            self.assertIn(f"Usage: reflectree {name}", text)
            self.assertIn(f"  reflectree {name}", text, "an example")
            self.assertLessEqual(max(map(len, text.splitlines())), 121, name)

    def test_examples_of_materials_can_be_run(self):
        for line in self.run_program("list", "--help")[0].splitlines():
            if line.startswith("  reflectree list") and "table.csv" not in line:
                self.run_program(*line.split("   ")[0].split()[1:])

    def test_version(self):
        self.assertRegex(self.run_program("--version")[0], r"^reflectree \d+\.\d+\.\d+\n$")


class List(ProgramTest):
    def test_shows_models_with_class_and_ranges(self):
        text, _ = self.run_program("list")
        self.assertIn("ggx  (physical)", text)
        self.assertRegex(text, r"alpha_x +0\.1 +0\.001 to 1")

    def test_json_holds_the_same(self):
        models = {m["name"]: m for m in self.json_of("list")["models"]}
        self.assertIn("lambert", models)
        alpha = models["ggx"]["parameters"][0]
        self.assertEqual((alpha["name"], alpha["default"], alpha["minimum"]), ("alpha_x", 0.1, 0.001))

    def test_prints_the_canonical_form_which_is_stable(self):
        once, _ = self.run_program("list", " .3*lambert:rho=.5+ggx:alpha=1e-1")
        self.assertEqual(once, "0.3*lambert:rho=0.5 + ggx:alpha=0.1,f0=1/0.8/0.3\n")
        self.assertEqual(self.run_program("list", once.strip())[0], once)

    def test_names_the_members_of_a_table(self):
        header = "material," + ",".join(f"{p}_{c}" for p in ("kd", "A") for c in "rgb") + ",B,C,ior"
        rows = "".join(f"\n{name},.1,.1,.1,1,1,1,100,1,1.5" for name in ("one", "two"))
        self.write("abc.csv", (header + rows + "\n").encode())
        self.assertEqual(self.run_program("list", "abc.csv")[0], "abc.csv#one\nabc.csv#two\n")
        self.assertEqual(self.json_of("list", "abc.csv")["members"], ["abc.csv#one", "abc.csv#two"])
        self.assertEqual(self.run_program("list", "abc.csv#two")[0], "abc.csv#two\n")


class Streams(ProgramTest):
    def test_results_and_words_are_apart(self):
        out, words = self.run_program("build", "lambert", "-o", "l.rfl")
        self.assertIn("expected trials", out)
        self.assertEqual(words, "saved l.rfl\n")
        self.assertEqual(self.run_program("-q", "build", "lambert", "-o", "l.rfl")[1], "")
        self.assertIn("evaluations", self.run_program("-v", "build", "lambert", "-o", "l.rfl")[1])

    def test_json_of_info(self):
        facts = self.json_of("info", "lambert:rho=0.25")
        self.assertEqual(facts["command"], "info")
        self.assertEqual(facts["material"], "lambert:rho=0.25")
        self.assertEqual(facts["bytes_on_disk"], None)
        self.assertAlmostEqual(facts["albedo_maximum"], 0.25 * 3 ** 0.5, places=4)
        self.assertLess(facts["expected_trials"], 1.2501)
        self.assertEqual(facts["certified_slabs"] + facts["estimated_slabs"], facts["exact_slabs"])

    def test_options_stand_on_either_side_of_the_subcommand(self):
        before, _ = self.run_program("--seed", 7, "sample", "lambert", "-n", 5)
        after, _ = self.run_program("sample", "lambert", "-n", 5, "--seed", 7)
        self.assertEqual(before, after)

    def test_full_disk_is_told(self):
        with open("/dev/full", "wb") as full:
            done = subprocess.run([PROGRAM, "list"], stdout=full, stderr=subprocess.PIPE, env=environment(), check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"stdout: writing failed", done.stderr)

    def test_colours_on_a_terminal_alone_and_not_against_the_users_wish(self):
        args = ["verify", "lambert", "--theta-o-deg", "45", "--samples", "100000", "--bound-trials", "10000"]
        code, text = on_terminal(args)
        self.assertEqual(code, 0)
        self.assertIn("\x1b[32mpass", text)
        self.assertNotIn("\x1b[32m", on_terminal(args, NO_COLOR="1")[1])
        self.assertNotIn("\x1b", self.run_program(*args)[0])

    def test_a_bar_on_a_terminal(self):
        _, text = on_terminal(["info", "ggx:alpha=0.01", "--variance", "0.0005", "--trials", "1.03"])
        self.assertIn("\rbuilding [", text)
        self.assertNotIn("building", on_terminal(["-q", "info", "ggx:alpha=0.01"])[1])


class Samples(ProgramTest):
    def test_csv_has_named_columns_of_unit_directions(self):
        out, _ = self.run_program("sample", "ggx:alpha=0.3", "-n", 200, "--theta-o-deg", 60)
        head, *rows = out.splitlines()
        self.assertEqual(head, "wi_x,wi_y,wi_z,pdf,weight_r,weight_g,weight_b")
        self.assertEqual(len(rows), 200)
        for row in rows:
            x, y, z, pdf, *weight = map(float, row.split(","))
            self.assertAlmostEqual(x * x + y * y + z * z, 1, places=5)
            self.assertTrue(z > 0 and pdf > 0 and all(w > 0 for w in weight))

    def test_exact_weights_of_a_grey_material_are_the_albedo(self):
        rows = self.run_program("sample", "lambert:rho=0.5", "-n", 50)[0].splitlines()[1:]
        for row in rows:
            self.assertAlmostEqual(float(row.split(",")[-1]), 0.5, places=4)

    def test_seeds_repeat_and_differ(self):
        one = self.run_program("sample", "ggx", "-n", 20, "--seed", 1)[0]
        self.assertEqual(one, self.run_program("sample", "ggx", "-n", 20)[0])
        self.assertNotEqual(one, self.run_program("sample", "ggx", "-n", 20, "--seed", 2)[0])
        self.assertNotEqual(one, self.run_program("sample", "ggx", "-n", 20, "--mode", "one-shot")[0])

    def test_json_rows(self):
        result = self.json_of("sample", "lambert", "-n", 3, "--phi-o-deg", 30)
        self.assertEqual(len(result["rows"]), 3)
        self.assertEqual(len(result["rows"][0]), len(result["columns"]))
        self.assertEqual(result["no_sample"], 0)


if __name__ == "__main__":
    unittest.main()
