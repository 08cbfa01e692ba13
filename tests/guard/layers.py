#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Keeps the arrows between the rooms by reading every #include.

    text, math <- brdf <- sampler <- formats <- picture, peers, verify, draw, study, render, apps

A room may include itself and the rooms below it. Some rooms have small rooms, which keep arrows of their
own. Up to formats a room sees the standard library alone; Embree is seen by embree_scene alone.

Usage: layers.py ROOT. Prints one line per broken arrow; exit code 1 if there is one.
"""
import pathlib
import re

from report import report

CORE = ("ground", "text", "math", "brdf", "sampler", "formats")  # ground: headers directly in include/reflectree
BELOW_SAMPLER = ("ground", "text", "math", "brdf")
SAMPLER = (*BELOW_SAMPLER, "sampler")
MAY_SEE = {
    "ground": (),
    "text": ("ground",),
    "math": ("ground",),
    "brdf": ("ground", "text", "math"),
    "sampler": BELOW_SAMPLER,
    "simd": SAMPLER,
    "formats": SAMPLER,
    "picture": (*SAMPLER, "formats"),
    "verify": (*SAMPLER, "simd"),
    "peers": SAMPLER,
    "draw": (*SAMPLER, "picture"),
    "study": (*SAMPLER, "verify", "peers", "draw"),
    "render": (*SAMPLER, "formats", "picture", "peers"),  # reads meshes and pictures; chooses samplers by name
}
# Small rooms of a room: what each may see of the others. The files beside the small rooms are "".
SMALL_ROOMS = {
    "sampler": {
        "known": (),
        "square": (),
        "": ("known", "square"),
        "build": ("known", "square", ""),
    },
    "brdf": {
        "": (),
        "models": ("", "tables", "material"),
        "tables": ("",),
        "material": ("", "models", "tables"),
    },
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
COMPILERS_OWN = {"math": {"immintrin.h"}}  # math/lanes.hpp, where there are vector registers
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def room_of(path: str) -> tuple[str, str]:
    """The room and the small room of a file: sampler/known/albedo.hpp is in ("sampler", "known")."""
    parts = path.split("/")
    if len(parts) == 1:
        return "ground", ""
    small = parts[1] if len(parts) > 2 and parts[1] in SMALL_ROOMS.get(parts[0], {}) else ""
    return parts[0], small


def sources(root: pathlib.Path):
    """(room, small room, file) of every C++ file that belongs to a room."""
    for top in (root / "include" / "reflectree", root / "src"):
        for file in sorted(top.rglob("*")):
            if file.suffix in (".hpp", ".cpp", ".h"):
                yield (*room_of(str(file.relative_to(top))), file)


def broken_arrows(root: pathlib.Path) -> list[str]:
    found = []
    for room, small, file in sources(root):
        where = file.relative_to(root)
        if room not in MAY_SEE:
            found.append(f"{where}: no room is called {room}; name it in tests/guard/layers.py")
            continue
        for bracket, name in INCLUDE.findall(file.read_text(encoding="utf-8")):
            seen, seen_small = room, small
            if name.startswith("reflectree/"):
                seen, seen_small = room_of(name.removeprefix("reflectree/"))
                if seen != room and seen not in MAY_SEE[room]:
                    found.append(f"{where}: {room} may not see {seen} ({name})")
            elif bracket == "<" and room in CORE and name not in STANDARD | COMPILERS_OWN.get(room, set()):
                found.append(f"{where}: {room} depends on the standard library alone, not on <{name}>")
            elif bracket == '"' and ".." not in name and (root / "src" / room / name).is_file() and (
                    "/" in name or not (file.parent / name).is_file()):
                seen_small = room_of(f"{room}/{name}")[1]
            elif bracket == '"' and not (file.parent / name).is_file():
                found.append(f'{where}: "{name}" is neither a public header, nor beside this file, nor in its room')
            elif bracket == '"' and (file.parent / name).resolve().parent != file.parent.resolve():
                found.append(f'{where}: "{name}" reaches into another folder; make it a public header')
            if seen == room and seen_small != small and seen_small not in SMALL_ROOMS[room][small]:
                found.append(f"{where}: {room}/{small} may not see {room}/{seen_small} ({name})")
            if "embree" in name and "reflectree/" not in name and file.stem != "embree_scene":
                found.append(f"{where}: embree_scene alone sees Embree, not this file")
    return found


if __name__ == "__main__":
    report(broken_arrows, "every arrow holds")
