# SPDX-License-Identifier: Apache-2.0
"""What judges return: checks with their verdicts, and figures without."""

from __future__ import annotations

import html
from typing import Any, Iterable, List, NamedTuple, Tuple

from . import _core
from ._error import Error


class Check(NamedTuple):
    """One check, and how it went.

    Attributes
    ----------
    name : str
        Such as ``"chi_square"``; docs/doctor.md and ``reflectree verify --help`` say what each asks.
    way : str
        The method that it is about, such as ``"sample_one_shot"``; empty where it is about the whole.
    where : str
        The viewers that it looked at.
    passed : bool
        ``statistic <= threshold``.
    decided : bool
        False where so few draws cannot tell; it has then passed, and the sentence says what would decide it.
    statistic, threshold : float
        What was measured, and its limit.
    p_value : float
        Of a statistical test; 1 for any other check.
    sentence : str
        What the numbers are.
    """

    name: str
    way: str
    where: str
    passed: bool
    decided: bool
    statistic: float
    threshold: float
    p_value: float
    sentence: str

    @property
    def verdict(self) -> str:
        """``"pass"``, ``"FAIL"``, or ``"open"`` where it is not decided."""
        return "FAIL" if not self.passed else "pass" if self.decided else "open"

    def __str__(self) -> str:
        p = f"  p = {self.p_value:.2g}" if self.p_value < 1 else ""
        sign = "<=" if self.statistic <= self.threshold else ">"
        where = f", {self.where}" if self.where else ""
        return (f"{self.verdict}  {self.name}  {self.statistic:.5g} {sign} {self.threshold:.5g}{p}  "
                f"({self.sentence}{where})")


class Figure(NamedTuple):
    """A number without a verdict.

    Attributes
    ----------
    name : str
        What it is.
    where : str
        The viewer that it belongs to.
    value : float
        The number.
    """

    name: str
    where: str
    value: float


def need_judges(who: str) -> Any:
    """The core, where it was built with the judges."""
    if not _core.has_judges:
        raise Error("the package was built without the judges, for which the headers of Boost and Eigen are needed", who,
                    "install them (on Debian: libboost-dev libeigen3-dev) and repeat pip install --force-reinstall")
    return _core


def rows_html(rows: Iterable[Tuple[str, ...]], head: Tuple[str, ...]) -> str:
    """A table; every cell is escaped."""
    def line(cells: Tuple[str, ...], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag} style='text-align:left'>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    return "<table>" + line(head, "th") + "".join(line(row, "td") for row in rows) + "</table>"


def checks_html(checks: List[Check]) -> str:
    head = ("check", "method", "at", "verdict", "found", "limit", "p", "what")
    return rows_html(((c.name, c.way, c.where, c.verdict, f"{c.statistic:.4g}", f"{c.threshold:.4g}",
                       f"{c.p_value:.2g}" if c.p_value < 1 else "", c.sentence) for c in checks), head)
