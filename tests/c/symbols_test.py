#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The shared library shows the symbols of symbols.txt and nothing else, and the header declares exactly those.

Usage: symbols_test.py NM LIBRARY SYMBOLS HEADER [--twin]. --twin: with a symbol struck off and one added, the
comparison must fail.
"""
import pathlib
import re
import subprocess
import sys


def main() -> int:
    nm, library, symbols, header = sys.argv[1:5]
    listed = set(pathlib.Path(symbols).read_text(encoding="utf-8").split())
    if "--twin" in sys.argv:
        listed = (listed - {"reflectree_build"}) | {"reflectree_planted"}
    lines = subprocess.run([nm, "-D", "--defined-only", library], check=True, capture_output=True, text=True).stdout
    # "address kind name@@version"; the version itself is an absolute symbol.
    shown = {line.split()[2].split("@")[0] for line in lines.splitlines() if line.split()[1] != "A"}
    text = pathlib.Path(header).read_text(encoding="utf-8")
    declared = set(re.findall(r"REFLECTREE_API\s[^;]*?\b(reflectree_\w+)\(", text))
    wrong = [f"{name}: {what}" for what, names in (
        ("shown, not listed", shown - listed), ("listed, not shown", listed - shown),
        ("declared, not listed", declared - listed), ("listed, not declared", listed - declared)) for name in names]
    print("\n".join(sorted(wrong)) or f"{len(shown)} symbols")
    if "--twin" in sys.argv:
        return 0 if len(wrong) == 4 else 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
