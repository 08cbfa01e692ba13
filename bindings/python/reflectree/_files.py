# SPDX-License-Identifier: Apache-2.0
"""Paths and texts; files are written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Union

from ._error import Error


def as_text(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise Error(f"a {type(value).__name__} is no text", name, "give a str")
    try:
        value.encode()
    except UnicodeEncodeError as error:
        raise Error(f"{value!r} has characters that are none of Unicode", name, "leave them out") from error
    return value


def as_path(value: Any) -> str:
    if not isinstance(value, (str, os.PathLike)):
        raise Error(f"a {type(value).__name__} is no path", "path", "give a str or a pathlib.Path; open files are not read")
    return as_text(os.fspath(value), "path")


def write_text(path: Union[str, "os.PathLike[str]"], text: str) -> None:
    path = as_path(path)
    try:
        handle, temporary = tempfile.mkstemp(dir=os.path.dirname(path) or ".", prefix=".reflectree-")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                file.write(text)
            os.chmod(temporary, 0o644)
            os.replace(temporary, path)
        except BaseException:
            os.unlink(temporary)
            raise
    except OSError as error:
        raise Error(f"it cannot be written ({error.strerror})", path, "name a file in a folder that may be written to") from error
