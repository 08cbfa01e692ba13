# SPDX-License-Identifier: Apache-2.0
"""What the doctor says: findings, each with a pair of directions that shows it, and the symptoms."""

from __future__ import annotations

import html
import json
import math
import os
from typing import Any, Dict, List, NamedTuple, Optional, Union

import numpy as np

from . import _core
from ._arrays import Array
from ._checks import Check, Figure, checks_html, rows_html
from ._files import write_text


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
        """An offline page with figures; written to a file, too, where a path is given.
        Needs the studio (docs/python.md)."""
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
