# SPDX-License-Identifier: Apache-2.0
"""Every row as Mitsuba shows it, by its stored numbers; or the sentence that refuses it, with its place."""
import os
import pathlib
import re
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor

from all_rows import BY_WORD, ROWS, expected, key, load
from judge import LIMIT, worst
from ours import render

PROGRAM = os.environ["REFLECTREE_PROGRAM"]
STORED = load()


def rendered(row):
    with tempfile.TemporaryDirectory() as folder:
        return render(PROGRAM, row, pathlib.Path(folder))


class Words(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with ThreadPoolExecutor(2) as pool:
            cls.shown = dict(zip((r.word for r in ROWS), pool.map(rendered, ROWS)))

    def test_pictures_are_mitsubas(self):
        for row in ROWS:
            want = expected(row, STORED)
            if want is None:
                continue
            with self.subTest(row.word):
                self.assertTrue(want, "no numbers: run bench/mitsuba/words.py --store")
                ours, said = self.shown[row.word]
                self.assertIsNotNone(ours, said)
                self.assertLess(worst(ours, want, row.slack), LIMIT, f"ours {ours}\nMitsuba's {want}\n{row.scene}")

    def test_what_differs_on_purpose_is_shown_all_the_same(self):
        for row in ROWS:
            if row.why and not row.error:
                with self.subTest(row.word):
                    ours, said = self.shown[row.word]
                    self.assertIsNotNone(ours, said)
                    self.assertGreater(sum(m for m, _ in ours), 0)

    def test_what_is_refused_is_named_with_its_place(self):
        for row in ROWS:
            if not row.error:
                continue
            with self.subTest(row.word):
                _, said = self.shown[row.word]
                self.assertIsNotNone(said, "it was rendered")
                self.assertIn(row.error, said)
                at = re.search(r"scene\.xml:(\d+):(\d+): ", said)
                self.assertIsNotNone(at, said)
                line = row.scene.split("\n")[int(at[1]) - 1]
                self.assertEqual(line[int(at[2]) - 1], "<", f"{said} in {line}")
                self.assertEqual(said.count("\n"), 1, "one line")

    def test_all_that_is_wrong_is_told_at_once(self):
        _, said = self.shown["every unknown word at once"]
        for problem in ("'reflectence' is not known", "no bsdf 'fur' is known", "no emitter 'sun' is known"):
            self.assertIn(problem, said)
        self.assertEqual(len(re.findall(r"scene\.xml:\d+:\d+: ", said)), 3, said)

    def test_the_judge_sees_faults(self):
        """Two per cent more light, red for blue, left for right, the sRGB curve: each is another picture."""
        want = STORED[key(BY_WORD["texture: PNG, 8 bits, RGB"])]["numbers"]
        faults = {
            "brighter": [(1.02 * m, e) for m, e in want],
            "red for blue": want[12:] + want[6:12] + want[:6],
            "left for right": [want[6 * (i // 6) + (i % 6 ^ 1)] if i % 6 < 4 else want[i] for i in range(18)],
            "upside down": [want[6 * (i // 6) + (i % 6 ^ 2)] if i % 6 < 4 else want[i] for i in range(18)],
            "not decoded": [(m ** (1 / 2.2), e) for m, e in want],
            "no number": [(float("nan"), 0)] * 18,
        }
        self.assertLess(worst(want, want, .004), LIMIT)
        for name, fault in faults.items():
            self.assertGreater(worst(fault, want, .004), LIMIT, name)

    def test_rows_are_distinguishable(self):
        """What the words change, the numbers tell: no two wraps, filters or axes show the same."""
        for kind in ("texture: wrap_mode ", "fov_axis ", "envmap: to_world, "):
            some = [r for r in ROWS if r.word.startswith(kind) and not r.error]
            for i, a in enumerate(some):
                for b in some[i + 1:]:
                    if kind == "fov_axis " and a.word.split(", ")[1] != b.word.split(", ")[1]:
                        continue
                    same = {("x", "smaller"), ("x", "larger"), ("y", "smaller"), ("y", "larger")}
                    axes = tuple(r.word.split()[1].rstrip(",") for r in (a, b))
                    if kind == "fov_axis " and axes in same:
                        continue
                    self.assertGreater(worst(STORED[key(a)]["numbers"], STORED[key(b)]["numbers"], .004), LIMIT,
                                       f"{a.word} and {b.word}")


if __name__ == "__main__":
    unittest.main()
