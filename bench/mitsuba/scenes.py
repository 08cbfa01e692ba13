#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The small scenes of tests/scenes/words, which use every word that we read, by both programs.

    bench/mitsuba/scenes.py [--reflectree build/bin/reflectree] [--venv build/mitsuba] [--only TEXT] [--spp 1024] [--store]

A row per scene: the ratio of the means of red, green and blue, ours over Mitsuba's, with their standard error, and the
largest z-score of a block. --store keeps Mitsuba's numbers, means over 4 x 4 blocks with standard errors, in
tests/scenes/words.json for the test. Exits with 1 where a scene disagrees.
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
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tests" / "scenes")]

from beside_mitsuba import mitsuba_python  # noqa: E402
from words_judge import SLACK, differs, key, load, means, numbers_of, render, scenes, score, scores, seed_of, store  # noqa: E402

RUNS = 8


class Mitsuba:
    def __init__(self, python):
        self.process = subprocess.Popen([python, HERE / "words_worker.py"], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.process.stdout.readline()

    def render(self, scene, spp):
        seeds = [RUNS * seed_of(scene) + i for i in range(RUNS)]
        print(json.dumps({"scene": str(scene), "spp": spp, "seeds": seeds}), file=self.process.stdin, flush=True)
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer:
            sys.exit(f"Mitsuba refuses {scene.name}: {answer['error']}")
        runs = [[m for m, _ in numbers_of(p)] for p in answer["pictures"]]
        if not all(math.isfinite(m) for run in runs for m in run):
            sys.exit(f"Mitsuba's picture of {scene.name} has values that are not finite")
        return [(statistics.mean(v), statistics.stdev(v) / math.sqrt(len(v))) for v in zip(*runs)]


def row(scene, ours, theirs):
    n = len(ours) // 3
    ratios = [x / y if y else math.nan for x, y in zip(means(ours), means(theirs))]
    noise = math.sqrt(sum(e * e for m, e in [*ours[n:2 * n], *theirs[n:2 * n]])) / n / max(means(theirs)[1], 1e-9)
    worst = max(abs(score(x, y, SLACK)) for x, y in zip(ours, theirs))
    return f"{scene.stem:20}" + " ".join(f"{r:.4f}" for r in ratios) + f" +- {noise:.4f}  {worst:4.1f}"


def main():
    parser = argparse.ArgumentParser(description="The scenes of tests/scenes/words, by both programs")
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--venv", default="build/mitsuba", type=pathlib.Path)
    parser.add_argument("--only", default="", help="scenes whose name has this in it")
    parser.add_argument("--spp", default=1024, type=int, help="of Mitsuba's, for each of eight seeds")
    parser.add_argument("--store", action="store_true")
    o = parser.parse_args()
    mitsuba, stored, kept, wrong, all_scores = None, load(), {}, 0, []
    for scene in scenes():
        if o.only not in scene.stem:
            if key(scene) in stored:
                kept[key(scene)] = stored[key(scene)]
            continue
        if o.store or key(scene) not in stored:
            mitsuba = mitsuba or Mitsuba(mitsuba_python(o.venv.resolve()))
            stored[key(scene)] = mitsuba.render(scene, o.spp)
        theirs = kept[key(scene)] = stored[key(scene)]
        with tempfile.TemporaryDirectory() as folder:
            ours, said = render(o.reflectree.resolve(), scene, pathlib.Path(folder) / "out.exr")
        faults = differs(ours, theirs) if ours else [said.strip()]
        wrong += bool(faults)
        all_scores += scores(ours, theirs) if ours else []
        print((row(scene, ours, theirs) if ours else f"{scene.stem:20}") + "  " + "; ".join(faults or ["same"]), flush=True)
    if o.store:
        store(kept)
    if len(all_scores) > 1:
        print(f"{len(all_scores)} z-scores of blocks: mean {statistics.mean(all_scores):.3f}, "
              f"standard deviation {statistics.stdev(all_scores):.3f}, largest {max(map(abs, all_scores)):.2f}")
    print(f"{wrong} scenes disagree")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
