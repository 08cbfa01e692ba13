#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the Python package costs: builds of NumPy functions, sampling, memory, threads, judges.

Usage: PYTHONPATH=build/python measure.py [PART...], of builds, rates, memory, threads, judges. Sampling is in CPU time of
the thread, the least of some runs; builds and judges are in CPU time and by the clock. Best on a machine that does
nothing else; on a shared one the clock tells little, and ratios of CPU times something.
"""

import os
import platform
import resource
import sys
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


def kernel_times():
    """Nanoseconds that this thread has run, and that it has waited for a core; Linux alone."""
    with open("/proc/thread-self/schedstat") as file:
        ran, waited, _ = file.read().split()
    return int(ran), int(waited)


def observed(work):
    """Seconds by the clock, on a core, waiting for a core; what is left was spent blocked."""
    clock, (ran, waited) = time.perf_counter_ns(), kernel_times()
    work()
    now = kernel_times()
    return np.array([time.perf_counter_ns() - clock, now[0] - ran, now[1] - waited]) * 1e-9


def threads():
    """Two threads beside one, alternating. On a machine that others use, the clock tells what they left of it; but the
    kernel knows for how long each thread ran, waited for a core, or was blocked by a lock or the GIL. With two cores
    free nobody waits for one, and the pair takes as long as the slower of them runs and is blocked."""
    repeats, rounds = 4, 11
    print(f"\n| two threads beside one, {repeats} × 10⁶ directions each | by the clock | with two cores free | blocked |")
    print("|---|---:|---:|---:|")
    material, wo = rt.Sampler("ggx:alpha=0.1"), viewers(np.float32)
    u = np.random.default_rng(2).random((N, 2)).astype(np.float32)
    out = [material.sample(wo, rng=k) for k in range(2)]
    for name, call in (("exact", lambda k: material.sample(wo, rng=k, out=out[k])),
                       ("one-shot by alias table", lambda k: material.sample_one_shot(wo, rng=k, out=out[k])),
                       ("one-shot from uniforms", lambda k: material.sample_one_shot(wo, u, out=out[k])),
                       ("exact pdf", lambda k: material.pdf(wo, wo, out=out[k].pdf))):
        by_clock, by_kernel, blocked = [], [], []

        def repeated(k):
            for _ in range(repeats):
                call(k)

        for _ in range(rounds):
            alone = observed(lambda: repeated(0))
            pair, barrier = [None, None], threading.Barrier(2)

            def work(k):
                barrier.wait()
                pair[k] = observed(lambda: repeated(k))

            started = [threading.Thread(target=work, args=(k,)) for k in range(2)]
            for t in started:
                t.start()
            for t in started:
                t.join()
            by_clock.append(2 * alone[0] / max(p[0] for p in pair))
            by_kernel.append(2 * alone[1] / max(p[0] - p[2] for p in pair))
            blocked.append(max((p[0] - p[1] - p[2]) / (p[0] - p[2]) for p in pair))
        line(name, *("{:.2f} ({:.2f} to {:.2f})".format(*np.quantile(x, (0.5, 0.25, 0.75))) for x in (by_clock, by_kernel)),
             f"{100 * np.median(blocked):.1f} %")
    print(f"Medians of {rounds}, with quartiles; blocked: the share of a thread's time, waits for a core left out.")


def judges():
    """What verdicts cost, and how many pairs of directions a function is given at once."""
    print("\n| judge | clock | CPU | pairs per call |\n|---|---:|---:|---:|")

    def measured(name, work, calls=lambda result: None):
        clock, cpu = time.perf_counter(), time.process_time()
        result = work()
        clock, cpu = time.perf_counter() - clock, time.process_time() - cpu
        count = calls(result)
        line(name, f"{clock:.1f} s", f"{cpu:.1f} s", f"{count[1] / count[0]:.0f}" if count else "")

    material, mine = rt.Sampler("ggx:alpha=0.1"), rt.Sampler(ggx)

    def draw(wo, rng):
        s = mine.sample_one_shot(wo, rng=rng)
        return s.wi, s.pdf, s.weight, s.valid

    def density(wo, wi):
        return mine.pdf(wo, wi, mode="one-shot")

    measured("`rt.doctor`, a material's exact mode", lambda: rt.doctor(material))
    measured("`rt.doctor`, three functions of NumPy", lambda: rt.doctor(eval=ggx, sample=draw, pdf=density),
             lambda d: (d.calls, d.directions))
    measured("`rt.verify`, a material, effort 1", lambda: rt.verify(material))
    before = mine.brdf.calls
    measured("`rt.verify`, a NumPy function, effort 0.1", lambda: rt.verify(mine, effort=0.1),
             lambda _: tuple(np.subtract(mine.brdf.calls, before)))


print(f"Python {platform.python_version()}, NumPy {np.__version__}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
PARTS = {part.__name__: part for part in (builds, rates, memory, threads, judges)}
for part in sys.argv[1:] or PARTS:
    if part not in PARTS:
        sys.exit(f"no part '{part}'; choose of {', '.join(PARTS)}")
    PARTS[part]()
