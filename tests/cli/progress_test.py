# SPDX-License-Identifier: Apache-2.0
"""How far long work is: plain lines in a log, a bar on a terminal, nothing with --quiet."""
import os
import pty
import re
import subprocess
import unittest

from interrupt_test import scene
from program import PROGRAM, ProgramTest, environment

# By the clock: it shows progress on any machine, and ends.
COMMAND = ["render", "scene.xml", "-o", "out.exr", "--time", "3"]


class Progress(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("scene.xml", scene(32, 24))

    def check_shares(self, shown):
        """`shown`: percents and seconds left (or None)."""
        shown = [(int(percent), left) for percent, left in shown]
        self.assertEqual(shown, sorted(shown, key=lambda pair: pair[0]))
        self.assertLessEqual(shown[-1][0], 100)
        for percent, left in shown:
            if percent > 10:
                self.assertIsNotNone(left, "time left is told once a tenth is done")
            if percent < 10:
                self.assertIsNone(left)
        self.assertTrue(any(left for _, left in shown))

    def test_lines_in_a_log(self):
        _, words = self.run_program(*COMMAND)
        lines = words.splitlines()
        self.assertRegex(lines[-1], "^saved out.exr and out.png")
        shown = [re.fullmatch(r"rendering: (\d+) %(?:, (\d+) s left)?", line) for line in lines[:-1]]
        self.assertNotIn(None, shown, words)
        self.assertGreaterEqual(len(shown), 2)
        self.check_shares([found.groups() for found in shown])

    def test_a_bar_on_a_terminal(self):
        words = self.on_a_terminal(*COMMAND)
        *bars, rest = words.split("\x1b[K")
        self.assertEqual(bars.pop(), "\r", "it is wiped")
        self.assertRegex(rest, "^saved out.exr and out.png")
        shown = [re.fullmatch(r"\rrendering \[(#*)(\.*)\] +(\d+) %(?:, (\d+) s left)?", bar) for bar in bars]
        self.assertNotIn(None, shown, repr(words))
        self.assertGreaterEqual(len(shown), 5)
        self.check_shares([found.groups()[2:] for found in shown])
        for found in shown:
            full, rest_of_bar, percent, _ = found.groups()
            self.assertEqual(len(full) + len(rest_of_bar), 30)
            self.assertAlmostEqual(len(full), 30 * int(percent) / 100, delta=1.2)

    def test_nothing_when_it_is_to_be_quiet(self):
        self.assertEqual(self.run_program("--quiet", *COMMAND)[1], "")
        self.assertEqual(self.on_a_terminal("--quiet", *COMMAND), "")

    def on_a_terminal(self, *args):
        """What it writes to a terminal as stderr."""
        ours, theirs = pty.openpty()
        child = subprocess.Popen([PROGRAM, *args], cwd=self.folder, env=environment(), stdin=subprocess.DEVNULL,
                                 stdout=subprocess.DEVNULL, stderr=theirs)
        os.close(theirs)
        words = b""
        with child:
            try:
                while read := os.read(ours, 4096):
                    words += read
            except OSError:  # how Linux says that the other end is closed
                pass
        os.close(ours)
        self.assertEqual(child.returncode, 0)
        return words.decode()


if __name__ == "__main__":
    unittest.main()
