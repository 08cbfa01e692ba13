# SPDX-License-Identifier: Apache-2.0
"""One sampler of all members of a family: right for each of them, refused in words where it is asked for none."""

import pickle

import numpy as np
import numpy_drjit
import pytest
from conftest import directions, ggx
from test_statistics import LIMIT, cell_masses, cell_of, chi_square_score

import reflectree as rt
from reflectree._drjit import DrJitSampler

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
    with pytest.raises(rt.Error, match="a float is no family"):
        rt.FamilySampler(0.3)
    with pytest.raises(rt.Error, match="ranges inside"):
        rt.FamilySampler("ggx:alpha=0.2..0.8", alpha=(0.2, 0.8))
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


# Functions of NumPy.


def haze(wo, wi, alpha):
    """A function of a module, so that it can be pickled."""
    return ggx(wo, wi, alpha=alpha)


@pytest.fixture(scope="module")
def hazes():
    return rt.FamilySampler(haze, alpha=(0.2, 0.8), dtype=np.float32, expected_trials=1.5, one_shot_variance=0.05,
                            albedo_error=1e-3)  # quick to build


def test_a_function_is_told_its_parameters(hazes):
    assert hazes.name == "haze" and list(hazes.ranges) == ["alpha"] and hazes.value_shape == ()
    assert hazes.report.expected_trials < 1.51 and not hazes.report.notes
    wo, wi = directions(500, seed=1), directions(500, seed=2)
    alpha = np.random.default_rng(3).uniform(0.2, 0.8, 500)
    expected = haze(wo, wi, alpha)
    assert np.allclose(hazes.eval(wo, wi, alpha=alpha), expected, rtol=1e-3)
    assert np.allclose(hazes.eval(wo, wi, alpha=alpha, cosine=True), expected * wi[:, 2], rtol=1e-3)
    assert not np.allclose(hazes.eval(wo, wi, alpha=np.roll(alpha, 1)), expected, rtol=1e-1)  # the twin
    assert not np.any(hazes.eval(wo, wi * [1, 1, -1], alpha=alpha))
    for k in range(0, 500, 100):
        one = hazes.at(alpha=alpha[k])
        assert one.brdf.name == f"haze at alpha = {alpha[k]:g}"
        for mode in ("exact", "one-shot"):
            assert np.isclose(hazes.pdf(wo[k], wi[k], mode=mode, alpha=alpha[k]), one.pdf(wo[k], wi[k], mode=mode),
                              rtol=1e-4)


@pytest.mark.parametrize("alpha", [0.2, 0.37, 0.8])
def test_density_of_a_functions_member(hazes, alpha):
    def masses(a):
        return cell_masses(rt.function(lambda wo, wi: haze(wo, wi, a)), WO)

    expected, albedo = masses(alpha)
    drawn = hazes.sample(WO, N, alpha=alpha, rng=3)
    assert drawn.valid.all() and drawn.weight.shape == (N,)
    counts = np.bincount(cell_of(drawn.wi, WO), minlength=len(expected))
    assert chi_square_score(counts, expected) < LIMIT
    assert chi_square_score(counts, masses(1.15 * alpha if alpha < 0.8 else 0.7)[0]) > LIMIT  # the twin
    u = np.random.default_rng(5).random((N, 2))
    for weight in (drawn.weight, hazes.sample_one_shot(WO, n=N, alpha=alpha, rng=4).weight,
                   hazes.sample_one_shot(WO, u, alpha=alpha).weight):
        error = weight.std() / np.sqrt(N) + 2e-3 * albedo
        assert abs(weight.mean() - albedo) < LIMIT * error
        assert abs(weight.mean() - 1.02 * albedo) > LIMIT * error


def test_samples_of_many_members_of_a_function(hazes):
    wo = directions(3000, seed=1)
    alpha = np.random.default_rng(3).uniform(0.2, 0.8, 3000)
    u = np.random.default_rng(4).random((3000, 2))
    assert np.allclose(hazes.sample_one_shot(wo[7], u[7], alpha=alpha[7]).wi,
                       hazes.at(alpha=alpha[7]).sample_one_shot(wo[7], u[7]).wi, atol=1e-5)
    for mode, drawn in (("exact", hazes.sample(wo, alpha=alpha, rng=4)),
                        ("one-shot", hazes.sample_one_shot(wo, alpha=alpha, rng=5)),
                        ("one-shot", hazes.sample_one_shot(wo, u, alpha=alpha))):
        assert drawn.valid.all()
        assert np.quantile(np.abs(drawn.pdf / hazes.pdf(wo, drawn.wi, mode=mode, alpha=alpha) - 1), 0.99) < 1e-3
        weight = hazes.eval(wo, drawn.wi, cosine=True, alpha=alpha) / drawn.pdf
        assert np.quantile(np.abs(drawn.weight / weight - 1), 0.99) < 1e-3
        # The twin: densities of a neighbour's parameters.
        assert np.quantile(np.abs(drawn.pdf / hazes.pdf(wo, drawn.wi, mode=mode, alpha=np.roll(alpha, 1)) - 1),
                           0.5) > 1e-2
    below = wo * np.where(np.arange(3000) % 3 == 0, -1, 1)[:, None]
    assert np.array_equal(hazes.sample(below, alpha=alpha, rng=4).valid, below[:, 2] > 0)
    assert np.array_equal(hazes.sample_one_shot(below, alpha=alpha, rng=4).valid, below[:, 2] > 0)


def test_a_functions_family_is_kept_and_found_again(hazes, tmp_path):
    path = tmp_path / "hazes.rfl"
    hazes.save(path)
    for again in (rt.load_family(path, haze), pickle.loads(pickle.dumps(hazes))):
        assert again.ranges == hazes.ranges and again.name == "haze"
        assert np.array_equal(again.sample(WO, 50, alpha=0.3, rng=1).wi, hazes.sample(WO, 50, alpha=0.3, rng=1).wi)
    with pytest.raises(rt.Error, match="a function of Python.*load_family"):
        rt.load_family(path)
    with pytest.raises(rt.Error, match="another BRDF"):
        rt.load_family(path, lambda wo, wi, alpha: haze(wo, wi, 1.1 * alpha))
    member = pickle.loads(pickle.dumps(hazes.at(alpha=0.3)))
    assert np.array_equal(member.sample(WO, 50, rng=1).wi, hazes.at(alpha=0.3).sample(WO, 50, rng=1).wi)


def test_bad_functions():
    def negative(wo, wi, alpha):
        return np.where(alpha > 0.3, -1.0, 1.0)

    for given, sentence in (
        ({}, "0 parameters have a range"),
        ({"a": (0, 1), "b": (0, 1), "c": (0, 1)}, "3 parameters have a range"),
        ({"alpha": (0.8, 0.2)}, "0.8 to 0.2 is empty"),
        ({"alpha": (0.2, np.nan)}, "is empty"),
        ({"alpha": 0.3}, "0.3 is no range"),
        ({"n": (1, 2)}, "n is an argument"),
        ({"alpha": (0.2, 0.8)}, "alpha = .*it returned -1"),
    ):
        with pytest.raises(rt.Error, match=sentence):
            rt.FamilySampler(negative, **given)
    with pytest.raises(TypeError, match="beta"):
        rt.FamilySampler(haze, beta=(0.2, 0.8))
    with pytest.raises(rt.Error, match="one value per pair"):
        rt.FamilySampler(lambda wo, wi, alpha: np.ones((len(wo), 3))[:-1], alpha=(0.2, 0.8))
    with pytest.raises(rt.Error, match="no type for directions"):
        rt.FamilySampler(haze, alpha=(0.2, 0.8), dtype=int)


def test_a_function_of_channels_and_two_parameters():
    def tinted(wo, wi, width, tint):
        value = np.exp(-(1 - wo[:, 2] * wi[:, 2]) / width)
        return np.stack([value + 0.1, (value + 0.1) * tint], axis=1)

    family = rt.FamilySampler(tinted, width=(0.5, 1.5), tint=(0.2, 0.8), expected_trials=2, one_shot_variance=0.1,
                              albedo_error=1e-2, dtype=np.float32)
    wo, wi = directions(50, seed=1), directions(50, seed=2)
    assert family.value_shape == (2,) and family.channels == 2
    assert np.allclose(family.eval(wo, wi, width=0.7, tint=0.4), tinted(wo, wi, 0.7, 0.4), rtol=1e-4)
    drawn = family.sample(wo, width=0.7, tint=0.4, rng=1)
    assert np.allclose(drawn.weight[:, 1], 0.4 * drawn.weight[:, 0], rtol=1e-4)
    # The same over arrays (test_tables.py): a grid over three coordinates, cubics over two.
    over_numpy = DrJitSampler(numpy_drjit, numpy_drjit, family.tables(), family.tables("exact"))
    rng = np.random.default_rng(3)
    at = {name: rng.uniform(*ends, 50).astype(np.float32) for name, ends in family.ranges.items()}
    columns = [np.ascontiguousarray(w.T, dtype=np.float32) for w in (wo, wi)]
    assert np.allclose(over_numpy.pdf(*columns, True, list(at.values())), family.pdf(wo, wi, mode="one-shot", **at),
                       rtol=1e-3)
    view = over_numpy.view(columns[0], list(at.values()))
    assert np.allclose(over_numpy._albedo(view, True) / family.tables().scale, family.albedo(wo, **at), rtol=1e-4)
