# SPDX-License-Identifier: Apache-2.0
"""Conventions said aloud: angles to directions, and functions of other conventions as ours.

Ours: ``wo`` is known and points to the viewer, ``wi`` is sampled and points to the light, both unit and away from
the surface, z its normal; f in sr^-1 without the cosine.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Tuple

import numpy as np

from ._arrays import Array, as_floats, common_dtype, common_shape
from ._error import Error

AZIMUTHS = ("forward", "backward")


def direction(theta: Any, phi: Any) -> Array:
    """The unit direction at the angle theta from the normal and the azimuth phi, radians; shape (..., 3)."""
    theta, phi = as_floats(theta, "theta"), as_floats(phi, "phi")
    shape = common_shape([theta.shape, phi.shape], "theta and phi")
    result = np.empty(shape + (3,), common_dtype(theta, phi))
    result[..., 0] = np.sin(theta) * np.cos(phi)
    result[..., 1] = np.sin(theta) * np.sin(phi)
    result[..., 2] = np.cos(theta)
    return result


def _turn_of(azimuth: str) -> float:
    if azimuth not in AZIMUTHS:
        raise Error(f"{azimuth!r} does not say what azimuth 0 means", "azimuth",
                    "say 'forward' where the light at phi = 0 is opposite to the viewer, as a mirror reflects, or "
                    "'backward' where it is on the viewer's side")
    return np.pi if azimuth == "forward" else 0.0


def from_angles(theta_o: Any, theta_i: Any, phi: Any, *, azimuth: str) -> Tuple[Array, Array]:
    """Directions ``(wo, wi)`` from angles, radians.

    Parameters
    ----------
    theta_o, theta_i : arrays
        Angles of the viewer and of the light from the normal.
    phi : array
        Azimuth between the two.
    azimuth : "forward" or "backward"
        What phi = 0 means; there is no default, since optics and remote sensing disagree. "forward": the light is
        opposite to the viewer, and a mirror reflects there. "backward": it is on the viewer's side, and at equal
        angles stands right behind the viewer.

    Returns
    -------
    (wo, wi) : arrays, shape (..., 3)
        The viewer at azimuth 0.
    """
    turn = _turn_of(azimuth)
    theta_o, theta_i, phi = as_floats(theta_o, "theta_o"), as_floats(theta_i, "theta_i"), as_floats(phi, "phi")
    shape = common_shape([theta_o.shape, theta_i.shape, phi.shape], "theta_o, theta_i and phi")
    dtype = common_dtype(theta_o, theta_i, phi)
    zero = np.zeros((), dtype)
    wo = direction(np.broadcast_to(theta_o, shape), zero)
    wi = direction(np.broadcast_to(theta_i, shape), (phi + dtype(turn)).astype(dtype))
    return wo.astype(dtype, copy=False), wi.astype(dtype, copy=False)


@dataclass(frozen=True)
class _OfAngles:
    f: Callable[..., Array]
    azimuth: str
    cosine: bool

    def __call__(self, wo: Array, wi: Array) -> Array:
        theta_o = np.arctan2(np.hypot(wo[:, 0], wo[:, 1]), wo[:, 2])
        theta_i = np.arctan2(np.hypot(wi[:, 0], wi[:, 1]), wi[:, 2])
        phi = np.arctan2(wi[:, 1], wi[:, 0]) - np.arctan2(wo[:, 1], wo[:, 0]) - _turn_of(self.azimuth)
        phi = np.abs(np.remainder(phi + np.pi, 2 * np.pi) - np.pi)
        return _divided(self.f(theta_o, theta_i, phi), wi, self.cosine)


def function_of_angles(f: Callable[[Array, Array, Array], Array], *, azimuth: str,
                       cosine: bool) -> Callable[[Array, Array], Array]:
    """A function ``f(theta_o, theta_i, phi)`` of angles as ``f(wo, wi)``.

    phi is in [0, pi], as mirror-symmetric isotropic measurements have it; ``azimuth`` says what 0 means
    (:func:`from_angles`). ``cosine``: whether f's values contain cos theta_i, which is then divided out.
    """
    _turn_of(azimuth)
    return _OfAngles(f, azimuth, bool(cosine))


@dataclass(frozen=True)
class _MitsubaOrder:
    f: Callable[..., Array]
    cosine: bool

    def __call__(self, wo: Array, wi: Array) -> Array:
        return _divided(self.f(wi=wo, wo=wi), wi, self.cosine)


def mitsuba_order(f: Callable[..., Array], *, cosine: bool) -> Callable[[Array, Array], Array]:
    """A function with arguments named as Mitsuba names them, as ours.

    Mitsuba calls the known direction wi and samples wo; ours is the other way round. f is called as
    ``f(wi=known, wo=sampled)``, by these names. ``cosine``: whether its values contain the cosine of the sampled
    direction, as Mitsuba's ``eval`` does; it is then divided out.
    """
    return _MitsubaOrder(f, bool(cosine))


def swapped(f: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """A function whose first argument points to the light, ``f(wi, wo)``, as ours."""
    return _Swapped(f)


@dataclass(frozen=True)
class _Swapped:
    f: Callable[[Array, Array], Array]

    def __call__(self, wo: Array, wi: Array) -> Array:
        return self.f(wi, wo)


@dataclass(frozen=True)
class _WithoutCosine:
    f: Callable[[Array, Array], Array]

    def __call__(self, wo: Array, wi: Array) -> Array:
        return _divided(self.f(wo, wi), wi, True)


def without_cosine(f: Callable[[Array, Array], Array]) -> Callable[[Array, Array], Array]:
    """A function whose values contain cos theta_i, as ours, which do not."""
    return _WithoutCosine(f)


def _divided(values: Array, wi: Array, cosine: bool) -> Array:
    if not cosine:
        return values
    values = np.asarray(values)
    cos_theta_i = wi[:, 2]
    without: Array = values / (cos_theta_i if values.ndim == 1 else cos_theta_i[:, None])
    return without
