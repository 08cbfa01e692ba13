# SPDX-License-Identifier: Apache-2.0
"""The studies: study_paper measures real MERL files where a folder of them is given; study_pictures judges, and goes
on where it was interrupted; its scenes render; every study tells its usage."""
import os
import pathlib
import signal
import subprocess
import unittest

from program import ProgramTest, environment


class StudyPaper(ProgramTest):
    def measure(self, *args, code=0):
        done = subprocess.run([os.environ["REFLECTREE_STUDY_PAPER"], "--only-measured", *args], cwd=self.folder,
                              env=environment(), capture_output=True, timeout=300, check=False)
        self.assertEqual(done.returncode, code, done.stderr.decode())
        return done.stdout.decode(), done.stderr.decode()

    def test_every_file_of_the_folder_is_measured(self):
        (self.folder / "merl").mkdir()
        self.run_program("bake", "phong", "-o", "merl/glossy.binary")
        self.write("merl/notes.txt", b"no table")
        out, _ = self.measure("--merl", "merl")
        rows = {row[1]: row[2:] for row in ([c.strip() for c in line.split("|")] for line in out.splitlines())
                if len(row) > 8}
        self.assertIn("glossy", rows)
        self.assertNotIn("notes", rows)
        leaves, megabytes, _, trials, unmet, error = rows["glossy"][:6]
        self.assertGreater(int(leaves), 90 * 16)
        self.assertGreater(float(megabytes), 0.05)
        self.assertLess(1, float(trials))
        self.assertLess(float(trials), 4)  # n_max
        self.assertLess(float(error), 0.05)
        self.assertGreaterEqual(int(unmet), 0)
        self.assertIn("median of 1", " ".join(rows))

    def test_what_is_no_table_is_refused(self):
        (self.folder / "merl").mkdir()
        self.assertIn("no .binary files", self.measure("--merl", "merl", code=2)[1])
        self.write("merl/broken.binary", b"\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0short")
        self.assertIn("broken.binary", self.measure("--merl", "merl", code=2)[1])
        self.assertIn("Left out", self.measure()[0])


class StudyPictures(ProgramTest):
    SCENES = pathlib.Path(__file__).parents[2] / "bench" / "studies" / "scenes"
    SMALL = ["--quick", "--seeds", "2", "--other-seeds", "1", "--reference", "32", "--only", "retro", "--parts", "path"]

    def start(self, *args):
        program = os.environ["REFLECTREE_STUDY_PICTURES"]
        return subprocess.Popen([program, *args, "--scenes", self.SCENES], cwd=self.folder, env=environment(),
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def study(self, *args, code=0):
        with self.start(*args) as child:
            _, words = child.communicate(timeout=300)
        self.assertEqual(child.returncode, code, words)
        return words

    def page(self, folder):
        return (self.folder / folder / "pictures.md").read_text()

    def rows(self, folder):
        """Of the scene's table: sampler to figures."""
        text = self.page(folder).split("### Path tracing")[1]
        cells = [[c.strip() for c in line.split("|")[1:-1]] for line in text.splitlines() if line.startswith("|")]
        return {row[0]: row[1:] for row in cells[2:]}

    def test_our_sampler_is_judged_and_a_worse_one_in_its_place_loses(self):
        self.study("ours", *self.SMALL, "--samplers", "cosine,proxy,adaptive-cdf")
        page = self.page("ours")
        self.assertIn("every scene: holds (2 of 2; 0 are out of reach)", page)
        self.assertRegex(page, r"retro \| path \| cosine \|.*\| reached \|")
        self.assertIn("elsewhere no loss beyond noise: holds", page)
        self.assertIn("within two standard errors: holds", page)
        self.assertEqual(set(self.rows("ours")), {"one-shot", "exact", "cosine", "proxy", "adaptive-cdf"})
        for name in ("reference", "cosine", "one-shot", "one-shot-error"):
            data = (self.folder / "ours" / f"pictures-retro-{name}.png").read_bytes()
            self.assertTrue(data.startswith(b"\x89PNG"))
        html = (self.folder / "ours" / "pictures.html").read_text()
        self.assertEqual(html.count("data:image/png"), 9)  # 1 converged, 4 samplers with their errors
        self.assertNotIn("http", html.replace("http://www.w3.org", ""))
        # The twin: the cosine lobe in one-shot mode's place.
        self.study("twin", *self.SMALL, "--samplers", "proxy,adaptive-cdf", "--ours", "cosine", code=1)
        page = self.page("twin")
        self.assertIn("every scene: does not hold (0 of 1", page)
        self.assertRegex(page, r"retro \| path \| proxy \|.*\| missed \|")
        self.assertIn("elsewhere no loss beyond noise: does not hold", page)
        self.assertIn("within two standard errors: does not hold", page)
        self.assertRegex(page, r"retro \| path \| adaptive-cdf \|.*\| yes \|")

    def test_what_is_interrupted_goes_on(self):
        args = [*self.SMALL, "--samplers", "cosine"]
        self.study("whole", *args)
        every_part = [a for a in args if a not in ("--parts", "path")]  # enough to do for the signal to meet
        child = self.start("cut", *every_part, "--threads", "1")
        with child:
            for line in child.stderr:
                if line.startswith("retro, path: 2 of"):
                    break
            child.send_signal(signal.SIGINT)
            child.communicate(timeout=60)
        self.assertEqual(child.returncode, 130)
        self.assertIn("Combined", self.page("cut"))
        self.assertIn("measured otherwise", self.study("cut", *args, "--seed", "2", "--resume", code=2))
        self.study("cut", *args, "--resume")
        whole, cut = self.rows("whole"), self.rows("cut")
        self.assertEqual(set(whole), set(cut))
        for name, figures in whole.items():
            self.assertEqual(figures[:3], cut[name][:3])  # the rest depends on time

    def test_ways_are_combined(self):
        self.study("ways", "--quick", "--seeds", "2", "--reference", "32", "--only", "plates", "--parts", "ways",
                   "--samplers", "exact")
        text = self.page("ways").split("### Veach's plates")[1]
        for way in ("plain", "split in 4, stratified", "Owen–Sobol' points", "MIS with lights", "resampled by light, 1 of 8"):
            self.assertIn(f"| {way} |", text)
        self.assertIn("| together: MIS, split, stratified, Sobol' |", text)

    def test_what_is_not_there_is_named(self):
        self.assertIn("no sampler 'magic'", self.study("x", *self.SMALL, "--samplers", "magic", code=2))
        self.assertIn("no scene 'moon'", self.study("x", "--only", "moon", code=2))
        self.assertIn("--parts", self.study("x", "--parts", "moon", code=2))
        self.write("taken", b"a file")
        self.assertIn("taken", self.study("taken", *self.SMALL, code=2))
        self.study("left", "--only", "ball")  # without data
        self.assertIn("Left out", self.page("left"))

    def test_its_scenes_render(self):
        for name in ("metal", "retro", "plates"):
            self.run_program("render", self.SCENES / f"{name}.xml", "--spp", 1, "-o", f"{name}.exr")
            self.run_program("image-compare", f"{name}.exr", f"{name}.exr")
        # The twin: without its data the fourth is refused.
        self.assertIn("$", self.run_program("render", self.SCENES / "ball.xml", "--spp", 1, code=2)[1])


class Usage(ProgramTest):
    def test_every_study_helps_and_refuses_what_it_does_not_know(self):
        studies = sorted(pathlib.Path(os.environ["REFLECTREE_STUDY_PAPER"]).parent.glob("study_*"))
        self.assertGreaterEqual(len(studies), 6)
        for study in studies:
            with self.subTest(study.name):
                def run(*args, study=study):
                    return subprocess.run([study, *args], cwd=self.folder, env=environment(), capture_output=True,
                                          timeout=60, check=False)
                shown = run("--help")
                self.assertEqual(shown.returncode, 0, shown.stderr)
                self.assertIn(b"Usage:", shown.stdout)
                refused = run("--nonsense")
                self.assertEqual(refused.returncode, 2, refused.stderr)
                self.assertIn(b"--help", refused.stderr)
                self.assertEqual(refused.stdout, b"")
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
