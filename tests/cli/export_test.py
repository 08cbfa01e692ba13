#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""export: the array of the runtimes, the same in every language, and the one that the C runtime loads itself."""
import pathlib
import re
import shutil
import subprocess
import unittest

from program import ProgramTest

RUNTIME = pathlib.Path(__file__).resolve().parents[2] / "runtime"
MATERIAL = "plastic:alpha=0.4"
ANISOTROPIC = ("ggx:alpha_x=0.5,alpha_y=0.6", "--trials", "4", "--variance", "1")
COMPARE = """
#include "reflectree_load.h"
#include "words.h"
int main(int argc, char** argv) {
  rfl_sampler a, b;
  const char* error = rfl_load(&a, argc > 1 ? argv[1] : "");
  if (error) return puts(error), 1;
  if (rfl_open(&b, mine, sizeof mine / sizeof mine[0])) return 2;
  if (a.words[2] != b.words[2] || memcmp(a.words, b.words, sizeof mine) != 0) return 3;
  rfl_free(&a);
  return 0;
}
"""


def words(text):
    return re.findall(r"0x[0-9a-f]+(?=u[,\n)}])", text)


class Export(ProgramTest):
    def test_all_languages_hold_what_the_c_runtime_loads(self):
        self.run_program("-q", "build", MATERIAL, "-o", "it.rfl")
        result = self.json_of("export", "it.rfl", "--c", "words.h", "--glsl", "words.glsl", "--wgsl", "words.wgsl",
                              "--name", "mine")
        texts = [(self.folder / f"words.{end}").read_text() for end in ("h", "glsl", "wgsl")]
        lists = [words(text) for text in texts]
        self.assertGreater(len(lists[0]), 1000)
        self.assertEqual(lists[0], lists[1])
        self.assertEqual(lists[0], lists[2])
        self.assertEqual(int(lists[0][2], 16), len(lists[0]))
        self.assertEqual(result["words"], len(lists[0]))
        for text in texts:
            self.assertIn("plastic", text.split("\n")[0])
            self.assertIn(f"{len(lists[0])}", text)
        compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
        if not compiler:
            self.skipTest("skipped: no C compiler")
        (self.folder / "compare.c").write_text(COMPARE)
        subprocess.run([compiler, "-std=c99", "-Werror", "-Wall", "-Wextra", f"-I{RUNTIME}", "compare.c", "-o",
                        "compare", "-lm"], cwd=self.folder, check=True)
        compare = [str(self.folder / "compare"), str(self.folder / "it.rfl")]
        self.assertEqual(subprocess.run(compare, check=False).returncode, 0)
        self.run_program("-q", "build", *ANISOTROPIC, "-o", "brushed.rfl")
        self.run_program("-q", "export", "brushed.rfl", "--c", "words.h", "--name", "mine")
        subprocess.run([compiler, "-std=c99", f"-I{RUNTIME}", "compare.c", "-o", "brushed", "-lm"], cwd=self.folder,
                       check=True)
        self.assertEqual(subprocess.run([str(self.folder / "brushed"), str(self.folder / "brushed.rfl")],
                                        check=False).returncode, 0)
        # The twin: another sampler is another array.
        self.run_program("-q", "build", "plastic:alpha=0.41", "-o", "it.rfl")
        self.assertEqual(subprocess.run(compare, check=False).returncode, 3)

    def test_errors(self):
        lambert = "lambert:rho=0.5"
        for arguments, said in (
                (("ggx:alpha=0.3..0.4", "--c", "no.h"), "family"),
                ((lambert,), "no language"),
                ((lambert, "--c", "no.h", "--name", "1x"), "1x"),
                ((lambert, "--c", "no/no.h"), "no/no.h")):
            _, error = self.run_program("-q", "export", *arguments, code=2)
            self.assertIn(said, error)
            self.assertEqual(len(error.splitlines()), 1)
        self.assertFalse((self.folder / "no.h").exists())


if __name__ == "__main__":
    unittest.main()
