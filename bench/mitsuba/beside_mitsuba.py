#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Our path tracer beside Mitsuba 3's: the same scenes at the same depth, in one run, on the same threads.

    REFLECTREE_DATA=... bench/mitsuba/beside_mitsuba.py [--reflectree build/bin/reflectree] [--spp 32]

Speed is paths per second of processor time (all threads; user and system), so that what else the machine does
cancels; the time of loading a scene and of compiling kernels is left out: ours is the difference of two renders,
Mitsuba's is that of a render after a first one. The programs take turns, and medians are shown. Equal time is
equal processor time: relMSE times the time it took, since it falls as one over the number of samples.

Mitsuba is the wheel of the package index, put into a virtual environment (--venv) if it is not there. Exits with
3 where it cannot be had, 1 where a limit is missed, 2 for wrong arguments.
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import venv

WHEEL = "mitsuba==3.9.1"
HERE = pathlib.Path(__file__).resolve().parent
SCENES = ["cbox_spectral", "balls_ggx", "balls_measured", "veach_mis", "lights_and_materials"]
JUDGED = "balls_measured"  # by relMSE too


def stop(message, code):
    print(f"\nbeside_mitsuba: {message}\n", file=sys.stderr)
    sys.exit(code)


def mitsuba_python(folder):
    """The interpreter of a virtual environment that has the wheel."""
    python = folder / "bin" / "python"
    if not python.exists():
        venv.create(folder, with_pip=True)
    check = [python, "-c", "import mitsuba"]
    if subprocess.run(check, capture_output=True).returncode == 0:
        return python
    done = subprocess.run([python, "-m", "pip", "install", "--quiet", WHEEL, "numpy"])
    if done.returncode != 0 or subprocess.run(check).returncode != 0:
        stop(f"NOT MEASURED: the wheel {WHEEL} is not there and cannot be installed", 3)
    return python


class Mitsuba:
    """A worker process that holds one variant; scenes stay loaded, kernels compiled."""

    def __init__(self, python, variant, threads):
        command = [python, HERE / "mitsuba_worker.py", variant, str(threads)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.ready = "error" not in self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        return json.loads(line) if line else {"error": "the worker ended"}

    def render(self, scene, spp, seed, out):
        request = {"scene": str(scene), "spp": spp, "seed": seed, "out": str(out)}
        print(json.dumps(request), file=self.process.stdin, flush=True)
        answer = self.answer()
        if "error" in answer:
            stop(f"Mitsuba: {answer['error']}", 3)
        return answer["seconds"], answer["pixels"]


def our_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Ours:
    ready = True

    def __init__(self, program, threads):
        self.program, self.threads = program, threads

    def render(self, scene, spp, seed, out):
        def command(samples):
            return [self.program, "--threads", str(self.threads), "--seed", str(seed), "render", scene, "-o", out,
                    "--spp", str(samples)]

        loading = our_seconds(command(1))
        return (our_seconds(command(spp + 1)) - loading), None


def relative_mse(program, picture, reference):
    done = subprocess.run([program, "--json", "image-compare", picture, reference], check=True, capture_output=True)
    found = json.loads(done.stdout)
    return statistics.mean(c["relative_mse"] for c in found["channels"])


def measure(program, renderers, scenes, spp, repeats, data, folder):
    """{scene: {renderer: (paths per second, relMSE times seconds)}}"""
    table = {}
    for name in scenes:
        scene, reference = data / "scenes" / f"{name}.mitsuba.xml", data / "reference" / f"{name}.exr"
        runs = {r: [] for r in renderers}
        pixels = None
        for turn in range(repeats):
            for r, renderer in renderers.items():
                out = folder / f"{r}.exr"
                seconds, found = renderer.render(scene, spp, 7001 + turn, out)
                pixels = found or pixels
                runs[r].append((seconds, relative_mse(program, out, reference) * seconds))
        table[name] = {r: (pixels * spp / statistics.median(s for s, _ in v), statistics.mean(e for _, e in v))
                       for r, v in runs.items()}
        row = table[name]
        ours, ours_error = row["reflectree"]
        text = f"{name:22}{ours / 1e6:8.3f}"
        for r in row:
            if r != "reflectree":
                text += f"   {r} {row[r][0] / 1e6:7.3f} ({ours / row[r][0]:5.2f}x, relMSE {ours_error / row[r][1]:5.2f}x)"
        print(text, flush=True)
    return table


def missed(table):
    """The limits that are not kept, as sentences."""
    said = []
    for name, row in table.items():
        ours, error = row["reflectree"]
        if "scalar_rgb" in row and ours < 2 * row["scalar_rgb"][0]:
            said.append(f"{name}: fewer than twice the paths of scalar_rgb")
        if name != JUDGED:
            continue
        if "llvm_ad_rgb" in row and ours < row["llvm_ad_rgb"][0]:
            said.append(f"{name}: fewer paths than llvm_ad_rgb")
        if "scalar_rgb" in row and error > row["scalar_rgb"][1] / 2:
            said.append(f"{name}: relMSE at equal time above half of scalar_rgb's")
    return said


def main():
    parser = argparse.ArgumentParser(description="Our path tracer beside Mitsuba 3's")
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--data", default=os.environ.get("REFLECTREE_DATA"), type=pathlib.Path)
    parser.add_argument("--venv", default="build/mitsuba", type=pathlib.Path)
    parser.add_argument("--spp", default=32, type=int)
    parser.add_argument("--repeats", default=3, type=int)
    parser.add_argument("--threads", default=2, type=int)
    parser.add_argument("--scenes", default=",".join(SCENES))
    o = parser.parse_args()
    if o.data is None or not (o.data / "scenes").is_dir():
        stop("name the data: --data or REFLECTREE_DATA", 2)
    if not o.reflectree.exists():
        stop(f"no program {o.reflectree}: build it, or name it by --reflectree", 2)
    program, python = o.reflectree.resolve(), mitsuba_python(o.venv.resolve())
    renderers = {"reflectree": Ours(program, o.threads)}
    for variant in ["scalar_rgb", "llvm_ad_rgb"]:
        renderers[variant] = Mitsuba(python, variant, o.threads)
    lacking = [r for r in renderers if not renderers[r].ready]
    for r in lacking:
        print(f"NOT MEASURED: {r} (LLVM 16 or later, named by DRJIT_LIBLLVM_PATH if it is not found)", file=sys.stderr)
        del renderers[r]
    print(f"{o.spp} samples per pixel, {o.threads} threads, medians of {o.repeats}; million paths per second of one core;"
          " in brackets ours over theirs, and our relMSE over theirs at equal time")
    with tempfile.TemporaryDirectory() as folder:
        table = measure(program, renderers, o.scenes.split(","), o.spp, o.repeats, o.data.resolve(), pathlib.Path(folder))
    said = missed(table)
    for sentence in said:
        print(f"MISSED: {sentence}")
    sys.exit(3 if lacking else 1 if said else 0)


if __name__ == "__main__":
    main()
