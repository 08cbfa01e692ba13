# SPDX-License-Identifier: Apache-2.0
"""Functions, and samplers that are built once."""

import numpy as np
import pytest

import reflectree as rt


def ggx(wo, wi, alpha=0.2, f0=0.04):
    """Walter et al. 2007 with the height-correlated shadowing of Heitz 2014 and Schlick's Fresnel."""
    wh = wo + wi
    wh /= np.linalg.norm(wh, axis=1, keepdims=True)
    cos_o, cos_i, a2 = wo[:, 2], wi[:, 2], alpha * alpha
    d = a2 / (np.pi * (wh[:, 2] ** 2 * (a2 - 1) + 1) ** 2)
    v = 0.5 / (cos_i * np.sqrt(a2 + (1 - a2) * cos_o**2) + cos_o * np.sqrt(a2 + (1 - a2) * cos_i**2))
    fresnel = f0 + (1 - f0) * (1 - np.einsum("ij,ij->i", wo, wh)) ** 5
    return d * v * fresnel


def two_channels(wo, wi):
    value = ggx(wo, wi)
    return np.stack([value + 0.1, 0.5 * value + 0.3], axis=1)


def directions(n, seed=1, lowest=0.02):
    """Random unit directions above the surface."""
    rng = np.random.default_rng(seed)
    z = rng.uniform(lowest, 1, n)
    return rt.direction(np.arccos(z), rng.uniform(0, 2 * np.pi, n))


@pytest.fixture(scope="session")
def gold():
    return rt.Sampler("ggx:alpha=0.2,f0=1/0.8/0.3")


@pytest.fixture(scope="session")
def mine():
    return rt.Sampler(ggx)


@pytest.fixture(scope="session")
def pair():
    return rt.Sampler(two_channels)
