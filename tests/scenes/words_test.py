# SPDX-License-Identifier: Apache-2.0
"""Each scene of words/ shows what Mitsuba shows, by its stored numbers; and together they use every word that we read."""
import math
import os
import pathlib
import re
import statistics
import tempfile
import unittest
import xml.etree.ElementTree as tree
from concurrent.futures import ThreadPoolExecutor

import words_files
from words_judge import FOLDER, differs, key, load, means, render, scenes, scores

PROGRAM = os.environ["REFLECTREE_PROGRAM"]
ROOT = pathlib.Path(__file__).resolve().parents[2]
STORED = load()
# Points that are placed, not drawn: standard errors are then too large, and z-scores too small.
PLACED = {"stratified", "multijitter", "orthogonal", "ldsampler"}
# Mitsuba has no such words, or they are parts of others.
OURS_ALONE = {"recursive", "photons", "photon_count", "final_gather", "split", "sobol", "reflectree", "mm"}


def shown(scene, *more):
    with tempfile.TemporaryDirectory() as folder:
        return render(PROGRAM, scene, str(pathlib.Path(folder) / "out.exr"), *more)


def normal(z):
    """What is wrong with z as draws from the normal distribution, beyond four standard errors."""
    n = len(z)
    mean, square = statistics.mean(z), statistics.mean(v * v for v in z)
    tail = sum(abs(v) > 2 for v in z) / n
    said = [] if abs(mean) < 4 / math.sqrt(n) else [f"their mean is {mean:.3f}"]
    said += [] if abs(square - 1) < 4 * math.sqrt(2 / n) else [f"their mean square is {square:.3f}"]
    return said + ([] if abs(tail - .0455) < 4 * math.sqrt(.0455 * .9545 / n) else [f"{100 * tail:.1f} % are beyond 2"])


class Words(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with ThreadPoolExecutor(2) as pool:
            cls.shown = dict(zip(scenes(), pool.map(shown, scenes())))
        cls.pairs = {s: (ours, STORED[key(s)]) for s, (ours, _) in cls.shown.items() if ours and key(s) in STORED}

    def test_pictures_are_mitsubas(self):
        self.assertGreater(len(self.shown), 40)
        for scene, (ours, said) in self.shown.items():
            with self.subTest(scene.stem):
                self.assertIsNotNone(ours, said)
                self.assertIn(key(scene), STORED, "no numbers: run bench/mitsuba/scenes.py --store")
                self.assertEqual(differs(ours, STORED[key(scene)]), [])

    def drawn(self):
        return [(a, b) for s, (a, b) in self.pairs.items() if s.stem not in PLACED]

    def test_differences_are_noise(self):
        z = [v for a, b in self.drawn() for v in scores(a, b)]
        self.assertGreater(len(z), 300)
        self.assertEqual(normal(z), [])

    def test_faults_are_seen(self):
        """Two per cent more light, red for blue, left for right."""
        for scene, (ours, theirs) in self.pairs.items():
            n, across = len(ours) // 3, 4
            mirrored = [ours[i - i % across + across - 1 - i % across] for i in range(len(ours))]
            with self.subTest(scene.stem):
                self.assertTrue(differs([(1.02 * m, e) for m, e in ours], theirs), "brighter")
                red, _, blue = means(theirs)
                if abs(red / blue - 1) > .03:
                    self.assertTrue(differs(ours[2 * n:] + ours[n:2 * n] + ours[:n], theirs), "red for blue")
                if differs([theirs[i - i % across + across - 1 - i % across] for i in range(len(theirs))], theirs):
                    self.assertTrue(differs(mirrored, theirs), "left for right")
        brighter = [v for a, b in self.drawn() for v in scores([(1.02 * m, e) for m, e in a], b)]
        self.assertTrue(normal(brighter))

    def test_a_brighter_lamp_is_seen(self):
        scene = FOLDER / "stratified.xml"
        ours, said = shown(scene, "-D", "glow=4.3")  # of the lamp, in red
        self.assertIsNotNone(ours, said)
        self.assertTrue(differs(ours, STORED[key(scene)]))

    def test_every_word_is_used(self):
        used = set()
        for path in FOLDER.rglob("*.xml"):
            for element in tree.parse(path).iter():
                used |= {element.tag, *element.attrib, *element.attrib.values()}
        missing = self.words() - used - OURS_ALONE
        self.assertEqual(missing, set(), "words that we read and no scene of words/ uses")
        self.assertIn("cutoff_angle", self.words() - (used - {"cutoff_angle"}) - OURS_ALONE, "the twin")

    @staticmethod
    def words():
        """Names, types, tags, attributes and values that the readers know."""
        found = set()
        for path in (ROOT / "src" / "render" / "reading").glob("*.cpp"):
            text = path.read_text()
            for listed in re.findall(r"\bonly\(\w+, \{(.*?)\}\)", text, re.DOTALL):
                found |= set(re.findall(r'"(\w+)"', listed))
            found |= set(re.findall(r'(?:type|name|kind|wrap|filter|along|tag|format|n\.name\(\)|type\(\w+\)) [!=]= "(\w+)"', text))
            for listed in re.findall(r'\{("\w+", \{[^}]*\}, \{[^}]*\})\}', text):  # of attributes
                found |= set(re.findall(r'"(\w+)"', listed))
        return found

    def test_files_are_what_the_script_makes(self):
        made = words_files.FILES
        self.assertEqual({p.name for p in (FOLDER / "files").iterdir()}, set(made))
        for name, data in made.items():
            self.assertEqual((FOLDER / "files" / name).read_bytes(), data, name)
        self.assertLess(sum(p.stat().st_size for p in FOLDER.rglob("*") if p.is_file()), 200_000)


if __name__ == "__main__":
    unittest.main()
