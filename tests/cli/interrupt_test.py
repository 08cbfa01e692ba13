# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C in the middle of long work: exit code 130, soon, and nothing half-written."""
import re
import signal
import subprocess
import time
import unittest

from program import PROGRAM, ProgramTest, environment

# Long enough on any machine; it is never finished.
LONG = ["ggx:alpha=0.02 + retro_reflector:alpha=0.02", "--trials", "1.02", "--variance", "0.0001"]


def scene(width, height):
    return f"""<scene version="3.0.0"><integrator type="path"/><sensor type="perspective">
<transform name="to_world"><lookat origin="0, -3, 1" target="0, 0, 0.8" up="0, 0, 1"/></transform>
<film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/></film></sensor>
<emitter type="constant"/><shape type="rectangle"><bsdf type="diffuse"/></shape>
<shape type="sphere"><float name="radius" value="0.5"/></shape></scene>""".encode()


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

    def interrupted_render(self, *args):
        """Stops it once it shows progress; returns the last line that it wrote."""
        child = subprocess.Popen([PROGRAM, "--threads", "1", "render", "scene.xml", "-o", "out.exr", *args],
                                 cwd=self.folder, env=environment(), stderr=subprocess.PIPE, text=True)
        with child:
            self.assertRegex(child.stderr.readline(), "^rendering: ")
            child.send_signal(signal.SIGINT)
            _, words = child.communicate(timeout=120)
        self.assertEqual(child.returncode, 130, words)
        return words.splitlines()[-1]

    def test_a_render_keeps_what_is_done_and_goes_on_bit_for_bit(self):
        self.write("scene.xml", scene(48, 32))
        said = self.interrupted_render("--spp", "100000000")
        done = int(re.fullmatch(r"saved out.exr and out.png, (\d+) samples per pixel; --resume goes on", said)[1])
        self.assertGreater(done, 0)
        self.assertEqual(self.files(), ["out.exr", "out.exr.sums", "out.png", "scene.xml"])
        parts = self.picture("out")
        goal = str(done + 13)
        self.run_program("render", "scene.xml", "-o", "out.exr", "--spp", goal, "--resume")
        self.run_program("render", "scene.xml", "-o", "whole.exr", "--spp", goal)
        self.assertEqual(self.picture("out"), self.picture("whole"))
        self.assertNotEqual(parts, self.picture("whole"), "the twin: without the rest")
        self.run_program("render", "scene.xml", "-o", "other.exr", "--spp", goal, "--seed", 2)
        self.assertNotEqual(self.picture("other"), self.picture("whole"), "the twin: another seed")

    def test_a_render_without_a_pass_leaves_nothing(self):
        self.write("scene.xml", scene(1500, 1500))
        self.assertEqual(self.interrupted_render("--spp", "64"), "interrupted")
        self.assertEqual(self.files(), ["scene.xml"])

    def files(self):
        return sorted(p.name for p in self.folder.iterdir())

    def picture(self, name):
        return [(self.folder / (name + end)).read_bytes() for end in (".exr", ".png")]


if __name__ == "__main__":
    unittest.main()
