# SPDX-License-Identifier: Apache-2.0
"""Figures with matplotlib, an optional extra: ``pip install reflectree[plot]``.

Each function draws into ``ax`` where one is given, and returns its axes.
"""

from __future__ import annotations

from typing import Any, Sequence, Tuple

import numpy as np

from ._arrays import Array, Rng, as_vectors
from ._brdf import BrdfLike, as_brdf
from ._conventions import direction
from ._error import Error
from ._sampler import Sampler, _is_one_shot

__all__ = ["lobe", "samples", "slices", "tree"]


def _axes(ax: Any, **subplot: Any) -> Any:
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError:
        raise Error("matplotlib is not installed", "rt.plot", "pip install matplotlib") from None
    return plt.subplots(subplot_kw=subplot)[1]


def _brdf_of(what: Any) -> Any:
    return what.brdf if isinstance(what, Sampler) else as_brdf(what)


def _one(wo: Any) -> Array:
    one: Array = as_vectors(wo, 3, "wo").astype(np.float64)
    if one.shape != (3,):
        raise Error(f"its shape is {one.shape}", "wo", "give one direction, shape (3,)")
    return one


def _plane(wo: Array, n: int) -> Tuple[Array, Array]:
    """Angles from the normal, positive on the viewer's side, and directions in the plane of incidence."""
    theta = (np.arange(n) + 0.5) / n * np.pi - np.pi / 2
    phi = np.arctan2(wo[1], wo[0])
    return theta, direction(theta, np.full(n, phi))


def _single(values: Array) -> Array:
    """One number per direction: the root of the mean square over channels."""
    single: Array = values if values.ndim == 1 else np.sqrt(np.mean(values**2, axis=-1))
    return single


def lobe(what: "BrdfLike | Sampler", wo: Any, *, cosine: bool = True, n: int = 721, ax: Any = None,
         **style: Any) -> Any:
    """f, with cos theta_i unless ``cosine=False``, in the plane of incidence as a polar plot, sr^-1."""
    wo = _one(wo)
    theta, wi = _plane(wo, n)
    ax = _axes(ax, projection="polar")
    ax.plot(theta, _single(_brdf_of(what).eval(wo, wi, cosine=cosine)), **style)
    height = ax.get_ylim()[1]
    ax.annotate("", xy=(np.arctan2(np.hypot(wo[0], wo[1]), wo[2]), height), xytext=(0, 0),
                arrowprops={"arrowstyle": "->", "color": "gray"})
    ax.set_theta_zero_location("N")
    ax.set_thetamin(-90)
    ax.set_thetamax(90)
    ax.set_title("f cos θi" if cosine else "f")
    return ax


def slices(sampler: Sampler, wo: Any, *, modes: Sequence[str] = ("exact", "one-shot"), n: int = 2001,
           ax: Any = None) -> Any:
    """The densities of both modes in the plane of incidence, per solid angle, on a logarithmic axis."""
    wo = _one(wo)
    theta, wi = _plane(wo, n)
    ax = _axes(ax)
    for mode, style in zip(modes, ("-", "--")):
        ax.plot(np.degrees(theta), sampler.pdf(wo, wi, mode=mode), style, label=mode)
    ax.set_yscale("log")
    ax.set_xlabel("θi in degrees, positive on the viewer's side")
    ax.set_ylabel("density, sr$^{-1}$")
    ax.legend()
    return ax


def samples(sampler: Sampler, wo: Any, n: int = 2000, *, mode: str = "exact", rng: Rng = 0, ax: Any = None,
            **style: Any) -> Any:
    """n directions of a mode on the unit disk, x and y of wi; their density there is per projected solid angle."""
    wo = _one(wo)
    drawn = sampler.sample_one_shot(wo, n=n, rng=rng) if _is_one_shot(mode) else sampler.sample(wo, n, rng=rng)
    ax = _axes(ax)
    ax.scatter(drawn.wi[drawn.valid, 0], drawn.wi[drawn.valid, 1], **{"s": 2, "linewidths": 0, **style})
    ax.plot(wo[0], wo[1], "x", color="gray")
    angle = np.linspace(0, 2 * np.pi, 361)
    ax.plot(np.cos(angle), np.sin(angle), color="gray", linewidth=0.8)
    ax.set_aspect("equal")
    ax.set_xlabel("x of wi")
    ax.set_ylabel("y of wi")
    return ax


def tree(sampler: Sampler, wo: Any, *, mode: str = "exact", ax: Any = None) -> Any:
    """The leaves of the tree that serves wo, in square coordinates, coloured by their mass per area."""
    wo = _one(wo)
    leaves = np.asarray(sampler._core.leaves(_is_one_shot(mode), *(float(x) for x in wo))).reshape(-1, 5)
    if len(leaves) == 0:
        raise Error("there is no sample for this direction, so no tree serves it", "wo",
                    "give a viewer above the horizon")
    ax = _axes(ax)
    from matplotlib.collections import PatchCollection
    from matplotlib.colors import LogNorm
    from matplotlib.patches import Rectangle

    patches = [Rectangle((x, y), w, h) for x, y, w, h, _ in leaves]
    density = leaves[:, 4] / (leaves[:, 2] * leaves[:, 3])
    shown = PatchCollection(patches, edgecolor="white", linewidth=0.3, norm=LogNorm())
    shown.set_array(np.maximum(density, density.max() * 1e-9))
    ax.add_collection(shown)
    ax.figure.colorbar(shown, ax=ax, label="mass per area")
    ax.set_xlim(-1, 1)
    ax.set_ylim(0 if sampler._core.half_square else -1, 1)
    ax.set_xlabel("azimuth about the pole, x")
    ax.set_ylabel("from the pole to the rim, y")
    return ax
