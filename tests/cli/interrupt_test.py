# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C in the middle of long work: exit code 130, soon, and nothing half-written."""
import signal
import subprocess
import time
import unittest

from program import PROGRAM, ProgramTest, environment

# Long enough on any machine; it is never finished.
LONG = ["ggx:alpha=0.02 + retro_reflector:alpha=0.02", "--trials", "1.02", "--variance", "0.0001"]


class Interrupt(ProgramTest):
    def assert_stops(self, *args):
        before = sorted(p.name for p in self.folder.iterdir())
        child = subprocess.Popen([PROGRAM, *args], cwd=self.folder, env=environment(), stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        with child:
            child.stderr.readline()  # the first line of progress: it is at work
            self.assertIsNone(child.poll(), "it ended before it could be stopped")
            sent = time.monotonic()
            child.send_signal(signal.SIGINT)
            out, words = child.communicate(timeout=60)
            self.assertLess(time.monotonic() - sent, 10)
        self.assertEqual(child.returncode, 130, words)
        self.assertEqual(out, "")
        self.assertTrue(words.endswith("interrupted\n"), words)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), before)

    def test_a_build(self):
        self.assert_stops("build", *LONG, "-o", "slow.rfl")

    def test_a_build_leaves_the_older_file(self):
        self.run_program("build", "lambert", "-o", "kept.rfl")
        kept = (self.folder / "kept.rfl").read_bytes()
        self.assert_stops("build", *LONG, "-o", "kept.rfl")
        self.assertEqual((self.folder / "kept.rfl").read_bytes(), kept)

    def test_info(self):
        self.assert_stops("info", *LONG)

    def test_compare(self):
        self.assert_stops("compare", LONG[0], "lambert", "--csv", "cells.csv", "--html", "page.html")

    def test_many_samples(self):
        self.run_program("build", "lambert", "-o", "l.rfl")
        child = subprocess.Popen([PROGRAM, "sample", "l.rfl", "-n", "10000000", "-o", "many.csv"], cwd=self.folder,
                                 env=environment(), stderr=subprocess.PIPE)
        with child:
            time.sleep(0.3)
            child.send_signal(signal.SIGINT)
            child.communicate(timeout=60)
        self.assertEqual(child.returncode, 130)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["l.rfl"])


if __name__ == "__main__":
    unittest.main()
