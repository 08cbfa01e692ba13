# SPDX-License-Identifier: Apache-2.0
"""One sampler of all members of a family: right for each of them, refused in words where it is asked for none."""

import pickle

import numpy as np
import pytest
from conftest import directions
from test_statistics import LIMIT, cell_masses, cell_of, chi_square_score

import reflectree as rt

WO = rt.direction(0.9, 0.4)
N = 100_000


@pytest.fixture(scope="module")
def metals():
    return rt.FamilySampler("ggx:alpha=0.2..0.8,f0=1/0.8/0.3")


def member(alpha):
    return rt.material(f"ggx:alpha={alpha},f0=1/0.8/0.3")


def test_it_tells_what_it_is(metals):
    assert list(metals.ranges) == ["alpha"] and np.allclose(metals.ranges["alpha"], (0.2, 0.8))
    assert metals.channels == 3 and "alpha=0.2..0.8" in repr(metals)
    assert metals.report.expected_trials < 1.26 and not metals.report.notes
    assert 0 < metals.nbytes < 256 * 1024


@pytest.mark.parametrize("alpha", [0.2, 0.37, 0.8])
def test_density_of_a_member(metals, alpha):
    masses, albedo = cell_masses(member(alpha), WO)
    drawn = metals.sample(WO, N, alpha=alpha, rng=3)
    assert drawn.valid.all()
    counts = np.bincount(cell_of(drawn.wi, WO), minlength=len(masses))
    assert chi_square_score(counts, masses) < LIMIT
    # The twin: another member.
    assert chi_square_score(counts, cell_masses(member(1.15 * alpha if alpha < 0.8 else 0.7), WO)[0]) > LIMIT
    for weight in (drawn.weight, metals.sample_one_shot(WO, n=N, alpha=alpha, rng=4).weight):
        error = weight.std(axis=0) / np.sqrt(N) + 2e-4 * albedo
        assert np.all(np.abs(weight.mean(axis=0) - albedo) < LIMIT * error)
        assert np.any(np.abs(weight.mean(axis=0) - 1.01 * albedo) > LIMIT * error)


def test_every_direction_has_parameters_of_its_own(metals):
    wo, wi = directions(500, seed=1), directions(500, seed=2)
    alpha = np.random.default_rng(3).uniform(0.2, 0.8, 500)
    values = metals.eval(wo, wi, alpha=alpha)
    some = range(0, 500, 50)
    for k in some:
        one = metals.at(alpha=alpha[k])
        assert np.allclose(values[k], one.eval(wo[k], wi[k]), rtol=1e-5)
        for mode in ("exact", "one-shot"):
            assert np.isclose(metals.pdf(wo[k], wi[k], mode=mode, alpha=alpha[k]), one.pdf(wo[k], wi[k], mode=mode),
                              rtol=1e-4)
    drawn = metals.sample(wo, alpha=alpha, rng=4)
    assert drawn.valid.all()
    assert np.allclose(drawn.pdf, metals.pdf(wo, drawn.wi, alpha=alpha), rtol=1e-4)
    weight = metals.eval(wo, drawn.wi, cosine=True, alpha=alpha) / drawn.pdf[:, None]
    assert np.allclose(drawn.weight, weight, rtol=1e-4)
    # The twin: densities of a neighbour's parameters.
    assert not np.allclose(drawn.pdf, metals.pdf(wo, drawn.wi, alpha=np.roll(alpha, 1)), rtol=1e-2)


def test_shapes_types_and_seeds(metals):
    grid = metals.sample(WO, alpha=np.linspace(0.2, 0.8, 12).reshape(3, 4), rng=1)
    assert grid.wi.shape == (3, 4, 3) and grid.pdf.shape == (3, 4) and grid.weight.shape == (3, 4, 3)
    assert metals.sample(directions(5), 7, alpha=0.3).wi.shape == (5, 7, 3)
    single = metals.sample(WO.astype(np.float32), alpha=0.3, rng=1)
    assert single.wi.dtype == np.float32 and np.isscalar(single.pdf)
    a, b = (metals.sample(WO, 100, alpha=0.5, rng=9) for _ in range(2))
    assert np.array_equal(a.wi, b.wi)
    u = np.random.default_rng(1).random((64, 2))
    points = metals.sample_one_shot(WO, u, alpha=0.5)
    assert np.array_equal(points.wi, metals.sample_one_shot(WO, u, alpha=0.5).wi)
    assert np.allclose(points.wi, metals.at(alpha=0.5).sample_one_shot(WO, u).wi, atol=1e-5)
    assert np.isclose(metals.albedo(WO, alpha=0.5), metals.at(alpha=0.5).albedo(WO), rtol=1e-4)
    assert 1 <= metals.expected_trials(WO, alpha=0.5) < 1.26


def test_kept_and_found_again(metals, tmp_path):
    path = tmp_path / "metals.rfl"
    metals.save(path)
    for again in (rt.load_family(path), pickle.loads(pickle.dumps(metals))):
        assert again.ranges == metals.ranges
        assert np.array_equal(again.sample(WO, 50, alpha=0.3, rng=1).wi, metals.sample(WO, 50, alpha=0.3, rng=1).wi)
    with pytest.raises(rt.Error, match="a family.*load_family"):
        rt.load_sampler(path)
    one = metals.at(alpha=0.3)
    one.save(tmp_path / "one.rfl")
    assert np.array_equal(rt.load_sampler(tmp_path / "one.rfl").sample(WO, 50, rng=1).wi, one.sample(WO, 50, rng=1).wi)
    with pytest.raises(rt.Error, match="single material.*load_sampler"):
        rt.load_family(tmp_path / "one.rfl")


def test_bad_input(metals):
    with pytest.raises(rt.Error, match="no parameter has a range"):
        rt.FamilySampler("ggx:alpha=0.3")
    with pytest.raises(rt.Error, match="a function is no family"):
        rt.FamilySampler(lambda wo, wi: wo[:, 2])
    with pytest.raises(rt.Error, match="alpha is missing"):
        metals.sample(WO)
    with pytest.raises(rt.Error, match="no range of rough"):
        metals.sample(WO, alpha=0.3, rough=1)
    for bad in (0.19, 0.81, np.nan, np.inf, 1e300):
        with pytest.raises(rt.Error, match="outside of its range"):
            metals.pdf(WO, WO, alpha=bad)
    with pytest.raises(rt.Error, match=r"alpha\[1, 0\]"):
        metals.sample(WO, alpha=[[0.3], [5.0]])
    with pytest.raises(rt.Error, match="cannot be broadcast"):
        metals.sample(directions(5), alpha=[0.3, 0.4])
    with pytest.raises(rt.Error, match="one number for each"):
        metals.at(alpha=[0.3, 0.4])
    with pytest.raises(rt.Error):
        metals.sample([0, 0, 2.0], alpha=0.3)
