#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders every scene of a folder by both programs at few samples, and prints a table.

    bench/mitsuba/census.py FOLDER [--reflectree build/bin/reflectree] [--venv build/mitsuba] [--spp 16]
                            [--width 96] [--timeout 120] [--table FILE]

A row per scene: whether it loads, or the sentence that refuses it; the ratio of the means of red, green and blue, ours
over Mitsuba's; the largest z-score of a grid of 4 x 4 blocks and of the whole; seconds of both, loading included.
Scenes are read from a copy of the folder in which films are small and samples few; all else in it is linked. Without
Mitsuba's wheel (see beside_mitsuba.py) ours alone is tried. A scene without a sensor, which others include, is left
out. Exits with 1 where both render and differ.
"""
import argparse
import json
import math
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tests" / "words")]

from beside_mitsuba import mitsuba_python  # noqa: E402
from pixels import read_exr  # noqa: E402

SEEDS = [11, 12, 13, 14]
BLOCKS = 4
SLACK = .01  # of the mean: what is called the same


def shrunk(text, width, spp):
    """The same scene with a film of at most that many columns or rows, and few samples."""
    size = re.compile(r'(name="(?:width|height|res|resx|resy|resolution|film_width|film_height)"\s+value=")(\d+)(")')
    largest = max([int(m[2]) for m in size.finditer(text)], default=0)
    if largest > width:
        text = size.sub(lambda m: f"{m[1]}{max(1, round(int(m[2]) * width / largest))}{m[3]}", text)
    count = re.compile(r'(name="(?:sample_count|sampleCount|spp|samples)"\s+value=")\d+(")')
    return count.sub(rf"\g<1>{spp}\g<2>", text)


def copied(folder, place, width, spp):
    """The folder with its scenes shrunk and all else linked; yields the scenes."""
    for path in sorted(folder.rglob("*")):
        to = place / path.relative_to(folder)
        if path.is_dir():
            to.mkdir(parents=True, exist_ok=True)
        elif path.suffix == ".xml":
            text = path.read_text(errors="replace")
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_text(shrunk(text, width, spp))
            if "<scene" in text:
                yield to
        elif path.is_file():
            to.parent.mkdir(parents=True, exist_ok=True)
            to.symlink_to(path.resolve())


def blocks(channels):
    """Means over a grid and over the whole, per channel."""
    height, width = len(channels[0]), len(channels[0][0])
    cells = [(0, height, 0, width)]
    if height >= BLOCKS and width >= BLOCKS:
        cells += [(height * j // BLOCKS, height * (j + 1) // BLOCKS, width * i // BLOCKS, width * (i + 1) // BLOCKS)
                  for j in range(BLOCKS) for i in range(BLOCKS)]
    return [[sum(sum(row[x0:x1]) for row in c[y0:y1]) / ((y1 - y0) * (x1 - x0)) for y0, y1, x0, x1 in cells] for c in channels]


def ours(program, scene, spp, timeout):
    runs, start = [], time.monotonic()
    for seed in SEEDS:
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out.exr"
            command = [program, "--seed", str(seed), "render", scene, "-o", out, "--spp", str(spp)]
            try:
                done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout, check=False)
            except subprocess.TimeoutExpired:
                return None, f"not within {timeout} s", timeout
            if done.returncode != 0:
                lines = [x for x in done.stderr.decode(errors="replace").split("\n") if x.startswith("error: ")]
                said = lines[-1][7:] if lines else f"ends with {done.returncode}"
                return None, said.replace(str(scene.parent) + "/", "").replace(scene.name, "scene"), time.monotonic() - start
            found = read_exr(out.read_bytes())
            runs.append(blocks([found[c] for c in "RGB"]))
    return runs, "", time.monotonic() - start


class Mitsuba:
    def __init__(self, python):
        self.python, self.process = python, None

    def render(self, scene, spp, timeout):
        if self.process is None:
            self.process = subprocess.Popen([self.python, HERE / "words_worker.py"], stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            self.process.stdout.readline()
        start = time.monotonic()
        print(json.dumps({"scene": str(scene), "spp": spp, "seeds": SEEDS}), file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()  # scenes at few samples end; a crash ends the line
        took = time.monotonic() - start
        if not line:
            self.process = None
            return None, "ends without a word", took
        answer = json.loads(line)
        if "error" in answer:
            return None, answer["error"], took
        return [blocks(p) for p in answer["pictures"]], "", took


def compared(a, b):
    """(ratios of R, G, B, largest |z| beyond the slack)"""
    ratios, worst = [], 0.
    for c in range(3):
        for k in range(len(a[0][c])):
            x, y = ([run[c][k] for run in runs] for runs in (a, b))
            mx, my = statistics.mean(x), statistics.mean(y)
            error = math.hypot(statistics.stdev(x), statistics.stdev(y)) / math.sqrt(len(x))
            beyond = abs(mx - my) - SLACK * max(abs(my), .05 * abs(statistics.mean([run[c][0] for run in b])))
            if beyond > 0:
                worst = max(worst, beyond / max(error, 1e-9))
            if k == 0:
                ratios.append(mx / my if my else 1. if mx == my else math.inf)
    return ratios, worst


def main():
    parser = argparse.ArgumentParser(description="Every scene of a folder, by both programs")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--venv", default="build/mitsuba", type=pathlib.Path)
    parser.add_argument("--spp", default=16, type=int)
    parser.add_argument("--width", default=96, type=int)
    parser.add_argument("--timeout", default=120, type=int, help="seconds per render of ours")
    parser.add_argument("--table", type=pathlib.Path)
    o = parser.parse_args()
    try:
        mitsuba = Mitsuba(mitsuba_python(o.venv.resolve()))
    except SystemExit:
        mitsuba = None
        print("ours alone", flush=True)
    lines = ["| scene | ours | ratio of R, G, B | z | seconds, ours and Mitsuba's |", "|---|---|---|---|---|"]
    count = {"same": 0, "differs": 0, "refused": 0, "renders": 0, "Mitsuba refuses": 0}
    place = pathlib.Path(tempfile.mkdtemp())
    for scene in list(copied(o.folder.resolve(), place, o.width, o.spp)):
        mine, said, seconds = ours(o.reflectree.resolve(), scene, o.spp, o.timeout)
        if "no <sensor>" in said:
            continue  # a part of others
        theirs, why, theirs_seconds = mitsuba.render(scene, o.spp, o.timeout) if mitsuba else (None, "", 0)
        ratios, z, times = "", "", f"{seconds:.1f}" + (f", {theirs_seconds:.1f}" if mitsuba else "")
        if mine is None:
            verdict = "refused"
            said += f" (Mitsuba: {why.strip()[:80]})" if mitsuba and theirs is None else ""
        elif theirs is None:
            verdict = "Mitsuba refuses" if mitsuba else "renders"
            said = why.strip()[:120]
        else:
            found, worst = compared(mine, theirs)
            ratios, z = " ".join(f"{r:.3f}" for r in found), f"{worst:.1f}"
            verdict = "same" if worst < 4.5 else "differs"
        count[verdict] += 1
        name = str(scene.relative_to(place))
        lines.append(f"| {name} | {verdict}{': ' + said if said else ''} | {ratios} | {z} | {times} |".replace("\n", " "))
        print(lines[-1], flush=True)
    print(", ".join(f"{n} {k}" for k, n in count.items() if n))
    shutil.rmtree(place)
    if o.table:
        o.table.write_text("\n".join(lines) + "\n")
    sys.exit(1 if count["differs"] else 0)


if __name__ == "__main__":
    main()
