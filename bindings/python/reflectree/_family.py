# SPDX-License-Identifier: Apache-2.0
"""Families: one sampler of a material or function whose parameters vary within ranges, as by a texture."""

from __future__ import annotations

import os
import time
import warnings
from typing import Any, Callable, Dict, List, Optional, Tuple, Union

import numpy as np

from . import _core
from ._arrays import (Array, Rng, Samples, as_count, as_floats, as_output, as_vectors, common_dtype, common_shape,
                      sample_outputs, scalar_or_array, seed_words, spread)
from ._brdf import Brdf, function, material
from ._error import BuildWarning, Error
from ._files import as_path, as_text
from ._progress import Progress, opened
from ._sampler import BuildReport, Sampler, _is_one_shot, _made, _scalars, _target, _wanted
from ._tables import Tables, tables_of

# Arguments of the methods; a parameter of a function cannot have such a name.
ARGUMENTS = ("family", "name", "dtype", "target", "expected_trials", "one_shot_variance", "albedo_error", "seed",
             "max_evaluations", "threads", "progress", "wo", "wi", "n", "u", "rng", "out", "mode", "cosine")


class FamilySampler:
    """Draws directions wi for a known wo and known parameters, exact for every value within the ranges.
    Immutable: threads share it, and sampling lets go of the GIL.

        metals = rt.FamilySampler("ggx:alpha=0.02..1")
        drawn = metals.sample(wo, alpha=texture)          # wo of shape (..., 3), texture of shape (...)

        def sheen(wo, wi, width): ...                     # arrays of shape (n, 3), (n, 3) and (n,)
        cloths = rt.FamilySampler(sheen, width=(0.1, 1))

    Parameters of the family are keyword arguments of every method: numbers or arrays that are broadcast against
    the leading shape of wo.

    Parameters
    ----------
    family : str or callable
        A material's text in which one or two parameters have a range; or ``f(wo, wi, **parameters) -> (n,) or
        (n, c)``, a function as :func:`reflectree.function` takes it, called with an array of shape (n,) more for
        each parameter.
    **ranges : (low, high)
        Of a function the range of each of its one or two parameters, by name. Both ends belong to it.
    dtype : numpy dtype
        Of the arrays that a function is given, as of :func:`reflectree.function`.
    name : str, optional
        Of a function, for errors; its own by default.
    target, expected_trials, one_shot_variance, albedo_error, seed, max_evaluations, threads, progress
        As of :class:`Sampler`.

    Raises
    ------
    Error
        For a text without a range, of an unknown model, or with a value out of range; for a function that is
        negative, NaN, infinite or differs between two calls, and what the function raises.

    Warns
    -----
    BuildWarning
        For each note of the report.
    """

    def __init__(self, family: Union[str, Callable[..., Array]], *, target: Union[str, int] = "norm",
                 expected_trials: float = 1.25, one_shot_variance: float = 0.01, albedo_error: float = 1e-4,
                 seed: int = 1, max_evaluations: int = 240_000_000, threads: Optional[int] = None,
                 progress: Progress = None, dtype: Any = np.float64, name: Optional[str] = None,
                 **ranges: Tuple[float, float]) -> None:
        given = _given_family(family, ranges)
        kind, channel = _target(target)
        made = (family, *_name_and_type(family, name, dtype)) if callable(family) else None
        wanted = _wanted(expected_trials, one_shot_variance, albedo_error, seed, max_evaluations, threads)
        started = time.perf_counter()
        with opened(progress) as tell:
            wanted.update(target=kind, channel=channel, progress=tell)
            if made:
                core = _core.Family.build_function(*made, given, **wanted)
            else:
                core = _core.Family.build(family, **wanted)  # type: ignore[arg-type]
        self._take(core, made, time.perf_counter() - started)
        for note in self.report.notes:
            warnings.warn(note, BuildWarning, stacklevel=2)

    def _take(self, core: Any, made: Optional[Tuple[Any, str, bool]], seconds: Optional[float]) -> None:
        self._core = core
        self._made = made  # of a function: it, its name, whether it is given float64
        self.name: str = made[1] if made else core.name
        self.channels: int = core.channels
        self.value_shape: Tuple[int, ...] = (core.channels,) if core.has_channel_axis else ()
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
        result = sample_outputs(out, shape, self.value_shape, dtype, inputs)
        seed, stream = (0, 0) if u is not None else seed_words(rng)
        self._core.sample(one_shot, spread(wo, shape), spread(at, shape), u, seed, stream, *result)
        return _scalars(result)

    # Values and densities

    def eval(self, wo: Any, wi: Any, *, cosine: bool = False, out: Optional[Array] = None, **parameters: Any) -> Array:
        """f(wo, wi) of the member in sr^-1: :meth:`Brdf.eval`."""
        return self._eval_pdf(wo, wi, parameters, out, False, cosine)[0]  # type: ignore[no-any-return]

    def pdf(self, wo: Any, wi: Any, *, mode: str = "exact", out: Optional[Array] = None, **parameters: Any) -> Array:
        """The density of a mode per solid angle, sr^-1, shape (...): :meth:`Sampler.pdf`."""
        return self._eval_pdf(wo, wi, parameters, out, _is_one_shot(mode), None)[1]  # type: ignore[no-any-return]

    def _eval_pdf(self, wo: Any, wi: Any, parameters: Dict[str, Any], out: Optional[Array], one_shot: bool,
                  cosine: Optional[bool]) -> Tuple[Any, Any]:
        wo, wi, at = as_vectors(wo, 3, "wo"), as_vectors(wi, 3, "wi"), self._rows(parameters)
        shape = common_shape([wo.shape[:-1], wi.shape[:-1], at.shape[:-1]], "wo, wi and the parameters")
        wants_f = cosine is not None
        result = as_output(out, shape + (self.value_shape if wants_f else ()), common_dtype(wo, wi), "out", (wo, wi))
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
        if self._made:
            f, name, double_precision = self._made
            values = dict(zip(self.ranges, np.asarray(row, np.float32).tolist()))
            text = name + " at " + ", ".join(f"{key} = {value:g}" for key, value in values.items())
            member = function(_Member(f, values), name=text, dtype=np.float64 if double_precision else np.float32)
            return _made(member, self._core.member_of(member._core, row.tolist()))
        core = self._core.member(row.tolist())
        text = core.material
        return _made(Brdf(core.brdf, text, (material, (text,))), core)

    @property
    def nbytes(self) -> int:
        """Bytes of its tables."""
        return int(self._core.nbytes)

    @property
    def isotropic(self) -> bool:
        """Whether the builder found that all members depend on azimuths by their difference alone."""
        return bool(self._core.isotropic)

    def tables(self, mode: str = "one-shot") -> Tables:
        """The run-time arrays of a mode, read-only: :meth:`Sampler.tables`."""
        return tables_of(self._core, _is_one_shot(mode))

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes a sampler file, whole or not at all; :func:`load_family` reads it, and must be given a function of
        Python again."""
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
        return _family_again, (self._core.to_bytes(), self._made)


class _Member:
    """A function at fixed parameters."""

    def __init__(self, f: Callable[..., Array], values: Dict[str, float]) -> None:
        self.f, self.values = f, values

    def __call__(self, wo: Array, wi: Array) -> Array:
        return self.f(wo, wi, **{name: np.full(len(wo), value, wo.dtype) for name, value in self.values.items()})


def _given_family(family: Any, ranges: Dict[str, Any]) -> List[Tuple[str, float, float]]:
    """The ranges of a function, checked; none of a text."""
    if isinstance(family, str):
        if ranges:
            raise Error(f"a text has its ranges inside, and {next(iter(ranges))} is given beside it", family,
                        'write them as in "ggx:alpha=0.02..1"')
        if not _core.names_family(as_text(family, "family")):
            raise Error("no parameter has a range", family, 'write one, such as "ggx:alpha=0.02..1", or use rt.Sampler')
        return []
    if not callable(family):
        raise Error(f"a {type(family).__name__} is no family", "family",
                    'give a material\'s text with a range, such as "ggx:alpha=0.02..1", or a function and its ranges')
    if not 1 <= len(ranges) <= 2:
        raise Error(f"{len(ranges)} parameters have a range", "family",
                    "give one or two, such as rt.FamilySampler(f, alpha=(0.02, 1))")
    for name, ends in ranges.items():
        if name in ARGUMENTS:
            raise Error(f"{name} is an argument of the sampler's methods", "family", "give the parameter another name")
        try:
            low, high = (float(end) for end in ends)
        except (TypeError, ValueError):
            raise Error(f"{ends!r} is no range", name, "give two numbers, such as (0.02, 1)") from None
        if not (np.isfinite(np.float32(low)) and np.isfinite(np.float32(high)) and np.float32(low) < np.float32(high)):
            raise Error(f"the range from {low:g} to {high:g} is empty", name, "give a smaller number and a larger one")
    return [(name, float(low), float(high)) for name, (low, high) in ranges.items()]


def _name_and_type(f: Any, name: Optional[str], dtype: Any) -> Tuple[str, bool]:
    if np.dtype(dtype) not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise Error(f"{dtype!r} is no type for directions", "dtype", "say numpy.float32 or numpy.float64")
    return name or getattr(f, "__qualname__", None) or type(f).__qualname__, np.dtype(dtype) == np.float64


def _family_of(core: Any, made: Optional[Tuple[Any, str, bool]] = None) -> FamilySampler:
    family = FamilySampler.__new__(FamilySampler)
    family._take(core, made, None)
    return family


def _family_again(data: bytes, made: Optional[Tuple[Any, str, bool]] = None) -> FamilySampler:
    f, name, double_precision = made or (None, "", True)
    return _family_of(_core.Family.from_bytes(data, "a pickled family", f, name, double_precision), made)


def load_family(path: Union[str, "os.PathLike[str]"], f: Optional[Callable[..., Array]] = None, *,
                dtype: Any = np.float64, name: Optional[str] = None) -> FamilySampler:
    """A family's sampler from its file, which :meth:`FamilySampler.save` or ``reflectree build`` wrote.

    Parameters
    ----------
    f : callable, optional
        The function that it was built for: needed for functions of Python. A material is found by its text.
    dtype, name
        Of the function, as of :class:`FamilySampler`.

    Raises
    ------
    Error
        For a file that is damaged, or holds the sampler of a single material, and for a function that is another.
    """
    path = as_path(path)
    text = _core.sampler_file_material(path)
    if not _core.names_family(path):
        raise Error("it holds the sampler of a single material", path, "read it by rt.load_sampler(path)")
    if f is None and text == _core.unnamed_family:
        raise Error("it was built for a function of Python, which the file does not hold", path,
                    "give the function, too: rt.load_family(path, f)")
    made = None if f is None else (f, *_name_and_type(f, name, dtype))
    core = _core.Family.from_file(path, *(made or (None, "", True)))
    return _family_of(core, made)
