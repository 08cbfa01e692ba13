# SPDX-License-Identifier: Apache-2.0
"""The run-time arrays of a sampler, and the code that runs over them inside of Mitsuba, here over NumPy's arrays."""

import numpy as np
import numpy_drjit
import pytest
from conftest import directions

import reflectree as rt
from reflectree import _drjit, _drjit_forest
from reflectree._drjit_domain import Domain

DOMAINS = ("projected_disk", "equal_area", "half_vector", "back_vector", "stretched", "mirror_vector", "normal_vector",
           "slope_star", "scaled_star")
MATERIALS = ("ggx:alpha=0.2", "lambert", "retro_reflector", "phong", "ggx:alpha_x=0.3,alpha_y=0.5,phi_deg=20")
pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning")  # of lanes that are not selected


def columns(w):
    return tuple(np.ascontiguousarray(w[:, k], dtype=np.float32) for k in range(3))


@pytest.fixture(scope="module", params=MATERIALS)
def sampler(request):
    return rt.Sampler(request.param, expected_trials=2, one_shot_variance=0.05, albedo_error=1e-3)  # quick to build


def over_numpy(sampler):
    return _drjit.DrJitSampler(numpy_drjit, numpy_drjit, sampler.tables())


@pytest.mark.parametrize("mode", ["exact", "one-shot"])
def test_tables_are_whole(sampler, mode):
    t = sampler.tables(mode)
    assert (t.domain, t.half) == (sampler._core.domain, sampler._core.half_square)
    assert (len(t.slabs), len(t.leaves)) == (sampler._core.slabs[mode == "one-shot"],
                                             sampler._core.leaf_counts[mode == "one-shot"])
    assert len(t.nodes) == (len(t.leaves) - len(t.slabs) if mode == "one-shot" else 0)
    x, y = t.leaves["x"].astype(np.int64), t.leaves["y"].astype(np.int64)
    area = (x & -x) * (y & -y) * 2.0**-30
    share = t.leaves["height"] * area
    for slab in t.slabs:
        of = slice(slab["first"], slab["first"] + slab["count"])
        assert area[of].sum() == 1
        assert np.isclose(share[of].sum(), slab["volume"], rtol=1e-5)
        own = np.zeros(slab["count"])  # what the alias table gives each leaf
        np.add.at(own, np.arange(slab["count"]), t.leaves["threshold"][of] / slab["bucket"])
        np.add.at(own, t.leaves["alias"][of], 1 - t.leaves["threshold"][of] / slab["bucket"])
        assert np.allclose(own / slab["count"], share[of] / slab["volume"], rtol=1e-5, atol=1e-12)
    if sampler.isotropic:
        assert len(t.borders) == len(t.slabs) + 1 and t.symmetry == "isotropic"
    else:
        assert (t.partition_axis == 255).sum() == len(t.slabs) and t.symmetry != "isotropic"
    with pytest.raises(ValueError):
        t.leaves["height"][0] = 1


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("kind", DOMAINS)
def test_domains_and_their_inverses(kind, half):
    n = 4000
    rng = np.random.default_rng(1)
    wo = directions(n, seed=2)
    if kind not in ("slope_star", "scaled_star", "projected_disk", "equal_area", "stretched"):
        wo = np.stack([np.hypot(wo[:, 0], wo[:, 1]), 0 * wo[:, 2], wo[:, 2]], axis=1)
    domain = Domain(numpy_drjit, kind, half, 1.4, 1.7, (0.3, 0.5))
    px = rng.uniform(-1, 1, n).astype(np.float32)
    py = rng.uniform(0 if half else -1, 1, n).astype(np.float32)
    wi, area = domain.lift(columns(wo), px, py)
    assert np.max(np.abs(np.sum(np.square(wi), axis=0) - 1)) < 2e-6
    assert min(wi[2]) > 0 and np.all(area > 0)
    x, y = domain.lower(columns(wo), wi)
    assert np.quantile(np.abs(x - px), 0.99) < 1e-5 and np.quantile(np.abs(y - py), 0.99) < 1e-5
    assert abs(np.mean(np.broadcast_to(area, n)) - np.pi) < 0.25  # of the disk


def test_densities_and_the_monotone_descent_are_those_of_the_package(sampler):
    n = 20000
    wo, rng = directions(n, seed=3).astype(np.float32), np.random.default_rng(4)
    u = rng.random((n, 2), dtype=np.float32)
    mine = over_numpy(sampler)
    drawn = sampler.sample_one_shot(wo, u)
    wi, pdf = mine.sample(columns(wo), None, (u[:, 0], u[:, 1]), True, True)
    apart = np.max(np.abs(np.stack(wi, axis=1) - drawn.wi), axis=1)
    assert np.quantile(apart, 0.999) < 1e-4
    assert np.quantile(np.abs(pdf / drawn.pdf - 1), 0.99) < 1e-3
    other = directions(n, seed=5).astype(np.float32)
    for w in (drawn.wi, other):
        assert np.quantile(np.abs(mine.pdf(columns(wo), columns(w), True) / sampler.pdf(wo, w, mode="one-shot") - 1),
                           0.995) < 1e-4
    for k in range(20):  # one at a time, as scalar variants do
        x, y, z, density = sampler._core.draw_one(wo[k].tolist(), float(u[k, 0]), float(u[k, 1]))
        assert np.allclose([x, y, z, density], [*drawn.wi[k], drawn.pdf[k]], rtol=1e-6)
        assert sampler._core.density_one(wo[k].tolist(), other[k].tolist()) == sampler.pdf(wo[k], other[k],
                                                                                           mode="one-shot")
    assert sampler._core.draw_one([0, 0, -1], 0.5, 0.5)[3] == 0
    down = columns(wo * np.array([1, 1, -1], dtype=np.float32))
    assert not np.any(mine.pdf(down, columns(other), True)) and not np.any(mine.pdf(columns(wo), down, True))
    assert not np.any(mine.sample(down, None, (u[:, 0], u[:, 1]), True, True)[1])


def chi_square(sampler, n=200_000):
    """By the package's own inverse: uniforms that lead to what was drawn fill the square evenly."""
    rng = np.random.default_rng(6)
    wo = np.broadcast_to(rt.direction(0.9, 0.4).astype(np.float32), (n, 3))
    u = rng.random((3, n), dtype=np.float32)
    wi, _ = over_numpy(sampler).sample(columns(wo), u[0], (u[1], u[2]), True, False)
    back = sampler.invert(wo, np.stack(wi, axis=1))
    cells = np.minimum((back * 16).astype(int), 15)
    counts = np.bincount(cells[:, 0] * 16 + cells[:, 1], minlength=256)
    return np.sum((counts - n / 256) ** 2 / (n / 256))


def test_leaves_by_alias_table_follow_the_density(sampler):
    assert chi_square(sampler) < 255 + 5 * np.sqrt(2 * 255)  # 255 degrees of freedom, five sigma


@pytest.mark.parametrize("fault", ["slopes", "alias"])
def test_twin_with_a_planted_fault(fault, monkeypatch):
    sampler = rt.Sampler("ggx:alpha=0.2")
    if fault == "slopes":
        monkeypatch.setattr(_drjit_forest, "_linear", lambda dr, slope, u: u)
    else:
        monkeypatch.setattr(_drjit_forest.Forest, "choose",
                            lambda self, slab, word, active: slab.x + numpy_drjit.mul_hi(word, slab.y))
    assert chi_square(sampler) > 2 * (255 + 5 * np.sqrt(2 * 255))


# Families.

FAMILIES = {"ggx:alpha=0.1..0.8": {"expected_trials": 2, "one_shot_variance": 0.05, "albedo_error": 1e-3},
            "ggx:alpha_x=0.4..0.6,alpha_y=0.5": {"expected_trials": 2.5, "one_shot_variance": 0.5, "albedo_error": 1e-2}}


@pytest.fixture(scope="module", params=FAMILIES)
def family(request):
    return rt.FamilySampler(request.param, **FAMILIES[request.param])


def members(family, n):
    """A member for each direction, and the same as Dr.Jit has it."""
    rng = np.random.default_rng(8)
    values = {name: rng.uniform(*ends, n).astype(np.float32) for name, ends in family.ranges.items()}
    return values, tuple(values.values())


def test_members_over_arrays(family):
    n = 20000
    wo, rng = directions(n, seed=3).astype(np.float32), np.random.default_rng(4)
    u = rng.random((n, 2), dtype=np.float32)
    values, at = members(family, n)
    mine = over_numpy(family)
    drawn = family.sample_one_shot(wo, u, **values)
    wi, pdf = mine.sample(columns(wo), None, (u[:, 0], u[:, 1]), True, True, at)
    assert np.quantile(np.max(np.abs(np.stack(wi, axis=1) - drawn.wi), axis=1), 0.999) < 1e-4
    assert np.quantile(np.abs(pdf / drawn.pdf - 1), 0.99) < 1e-3
    for w in (drawn.wi, directions(n, seed=5).astype(np.float32)):
        expected = family.pdf(wo, w, mode="one-shot", **values)
        assert np.quantile(np.abs(mine.pdf(columns(wo), columns(w), True, at) / expected - 1), 0.995) < 1e-3
        neighbours = tuple(np.roll(x, 1) for x in at)  # the twin
        assert np.quantile(np.abs(mine.pdf(columns(wo), columns(w), True, neighbours) / expected - 1), 0.5) > 1e-2
    for k in range(len(at)):
        for bad in (0, 100, np.nan):
            beyond = [np.full(n, bad, np.float32) if j == k else x for j, x in enumerate(at)]
            assert not np.any(mine.sample(columns(wo), None, (u[:, 0], u[:, 1]), True, True, beyond)[1])
            assert not np.any(mine.pdf(columns(wo), columns(drawn.wi), True, beyond))


def test_albedo_and_exact_mode_of_members_over_arrays(family):
    n = 5000
    wo = directions(n, seed=3).astype(np.float32)
    values, at = members(family, n)
    mine = _drjit.DrJitSampler(numpy_drjit, numpy_drjit, family.tables(), family.tables("exact"))
    albedo = mine._albedo(mine.view(columns(wo), at), True)
    assert np.allclose(albedo / family.tables().scale, family.albedo(wo, **values), rtol=1e-4)
    wi = directions(n, seed=5).astype(np.float32)
    t = np.linalg.norm(family.eval(wo, wi, **values), axis=1) * family.tables().scale
    assert np.allclose(mine.pdf_exact(columns(wo), columns(wi), t, True, at), family.pdf(wo, wi, **values), rtol=1e-3)


@pytest.mark.parametrize("fault", [None, "widths"])
def test_members_by_alias_table_follow_the_density(fault, family, monkeypatch):
    n, rng = 200_000, np.random.default_rng(6)
    if fault == "widths":  # the twin: those of another member
        monkeypatch.setattr(_drjit.DrJitSampler, "_domain_of",
                            lambda self, view: self._domain._replace(widths=[1.1 * w for w in view.widths]))
    values = {name: np.float32(0.6 * low + 0.4 * high) for name, (low, high) in family.ranges.items()}
    wo = np.broadcast_to(rt.direction(0.9, 0.4).astype(np.float32), (n, 3))
    u = rng.random((3, n), dtype=np.float32)
    wi, _ = over_numpy(family).sample(columns(wo), u[0], (u[1], u[2]), True, False,
                                      [np.full(n, v) for v in values.values()])
    back = family.at(**values).invert(wo, np.stack(wi, axis=1))
    cells = np.minimum((back * 16).astype(int), 15)
    counts = np.bincount(cells[:, 0] * 16 + cells[:, 1], minlength=256)
    score, limit = np.sum((counts - n / 256) ** 2 / (n / 256)), 255 + 5 * np.sqrt(2 * 255)
    assert score > 2 * limit if fault else score < limit


def test_the_look_up_of_borders():
    rng = np.random.default_rng(7)
    for borders in ([], [0.3], [-0.99, -0.2, 0.1, 0.100001, 1.7], np.sort(rng.uniform(-1, 2, 40))):
        borders = np.asarray(borders, dtype=np.float32)
        look_up = _drjit_forest.BorderLookup(_drjit_forest.Library(numpy_drjit, numpy_drjit), borders, -1.0, 2.0)
        x = np.concatenate([np.linspace(-1, 2, 5000), borders]).astype(np.float32)
        assert np.array_equal(np.broadcast_to(look_up(x, True), len(x)), np.searchsorted(borders, x, side="right"))


def test_the_look_up_of_cosines():
    for borders in ([2.0**-17, 2], [2.0**-17, 0.1, 0.1000001, 0.5, 2],
                    np.concatenate([np.geomspace(2.0**-17, 1, 300)[:-1], [2]])):
        borders = np.asarray(borders, dtype=np.float32)
        look_up = _drjit_forest.CosineLookup(_drjit_forest.Library(numpy_drjit, numpy_drjit), borders)
        c = np.concatenate([np.geomspace(2.0**-17, 1, 5000).astype(np.float32), borders[:-1]])
        c = np.clip(c, np.float32(2.0**-17), 1)
        assert np.array_equal(np.broadcast_to(look_up(c, True), len(c)), np.searchsorted(borders, c, side="right") - 1)
