# SPDX-License-Identifier: Apache-2.0
"""Figures show what they say; without matplotlib a sentence says what to install."""

import sys

import numpy as np
import pytest

import reflectree as rt

WO = rt.direction(0.6, 0.4)


@pytest.fixture
def plt():
    pyplot = pytest.importorskip("matplotlib.pyplot")
    yield pyplot
    pyplot.close("all")


def test_lobe(plt, gold, mine):
    for what in (gold, mine, "lambert", gold.brdf):
        line = rt.plot.lobe(what, WO).lines[0]
        assert len(line.get_xdata()) == 721
    theta, r = rt.plot.lobe(gold, WO, color="k").lines[0].get_data()
    assert abs(theta[np.argmax(r)] + 0.6) < 0.05  # the mirror direction, opposite to the viewer
    r = rt.plot.lobe("lambert:rho=0.5", WO, cosine=False).lines[0].get_ydata()
    assert np.allclose(r, 0.5 / np.pi)


def test_slices(plt, gold):
    ax = rt.plot.slices(gold, WO)
    assert [line.get_label() for line in ax.lines] == ["exact", "one-shot"]
    assert all(abs(np.degrees(-0.6) - x[np.argmax(y)]) < 3 for x, y in (line.get_data() for line in ax.lines))


def test_samples(plt, gold):
    ax = rt.plot.samples(gold, WO, 500)
    assert len(ax.collections[0].get_offsets()) == 500
    assert rt.plot.samples(gold, WO, mode="one-shot", ax=ax) is ax


def test_tree(plt, gold):
    for mode in ("exact", "one-shot"):
        shown = rt.plot.tree(gold, WO, mode=mode).collections[0]
        leaves = np.array(gold._core.leaves(mode == "one-shot", *map(float, WO)))
        assert len(shown.get_paths()) == len(leaves)
        assert np.isclose(leaves[:, 4].sum(), 1, atol=1e-4)  # shares of the mass
        assert np.isclose((leaves[:, 2] * leaves[:, 3]).sum(), 2, atol=1e-6)  # they cover the half square
    with pytest.raises(rt.Error, match="above the horizon"):
        rt.plot.tree(gold, [0, 0, -1])


def test_one_direction(gold):
    with pytest.raises(rt.Error, match="give one direction"):
        rt.plot.lobe(gold, [WO, WO])


def test_without_matplotlib(monkeypatch, gold):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(rt.Error, match="pip install matplotlib"):
        rt.plot.slices(gold, WO)
