# SPDX-License-Identifier: Apache-2.0
"""Reflectance functions: materials by their text, measured files, functions of NumPy."""

from __future__ import annotations

import html
import os
from typing import Any, Callable, List, Optional, Tuple, Union

import numpy as np

from . import _core
from ._arrays import Array, as_output, as_vectors, common_dtype, common_shape, scalar_or_array, spread
from ._error import Error
from ._files import as_path, as_text

BrdfLike = Union["Brdf", str, "os.PathLike[str]", Callable[[Array, Array], Array]]


class Brdf:
    """A reflectance function f(wo, wi), sr^-1, without the cosine. Made by :func:`material`, :func:`load` and
    :func:`function`; immutable, and shared between threads.

    Attributes
    ----------
    name : str
        The canonical text of a material, or the name of a function.
    channels : int
        Of a value: 3 are red, green and blue.
    value_shape : tuple
        The last axes of a value: ``(channels,)``, or ``()`` of a function that returns ``(n,)``.
    """

    def __init__(self, core: Any, name: str, made: Tuple[Any, ...]) -> None:
        self._core = core
        self._made = made  # how to make it again
        self.name = name
        self.channels: int = core.channels
        self.value_shape: Tuple[int, ...] = (core.channels,) if core.has_channel_axis else ()

    def eval(self, wo: Any, wi: Any, *, cosine: bool = False, out: Optional[Array] = None) -> Array:
        """f(wo, wi) in sr^-1; 0 where a direction is below the surface.

        Parameters
        ----------
        wo, wi : arrays, shape (..., 3)
            Unit directions towards the viewer and the light; broadcast against each other.
        cosine : bool
            Whether to multiply by cos theta_i.
        out : array, optional
            Where to write the result.

        Returns
        -------
        array, shape (..., c), or (...) of a function without channels; of the type of the directions

        Raises
        ------
        Error
            For directions that are not finite or not of unit length, and shapes that do not fit.
        """
        wo, wi = as_vectors(wo, 3, "wo"), as_vectors(wi, 3, "wi")
        shape = common_shape([wo.shape[:-1], wi.shape[:-1]], "wo and wi")
        result = as_output(out, shape + self.value_shape, common_dtype(wo, wi), "out", (wo, wi))
        self._core.eval(spread(wo, shape), spread(wi, shape), result, cosine)
        return scalar_or_array(result)  # type: ignore[no-any-return]

    def __call__(self, wo: Any, wi: Any) -> Array:
        """f(wo, wi) in sr^-1, without the cosine: :meth:`eval`."""
        return self.eval(wo, wi)

    @property
    def calls(self) -> Tuple[int, int]:
        """Of a function: how often it was called, and for how many pairs of directions in all."""
        count, directions = self._core.calls
        return int(count), int(directions)

    def __reduce__(self) -> Tuple[Any, ...]:
        return self._made

    def __repr__(self) -> str:
        return f"<reflectree.Brdf {self.name}, {_channels_text(self.channels)}>"

    def _repr_html_(self) -> str:
        return f"<b>Brdf</b> <code>{html.escape(self.name)}</code>, {_channels_text(self.channels)}"


def _channels_text(channels: int) -> str:
    return "1 channel" if channels == 1 else f"{channels} channels"


def material(text: str) -> Brdf:
    """The material of a text, such as ``"0.3*lambert:rho=0.5 + ggx:alpha=0.1"``, or the path of a file.

    Raises
    ------
    Error
        For an unknown model, a value out of range, a file that cannot be read.
    """
    core = _core.Brdf.from_text(as_text(text, "material"), "")
    return Brdf(core, core.name, (material, (text,)))


def load(path: Union[str, "os.PathLike[str]"], member: str = "") -> Brdf:
    """The material of a measured or fitted file: RGL, MERL, Zemax, Klems matrices, or a member of a table.

    The format is told by the content. :func:`members` lists what ``member`` may be.
    """
    path, member = as_path(path), as_text(member, "member")
    core = _core.Brdf.from_file(path, member)
    return Brdf(core, core.name, (load, (path, member)))


def members(path: Union[str, "os.PathLike[str]"]) -> List[str]:
    """The members of a file, in order; empty for a file that is one material."""
    return list(_core.list_members(as_path(path)))


def models() -> List[str]:
    """The names of all models, for :func:`material`."""
    return list(_core.model_names())


def function(f: Callable[[Array, Array], Array], *, name: Optional[str] = None, dtype: Any = np.float64) -> Brdf:
    """A function of NumPy as a reflectance function.

    ``f(wo, wi)`` is given two arrays of shape (n, 3), unit directions above the surface, and returns an array of
    shape (n,) or (n, channels): sr^-1, without the cosine, finite and not negative. The arrays are f's own: it
    may keep or change them. Their columns, such as ``wo[:, 2]``, are of one piece.

    Parameters
    ----------
    f : callable
        Deterministic, and each value a function of its own pair of directions alone.
    name : str, optional
        For errors; f's own by default.
    dtype : numpy dtype
        Of the arrays that f is given: float64, or float32, which is quicker and less exact.
    """
    if np.dtype(dtype) not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise Error(f"{dtype!r} is no type for directions", "dtype", "say numpy.float32 or numpy.float64")
    if name is None:
        name = getattr(f, "__qualname__", None) or type(f).__qualname__
    core = _core.Brdf.from_function(f, name, np.dtype(dtype) == np.float64)
    return Brdf(core, name, (_function_again, (f, name, np.dtype(dtype).name)))


def _function_again(f: Callable[[Array, Array], Array], name: str, dtype: str) -> Brdf:
    return function(f, name=name, dtype=dtype)


def as_brdf(value: BrdfLike) -> Brdf:
    if isinstance(value, Brdf):
        return value
    if isinstance(value, str):
        return material(value)
    if isinstance(value, os.PathLike):
        return load(value)
    if callable(value):
        return function(value)
    raise Error(f"a {type(value).__name__} is no reflectance function", "brdf",
                "give a function f(wo, wi), a material's text, a path, or what rt.material and rt.load return")
