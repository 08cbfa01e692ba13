# SPDX-License-Identifier: Apache-2.0
"""Nothing is kept: 10^5 calls of each kind leave the process as large as it was, to less than ten bytes per call."""

import os
import pathlib

import numpy as np
import pytest

import reflectree as rt

STATM = pathlib.Path("/proc/self/statm")
CALLS = 100_000
ROOM = 10 * CALLS  # bytes
UP = np.array([0.0, 0.0, 1.0], np.float32)
WO = np.array([[0.6, 0.0, 0.8], [0.0, 0.0, 1.0]], np.float32)

pytestmark = pytest.mark.skipif(not STATM.exists(), reason="memory is read from Linux's /proc")


def growth(call):
    """Bytes by which the process grows over CALLS calls, once it has warmed up."""
    def resident():
        return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    for _ in range(CALLS // 10):
        call()
    before = resident()
    for _ in range(CALLS):
        call()
    return resident() - before


def refused(gold):
    try:
        gold.sample([0, 0, 2])
    except rt.Error:
        return
    raise AssertionError("accepted")


@pytest.mark.parametrize("kind", ["sample", "sample_one_shot", "pdf", "eval", "a material of its own", "an error"])
def test_nothing_is_kept(gold, kind):
    rng = np.random.default_rng(1)
    calls = {
        "sample": lambda: gold.sample(WO, rng=rng),
        "sample_one_shot": lambda: gold.sample_one_shot(WO, np.full((2, 2), 0.3)),
        "pdf": lambda: gold.pdf(WO, UP),
        "eval": lambda: gold.eval(WO, UP),
        "a material of its own": lambda: rt.material("lambert:rho=0.5").eval(WO, UP),
        "an error": lambda: refused(gold),
    }
    assert growth(calls[kind]) < ROOM


def test_nothing_is_kept_of_what_a_function_returns(mine):
    assert growth(lambda: mine.eval(WO, UP)) < ROOM


def test_twin_what_is_kept_is_seen(gold):
    kept = []
    assert growth(lambda: kept.append(gold.pdf(WO, UP))) > ROOM
