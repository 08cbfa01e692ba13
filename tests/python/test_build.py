# SPDX-License-Identifier: Apache-2.0
"""Builds: batches, threads, progress, interruption, memory that is given back."""

import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import warnings
import weakref

import numpy as np
import pytest
from conftest import directions, ggx

import reflectree as rt


def test_calls_come_in_batches():
    f = rt.function(ggx)
    sampler = rt.Sampler(f)
    calls, pairs = f.calls
    assert pairs / calls >= 1e4
    wo = directions(300_000)
    for draw in (lambda: sampler.sample(wo, rng=1), lambda: sampler.sample_one_shot(wo, rng=1),
                 lambda: sampler.sample_n(wo[0], 300_000, rng=1), lambda: sampler.pdf(wo, wo[0])):
        before = f.calls
        draw()
        assert (f.calls[1] - before[1]) / (f.calls[0] - before[0]) >= 1e4


def test_threads_do_not_matter():
    one, two = rt.Sampler("plastic", threads=1), rt.Sampler("plastic", threads=2)
    assert one._core.to_bytes() == two._core.to_bytes()


def test_the_samplers_are_those_of_cpp():
    """A function of one dtype and a material of the same formula get trees of the same size."""
    mine, theirs = rt.Sampler(lambda wo, wi: np.full((len(wo), 3), 0.25)), rt.Sampler("lambert:rho=0.78539816")
    assert mine._core.leaf_counts == theirs._core.leaf_counts
    assert np.allclose(mine.albedo(directions(20)), theirs.albedo(directions(20)), rtol=2e-4)


def test_targets():
    f = lambda wo, wi: np.stack([wi[:, 2], 1 - wi[:, 2]], axis=1) + 0.01  # noqa: E731
    wo = np.array([0, 0, 1.0])
    mean = [rt.Sampler(f, target=t).sample(wo, 20000, rng=1).wi[:, 2].mean() for t in (0, 1)]
    assert mean[0] > mean[1] + 0.1


def test_progress():
    told = []
    rt.Sampler(ggx, progress=lambda fraction, stage: told.append((fraction, stage)))
    fractions = [fraction for fraction, _ in told]
    assert fractions[-1] == 1 and all(0 <= f <= 1 for f in fractions)
    assert {"examining the function", "choosing the domain"} <= {stage for _, stage in told}

    class Enough(Exception):
        pass

    def stop(fraction, stage):
        if fraction > 0:
            raise Enough

    for material in (ggx, "ggx:alpha=0.1"):
        with pytest.raises(Enough):
            rt.Sampler(material, progress=stop)


def test_progress_by_tqdm(capfd):
    pytest.importorskip("tqdm")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of tqdm about notebooks
        rt.Sampler("lambert", progress=True)
    assert "100%" in capfd.readouterr().err


def test_progress_without_tqdm(monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(rt.Error, match="pip install tqdm"):
        rt.Sampler("lambert", progress=True)


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.parametrize("what", ["'ggx:alpha_x=0.05,alpha_y=0.4'", "slow"])
def test_ctrl_c_stops_a_build(what):
    """A process that would build for long is sent SIGINT once it says that it has begun."""
    program = textwrap.dedent(f"""
        import numpy as np, signal, sys, time
        import reflectree as rt

        signal.signal(signal.SIGINT, signal.default_int_handler)  # what a shell starts with & ignores it

        def slow(wo, wi):
            time.sleep(0.05)
            return np.exp(-40 * (wo[:, 0] - wi[:, 1]) ** 2) + wi[:, 2]

        print("ready", flush=True)
        try:
            while True:
                rt.Sampler({what})
        except KeyboardInterrupt:
            print("stopped", rt.Sampler("lambert").sample([0, 0, 1]).valid, flush=True)
    """)
    child = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline() == "ready\n"
        threading.Event().wait(0.4)
        child.send_signal(signal.SIGINT)
        assert child.communicate(timeout=120)[0] == "stopped True\n" and child.returncode == 0
    finally:
        child.kill()
        child.wait()
    child.stdout.close()


def test_a_build_that_cannot_keep_its_word_warns():
    with pytest.warns(rt.BuildWarning) as told:
        sampler = rt.Sampler("ggx:alpha=0.01", max_evaluations=1_000_000)
    assert [str(w.message) for w in told] == sampler.report.notes != []
    assert sampler.report.notes[0] in repr(sampler)


def test_many_threads_share_a_sampler(gold, mine):
    """Each thread gets what it would get alone."""
    wo = directions(3000)
    for sampler in (gold, mine):
        alone = [sampler.sample(wo, rng=seed).wi for seed in range(8)]
        found = [None] * 8

        def work(seed, sampler=sampler, found=found):
            found[seed] = sampler.sample(wo, rng=seed).wi

        threads = [threading.Thread(target=work, args=(seed,)) for seed in range(8)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        assert all(np.array_equal(a, b) for a, b in zip(alone, found))


def test_two_builds_at_once():
    built = {}
    threads = [threading.Thread(target=lambda k=k, f=f: built.__setitem__(k, rt.Sampler(f)))
               for k, f in enumerate((ggx, "plastic", ggx))]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert built[0]._core.to_bytes() == built[2]._core.to_bytes() == rt.Sampler(ggx)._core.to_bytes()


def test_nothing_is_kept():
    """Functions that refer to their own sampler are collected; calls leave nothing behind."""

    class Model:
        def __init__(self):
            self.sampler = rt.Sampler(self.f)

        def f(self, wo, wi):
            return wi[:, 2] + 0.1

    gone = weakref.ref(Model())
    gc.collect()
    assert gone() is None


def test_no_leak_in_many_calls(gold):
    resource = pytest.importorskip("resource")
    sampler = rt.Sampler(lambda wo, wi: wi[:, 2] + 0.1)
    wo, bad = np.array([0, 0, 1.0]), np.array([0, 0, 2.0])

    def calls(n):
        for _ in range(n):
            gold.sample(wo, rng=1)
            sampler.pdf(wo, wo)
            try:
                gold.albedo(bad)
            except rt.Error:
                pass

    calls(2000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    calls(10_000)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2000  # KiB: below 100 bytes a call


def test_what_a_sampler_tells(gold):
    for text in (repr(gold), gold._repr_html_()):
        for part in ("ggx:alpha=0.2,f0=1/0.8/0.3", "isotropic", "leaves", "KiB", "trials", "one-shot"):
            assert part in text
    assert gold.isotropic and gold.nbytes > 1000 and gold.build_seconds > 0
    assert 1 <= gold.report.expected_trials <= 1.26 and gold.report.notes == []
    assert gold.report.evaluations > 1e5
