#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the house from its own includes: rooms on floors, an arrow for every room that another one sees.

    tools/draw_house.py                 the picture to docs/house.svg, a table of rooms to standard output
    tools/draw_house.py --check         nothing is written; exit code 1 if docs/house.svg is not what is drawn now

A room is a folder of include/reflectree and src, apps/reflectree, or the headers at the top (ground). A room
stands on the lowest floor that is above all rooms it sees. Exit code 1 for a circle: then there are no floors.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
WIDTH, BOX_WIDTH, BOX_HEIGHT, FLOOR = 900, 118, 52, 104


def room_of(path: pathlib.PurePosixPath) -> str:
    return path.parts[0] if len(path.parts) > 1 else "ground"


def sources():
    """(room, small room, file) of every C++ file of the house."""
    for top, fixed in (("include/reflectree", None), ("src", None), ("apps/reflectree", "apps")):
        for file in sorted((ROOT / top).rglob("*")):
            if file.suffix not in (".hpp", ".cpp"):
                continue
            path = pathlib.PurePosixPath(file.relative_to(ROOT / top).as_posix())
            small = path.parts[1] if len(path.parts) > 2 else ""
            yield fixed or room_of(path), small, file


def read_house():
    files, lines, small_rooms, sees = {}, {}, {}, {}
    for room, small, file in sources():
        text = file.read_text(encoding="utf-8")
        files[room] = files.get(room, 0) + 1
        lines[room] = lines.get(room, 0) + text.count("\n")
        small_rooms.setdefault(room, set()).update([small] if small else [])
        seen = sees.setdefault(room, {})
        for name in INCLUDE.findall(text):
            if name.startswith("reflectree/"):
                other = room_of(pathlib.PurePosixPath(name.removeprefix("reflectree/")))
                if other != room:
                    seen[other] = seen.get(other, 0) + 1
    return files, lines, small_rooms, sees


def floors_of(sees):
    """The floor of every room; None for a circle."""
    floor = {}
    while len(floor) < len(sees):
        ready = [r for r in sees if r not in floor and all(other in floor for other in sees[r])]
        if not ready:
            return None
        for room in ready:
            floor[room] = 1 + max((floor[other] for other in sees[room]), default=-1)
    return floor


def needed(sees, room):
    """The rooms that `room` sees and that none of the others it sees leads to: the arrows worth drawing."""
    def below(r):
        found = set()
        for other in sees[r]:
            found |= {other} | below(other)
        return found
    return [other for other in sees[room] if not any(other in below(third) for third in sees[room] if third != other)]


def draw(files, lines, small_rooms, sees, floor):
    top = max(floor.values())
    height = (top + 1) * FLOOR + 40
    place = {}
    for level in range(top + 1):
        rooms = sorted(r for r in floor if floor[r] == level)
        for i, room in enumerate(rooms):
            place[room] = (WIDTH * (i + 0.5) / len(rooms), height - 30 - BOX_HEIGHT - level * FLOOR)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif">',
           '<title>The house: rooms and what they see</title>',
           '<style>rect{fill:#f4efe6;stroke:#5a4a3a}text{fill:#2a2420;text-anchor:middle}'
           '.name{font-size:15px;font-weight:bold}.note{font-size:10px}line{stroke:#8a7a6a}'
           '@media(prefers-color-scheme:dark){rect{fill:#2c2824;stroke:#b8a890}text{fill:#eee4d8}}</style>']
    for room in sorted(sees):
        x, y = place[room]
        for other in sorted(needed(sees, room)):
            ox, oy = place[other]
            out.append(f'<line x1="{x:.0f}" y1="{y + BOX_HEIGHT:.0f}" x2="{ox:.0f}" y2="{oy:.0f}"/>')
    for room in sorted(place):
        x, y = place[room]
        out.append(f'<rect x="{x - BOX_WIDTH / 2:.0f}" y="{y:.0f}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" rx="6"/>')
        out.append(f'<text class="name" x="{x:.0f}" y="{y + 18:.0f}">{room}</text>')
        out.append(f'<text class="note" x="{x:.0f}" y="{y + 32:.0f}">{files[room]} files</text>')
        if small_rooms[room]:
            words = ", ".join(sorted(small_rooms[room]))
            half = words if len(words) < 24 else words[:22].rsplit(",", 1)[0] + ", ..."
            out.append(f'<text class="note" x="{x:.0f}" y="{y + 45:.0f}">{half}</text>')
    return "\n".join(out) + "\n</svg>\n"


def main() -> int:
    files, lines, small_rooms, sees = read_house()
    floor = floors_of(sees)
    if floor is None:
        print("a circle: no room can stand below all that see it")
        return 1
    picture = draw(files, lines, small_rooms, sees, floor)
    target = ROOT / "docs" / "house.svg"
    if "--check" in sys.argv[1:]:
        same = target.is_file() and target.read_text(encoding="utf-8") == picture
        print("docs/house.svg is what the includes say" if same else "docs/house.svg is old: run tools/draw_house.py")
        return 0 if same else 1
    target.write_text(picture, encoding="utf-8")
    print("| floor | room | files | lines | small rooms | sees |\n|---|---|---|---|---|---|")
    for room in sorted(sees, key=lambda r: (-floor[r], r)):
        print(f"| {floor[room]} | {room} | {files[room]} | {lines[room]} | {', '.join(sorted(small_rooms[room]))} | "
              f"{', '.join(sorted(sees[room]))} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
