# SPDX-License-Identifier: Apache-2.0
"""The doctor: judges anybody's eval, sample and pdf, and says in words what is wrong with them."""

from __future__ import annotations

from typing import Any, Callable, Dict, Optional, Union

from ._arrays import as_threads, as_whole
from ._brdf import Brdf, BrdfLike, as_brdf
from ._checks import need_judges
from ._diagnosis import Diagnosis
from ._error import Error
from ._progress import Progress, opened
from ._sampler import Sampler
from ._triple import Triple

OURS = ("exact", "one-shot", "one-shot-monotone")


def causes() -> Dict[str, str]:
    """Every cause that the doctor knows by name: its key in ``Finding.cause``, and its meaning."""
    return dict(need_judges("rt.causes").doctor_causes())


def samplers() -> Dict[str, str]:
    """The names of our samplers and of all competitors, each with a line about it."""
    return dict(need_judges("rt.samplers").sampler_names())


def doctor(subject: Union[None, Sampler, BrdfLike] = None, *, eval: Optional[Callable[..., Any]] = None,
           sample: Optional[Callable[..., Any]] = None, pdf: Optional[Callable[..., Any]] = None,
           sampler: str = "exact", eval_returns: str = "detect", sample_returns: str = "detect",
           name: Optional[str] = None, effort: str = "default", seed: int = 1, threads: Optional[int] = None,
           progress: Progress = None) -> Diagnosis:
    """Examines a sampler from outside, by its eval, sample and pdf, and names what is wrong.

    Either three functions of NumPy::

        diagnosis = rt.doctor(eval=f, sample=draw, pdf=density)
        if not diagnosis:
            print(diagnosis)

    or ``subject``, a :class:`Sampler`, a material or a function, with the name of one of our samplers
    or of a competitor.

    Parameters
    ----------
    subject : Sampler, or what Sampler takes
        Whose sampler is examined. A sampler of ours is built where none is given.
    eval : callable
        ``eval(wo, wi) -> (n,) or (n, channels)`` for arrays of shape (n, 3), both directions above the surface: f in
        sr^-1, or f cos theta_i.
    sample : callable
        ``sample(wo, rng) -> (wi, pdf, weight)``, arrays of shape (n, 3), (n,) and (n,) or (n, channels), drawn with
        the ``numpy.random.Generator`` given; with a fourth array, whether there is a direction, or zeros in ``wi``
        where there is none. An ``rt.Samples`` will do. What is left out at the end: ``pdf`` is asked for,
        and there is no weight.
    pdf : callable, optional
        ``pdf(wo, wi) -> (n,)``: the density of sample's directions per solid angle. Without it the method has none.
    sampler : str
        Of ``subject``: one of :func:`samplers`.
    eval_returns : "detect", "f", "f_cos"
        What eval returns; the diagnosis says what was found out.
    sample_returns : "detect", "weight", "f_cos", "f", "none"
        What sample returns beside direction and pdf: f cos / pdf, one of the other two, or nothing.
    name : str, optional
        For the report.
    effort : "quick", "default", "thorough"
        Seconds, some ten seconds, a minute and more of a native sampler.
    seed : int
        Of all random numbers.
    threads : int, optional
        All cores by default. Functions of Python are called by the calling thread alone, in batches of up to 65 536.
    progress : True or callable, optional
        As in :class:`Sampler`.

    Raises
    ------
    Error
        For functions that return other shapes, unknown names, a competitor that does not serve the material, a
        package built without judges. What a function raises is passed on.
    KeyboardInterrupt
        Ctrl-C ends the work.
    """
    core = need_judges("rt.doctor")
    count, number = as_threads(threads), as_whole(seed, "seed")
    functions = [f for f in (eval, sample, pdf) if f is not None]
    if (subject is None) == (not functions):
        raise Error("one subject is wanted", "rt.doctor", "give a sampler or a material, or the functions eval, sample, pdf")
    if subject is None:
        triple = Triple(eval, sample, pdf)
        if not triple.has_values and sample_returns not in ("detect", "none"):
            raise Error("it returns no weight", "sample", f"return (wi, pdf, weight), or say sample_returns='none' "
                                                          f"instead of {sample_returns!r}")
        returns = sample_returns if triple.has_values else "none"
        with opened(progress) as tell:
            return Diagnosis(*core.diagnose_functions(
                triple.eval, triple.sample, None if pdf is None else triple.pdf, channels=triple.channels,
                name=name or getattr(sample, "__qualname__", type(sample).__qualname__), eval_returns=eval_returns,
                sample_returns=returns, effort=effort, seed=number, progress=tell))
    if sampler not in samplers():
        raise Error(f"no sampler {sampler!r}", "sampler", "choose of " + ", ".join(samplers()))
    brdf: Brdf = subject.brdf if isinstance(subject, Sampler) else as_brdf(subject)
    name = name or f"{sampler} of {brdf.name}"
    if sampler in OURS:
        built = subject if isinstance(subject, Sampler) else Sampler(brdf, threads=count)
        with opened(progress) as tell:
            return Diagnosis(core.diagnose_sampler(built._core, mode=sampler, name=name, effort=effort, seed=number,
                                                   threads=count, progress=tell))
    with opened(progress) as tell:
        return Diagnosis(core.diagnose_peer(brdf._core, sampler=sampler, name=name, effort=effort, seed=number,
                                            threads=count, progress=tell))
