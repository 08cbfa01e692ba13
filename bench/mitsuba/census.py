#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders every scene of a folder by both programs at few samples, and prints a table.

    bench/mitsuba/census.py FOLDER [--reflectree build/bin/reflectree] [--venv build/mitsuba] [--spp 16]
                            [--width 96] [--timeout 120] [--only TEXT] [--table FILE [--resume]]
                            [--page docs/results/census.md]

A row per scene: whether it loads, or the sentence that refuses it; the ratio of the means of red, green and blue, ours
over Mitsuba's, and the largest standard error of the three; the largest z-score of a grid of 4 x 4 blocks and of the
whole; seconds of both, loading included. Scenes are read from a copy of the folder in which films are small and samples
few; all else in it is linked. What differs is looked at again with eight times the samples, since errors from eight
renders are rough. Without Mitsuba's wheel (see beside_mitsuba.py) ours alone is tried. What others include, and a scene
without a sensor, is left out. --resume keeps the rows that are in the table. --page writes the counts and the reasons
behind the marker of that page; the folder's own folders are its collections. Exits with 1 where both render and differ.
"""
import argparse
import collections
import json
import math
import pathlib
import re
import select
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

SEEDS = [11, 12, 13, 14, 15, 16, 17, 18]
BLOCKS = 4
SLACK = .01  # of the mean: what is called the same
AGAIN = 8    # times the samples

# What a refusal is about, by the words of its sentence; the first that is found.
KINDS = [
    ("participating media", r"<medium>|<phase>|<volume>|'medium'|'interior'|'exterior'|gridvolume"),
    ("polarisation", r"'(polarizer|retarder|circular|pplastic|measured_polarized|stokes)'"),
    ("hair, curves and distance fields", r"'(hair|bsplinecurve|linearcurve|sdfgrid|ellipsoids\w*)'"),
    ("`roughdielectric`", r"'roughdielectric'"),
    ("`principled`, `principledthin`", r"'principled(thin)?'"),
    ("another integrator: `ptracer`, `prb`, ...", r"no integrator '"),
    ("another sensor", r"no sensor '"),
    ("another film or filter", r"no (film|rfilter) '|no pixel_format|no file_format"),
    ("another emitter", r"no emitter '"),
    ("a file that is not there, or not whole", r"no such file|no file '|Git LFS pointer|ends early|damaged|mend the XML"),
    ("words of another program: its materials, shapes, transforms, ...", r"no \w+ '|is not known|without '\w+'"),
    ("a value that the command line gives", r"nothing defines \$"),
]
MARKER = "<!-- table -->"


def shrunk(text, width, spp):
    """The same scene with a film of at most that many columns or rows, and few samples."""
    size = re.compile(r'(name="(?:(?:crop_|film_)?(?:width|height)|crop_offset_[xy]|res|resx|resy|resolution)"\s+value=")(\d+)(")')
    largest = max([int(m[2]) for m in size.finditer(text)], default=0)
    if largest > width:
        text = size.sub(lambda m: f"{m[1]}{int(m[2]) * width // largest or min(1, int(m[2]))}{m[3]}", text)
    count = re.compile(r'(name="(?:sample_count|sampleCount|spp|samples)"\s+value=")\d+(")')
    return count.sub(rf"\g<1>{spp}\g<2>", text)


def included(folder):
    """What scenes of the folder include."""
    names = set()
    for path in folder.rglob("*.xml"):
        if path.is_file():
            text = re.sub(r"<!--.*?-->", "", path.read_text(errors="replace"), flags=re.DOTALL)
            names |= {m.lstrip("./") for m in re.findall(r'<include\s+filename="([^"$]+)"', text)}
    return [p for p in folder.rglob("*.xml") if any(str(p).endswith("/" + n) for n in names)]


def copied(folder, place, width, spp):
    """The folder with its scenes shrunk and all else linked; yields the scenes that are no parts of others."""
    parts = set(included(folder))
    for path in sorted(folder.rglob("*")):
        to = place / path.relative_to(folder)
        if path.is_dir():
            to.mkdir(parents=True, exist_ok=True)
        elif path.suffix == ".xml":
            text = path.read_text(errors="replace")
            to.parent.mkdir(parents=True, exist_ok=True)
            to.write_text(shrunk(text, width, spp))
            if "<scene" in text and path not in parts:
                yield to
        elif path.is_file():
            to.parent.mkdir(parents=True, exist_ok=True)
            to.symlink_to(path.resolve())


def cells(height, width):
    """The whole, and a grid."""
    grid = [(height * j // BLOCKS, height * (j + 1) // BLOCKS, width * i // BLOCKS, width * (i + 1) // BLOCKS)
            for j in range(BLOCKS) for i in range(BLOCKS)]
    return [(0, height, 0, width)] + (grid if height >= BLOCKS and width >= BLOCKS else [])


def blocks(channels):
    """Means over the cells, per channel."""
    return [[sum(sum(row[x0:x1]) for row in c[y0:y1]) / ((y1 - y0) * (x1 - x0)) for y0, y1, x0, x1 in cells(len(c), len(c[0]))]
            for c in channels]


def ours(program, scene, spp, timeout):
    """Means and standard errors of the cells, per channel; what was said; seconds."""
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.exr"
        command = [program, "--seed", str(SEEDS[0]), "render", scene, "-o", out, "--spp", str(len(SEEDS) * spp)]
        try:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout, check=False)
        except subprocess.TimeoutExpired:
            return None, f"not within {timeout} s", timeout
        if done.returncode != 0:
            lines = [x for x in done.stderr.decode(errors="replace").split("\n") if x.startswith("error: ")]
            said = lines[-1][7:] if lines else f"ends with {done.returncode}"
            return None, said.replace(str(scene.parent) + "/", "").replace(scene.name, "scene"), time.monotonic() - start
        found = read_exr(out.read_bytes())
    squares = blocks([[[e * e for e in row] for row in found["stderr." + c]] for c in "RGB"])
    area = [(y1 - y0) * (x1 - x0) for y0, y1, x0, x1 in cells(len(found["R"]), len(found["R"][0]))]
    means = blocks([found[c] for c in "RGB"])
    numbers = [[(m, math.sqrt(s / n)) for m, s, n in zip(means[c], squares[c], area)] for c in range(3)]
    return numbers, "", time.monotonic() - start


class Mitsuba:
    def __init__(self, python):
        self.python, self.process = python, None

    def stop(self):
        if self.process:
            self.process.kill()
            self.process.wait()
        self.process = None

    def render(self, scene, spp, timeout):
        if self.process is None:
            self.process = subprocess.Popen([self.python, HERE / "words_worker.py"], stdin=subprocess.PIPE,
                                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            self.process.stdout.readline()
        start = time.monotonic()
        print(json.dumps({"scene": str(scene), "spp": spp, "seeds": SEEDS, "path": True}), file=self.process.stdin, flush=True)
        late = not select.select([self.process.stdout], [], [], timeout)[0]
        line = "" if late else self.process.stdout.readline()
        took = time.monotonic() - start
        if not line:
            self.stop()
            return None, f"not within {timeout} s" if late else "ends without a word", took
        answer = json.loads(line)
        if "error" in answer:
            return None, answer["error"], took
        if not all(math.isfinite(v) for p in answer["pictures"] for c in p for r in c for v in r):
            return None, "a picture with values that are not finite", took
        return [blocks(p) for p in answer["pictures"]], "", took


def compared(a, b):
    """(ratios of R, G, B, their largest standard error, largest |z| beyond the slack)"""
    ratios, noise, worst = [], 0., 0.
    for c in range(3):
        whole = abs(statistics.mean(run[c][0] for run in b))
        for k, (mx, ex) in enumerate(a[c]):
            y = [run[c][k] for run in b]
            my, error = statistics.mean(y), math.hypot(ex, statistics.stdev(y) / math.sqrt(len(y)))
            beyond = abs(mx - my) - SLACK * max(abs(my), .05 * whole)
            if beyond > 0:
                worst = max(worst, beyond / max(error, 1e-9))
            if k == 0:
                ratios.append(mx / my if my else 1. if mx == my else math.inf)
                noise = max(noise, error / my if my else 0)
    return ratios, noise, worst


class Census:
    def __init__(self, o):
        self.o, self.program = o, o.reflectree.resolve()
        try:
            self.mitsuba = Mitsuba(mitsuba_python(o.venv.resolve()))
        except SystemExit:
            self.mitsuba = None
            print("ours alone", flush=True)

    def look(self, scene, spp):
        """(verdict, what was said, ratios, their error, z, seconds), or none for a part of others."""
        mine, said, seconds = ours(self.program, scene, spp, self.o.timeout)
        if "no <sensor>" in said:
            return None
        theirs, why, theirs_seconds = self.mitsuba.render(scene, spp, self.o.timeout) if self.mitsuba else (None, "", 0)
        times, why = f"{seconds:.1f}" + (f", {theirs_seconds:.1f}" if self.mitsuba else ""), why.strip()[:120]
        if mine is None:
            if self.mitsuba and theirs is None:
                return "neither", f"{said} (Mitsuba: {why})", "", "", "", times
            return "refused", said, "", "", "", times
        if theirs is None:
            return "Mitsuba refuses" if self.mitsuba else "renders", why, "", "", "", times
        ratios, noise, z = compared(mine, theirs)
        shown = " ".join(f"{r:.3f}" for r in ratios)
        return "same" if z < 4.5 else "differs", "", shown, f"{noise:.3f}", f"{z:.1f}", times

    def row(self, scene):
        found = self.look(scene, self.o.spp)
        if found and found[0] == "differs":
            found = self.look(scene, AGAIN * self.o.spp)
        return found


def earlier(table):
    """Rows of an interrupted census, by scene."""
    found = {}
    for line in table.read_text().strip().split("\n")[2:] if table and table.exists() else []:
        name, *said, ratios, noise, z, times = line.strip().removeprefix("| ").removesuffix(" |").split(" | ")
        verdict, _, said = " | ".join(said).partition(": ")
        found[name] = (verdict, said, ratios.strip(), noise.strip(), z.strip(), times)
    return found


def kind_of(said):
    return next((name for name, words in KINDS if re.search(words, said)), "something else")


def page(path, rows):
    """What the page says of all scenes."""
    verdicts = ["same", "differs", "refused", "neither", "Mitsuba refuses", "renders"]
    shown = [v for v in verdicts if any(r[1] == v for r in rows)]
    lines = ["| collection | scenes | " + " | ".join(shown) + " |", "|---|---" + "|---" * len(shown) + "|"]
    collections_ = sorted({r[0].split("/")[0] for r in rows})
    for name in [*collections_, "all"]:
        own = [r for r in rows if name in ("all", r[0].split("/")[0])]
        label = name if name == "all" else f"[{name}](https://github.com/{name.replace('+', '/', 1)})" if "+" in name else name
        lines.append(f"| {label} | {len(own)} | " + " | ".join(str(sum(r[1] == v for r in own)) for v in shown) + " |")
    reasons = {v: collections.Counter(kind_of(r[2]) for r in rows if r[1] == v) for v in ("refused", "neither")}
    lines += ["", "| what stops a scene | that Mitsuba renders | that Mitsuba refuses, too |", "|---|---|---|"]
    for kind in sorted({*reasons["refused"], *reasons["neither"]}, key=lambda k: (-reasons["refused"][k], -reasons["neither"][k])):
        lines.append(f"| {kind} | {reasons['refused'][kind] or ''} | {reasons['neither'][kind] or ''} |")
    head = path.read_text().split(MARKER)[0] if path.exists() else "# Census of public scenes\n\n"
    path.write_text(head + MARKER + "\n" + "\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description="Every scene of a folder, by both programs")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--venv", default="build/mitsuba", type=pathlib.Path)
    parser.add_argument("--spp", default=16, type=int)
    parser.add_argument("--width", default=96, type=int)
    parser.add_argument("--timeout", default=120, type=int, help="seconds per render of ours")
    parser.add_argument("--only", default="", help="scenes whose path has this in it")
    parser.add_argument("--table", type=pathlib.Path, help="a file for the rows")
    parser.add_argument("--resume", action="store_true", help="keep the rows of that file")
    parser.add_argument("--page", type=pathlib.Path, help="a page for the counts")
    o = parser.parse_args()
    census, rows, kept = Census(o), [], earlier(o.table) if o.resume else {}
    lines = ["| scene | ours | ratio of R, G, B | its error | z | seconds, ours and Mitsuba's |", "|---|---|---|---|---|---|"]
    place = pathlib.Path(tempfile.mkdtemp())
    try:
        for scene in list(copied(o.folder.resolve(), place, o.width, o.spp)):  # all of it before the first
            name = str(scene.relative_to(place))
            found = kept.get(name) or (census.row(scene) if o.only in name else None)
            if not found:
                continue
            verdict, said, *rest = found
            rows.append((name, verdict, said, *rest))
            short = said if len(said) < 400 else said[:300] + " ... " + said[-80:]
            lines.append(f"| {name} | {verdict}{': ' + short if said else ''} | ".replace("\n", " ") + " | ".join(rest) + " |")
            print(lines[-1], flush=True)
            if o.table:  # as it goes: a census takes its time
                o.table.write_text("\n".join(lines) + "\n")
    finally:
        if census.mitsuba:
            census.mitsuba.stop()
        shutil.rmtree(place)
    count = collections.Counter(r[1] for r in rows)
    print(", ".join(f"{n} {v}" for v, n in count.items()))
    if o.page:
        page(o.page, rows)
    sys.exit(1 if count["differs"] else 0)


if __name__ == "__main__":
    main()
