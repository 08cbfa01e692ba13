# SPDX-License-Identifier: Apache-2.0
"""Progress of long work: a callable of the caller's, or tqdm's bar where it is installed."""

from __future__ import annotations

import contextlib
from typing import Any, Callable, Iterator, Optional, Union

from ._error import Error

Progress = Union[None, bool, Callable[[float, str], Any]]


@contextlib.contextmanager
def opened(progress: Progress) -> Iterator[Optional[Callable[[float, str], Any]]]:
    """What C++ calls as tell(fraction, stage)."""
    if progress is None or progress is False:
        yield None
    elif progress is not True:
        if not callable(progress):
            raise Error(f"a {type(progress).__name__} cannot be called", "progress",
                        "give progress(fraction, stage), or True for tqdm's bar")
        yield progress
    else:
        try:
            from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]
        except ImportError:
            raise Error("tqdm is not installed", "progress=True",
                        "pip install tqdm, or give a function progress(fraction, stage)") from None
        with tqdm(total=100, unit="%", bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}") as bar:

            def tell(fraction: float, stage: str) -> None:
                bar.set_description(stage, refresh=False)
                bar.update(max(0.0, 100 * fraction - bar.n))

            yield tell
