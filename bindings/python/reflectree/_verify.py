# SPDX-License-Identifier: Apache-2.0
"""Is a sampler right? Every check of the command ``reflectree verify``, on the methods of Python."""

from __future__ import annotations

import html
import json
from typing import Any, Dict, List, NamedTuple, Optional, Union

from ._arrays import as_number, as_threads, as_whole
from ._brdf import BrdfLike
from ._checks import Check, Figure, checks_html, need_judges
from ._progress import Progress, opened
from ._sampler import Sampler


class VerifyReport(NamedTuple):
    """What :func:`verify` found. Its truth is whether everything passed.

    Attributes
    ----------
    subject : str
        The function whose sampler it is.
    checks : list of Check
        In the order in which they ran.
    figures : list of Figure
        Numbers without a verdict: variance, reciprocity, largest albedo.
    notes : list of str
        What the build said about itself.
    """

    subject: str
    checks: List[Check]
    figures: List[Figure]
    notes: List[str]

    @property
    def passed(self) -> bool:
        """Whether no check failed."""
        return all(c.passed for c in self.checks)

    @property
    def failed(self) -> List[Check]:
        """The checks that failed."""
        return [c for c in self.checks if not c.passed]

    def __bool__(self) -> bool:
        return self.passed

    def to_dict(self) -> Dict[str, Any]:
        """Plain dictionaries and lists."""
        return {"subject": self.subject, "passed": self.passed, "checks": [c._asdict() for c in self.checks],
                "figures": [f._asdict() for f in self.figures], "notes": self.notes}

    def to_json(self) -> str:
        """The same as JSON."""
        return json.dumps(self.to_dict(), indent=2)

    def _summary(self) -> str:
        undecided = sum(not c.decided for c in self.checks)
        text = f"{len(self.checks) - len(self.failed)} of {len(self.checks)} checks of {self.subject} passed"
        return text + (f", {undecided} of them open" if undecided else "")

    def __repr__(self) -> str:
        return f"<reflectree.VerifyReport: {self._summary()}" + "".join(f"; {c}" for c in self.failed) + ">"

    def __str__(self) -> str:
        lines = [str(c) for c in self.checks]
        lines += [f"      {f.name}  {f.value:.5g}  ({f.where})" for f in self.figures]
        return "\n".join(lines + [f"note  {note}" for note in self.notes] + [self._summary()])

    def _repr_html_(self) -> str:
        return f"<b>{html.escape(self._summary())}</b>" + checks_html(self.checks)


def verify(sampler: Union[Sampler, BrdfLike], *, effort: float = 1.0, seed: int = 1, threads: Optional[int] = None,
           progress: Progress = None) -> VerifyReport:
    """Judges a sampler by its function: directions by chi-square against a cubature that shares no code with the
    builder, weights and densities draw by draw, bounds by trials and attack, the albedo table, places in leaves.

    What is asked are the methods that Python has: ``sample``, ``sample_n`` and ``sample_one_shot`` with and without
    uniforms. All statistical tests together reject a sound sampler in one run of 100 000.

    Parameters
    ----------
    sampler : Sampler, or what Sampler takes
        A function, text or path is built first, with the seed given.
    effort : float
        Multiplies what is drawn, 0.01 to 1000. A material takes some 6 s of processor time with 1, a function of NumPy
        some 8 s with 0.1.
    seed : int
        Of all random numbers.
    threads : int, optional
        All cores by default. A function of Python is called by one of them.
    progress : True or callable, optional
        As in :class:`Sampler`.

    Returns
    -------
    VerifyReport

    Raises
    ------
    Error
        For an effort out of range, a function that returns what is no reflectance, a package built without judges.
    KeyboardInterrupt
        Ctrl-C ends the work.
    """
    core = need_judges("rt.verify")
    count, number = as_threads(threads), as_whole(seed, "seed")
    if not isinstance(sampler, Sampler):
        sampler = Sampler(sampler, seed=number, threads=count)
    with opened(progress) as tell:
        found = core.verify(sampler._core, effort=as_number(effort, "effort"), seed=number, threads=count, progress=tell)
    return VerifyReport(sampler.brdf.name, [Check(**c) for c in found["checks"]],
                        [Figure(*f) for f in found["figures"]], list(found["notes"]))
