# SPDX-License-Identifier: Apache-2.0
"""Angles and other people's conventions."""

import pickle

import numpy as np
import pytest
from conftest import directions

import reflectree as rt


def lopsided(wo, wi):
    """Neither reciprocal nor symmetric: every mix-up shows."""
    return 0.1 + wo[:, 2] ** 2 + 0.3 * wi[:, 2] + 0.2 * (wo * wi).sum(axis=1)


def in_mitsubas_words(wi, wo):
    """The same with cosine, as Mitsuba's eval: wi is known, wo is sampled."""
    return lopsided(wi, wo) * wo[:, 2]


def test_directions_of_angles():
    wo, wi = rt.from_angles(0.3, 0.3, 0.0, azimuth="forward")
    assert np.allclose(wo, [np.sin(0.3), 0, np.cos(0.3)])
    assert np.allclose(wi, wo * [-1, 1, 1])  # where a mirror reflects
    wo, wi = rt.from_angles(0.3, 0.3, 0.0, azimuth="backward")
    assert np.allclose(wi, wo)
    for azimuth in ("forward", "backward"):
        wo, wi = rt.from_angles(0.2, [0.5, 0.6], [[0.1], [1.0]], azimuth=azimuth)
        assert wo.shape == wi.shape == (2, 2, 3)
        phi = np.arctan2(wi[..., 1], wi[..., 0]) - (np.pi if azimuth == "forward" else 0)
        assert np.allclose(np.exp(1j * phi), np.exp(1j * np.array([[0.1], [1.0]])))
    wo, wi = rt.from_angles(*np.float32([0.2, 0.3, 0.4]), azimuth="forward")
    assert wo.dtype == wi.dtype == np.float32
    assert rt.direction(np.float32(1), np.float32(2)).dtype == np.float32


def test_azimuths_have_no_default():
    with pytest.raises(TypeError, match="azimuth"):
        rt.from_angles(0.1, 0.2, 0.3)
    for call in (lambda: rt.from_angles(0.1, 0.2, 0.3, azimuth="front"),
                 lambda: rt.function_of_angles(lambda a, b, c: a, azimuth="solar", cosine=False)):
        with pytest.raises(rt.Error, match="say 'forward' .* or 'backward'"):
            call()


def test_functions_of_other_conventions():
    wo, wi = directions(200), directions(200, seed=2)
    expected = lopsided(wo, wi)
    assert np.allclose(rt.mitsuba_order(in_mitsubas_words, cosine=True)(wo, wi), expected)
    assert np.allclose(rt.mitsuba_order(in_mitsubas_words, cosine=False)(wo, wi), expected * wi[:, 2])
    assert np.allclose(rt.swapped(lopsided)(wi, wo), expected)
    assert not np.allclose(lopsided(wi, wo), expected)
    assert np.allclose(rt.without_cosine(lambda wo, wi: (expected * wi[:, 2])[:, None])(wo, wi)[:, 0], expected)


@pytest.mark.parametrize("azimuth", ["forward", "backward"])
def test_functions_of_angles(azimuth):
    def f(theta_o, theta_i, phi):
        return 1 + theta_o + 0.5 * theta_i**2 + 0.3 * np.cos(phi)

    theta_o, theta_i, phi = np.random.default_rng(1).uniform(0, [1.5, 1.5, np.pi], (100, 3)).T
    wo, wi = rt.from_angles(theta_o, theta_i, phi, azimuth=azimuth)
    turned = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    for turn in (np.eye(3), turned, np.diag([1, -1, 1])):
        g = rt.function_of_angles(f, azimuth=azimuth, cosine=False)
        assert np.allclose(g(wo @ turn.T, wi @ turn.T), f(theta_o, theta_i, phi))
    other = rt.function_of_angles(f, azimuth={"forward": "backward", "backward": "forward"}[azimuth], cosine=False)
    assert not np.allclose(other(wo, wi), f(theta_o, theta_i, phi), atol=0.1)


def test_adapters_are_picklable():
    wo, wi = directions(5), directions(5, seed=2)
    for f in (rt.mitsuba_order(in_mitsubas_words, cosine=True), rt.swapped(lopsided), rt.without_cosine(lopsided)):
        assert np.array_equal(pickle.loads(pickle.dumps(f))(wo, wi), f(wo, wi))
