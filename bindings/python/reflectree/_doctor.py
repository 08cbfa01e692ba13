# SPDX-License-Identifier: Apache-2.0
"""The doctor: judges anybody's eval, sample and pdf, and says in words what is wrong with them."""

from __future__ import annotations

import html
import json
import math
import os
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np

from . import _core
from ._arrays import Array, as_whole
from ._brdf import Brdf, BrdfLike, as_brdf
from ._checks import Check, Figure, checks_html, need_judges, rows_html
from ._conventions import direction
from ._error import Error
from ._files import write_text
from ._progress import Progress, opened
from ._sampler import Sampler

OURS = ("exact", "one-shot", "one-shot-monotone")


class Evidence(NamedTuple):
    """One pair of directions at which a fault shows.

    Attributes
    ----------
    wo, wi : array, shape (3,)
        To type into your own code.
    quantity : str
        Such as ``"pdf(wo, wi)"``; empty where the pair alone tells.
    found, expected : float
        Its value, and what it should be.
    """

    wo: Array
    wi: Array
    quantity: str
    found: float
    expected: float


class Finding(NamedTuple):
    """What is wrong, in words.

    Attributes
    ----------
    check : str
        Which check saw it.
    cause : str
        The hypothesis that explains it, a key of :func:`causes`; ``"unexplained"`` where none does.
    words : str
        A sentence.
    fault : bool
        False: a remark that fails nobody, such as missing reciprocity.
    evidence : Evidence, optional
        A pair that shows it.
    figures : list of Figure
        What the check measured.
    text : str
        All of it over a few lines, as the command line prints it.
    """

    check: str
    cause: str
    words: str
    fault: bool
    evidence: Optional[Evidence]
    figures: List[Figure]
    text: str

    def __str__(self) -> str:
        return self.text.rstrip("\n")


def _number(x: float) -> Any:
    """JSON has no NaN."""
    return x if math.isfinite(x) else str(x)


class Diagnosis:
    """What the doctor says. Its truth is whether no fault was found.

    Attributes
    ----------
    subject : str
        What was examined.
    conventions : list of str
        How the three functions were understood, in sentences.
    findings : list of Finding
        The first one often brings about the rest.
    checks : list of Check
        The symptoms.
    figures : list of Figure
        Quality: relative variance, worst weight, nanoseconds.
    calls, directions : int
        Of functions of Python: how often they were called, and for how many directions in all.
    """

    def __init__(self, core: Any, calls: int = 0, directions: int = 0) -> None:
        self._core = core
        self.subject: str = core.subject
        self.conventions: List[str] = list(core.conventions)
        self.checks = [Check(*c) for c in core.checks]
        self.figures = [Figure(*f) for f in core.figures]
        self.findings = [
            Finding(check, cause, words, fault,
                    None if pair is None else Evidence(np.array(pair[0], np.float32), np.array(pair[1], np.float32), *pair[2:]),
                    [Figure(*f) for f in figures], text)
            for check, cause, words, fault, pair, figures, text in core.findings]
        self.calls, self.directions = calls, directions

    @property
    def healthy(self) -> bool:
        """Whether no fault was found; remarks do not count."""
        return bool(self._core.healthy)

    @property
    def faults(self) -> List[Finding]:
        """The findings that are no mere remarks."""
        return [f for f in self.findings if f.fault]

    def __bool__(self) -> bool:
        return self.healthy

    def to_dict(self) -> Dict[str, Any]:
        """What ``reflectree doctor --json`` prints: plain dictionaries and lists."""
        def figures(list_of: List[Figure]) -> List[Dict[str, Any]]:
            return [{"name": f.name, "where": f.where, "value": _number(f.value)} for f in list_of]

        def finding(f: Finding) -> Dict[str, Any]:
            item: Dict[str, Any] = {"check": f.check, "cause": f.cause, "words": f.words, "fault": f.fault,
                                    "figures": figures(f.figures)}
            if f.evidence is not None:
                pair = item["evidence"] = {key: [float(str(x)) for x in getattr(f.evidence, key)] for key in ("wo", "wi")}
                if f.evidence.quantity:
                    pair.update(quantity=f.evidence.quantity, found=_number(f.evidence.found),
                                expected=_number(f.evidence.expected))
            return item

        return {"schema_version": 1, "command": "doctor", "subject": self.subject, "healthy": self.healthy,
                "conventions": self.conventions, "findings": [finding(f) for f in self.findings],
                "checks": [{"name": c.name, "where": c.where, "passed": c.passed, "statistic": _number(c.statistic),
                            "threshold": _number(c.threshold), "p_value": _number(c.p_value), "detail": c.sentence}
                           for c in self.checks],
                "figures": figures(self.figures)}

    def to_json(self, path: Union[None, str, "os.PathLike[str]"] = None) -> str:
        """The same as JSON text; written to a file, too, where a path is given, whole or not at all."""
        text = json.dumps(self.to_dict(), indent=2) + "\n"
        if path is not None:
            write_text(path, text)
        return text

    def to_html(self, path: Union[None, str, "os.PathLike[str]"] = None) -> str:
        """An offline page with figures; written to a file, too, where a path is given. Needs the studio
        (docs/python.md)."""
        from ._studio import need_studio

        text: str = need_studio("Diagnosis.to_html").doctor_html(self._core, "rt.doctor", _core.version)
        if path is not None:
            write_text(path, text)
        return text

    def _summary(self) -> str:
        n = len(self.faults)
        return "no fault was found" if n == 0 else "1 fault was found" if n == 1 else f"{n} faults were found"

    def __repr__(self) -> str:
        return f"<reflectree.Diagnosis of {self.subject}: {self._summary()}" + "".join(
            f"; {f.words}" for f in self.faults) + ">"

    def __str__(self) -> str:
        failed = [c for c in self.checks if not c.passed]
        lines = [self.subject] + [f"  {c}" for c in self.conventions] + [f"  {c}" for c in failed]
        lines.append(f"  pass  {len(self.checks) - len(failed)} of {len(self.checks)} checks")
        lines += [f"        {f.name:30} {f.where:20} {f.value:.4g}" for f in self.figures]
        return "\n".join(lines + [str(f) for f in self.findings] + [self._summary()])

    def _repr_html_(self) -> str:
        findings = "".join(f"<p><b>{'fault' if f.fault else 'remark'}</b> {html.escape(f.words)}<br>"
                           f"<code>{html.escape(f.text)}</code></p>" for f in self.findings)
        figures = rows_html(((f.name, f.where, f"{f.value:.4g}") for f in self.figures), ("figure", "at", "value"))
        return (f"<b>{html.escape(self.subject)}: {self._summary()}</b>{findings}{figures}"
                f"<details><summary>{len(self.checks)} checks</summary>{checks_html(self.checks)}</details>")


def causes() -> Dict[str, str]:
    """Every cause that the doctor knows by name: its key in ``Finding.cause``, and its meaning."""
    return dict(need_judges("rt.causes").doctor_causes())


def samplers() -> Dict[str, str]:
    """The names of our samplers and of all competitors, each with a line about it."""
    return dict(need_judges("rt.samplers").sampler_names())


# Functions of others: answers are brought to one form, and what cannot be is an Error that says what came.

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


class _Triple:
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

    or ``subject``, a :class:`Sampler`, a material or a function, with the name of one of our samplers or of a
    competitor.

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
        where there is none. An ``rt.Samples`` will do. What is left out at the end: ``pdf`` is asked for, and there is
        no weight.
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
    count, number = as_whole(threads or 0, "threads"), as_whole(seed, "seed")
    functions = [f for f in (eval, sample, pdf) if f is not None]
    if (subject is None) == (not functions):
        raise Error("one subject is wanted", "rt.doctor", "give a sampler or a material, or the functions eval, sample, pdf")
    if subject is None:
        triple = _Triple(eval, sample, pdf)
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
