# SPDX-License-Identifier: Apache-2.0
"""Exact importance samplers for any reflectance function that you can evaluate.

    import numpy as np
    import reflectree as rt

    sampler = rt.Sampler(lambda wo, wi: 0.3 / (wo[:, 2] + wi[:, 2]))
    drawn = sampler.sample(rt.direction(0.8, 0.0), n=100_000, rng=1)
    radiance = np.mean(drawn.weight * (drawn.wi[:, 2] > 0.5))

``wo`` is known and points to the viewer, ``wi`` is sampled and points to the light; both are unit vectors away from
the surface, z is its normal. Functions are in sr^-1 without the cosine, densities per solid angle, angles in radians.
"""

from __future__ import annotations

from . import _core, plot
from ._arrays import Samples
from ._brdf import Brdf, function, load, material, members, models
from ._checks import Check, Figure
from ._conventions import direction, from_angles, function_of_angles, mitsuba_order, swapped, without_cosine
from ._diagnosis import Diagnosis, Evidence, Finding
from ._doctor import causes, doctor, samplers
from ._error import BuildWarning, Error
from ._family import FamilySampler, load_family
from ._sampler import BuildReport, Sampler, load_sampler
from ._studio import Comparison, RenderWarning, compare, render
from ._tables import Tables
from ._verify import VerifyReport, verify

__version__: str = _core.version

__all__ = [
    "Brdf", "BuildReport", "BuildWarning", "Check", "Comparison", "Diagnosis", "Error", "Evidence", "FamilySampler",
    "Figure", "Finding", "RenderWarning", "Sampler", "Samples", "Tables", "VerifyReport", "causes", "compare", "direction",
    "doctor", "from_angles", "function", "function_of_angles", "load", "load_family", "load_sampler", "material", "members",
    "mitsuba_order", "models", "plot", "render", "samplers", "swapped", "verify", "without_cosine",
]
