# SPDX-License-Identifier: Apache-2.0
"""The studies: study_paper measures real MERL files where a folder of them is given; the scenes of study_pictures
render; every study tells its usage."""
import os
import pathlib
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
    def test_its_scenes_render(self):
        scenes = pathlib.Path(__file__).parents[2] / "bench" / "study" / "scenes"
        for name in ("metal", "retro", "plates"):
            self.run_program("render", scenes / f"{name}.xml", "--spp", 1, "-o", f"{name}.exr")
            self.run_program("image-compare", f"{name}.exr", f"{name}.exr")
        # The twin: without its data the fourth is refused.
        self.assertIn("$", self.run_program("render", scenes / "ball.xml", "--spp", 1, code=2)[1])


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
