# SPDX-License-Identifier: Apache-2.0
"""Renders with one Mitsuba variant what lines of JSON on the standard input ask for; answers in kind.

For beside_mitsuba.py, which runs it in an environment that has Mitsuba."""

import ctypes.util
import glob
import json
import os
import sys
import time


def newest_llvm():
    """LLVM's library, the newest; drjit's own search takes the oldest."""
    found = glob.glob("/usr/lib/*/libLLVM.so.*") + glob.glob("/usr/lib/*/libLLVM-*.so.1")
    number = lambda path: int("".join(c if c.isdigit() else " " for c in os.path.basename(path)).split()[0])
    modern = [path for path in found if number(path) >= 16]
    return max(modern, key=number) if modern else ctypes.util.find_library("LLVM")


def answer(**what):
    print(json.dumps(what), flush=True)


def main(variant, threads):
    if variant.startswith("llvm") and newest_llvm():
        os.environ.setdefault("DRJIT_LIBLLVM_PATH", newest_llvm())
    try:
        import drjit
        import mitsuba as mi

        mi.set_variant(variant)
    except Exception as error:  # whatever it is, the caller is told
        answer(error=str(error))
        return
    drjit.set_thread_count(threads)
    mi.set_log_level(mi.LogLevel.Error)
    answer(ready=variant)
    scenes = {}
    for line in sys.stdin:
        request = json.loads(line)
        path, spp, seed = request["scene"], request["spp"], request["seed"]

        def render(s):
            picture = mi.render(scenes[path], spp=spp, seed=s)
            drjit.eval(picture)
            drjit.sync_thread()
            return picture

        if path not in scenes:
            scenes[path] = mi.load_file(path)
            render(seed + 1)  # compiles the kernels
        start = time.process_time()
        picture = render(seed)
        seconds = time.process_time() - start
        mi.Bitmap(picture).convert(mi.Bitmap.PixelFormat.RGB).write(request["out"])
        answer(seconds=seconds, pixels=int(picture.shape[0] * picture.shape[1]))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
