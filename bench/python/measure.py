#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the Python package costs: builds of NumPy functions, sampling beside C++, memory, threads.

Usage: PYTHONPATH=build/python measure.py. Sampling is in CPU time of the thread, the
least of some runs; builds are in CPU time and by the clock. Run it on a machine that does nothing else.
"""

import os
import platform
import resource
import threading
import time
import tracemalloc

import numpy as np

import reflectree as rt

N = 1_000_000


def ggx(wo, wi, alpha_x=0.1, alpha_y=0.1, f0=0.04):
    """Height-correlated GGX (Heitz 2014) with Schlick's Fresnel; one function serves both shapes."""
    wh = wo + wi
    wh /= np.sqrt(np.einsum("ij,ij->i", wh, wh))[:, None]
    sx, sy = wh[:, 0] / alpha_x, wh[:, 1] / alpha_y
    d = 1 / (np.pi * alpha_x * alpha_y * (sx * sx + sy * sy + wh[:, 2] ** 2) ** 2)

    def stretched(w):
        return np.sqrt((alpha_x * w[:, 0]) ** 2 + (alpha_y * w[:, 1]) ** 2 + w[:, 2] ** 2)

    v = 0.5 / (wi[:, 2] * stretched(wo) + wo[:, 2] * stretched(wi))
    return d * v * (f0 + (1 - f0) * (1 - np.einsum("ij,ij->i", wo, wh)) ** 5)


def line(text, *figures):
    print(f"| {text} | " + " | ".join(figures) + " |", flush=True)


def builds():
    print("\n| build | clock | CPU | evaluations | pairs per call |\n|---|---:|---:|---:|---:|")
    for name, f in (("GGX 0.1, a lambda", lambda wo, wi: ggx(wo, wi)),
                    ("the same in float32", rt.function(ggx, dtype=np.float32)),
                    ("GGX 0.1 × 0.3", lambda wo, wi: ggx(wo, wi, 0.1, 0.3))):
        f = f if isinstance(f, rt.Brdf) else rt.function(f)
        clock, cpu = time.perf_counter(), time.process_time()
        rt.Sampler(f)
        clock, cpu = time.perf_counter() - clock, time.process_time() - cpu
        calls, pairs = f.calls
        line(name, f"{clock:.2f} s", f"{cpu:.2f} s", f"{pairs / 1e6:.1f} M", f"{pairs / calls:.0f}")


def least(work, runs=5, clock=time.thread_time):
    best = np.inf
    for _ in range(runs):
        start = clock()
        work()
        best = min(best, clock() - start)
    return best


def viewers(dtype):
    rng = np.random.default_rng(1)
    return rt.direction(np.arccos(rng.uniform(0.05, 1, N)), rng.uniform(0, 2 * np.pi, N)).astype(dtype)


def rates():
    print("\n| 10⁶ directions | ns per direction, float32 | float64 |\n|---|---:|---:|")
    material, mine = rt.Sampler("ggx:alpha=0.1"), rt.Sampler(ggx)
    for name, call in (
            ("material, exact", lambda wo, u, out: material.sample(wo, rng=1, out=out)),
            ("material, one-shot by alias table", lambda wo, u, out: material.sample_one_shot(wo, rng=1, out=out)),
            ("material, one-shot from uniforms", lambda wo, u, out: material.sample_one_shot(wo, u, out=out)),
            ("material, exact pdf", lambda wo, u, out: material.pdf(wo, out.wi, out=out.pdf)),
            ("NumPy function, exact", lambda wo, u, out: mine.sample(wo, rng=1)),
            ("NumPy function, one-shot by alias table", lambda wo, u, out: mine.sample_one_shot(wo, rng=1))):
        figures = []
        for dtype in (np.float32, np.float64):
            wo, u = viewers(dtype), np.random.default_rng(2).random((N, 2)).astype(dtype)
            out = material.sample(wo, rng=1)
            figures.append(f"{least(lambda: call(wo, u, out)) / N * 1e9:.1f}")
        line(name, *figures)


def memory():
    """What a call allocates besides its result, and what stays."""
    print("\n| 10⁶ directions, float64 | MiB |\n|---|---:|")
    sampler, wo = rt.Sampler("ggx:alpha=0.1"), viewers(np.float64)
    out = sampler.sample(wo, rng=1)
    line("result, four arrays", f"{sum(a.nbytes for a in out) / 2**20:.1f}")
    strided = np.zeros((N, 2, 3))
    strided[:, 0] = wo
    for name, call in (("allocated by NumPy, with `out=`", lambda: sampler.sample(wo, rng=1, out=out)),
                       ("the same, `wo` with strides", lambda: sampler.sample(strided[:, 0], rng=1, out=out))):
        tracemalloc.start()
        call()
        line(name, f"{tracemalloc.get_traced_memory()[1] / 2**20:.3f}")
        tracemalloc.stop()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    sampler.sample(wo, rng=1, out=out)
    sampler.pdf(wo, out.wi, out=out.pdf)
    line("growth of the process's peak by a call with `out=`",
         f"{(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024:.2f}")


def threads():
    """Two threads beside one, by the clock, alternating; the median of the ratios."""
    sampler, wo = rt.Sampler("ggx:alpha=0.1"), viewers(np.float32)
    out = [sampler.sample(wo, rng=k) for k in range(2)]
    ratios = []
    for _ in range(15):
        alone = least(lambda: sampler.sample(wo, rng=1, out=out[0]), 1, time.perf_counter)

        def both():
            started = [threading.Thread(target=sampler.sample, args=(wo,), kwargs={"rng": k, "out": out[k]})
                       for k in range(2)]
            for t in started:
                t.start()
            for t in started:
                t.join()

        ratios.append(2 * alone / least(both, 1, time.perf_counter))
    print(f"\nTwo threads sample {np.median(ratios):.2f} times as fast as one (quartiles "
          f"{np.quantile(ratios, 0.25):.2f} and {np.quantile(ratios, 0.75):.2f}).")


print(f"Python {platform.python_version()}, NumPy {np.__version__}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
builds()
rates()
memory()
threads()
