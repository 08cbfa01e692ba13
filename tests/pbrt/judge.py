#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compiles judge.cpp as pbrt's own build compiled its files, links it with that build's libraries, and runs it.

    judge.py PBRT_SOURCE PBRT_BUILD BINDINGS LIBRARY SCRATCH [--fault]

PBRT_SOURCE: a checkout of pbrt-v4 that bindings/pbrt/register.py has edited; PBRT_BUILD: where it was built.
BINDINGS: the folder of c/ and pbrt/, whose headers are judged; LIBRARY: libreflectree_c.so. With --fault the judge must
reject.
"""

import json
import pathlib
import shlex
import subprocess
import sys


def compile_words(build, bindings, judge, source, output, fault):
    """The command that compiled bxdfs.cpp, for another file."""
    commands = json.loads((build / "compile_commands.json").read_text())
    for entry in commands:
        if entry["file"].endswith("src/pbrt/bxdfs.cpp"):
            words = shlex.split(entry["command"])
            break
    else:
        raise SystemExit(f"judge.py: {build}/compile_commands.json does not name bxdfs.cpp: configure pbrt with "
                         "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON")
    kept, skip = [], False
    for word in words:
        if skip or word in ("-c", entry["file"]):
            skip = False
        elif word in ("-o", "-MT", "-MF"):
            skip = True
        elif word != "-MD":
            kept.append(word)
    kept[1:1] = [f"-I{bindings / 'pbrt'}", f"-I{bindings / 'c'}"]  # before those that pbrt was built with
    flags = [f'-DPBRT_JUDGE="{judge}"'] + (["-DREFLECTREE_PBRT_FAULT"] if fault else [])
    return kept + flags + ["-c", str(source), "-o", str(output)], pathlib.Path(entry["directory"])


def call(words, **options):
    """Runs it and returns what it printed, or ends with the words that failed."""
    ran = subprocess.run(words, check=False, **options)
    if ran.returncode:
        raise SystemExit(f"judge.py: failed: {shlex.join(map(str, words))}")
    return ran.stdout


def main(source, build, bindings, library, scratch, *options):
    source, build, bindings, library, scratch = (pathlib.Path(p).resolve()
                                                 for p in (source, build, bindings, library, scratch))
    fault = "--fault" in options
    if not (build / "compile_commands.json").is_file():
        print(f"skipped: {build} has no compile_commands.json: build pbrt there, and set PBRT_BUILD")
        return 0
    if "ReflectreeBxDF" not in (source / "src/pbrt/base/bxdf.h").read_text():
        print(f"judge.py: {source} is not registered: run bindings/pbrt/register.py and build it again")
        return 1
    scratch.mkdir(parents=True, exist_ok=True)
    program = scratch / ("judge_fault" if fault else "judge")
    words, folder = compile_words(build, bindings, source / "src/pbrt/bsdfs_test.cpp",
                                  pathlib.Path(__file__).with_name("judge.cpp"), program.with_suffix(".o"), fault)
    call(words, cwd=folder)
    archives = sorted(str(p) for p in build.rglob("*.a") if "gtest" not in p.name and "gmock" not in p.name)
    flags = call(["pkg-config", "--libs", "OpenEXR", "zlib"], stdout=subprocess.PIPE, text=True).split()
    call(["c++", program.with_suffix(".o"), "-Wl,--start-group", *archives, "-Wl,--end-group", library,
          f"-Wl,-rpath,{library.parent}", *flags, "-ldl", "-pthread", "-o", program])
    ran = subprocess.run([program], cwd=scratch, check=False)
    if fault:
        print("rejected" if ran.returncode else "the planted fault was NOT noticed")
        return 0 if ran.returncode else 1
    return ran.returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
