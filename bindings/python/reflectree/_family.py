# SPDX-License-Identifier: Apache-2.0
"""Families: one sampler of a material whose parameters vary within ranges, as by a texture."""

from __future__ import annotations

import os
import time
import warnings
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from . import _core
from ._arrays import (Array, Rng, Samples, as_count, as_floats, as_output, as_vectors, common_dtype, common_shape,
                      sample_outputs, scalar_or_array, seed_words, spread)
from ._brdf import Brdf, material
from ._error import BuildWarning, Error
from ._files import as_path, as_text
from ._progress import Progress, opened
from ._sampler import BuildReport, Sampler, _is_one_shot, _made, _scalars, _target, _wanted


class FamilySampler:
    """Draws directions wi for a known wo and known parameters, exact for every value within the ranges.
    Immutable: threads share it, and sampling lets go of the GIL.

        metals = rt.FamilySampler("ggx:alpha=0.02..1")
        drawn = metals.sample(wo, alpha=texture)          # wo of shape (..., 3), texture of shape (...)

    Parameters of the material are keyword arguments of every method: numbers or arrays that are broadcast against
    the leading shape of wo.

    Parameters
    ----------
    text : str
        A material of which one or two parameters have a range.
    target, expected_trials, one_shot_variance, albedo_error, seed, max_evaluations, threads, progress
        As of :class:`Sampler`.

    Raises
    ------
    Error
        For a text without a range, of an unknown model, or with a value out of range.

    Warns
    -----
    BuildWarning
        For each note of the report.
    """

    def __init__(self, text: str, *, target: Union[str, int] = "norm", expected_trials: float = 1.25,
                 one_shot_variance: float = 0.01, albedo_error: float = 1e-4, seed: int = 1,
                 max_evaluations: int = 240_000_000, threads: Optional[int] = None,
                 progress: Progress = None) -> None:
        if not isinstance(text, str):
            raise Error(f"a {type(text).__name__} is no family", "text",
                        'give a material\'s text with a range, such as "ggx:alpha=0.02..1"')
        if not _core.names_family(as_text(text, "text")):
            raise Error("no parameter has a range", text, 'write one, such as "ggx:alpha=0.02..1", or use rt.Sampler')
        name, channel = _target(target)
        wanted = _wanted(expected_trials, one_shot_variance, albedo_error, seed, max_evaluations, threads)
        started = time.perf_counter()
        with opened(progress) as tell:
            core = _core.Family.build(text, target=name, channel=channel, progress=tell, **wanted)
        self._take(core, time.perf_counter() - started)
        for note in self.report.notes:
            warnings.warn(note, BuildWarning, stacklevel=2)

    def _take(self, core: Any, seconds: Optional[float]) -> None:
        self._core = core
        self.name: str = core.name
        self.channels: int = core.channels
        self.ranges: Dict[str, Tuple[float, float]] = dict(core.ranges)
        self.build_seconds = seconds
        self.report = BuildReport(**core.report)

    # Sampling

    def sample(self, wo: Any, n: Optional[int] = None, *, rng: Rng = None, out: Optional[Samples] = None,
               **parameters: Any) -> Samples:
        """Exact mode: :meth:`Sampler.sample` of the member with these parameters."""
        return self._sample(False, wo, n, None, rng, out, parameters)

    def sample_one_shot(self, wo: Any, u: Any = None, *, n: Optional[int] = None, rng: Rng = None,
                        out: Optional[Samples] = None, **parameters: Any) -> Samples:
        """One-shot mode: :meth:`Sampler.sample_one_shot` of the member with these parameters."""
        return self._sample(True, wo, n, u, rng, out, parameters)

    def _sample(self, one_shot: bool, wo: Any, n: Optional[int], u: Any, rng: Rng, out: Optional[Samples],
                parameters: Dict[str, Any]) -> Samples:
        wo, at = as_vectors(wo, 3, "wo"), self._rows(parameters)
        dtype, shapes, inputs = common_dtype(wo), [wo.shape[:-1], at.shape[:-1]], [wo]
        shape = common_shape(shapes, "wo and the parameters")
        if n is not None:
            wo, at = spread(wo, shape)[..., None, :], spread(at, shape)[..., None, :]
            shape += (as_count(n, "n"),)
        if u is not None:
            u = as_vectors(u, 2, "u")
            inputs.append(u)
            shape = common_shape([shape, u.shape[:-1]], "wo, u and the parameters")
            u = spread(u, shape)
        result = sample_outputs(out, shape, (self.channels,), dtype, inputs)
        seed, stream = (0, 0) if u is not None else seed_words(rng)
        self._core.sample(one_shot, spread(wo, shape), spread(at, shape), u, seed, stream, *result)
        return _scalars(result)

    # Values and densities

    def eval(self, wo: Any, wi: Any, *, cosine: bool = False, out: Optional[Array] = None, **parameters: Any) -> Array:
        """f(wo, wi) of the member in sr^-1, shape (..., c): :meth:`Brdf.eval`."""
        return self._eval_pdf(wo, wi, parameters, out, False, cosine)[0]  # type: ignore[no-any-return]

    def pdf(self, wo: Any, wi: Any, *, mode: str = "exact", out: Optional[Array] = None, **parameters: Any) -> Array:
        """The density of a mode per solid angle, sr^-1, shape (...): :meth:`Sampler.pdf`."""
        return self._eval_pdf(wo, wi, parameters, out, _is_one_shot(mode), None)[1]  # type: ignore[no-any-return]

    def _eval_pdf(self, wo: Any, wi: Any, parameters: Dict[str, Any], out: Optional[Array], one_shot: bool,
                  cosine: Optional[bool]) -> Tuple[Any, Any]:
        wo, wi, at = as_vectors(wo, 3, "wo"), as_vectors(wi, 3, "wi"), self._rows(parameters)
        shape = common_shape([wo.shape[:-1], wi.shape[:-1], at.shape[:-1]], "wo, wi and the parameters")
        wants_f = cosine is not None
        result = as_output(out, shape + ((self.channels,) if wants_f else ()), common_dtype(wo, wi), "out", (wo, wi))
        self._core.eval_pdf(one_shot, spread(wo, shape), spread(wi, shape), spread(at, shape),
                            result if wants_f else None, None if wants_f else result, bool(cosine))
        result = scalar_or_array(result)
        return (result, None) if wants_f else (None, result)

    def albedo(self, wo: Any, *, out: Optional[Array] = None, **parameters: Any) -> Array:
        """The integral of the target times cos theta_i, from the table, shape (...): :meth:`Sampler.albedo`."""
        return self._of_viewer(self._core.albedo, wo, out, parameters)

    def expected_trials(self, wo: Any, *, out: Optional[Array] = None, **parameters: Any) -> Array:
        """The mean number of trials of exact mode, shape (...)."""
        return self._of_viewer(self._core.expected_trials, wo, out, parameters)

    def _of_viewer(self, of: Any, wo: Any, out: Optional[Array], parameters: Dict[str, Any]) -> Array:
        wo, at = as_vectors(wo, 3, "wo"), self._rows(parameters)
        shape = common_shape([wo.shape[:-1], at.shape[:-1]], "wo and the parameters")
        result = as_output(out, shape, common_dtype(wo), "out", (wo,))
        of(spread(wo, shape), spread(at, shape), result)
        return scalar_or_array(result)  # type: ignore[no-any-return]

    # What it is

    def at(self, **parameters: Any) -> Sampler:
        """The sampler of one member: as quick as any other, to be saved, verified and drawn."""
        row = self._rows(parameters)
        if row.ndim != 1:
            raise Error(f"the parameters have the shape {row.shape[:-1]}", "at", "give one number for each")
        core = self._core.member(row.tolist())
        text = core.material
        return _made(Brdf(core.brdf, text, (material, (text,))), core)

    @property
    def nbytes(self) -> int:
        """Bytes of its tables."""
        return int(self._core.nbytes)

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes a sampler file, whole or not at all; :func:`load_family` reads it."""
        self._core.save(as_path(path))

    def _rows(self, parameters: Dict[str, Any]) -> Array:
        """Their values in the order of the ranges, along a new last axis."""
        for name in parameters:
            if name not in self.ranges:
                raise Error(f"it has no range of {name}", self.name, "give " + " and ".join(self.ranges))
        for name in self.ranges:
            if name not in parameters:
                low, high = self.ranges[name]
                raise Error(f"{name} is missing", self.name, f"give {name}=, a number from {low:g} to {high:g}")
        columns = [as_floats(parameters[name], name) for name in self.ranges]
        for name, column in zip(self.ranges, columns):
            low, high = self.ranges[name]
            with np.errstate(over="ignore"):  # what is too large for a float is out of range, too
                single = column.astype(np.float32)
            bad = ~((single >= np.float32(low)) & (single <= np.float32(high)))
            if np.any(bad):
                where = tuple(int(i[0]) for i in np.nonzero(bad)) if column.ndim else ()
                place = name + (f"[{', '.join(map(str, where))}]" if where else "")
                raise Error(f"{column[where]:g} is outside of its range", place, f"give {low:g} to {high:g}")
        shape = common_shape([c.shape for c in columns], " and ".join(self.ranges))
        return np.stack([np.broadcast_to(c, shape) for c in columns], axis=-1).astype(np.float64)

    def __repr__(self) -> str:
        exact, one_shot = self._core.leaf_counts
        return (f"<reflectree.FamilySampler of {self.name}; {exact} + {one_shot} leaves, {self.nbytes / 1024:.0f} KiB; "
                f"{self.report.expected_trials:.3g} trials at most"
                + "".join(f"; note: {note}" for note in self.report.notes) + ">")

    def __reduce__(self) -> Tuple[Any, ...]:
        return _family_again, (self._core.to_bytes(),)


def _family_of(core: Any) -> FamilySampler:
    family = FamilySampler.__new__(FamilySampler)
    family._take(core, None)
    return family


def _family_again(data: bytes) -> FamilySampler:
    return _family_of(_core.Family.from_bytes(data, "a pickled family"))


def load_family(path: Union[str, "os.PathLike[str]"]) -> FamilySampler:
    """A family's sampler from its file, which :meth:`FamilySampler.save` or ``reflectree build`` wrote.

    Raises
    ------
    Error
        For a file that is damaged, or holds the sampler of a single material.
    """
    path = as_path(path)
    if not _core.names_family(path):
        raise Error("it holds the sampler of a single material", path, "read it by rt.load_sampler(path)")
    return _family_of(_core.Family.from_file(path))
