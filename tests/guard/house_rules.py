#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rules that every file obeys: an SPDX line, #pragma once in headers, nothing left for later, no
absolute path of somebody's machine.

Usage: house_rules.py ROOT. Prints one line per broken rule; exit code 1 if there is one.
"""
import os
import pathlib
import re

from report import report

SPDX = "SPDX-License-Identifier: Apache-2.0"
SOURCE = {".hpp", ".cpp", ".h", ".py", ".sh", ".cmake", ".in", ".js", ".css", ".ts", ".supp"}
SOURCE_NAMES = {"CMakeLists.txt", "x", "run", ".clang-format"}
TEXT = SOURCE | {".md", ".json", ".cff", ".txt", ".html"}
LATER = re.compile(r"\b(TO" + "DO|FIX" + r"ME|XX" + r"X)\b")
ABSOLUTE = re.compile(r"(?<![\w.$}>/~:])/(?:home|work|root|Users|mnt|media)/\w")


def files(root: pathlib.Path):
    for folder, folders, names in os.walk(root):
        at_root = pathlib.Path(folder) == root  # a room's small room may be called build
        folders[:] = sorted(d for d in folders if not (at_root and d.startswith(("build", "reflectree-demo")))
                            and d not in (".git", ".cache", ".venv", "__pycache__", "golden", "corpus"))
        for name in sorted(names):
            yield pathlib.Path(folder) / name


def broken_rules(root: pathlib.Path) -> list[str]:
    found = []
    for file in files(root):
        where = file.relative_to(root)
        is_source = file.suffix in SOURCE or file.name in SOURCE_NAMES
        if not is_source and file.suffix not in TEXT:
            continue
        text = file.read_text(encoding="utf-8", errors="replace")
        if is_source and file.name != ".clang-format" and not any(SPDX in line for line in text.split("\n")[:3]):
            found.append(f"{where}: no SPDX line at the top")
        if file.suffix == ".hpp" and "#pragma once" not in text:
            found.append(f"{where}: no #pragma once")
        for number, line in enumerate(text.split("\n"), 1):
            if LATER.search(line):
                found.append(f"{where}:{number}: something is left for later: {line.strip()}")
            if ABSOLUTE.search(line):
                found.append(f"{where}:{number}: an absolute path: {line.strip()}")
    return found


if __name__ == "__main__":
    report(broken_rules, "every rule holds")
