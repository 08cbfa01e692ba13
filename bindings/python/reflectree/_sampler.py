# SPDX-License-Identifier: Apache-2.0
"""Samplers: built from any reflectance function, saved, loaded."""

from __future__ import annotations

import html
import os
import time
import warnings
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np

from . import _core
from ._arrays import (Array, Rng, Samples, as_count, as_number, as_output, as_threads, as_vectors, as_whole,
                      common_dtype, common_shape, sample_outputs, scalar_or_array, seed_words, spread)
from ._brdf import Brdf, BrdfLike, as_brdf
from ._error import BuildWarning, Error
from ._files import as_path, as_text
from ._progress import Progress, opened
from ._tables import Tables, tables_of

MODES = ("exact", "one-shot")


class BuildReport(NamedTuple):
    """What the builder measured about its own bounds.

    Attributes
    ----------
    expected_trials : float
        Of exact mode, the worst viewer.
    overshoot_mass : float
        The share of the target above the bounds, an estimate.
    one_shot_variance : float
        Relative variance of one-shot weights, the median over viewers.
    asymmetry : float
        How far f is from its mirror image in the plane of incidence.
    evaluations : int
        Of f.
    notes : list of str
        What was promised and is not kept, where, and what to do; none as a rule.
    """

    expected_trials: float
    overshoot_mass: float
    one_shot_variance: float
    asymmetry: float
    evaluations: int
    notes: List[str]


class Sampler:
    """Draws directions wi for a known wo. Immutable: threads share it, and sampling lets go of the GIL.

    Parameters
    ----------
    brdf : Brdf, str, path, or callable
        A material, its text, a file, or ``f(wo, wi) -> (n,) or (n, c)`` (see :func:`reflectree.function`).
    target : "norm", "luminance", "maximum", or int
        The scalar of the channels that is sampled; a number names one channel.
    expected_trials : float
        Of exact mode, for every viewer.
    one_shot_variance : float
        Relative variance of the target's weight in one-shot mode.
    albedo_error : float
        Relative, of the albedo table.
    seed : int
        Of the build. The sampler does not depend on the number of threads.
    max_evaluations : int
        Of f. A build that would need more ends with what it has, and says so.
    threads : int, optional
        All cores by default. A function of Python is called by one of them.
    progress : True or callable, optional
        True: a bar of tqdm. A callable is called as ``progress(fraction, stage)``; what it raises ends the build.

    Raises
    ------
    Error
        For a function that is negative, NaN, infinite or differs between two calls, and for options out of range.
    KeyboardInterrupt
        Ctrl-C ends the build.

    Warns
    -----
    BuildWarning
        For each note of the report.
    """

    def __init__(self, brdf: BrdfLike, *, target: Union[str, int] = "norm", expected_trials: float = 1.25,
                 one_shot_variance: float = 0.01, albedo_error: float = 1e-4, seed: int = 1,
                 max_evaluations: int = 240_000_000, threads: Optional[int] = None,
                 progress: Progress = None) -> None:
        f = as_brdf(brdf)
        name, channel = _target(target)
        wanted = _wanted(expected_trials, one_shot_variance, albedo_error, seed, max_evaluations, threads)
        if channel >= f.channels:
            raise Error(f"channel {channel} of {f.channels}", "target", f"say 0 to {f.channels - 1}")
        started = time.perf_counter()
        with opened(progress) as tell:
            core = _core.Sampler.build(f._core, target=name, channel=channel, progress=tell, **wanted)
        self._take(f, core, time.perf_counter() - started)
        for note in self.report.notes:
            warnings.warn(note, BuildWarning, stacklevel=2)

    def _take(self, brdf: Brdf, core: Any, seconds: Optional[float]) -> None:
        self._core = core
        self.brdf = brdf
        self.build_seconds = seconds
        self.report = BuildReport(**core.report)

    # Sampling

    def sample(self, wo: Any, n: Optional[int] = None, *, u: Any = None, rng: Rng = None,
               out: Optional[Samples] = None) -> Samples:
        """Exact mode: directions whose density is proportional to the target times cos theta_i.

        Parameters
        ----------
        wo : array, shape (..., 3)
            Unit directions towards the viewer.
        n : int, optional
            So many independent directions for each wo, along a new last axis; without it, one.
        u : array, shape (..., 2), optional
            Uniforms in [0, 1), broadcast against wo, that choose the leaf of the first trial: stratified points
            stay stratified there. All else comes from ``rng``.
        rng : numpy.random.Generator, int, or None
            One draw of it seeds the call. None: fresh entropy.
        out : Samples, optional
            Arrays to write to.

        Returns
        -------
        Samples
        """
        return self._sample(False, wo, n, u, rng, out)

    def sample_one_shot(self, wo: Any, u: Any = None, *, n: Optional[int] = None, rng: Rng = None,
                        out: Optional[Samples] = None) -> Samples:
        """One-shot mode: no rejection. With uniforms ``u``, shape (..., 2), a continuous map of the unit square,
        the same for the same u; without them from ``rng``, by alias table. Else as :meth:`sample`."""
        return self._sample(True, wo, n, u, rng, out)

    def _sample(self, one_shot: bool, wo: Any, n: Optional[int], u: Any, rng: Rng,
                out: Optional[Samples]) -> Samples:
        wo = as_vectors(wo, 3, "wo")
        dtype, shape, inputs = common_dtype(wo), wo.shape[:-1], [wo]
        if n is not None:
            shape, wo = shape + (as_count(n, "n"),), wo[..., None, :]
        if u is not None:
            u = as_vectors(u, 2, "u")
            inputs.append(u)
            shape = common_shape([shape, u.shape[:-1]], "wo and u")
            u = spread(u, shape)
        result = sample_outputs(out, shape, self.brdf.value_shape, dtype, inputs)
        seed, stream = (0, 0) if one_shot and u is not None else seed_words(rng)
        self._core.sample(one_shot, spread(wo, shape), u, seed, stream, *result)
        return _scalars(result)

    def sample_n(self, wo: Any, n: int, *, mode: str = "exact", rng: Rng = None,
                 out: Optional[Samples] = None) -> Samples:
        """n directions for each wo in one call, divided among the leaves of its tree: stratified, ordered by
        leaf and *not independent*. The mean over all n is unbiased (with "no sample" as weight 0).

        Results have the leading shape ``wo.shape[:-1] + (n,)``.
        """
        wo = as_vectors(wo, 3, "wo")
        shape = wo.shape[:-1] + (as_count(n, "n"),)
        result = sample_outputs(out, shape, self.brdf.value_shape, common_dtype(wo), [wo])
        self._core.sample_n(_is_one_shot(mode), wo, *seed_words(rng), *result)
        return _scalars(result)

    def invert(self, wo: Any, wi: Any, *, out: Optional[Array] = None) -> Array:
        """The uniforms u, shape (..., 2), that ``sample_one_shot(wo, u)`` takes to wi, up to rounding; NaN where
        there are none (a direction at or below the horizon)."""
        wo, wi, shape = _pair(wo, wi)
        result = as_output(out, shape + (2,), common_dtype(wo, wi), "out", (wo, wi))
        self._core.invert(spread(wo, shape), spread(wi, shape), result)
        return result

    # Values and densities

    def eval(self, wo: Any, wi: Any, *, cosine: bool = False, out: Optional[Array] = None) -> Array:
        """f(wo, wi): :meth:`Brdf.eval`."""
        return self.brdf.eval(wo, wi, cosine=cosine, out=out)

    def pdf(self, wo: Any, wi: Any, *, mode: str = "exact", out: Optional[Array] = None) -> Array:
        """The density of a mode per solid angle, sr^-1, shape (...); 0 below the surface."""
        wo, wi, shape = _pair(wo, wi)
        result = as_output(out, shape, common_dtype(wo, wi), "out", (wo, wi))
        self._core.eval_pdf(_is_one_shot(mode), spread(wo, shape), spread(wi, shape), None, result, False)
        return scalar_or_array(result)  # type: ignore[no-any-return]

    def eval_pdf(self, wo: Any, wi: Any, *, mode: str = "exact", cosine: bool = False,
                 out: Optional[Tuple[Array, Array]] = None) -> Tuple[Array, Array]:
        """Value and density together, for one evaluation of f: ``(eval(wo, wi), pdf(wo, wi))``."""
        wo, wi, shape = _pair(wo, wi)
        dtype = common_dtype(wo, wi)
        f_out, pdf_out = (None, None) if out is None else out
        f = as_output(f_out, shape + self.brdf.value_shape, dtype, "out[0]", (wo, wi))
        pdf = as_output(pdf_out, shape, dtype, "out[1]", (wo, wi))
        self._core.eval_pdf(_is_one_shot(mode), spread(wo, shape), spread(wi, shape), f, pdf, cosine)
        return scalar_or_array(f), scalar_or_array(pdf)

    def albedo(self, wo: Any, *, out: Optional[Array] = None) -> Array:
        """The integral of the target times cos theta_i over the hemisphere, from the table; shape (...).

        The target of three channels is the root of the sum of their squares unless another was asked for: of a
        white surface it is sqrt(3) times the albedo of one channel.
        """
        wo = as_vectors(wo, 3, "wo")
        result = as_output(out, wo.shape[:-1], common_dtype(wo), "out", (wo,))
        self._core.albedo(wo, result)
        return scalar_or_array(result)  # type: ignore[no-any-return]

    def expected_trials(self, wo: Any, *, out: Optional[Array] = None) -> Array:
        """The mean number of trials of exact mode, shape (...)."""
        wo = as_vectors(wo, 3, "wo")
        result = as_output(out, wo.shape[:-1], common_dtype(wo), "out", (wo,))
        self._core.expected_trials(wo, result)
        return scalar_or_array(result)  # type: ignore[no-any-return]

    # What it is

    @property
    def nbytes(self) -> int:
        """Bytes of its tables."""
        return int(self._core.nbytes)

    @property
    def isotropic(self) -> bool:
        """Whether the builder found that f depends on azimuths by their difference alone."""
        return bool(self._core.isotropic)

    def tables(self, mode: str = "one-shot") -> Tables:
        """The run-time arrays of a mode, read-only: what runtimes in other array languages sample from."""
        return tables_of(self._core, _is_one_shot(mode))

    def save(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Writes a sampler file, whole or not at all. The function is not inside: :func:`load_sampler` finds a
        material again by its text, and must be given a function of Python."""
        self._core.save(as_path(path))

    def __reduce__(self) -> Tuple[Any, ...]:
        return _sampler_again, (self.brdf, self._core.to_bytes())

    def _facts(self) -> List[Tuple[str, str]]:
        exact, one_shot = self._core.leaf_counts
        built = "" if self.build_seconds is None else f", built in {self.build_seconds:.2f} s"
        return [
            ("function", f"{self.brdf.name}, {'isotropic' if self.isotropic else 'anisotropic'}, "
                         f"{self.brdf.channels} channel{'s' if self.brdf.channels > 1 else ''}"),
            ("tables", f"{exact} + {one_shot} leaves, {self.nbytes / 1024:.0f} KiB, domain {self._core.domain}{built}"),
            ("exact", f"{self.report.expected_trials:.3g} trials at most, "
                      f"overshoot {self.report.overshoot_mass:.1g} of the mass (an estimate)"),
            ("one-shot", f"relative variance {self.report.one_shot_variance:.2g}"),
        ] + [("note", note) for note in self.report.notes]

    def __repr__(self) -> str:
        return "<reflectree.Sampler of " + "; ".join(
            text if key == "function" else f"{key}: {text}" for key, text in self._facts()) + ">"

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><th style='text-align:left'>{key}</th><td style='text-align:left'>{html.escape(text)}"
                       "</td></tr>" for key, text in self._facts())
        return f"<b>Sampler</b><table>{rows}</table>"


def _pair(wo: Any, wi: Any) -> Tuple[Array, Array, Tuple[int, ...]]:
    wo, wi = as_vectors(wo, 3, "wo"), as_vectors(wi, 3, "wi")
    return wo, wi, common_shape([wo.shape[:-1], wi.shape[:-1]], "wo and wi")


def _scalars(samples: Samples) -> Samples:
    return Samples(samples.wi, *(scalar_or_array(a) for a in samples[1:]))


def _target(target: Union[str, int]) -> Tuple[str, int]:
    """Its name, and the number of a channel."""
    if isinstance(target, str):
        return as_text(target, "target"), 0
    channel = as_whole(target, "target")
    if channel > 255:
        raise Error(f"channel {channel}", "target", "a function has at most 256 channels, from 0")
    return "channel", channel


def _wanted(expected_trials: float, one_shot_variance: float, albedo_error: float, seed: int, max_evaluations: int,
            threads: Optional[int]) -> Dict[str, Any]:
    """The options of a build, each a number of its kind."""
    return {"expected_trials": as_number(expected_trials, "expected_trials"),
            "one_shot_variance": as_number(one_shot_variance, "one_shot_variance"),
            "albedo_error": as_number(albedo_error, "albedo_error"), "seed": as_whole(seed, "seed"),
            "max_evaluations": as_whole(max_evaluations, "max_evaluations"), "threads": as_threads(threads)}


def _is_one_shot(mode: str) -> bool:
    if mode not in MODES:
        raise Error(f"{mode!r} is no mode", "mode", "say 'exact' or 'one-shot'")
    return mode == "one-shot"


def _made(brdf: Brdf, core: Any) -> Sampler:
    sampler = Sampler.__new__(Sampler)
    sampler._take(brdf, core, None)
    return sampler


def _sampler_again(brdf: Brdf, data: bytes) -> Sampler:
    return _made(brdf, _core.Sampler.from_bytes(brdf._core, data, "a pickled sampler"))


def load_sampler(path: Union[str, "os.PathLike[str]"], brdf: Optional[BrdfLike] = None) -> Sampler:
    """A sampler from its file.

    Parameters
    ----------
    path : path
        Of what :meth:`Sampler.save` or ``reflectree build`` wrote.
    brdf : optional
        The function that it was built for: needed for functions of Python. A material is found by its text.

    Raises
    ------
    Error
        For a file that is damaged, and a function that is another.
    """
    path = as_path(path)
    text = _core.sampler_file_material(path)
    if _core.names_family(path):
        raise Error("it holds the sampler of a family", path, "read it by rt.load_family(path)")
    if brdf is not None:
        f = as_brdf(brdf)
    elif text == _core.unnamed:
        raise Error("it was built for a function of Python, which the file does not hold", path,
                    "give the function, too: rt.load_sampler(path, f)")
    else:
        core = _core.Brdf.from_text(text, path)
        f = Brdf(core, core.name, (_beside, (text, path)))
    return _made(f, _core.Sampler.from_file(f._core, path))


def _beside(text: str, path: str) -> Brdf:
    core = _core.Brdf.from_text(text, path)
    return Brdf(core, core.name, (_beside, (text, path)))
