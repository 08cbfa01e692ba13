#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the notebooks of the tutorials from their scripts, so that there is one text of each.

Usage: notebooks.py ROOT [--check]. examples/python/NAME.py becomes examples/python/notebooks/NAME.ipynb: the docstring
is the title, a line `# %%` begins a cell of code, `# %% [markdown]` one of text, in comments. With --check nothing is
written; exit code 1 where a notebook is not that of its script.
"""
import ast
import json
import pathlib
import re
import sys


def cells_of(script: str) -> list[tuple[str, str]]:
    """("markdown" or "code", text), in order. Code is a line less than the script: comments before the first cell."""
    title = ast.get_docstring(ast.parse(script))
    first, _, rest = title.partition("\n")
    cells = [("markdown", f"# {first.rstrip('.')}" + (f"\n{rest}" if rest.strip() else ""))]
    for part in re.split(r"^# %%", script, flags=re.MULTILINE)[1:]:
        head, _, body = part.partition("\n")
        if head.strip() == "[markdown]":
            lines = [line for line in body.strip("\n").split("\n")]
            if not all(line == "#" or line.startswith("# ") for line in lines):
                raise ValueError(f"a cell of text holds code: {lines[0]}")
            cells.append(("markdown", "\n".join(line[2:] for line in lines)))
        elif head.strip():
            raise ValueError(f"a cell of another kind: {head}")
        else:
            cells.append(("code", body.strip("\n")))
    return cells


def notebook(script: str) -> str:
    def cell(number: int, kind: str, text: str) -> dict:
        lines = text.splitlines(keepends=True)
        made = {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": lines}
        return made | {"execution_count": None, "outputs": []} if kind == "code" else made

    return json.dumps({
        "cells": [cell(number, *c) for number, c in enumerate(cells_of(script))],
        "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
                     "language_info": {"name": "python"}},
        "nbformat": 4, "nbformat_minor": 5}, indent=1, ensure_ascii=False) + "\n"


def main() -> int:
    folder = pathlib.Path(sys.argv[1]) / "examples" / "python"
    check = "--check" in sys.argv[2:]
    stale = []
    for script in sorted(folder.glob("*.py")):
        target = folder / "notebooks" / f"{script.stem}.ipynb"
        text = notebook(script.read_text(encoding="utf-8"))
        if target.exists() and target.read_text(encoding="utf-8") == text:
            continue
        stale.append(target.name)
        if not check:
            target.parent.mkdir(exist_ok=True)
            target.write_text(text, encoding="utf-8")
    for left in sorted({p.stem for p in folder.glob("notebooks/*.ipynb")} - {p.stem for p in folder.glob("*.py")}):
        stale.append(f"{left}.ipynb, which has no script")
    if check and stale:
        print("not those of their scripts (run tools/notebooks.py .):", ", ".join(stale))
    return 1 if check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
