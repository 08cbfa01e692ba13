#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every word of Mitsuba's XML that we read, as a small scene rendered by both: a table, a row per word.

    bench/mitsuba/words.py [--reflectree build/bin/reflectree] [--table docs/results/mitsuba-words.md]
                           [--store] [--only TEXT] [--venv build/mitsuba]

The scenes are those of tests/words. With Mitsuba's wheel (put into a virtual environment as by
beside_mitsuba.py) each is rendered by both programs, and --store keeps Mitsuba's numbers for the test; without
the wheel ours alone is held against the stored ones. Exits with 1 where a row disagrees.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
WORDS = HERE.parents[1] / "tests" / "words"
sys.path.insert(0, str(WORDS))
sys.path.insert(0, str(HERE))

from all_rows import ROWS, expected, key, load, store  # noqa: E402
from beside_mitsuba import mitsuba_python  # noqa: E402
from judge import LIMIT, means, numbers_of, worst  # noqa: E402
from ours import put, render  # noqa: E402

SEEDS = [11, 12, 13, 14]


class Mitsuba:
    def __init__(self, python):
        self.python = python
        self.start()

    def start(self):
        self.process = subprocess.Popen([self.python, HERE / "words_worker.py"], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.version = json.loads(self.process.stdout.readline())["ready"]

    def render(self, row, folder):
        request = {"scene": str(put(row, folder)), "spp": row.spp, "seeds": SEEDS}
        print(json.dumps(request), file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()
        if not line:  # some scenes end the program
            self.start()
            return {"error": "ends without a word"}
        answer = json.loads(line)
        if "error" in answer:
            return {"error": answer["error"]}
        if not all(r for p in answer["pictures"] for c in p for r in c or [[]]):
            return {"error": "a picture without pixels"}
        if not all(math.isfinite(v) for p in answer["pictures"] for c in p for r in c for v in r):
            return {"error": "not finite"}
        runs = [[m for m, _ in numbers_of(p)] for p in answer["pictures"]]
        return {"numbers": [(statistics.mean(v), statistics.stdev(v) / math.sqrt(len(v))) for v in zip(*runs)]}


def text(numbers):
    return " ".join(f"{m:.4g}" for m in means(numbers))


def verdict(row, ours, said, theirs, stored):
    """(agrees, ratio of means, distance, words)"""
    if row.error:
        good = said is not None and row.error in said and "scene.xml:" in said
        return good, "", "", "refused" if good else "NOT REFUSED"
    if ours is None:
        return False, "", "", "REFUSED"
    if "error" in theirs:
        like = expected(row, stored)
        good = bool(row.why) and (like is None or bool(like) and worst(ours, like, row.slack) < LIMIT)
        return good, "", "", "on purpose" if good else "MITSUBA REFUSES"
    there = theirs["numbers"]
    distance, a, b = worst(ours, there, row.slack), sum(means(ours)), sum(means(there))
    ratio = f"{a / b:.4f}" if b else "1" if a == b else "-"
    if row.why:
        like = expected(row, stored)
        good = like is None or bool(like) and worst(ours, like, row.slack) < LIMIT
        return good, ratio, f"{distance:.1f}", "on purpose" if good else "NOT WHAT IS MEANT"
    return distance < LIMIT, ratio, f"{distance:.1f}", "same" if distance < LIMIT else "DIFFERS"


def main():
    parser = argparse.ArgumentParser(description="Every word of Mitsuba's XML, by both programs")
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--venv", default="build/mitsuba", type=pathlib.Path)
    parser.add_argument("--table", type=pathlib.Path)
    parser.add_argument("--store", action="store_true")
    parser.add_argument("--stored", action="store_true", help="do not ask Mitsuba")
    parser.add_argument("--only", default="", help="rows whose group or word has this in it")
    parser.add_argument("--verbose", action="store_true", help="all the numbers of each")
    o = parser.parse_args()
    stored = load()
    mitsuba = None
    if not o.stored:
        try:
            mitsuba = Mitsuba(mitsuba_python(o.venv.resolve()))
        except SystemExit:
            print("ours against Mitsuba's stored numbers", flush=True)
    lines, wrong, n = [], 0, 0
    for row in ROWS:
        if o.only not in f"{row.group}: {row.word}":
            continue
        with tempfile.TemporaryDirectory() as folder:
            theirs = mitsuba.render(row, pathlib.Path(folder)) if mitsuba else stored.get(key(row), {"error": "no numbers are stored"})
        with tempfile.TemporaryDirectory() as folder:
            ours, said = render(o.reflectree.resolve(), row, pathlib.Path(folder))
        if mitsuba:
            stored[key(row)] = theirs
        good, ratio, distance, words = verdict(row, ours, said, theirs, stored)
        wrong, n = wrong + (not good), n + 1
        shown = text(theirs["numbers"]) if "numbers" in theirs else "refuses"
        lines.append((row, text(ours) if ours else "refuses", shown, ratio, distance, words))
        if not good or o.verbose or o.only:
            print(f"{row.word}: {words}; ours {text(ours) if ours else said.strip()}; Mitsuba "
                  f"{shown if 'numbers' in theirs else theirs['error']}; {ratio} {distance}", flush=True)
            if o.verbose and ours and "numbers" in theirs:
                for a, b in zip(ours, theirs["numbers"]):
                    print(f"   {a[0]:.5f} {b[0]:.5f}  {a[1]:.5f} {b[1]:.5f}")
    print(f"{n} rows, {wrong} wrong")
    if o.store and mitsuba:
        store({key(r): stored[key(r)] for r in ROWS if key(r) in stored})
    if o.table:
        write_table(o.table, lines, mitsuba.version if mitsuba else "3.9.1, stored")
    sys.exit(1 if wrong else 0)


def write_table(path, lines, version):
    head = path.read_text().split("<!-- table -->")[0] if path.exists() else "# Mitsuba's words\n\n"
    out = [head + "<!-- table -->", f"{len(lines)} rows; Mitsuba {version}.", ""]
    group = None
    for row, ours, theirs, ratio, distance, words in lines:
        if row.group != group:
            group = row.group
            out += ["" if len(out) > 3 else "", f"### {group.capitalize()}", "",
                    "| word | ours | Mitsuba | ratio | z | |", "|---|---|---|---|---|---|"]
        note = f"{words}: {row.why}" if row.why else words
        out.append(f"| {row.word} | {ours} | {theirs} | {ratio} | {distance} | {note} |")
    path.write_text("\n".join(out) + "\n")


if __name__ == "__main__":
    main()
