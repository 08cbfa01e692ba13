# SPDX-License-Identifier: Apache-2.0
"""The one exception of the package."""

from __future__ import annotations


class Error(ValueError):
    """What is wrong, where, and how to mend it; the same three that C++ and the command line say.

    Attributes
    ----------
    what : str
        What is wrong.
    where : str
        The file, argument or direction that it is about.
    how : str
        How to mend it.
    """

    def __init__(self, what: str, where: str, how: str) -> None:
        super().__init__(what, where, how)
        self.what = what
        self.where = where
        self.how = how

    def __str__(self) -> str:
        return f"{self.where}: {self.what}; {self.how}"


class BuildWarning(UserWarning):
    """What a sampler was asked to keep and does not, a sentence of its ``report.notes``."""
