# SPDX-License-Identifier: Apache-2.0
"""Samplers and functions on disk, in pickles, in other processes."""

import concurrent.futures
import multiprocessing
import os
import pathlib
import pickle

import numpy as np
import pytest
from conftest import directions, ggx

import reflectree as rt

WO = directions(300)


def same(a, b):
    return all(np.array_equal(x, y) for x, y in zip(a.sample(WO, rng=1), b.sample(WO, rng=1)))


def test_save_and_load(gold, mine, tmp_path):
    gold.save(tmp_path / "gold.rfl")
    mine.save(str(tmp_path / "mine.rfl"))
    for loaded, made in ((rt.load_sampler(tmp_path / "gold.rfl"), gold),
                         (rt.load_sampler(tmp_path / "gold.rfl", gold.brdf), gold),
                         (rt.load_sampler(tmp_path / "mine.rfl", ggx), mine),
                         (rt.load_sampler(str(tmp_path / "mine.rfl"), mine.brdf), mine)):
        assert same(loaded, made) and loaded.report == made.report
        assert loaded.build_seconds is None and "built in" not in repr(loaded)


def test_pickles(gold, mine):
    for sampler in (gold, mine):
        again = pickle.loads(pickle.dumps(sampler))
        assert same(sampler, again) and same(sampler, pickle.loads(pickle.dumps(again)))
        assert np.array_equal(pickle.loads(pickle.dumps(sampler.brdf))(WO, WO[::-1]), sampler.brdf(WO, WO[::-1]))
    with pytest.raises(Exception, match="lambda"):
        pickle.dumps(rt.function(lambda wo, wi: wi[:, 2]))
    error = pickle.loads(pickle.dumps(rt.Error("what", "where", "how")))
    assert (error.what, error.where, error.how) == ("what", "where", "how")


def _mean(sampler):
    return float(sampler.sample(WO, rng=1).weight.mean())


def test_other_processes(gold, mine):
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        for sampler in (gold, mine):
            assert pool.submit(_mean, sampler).result() == _mean(sampler)


def test_samplers_of_the_command_line_and_of_python_are_one_format(gold, tmp_path):
    gold.save(tmp_path / "gold.rfl")
    assert (tmp_path / "gold.rfl").read_bytes() == gold._core.to_bytes()


@pytest.mark.skipif("REFLECTREE_DATA" not in os.environ, reason="REFLECTREE_DATA names no folder of measured files")
def test_measured_files():
    files = sorted(pathlib.Path(os.environ["REFLECTREE_DATA"]).rglob("*.bsdf"))[:1]
    assert files, "no .bsdf in REFLECTREE_DATA"
    f = rt.load(files[0])
    assert np.all(f(WO, WO[::-1]) >= 0) and rt.material(str(files[0])).name == f.name
    assert pickle.loads(pickle.dumps(f)).name == f.name
