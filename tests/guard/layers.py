#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Keeps the arrows between the rooms by reading every #include.

    math <- brdf <- sampler <- simd, io, verify, draw, peers, render, study, apps, bindings

A room may include itself and the rooms below it. The core (math, brdf, sampler) sees the standard
library alone; Embree is seen by render/embree_scene alone.

Usage: layers.py ROOT. Prints one line a broken arrow; exit code 1 if there is one.
"""
import pathlib
import re
import sys

CORE = ("base", "math", "brdf", "sampler")  # base: headers directly in include/reflectree
MAY_SEE = {
    "base": (),
    "math": ("base",),
    "brdf": ("base", "math"),
    "sampler": ("base", "math", "brdf"),
    "simd": CORE,
    "io": CORE,
    "verify": (*CORE, "simd"),
    "peers": CORE,
    "render": (*CORE, "io", "peers"),  # reads meshes and pictures; chooses samplers by name
    "draw": (*CORE, "verify"),
    "study": (*CORE, "verify", "peers", "draw"),
}
STANDARD = frozenset(
    """algorithm array atomic bit bitset cassert cctype cerrno cfloat charconv chrono cinttypes climits
    clocale cmath cstdarg compare complex concepts condition_variable csignal cstddef cstdint cstdio cstdlib
    cstring ctime deque exception filesystem forward_list fstream functional future initializer_list
    iomanip ios iosfwd iostream istream iterator limits list locale map memory mutex new numbers
    numeric optional ostream queue random ratio set shared_mutex span sstream stack stdexcept
    streambuf string string_view system_error thread tuple type_traits typeindex typeinfo
    unordered_map unordered_set utility valarray variant vector version""".split()
)
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def room_of(path: str) -> str:
    """The room of a header as it is included: reflectree/brdf/value.hpp is in brdf."""
    parts = path.split("/")
    return parts[1] if len(parts) > 2 else "base"


def sources(root: pathlib.Path):
    """(room, file) of every C++ file that belongs to a room."""
    for top in (root / "include" / "reflectree", root / "src"):
        for file in sorted(top.rglob("*")):
            if file.suffix in (".hpp", ".cpp", ".h"):
                parts = file.relative_to(top).parts
                yield (parts[0] if len(parts) > 1 else "base"), file


def broken_arrows(root: pathlib.Path) -> list[str]:
    found = []
    for room, file in sources(root):
        where = file.relative_to(root)
        if room not in MAY_SEE:
            found.append(f"{where}: no room is called {room}; name it in tests/guard/layers.py")
            continue
        for bracket, name in INCLUDE.findall(file.read_text(encoding="utf-8")):
            if name.startswith("reflectree/"):
                seen = room_of(name)
                if seen != room and seen not in MAY_SEE[room]:
                    found.append(f"{where}: {room} may not see {seen} ({name})")
            elif bracket == "<" and room in CORE and name not in STANDARD:
                found.append(f"{where}: {room} depends on the standard library alone, not on <{name}>")
            elif bracket == '"' and not (file.parent / name).is_file():
                found.append(f'{where}: "{name}" is neither a public header nor beside this file')
            elif bracket == '"' and (file.parent / name).resolve().parent != file.parent.resolve():
                found.append(f'{where}: "{name}" reaches into another folder; make it a public header')
            if "embree" in name and "reflectree/" not in name and file.stem != "embree_scene":
                found.append(f"{where}: render/embree_scene alone sees Embree, not this file")
    return found


def main() -> int:
    found = broken_arrows(pathlib.Path(sys.argv[1]))
    print("\n".join(found) or "every arrow holds")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
