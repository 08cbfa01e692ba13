# SPDX-License-Identifier: Apache-2.0
"""Values of materials and functions, and what both tell of themselves."""

import numpy as np
from conftest import directions, ggx, two_channels

import reflectree as rt


def test_a_material_is_its_formula():
    f = rt.material("lambert:rho=0.5")
    wo, wi = directions(50), directions(50, seed=2)
    assert np.allclose(f(wo, wi), 0.5 / np.pi)
    assert np.allclose(f.eval(wo, wi, cosine=True), (0.5 / np.pi * wi[:, 2])[:, None])
    assert f.channels == 3 and f.value_shape == (3,) and f.name.startswith("lambert:rho=0.5")
    assert np.all(f(wo, wi * [1, 1, -1]) == 0) and np.all(f(wo * [1, 1, -1], wi) == 0)
    assert "ggx" in rt.models()


def test_a_function_is_itself():
    f = rt.function(ggx)
    wo, wi = directions(5000), directions(5000, seed=2)
    assert f.value_shape == () and f.channels == 1 and f.name == "ggx"
    # The core's directions are float32.
    near = ggx(wo.astype(np.float32).astype(float), wi.astype(np.float32).astype(float))
    assert np.allclose(f(wo, wi), near, rtol=1e-6)
    assert rt.function(two_channels)(wo, wi).shape == (5000, 2)
    assert rt.function(lambda wo, wi: np.ones((len(wo), 1)))(wo, wi).shape == (5000, 1)
    single = rt.function(lambda wo, wi: np.float32(wo[:, 2]) * (wi.dtype == np.float32), dtype=np.float32)
    assert np.allclose(single(wo, wi), wo[:, 2])


def test_what_a_function_is_given():
    seen = []

    def f(wo, wi):
        seen.append((wo.shape, wi.shape, wo.dtype, wo[:, 2].flags.c_contiguous, wo.flags.owndata or wo.base is not None))
        assert np.all(wo[:, 2] > 0) and np.all(wi[:, 2] > 0)
        assert np.allclose(np.linalg.norm(wo, axis=1), 1, atol=1e-6)
        return [0.5] * len(wo)  # a list will do

    brdf = rt.function(f)
    wo = directions(100)
    assert np.array_equal(brdf(wo, wo * [1, 1, -1])[:3], [0, 0, 0])
    calls = len(seen)
    assert brdf([0, 0, 1], [0, 0, 1]) == 0.5 and len(seen) == calls + 1
    assert seen[-1] == ((1, 3), (1, 3), np.float64, True, True)


def test_what_they_tell():
    assert repr(rt.material("ggx:alpha=0.1")).startswith("<reflectree.Brdf ggx:alpha=0.1")
    assert "&lt;lambda&gt;" in rt.function(lambda wo, wi: wi[:, 2])._repr_html_()
    assert repr(rt.function(ggx)) == "<reflectree.Brdf ggx, 1 channel>"
