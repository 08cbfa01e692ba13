# SPDX-License-Identifier: Apache-2.0
"""Functions of others: answers are brought to one form, and what cannot be is an Error that says what came."""

from __future__ import annotations

from typing import Any, Tuple

import numpy as np

from ._arrays import Array
from ._conventions import direction
from ._error import Error


def _numbers(value: Any, name: str, n: int) -> Array:
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise Error(f"it returned what is no array ({error})", name, "return numbers of one shape") from error
    if array.dtype.kind not in "fiub":
        raise Error(f"it returned an array of type {array.dtype}", name, "return numbers")
    if array.ndim == 0 or array.shape[0] != n:
        raise Error(f"it returned the shape {array.shape} for n = {n} directions", name,
                    "return one row for each direction")
    return array.astype(np.float64)


def _column(value: Any, name: str, n: int) -> Array:
    array = _numbers(value, name, n)
    if array.shape not in ((n,), (n, 1)):
        raise Error(f"it returned the shape {array.shape} for n = {n} directions", name, "return the shape (n,)")
    return array.reshape(n, 1)


def _rows(value: Any, name: str, n: int, width: int, meaning: str) -> Array:
    array = _numbers(value, name, n)
    if array.ndim == 1 and width == 1:
        array = array[:, None]
    if array.shape != (n, width):
        raise Error(f"it returned the shape {array.shape} for n = {n} directions", name,
                    f"return {meaning} of the shape (n, {width})")
    return np.ascontiguousarray(array)


def _parts(drawn: Any, name: str) -> Tuple[Any, Any, Any, Any]:
    """wi, pdf, value, valid; None for what is left out."""
    if hasattr(drawn, "wi"):
        return (drawn.wi, getattr(drawn, "pdf", None), getattr(drawn, "weight", getattr(drawn, "value", None)),
                getattr(drawn, "valid", None))
    if isinstance(drawn, tuple) and 1 <= len(drawn) <= 4:
        wi, pdf, value, valid = drawn + (None,) * (4 - len(drawn))
        return wi, pdf, value, valid
    if isinstance(drawn, np.ndarray):
        return drawn, None, None, None
    raise Error(f"it returned a {type(drawn).__name__}", name,
                "return (wi, pdf, weight), with whether each is valid as a fourth, or an rt.Samples")


class Triple:
    """eval, sample and pdf; ``pdf`` may be missing where sample tells."""

    def __init__(self, eval: Any, sample: Any, pdf: Any) -> None:
        for name, f in (("eval", eval), ("sample", sample), ("pdf", pdf)):
            if f is None and name == "pdf":
                continue
            if not callable(f):
                raise Error("there is none" if f is None else f"a {type(f).__name__} cannot be called", name,
                            "give functions eval(wo, wi), sample(wo, rng) and, where there is a density, pdf(wo, wi)")
        self.f, self.draw, self.density = eval, sample, pdf
        # As many pairs as nobody has channels, so that axes cannot be taken for each other.
        n = 1021
        wo = direction(np.linspace(0.3, 1.3, n), np.full(n, 0.1))
        wi = direction(np.linspace(0.2, 1.2, n), np.linspace(3, 9, n))
        values = _numbers(eval(wo.copy(), wi.copy()), "eval", n)
        if values.ndim > 2 or not 1 <= values[0].size <= 256:
            raise Error(f"it returned the shape {values.shape} for n = {n} pairs of directions", "eval",
                        "return (n,) or (n, channels), at most 256 of them")
        self.channels = int(values[0].size)
        _, p, value, _ = _parts(sample(wo.copy(), np.random.default_rng(0)), "sample")
        self.has_values = value is not None
        if p is None and pdf is None:
            raise Error("neither it nor a function pdf gives the density", "sample", "return (wi, pdf, weight)")

    def eval(self, wo: Array, wi: Array) -> Array:
        return _rows(self.f(wo, wi), "eval", len(wo), self.channels, "values")

    def pdf(self, wo: Array, wi: Array) -> Array:
        return _column(self.density(wo, wi), "pdf", len(wo))

    def sample(self, wo: Array, seed: int) -> Array:
        n = len(wo)
        wi, p, value, valid = _parts(self.draw(wo.copy(), np.random.default_rng(seed)), "sample")
        out = np.zeros((n, 5 + self.channels))
        out[:, :3] = _rows(wi, "sample", n, 3, "directions wi")
        out[:, 4] = np.any(out[:, :3] != 0, axis=1) if valid is None else _column(valid, "sample", n)[:, 0] != 0
        if p is not None:
            out[:, 3:4] = _column(p, "sample", n)
        else:  # pdf is told directions above the surface alone
            drawn = (out[:, 4] != 0) & (out[:, 2] > 0)
            if drawn.any():
                out[drawn, 3] = self.pdf(wo[drawn], np.array(out[drawn, :3]))[:, 0]
        if (value is not None) != self.has_values:
            raise Error("it returns a weight in one call and none in another", "sample", "return (wi, pdf, weight)")
        if value is not None:
            out[:, 5:] = _rows(value, "sample", n, self.channels, "weights")
        return out
