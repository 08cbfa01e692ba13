# SPDX-License-Identifier: Apache-2.0
"""The README shows examples/ten_lines.cpp as it is. Usage: in_readme.py ROOT"""
import pathlib
import sys

root = pathlib.Path(sys.argv[1])
code = [line for line in (root / "examples/ten_lines.cpp").read_text().splitlines() if not line.startswith("//")]
shown = "".join(f"    {line}\n" if line else "\n" for line in code)
if shown not in (root / "README.md").read_text():
    sys.exit("README.md: its example is not examples/ten_lines.cpp; copy it again")
