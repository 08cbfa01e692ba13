#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Nothing in the documents leads nowhere.

1. Every relative link of every .md file names a file or folder, and its anchor a heading of that page.
2. Every path that a document names in backticks exists: `src/math/cubature.cpp`, `math/sum.hpp` (which is looked
   for in include/reflectree and src, too), `scenes/{ball,room}.xml`. Names to be filled in are left alone:
   `src/formats/NAME.cpp`. So does every header of ours that its code includes.
   The same holds for paths in comments of C++ and CMake; there a path may begin anywhere, `square/domain.hpp`.
3. Every question of docs/questions.md has a path from README in at most three steps. Each page on it really links
   to the next, and the words in backticks behind the last link stand in the file that it leads to.

Usage: links.py ROOT. Prints one line per dead end; exit code 1 if there is one.
"""
import itertools
import os
import pathlib
import re

from house_rules import files
from report import report

ROOTS = ("src", "include", "tests", "docs", "tools", "bench", "apps", "bindings", "runtime", "examples", "cmake", "scenes")
BASES = ("", "include", "include/reflectree", "src")  # where a header may be named from
SOURCE = (".hpp", ".cpp", ".py", ".cmake", ".inc")
LINK = re.compile(r"\[(?:[^\[\]]|\[[^\]]*\])*\]\(([^()\s]+)\)")
CODE = re.compile(r"`([^`]+)`")
INCLUDE = re.compile(r"#include [<\"](reflectree/[^>\"]+)[>\"]")
WORD = re.compile(r"[A-Za-z_][\w.-]*(?:/[\w.{},*<>-]*)+")
STEPS = 3
QUESTIONS = 12  # at least


def prose(text: str):
    """(number, line) outside of code blocks."""
    fenced, before = False, ""
    for number, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced and not (line.startswith("    ") and (not before.strip() or before.startswith("    "))):
            yield number, line
        before = line


def anchors(text: str) -> set[str]:
    """The headings of a page as the links of web pages name them."""
    found: dict[str, int] = {}
    names = set()
    for _, line in prose(text):
        heading = re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if heading:
            words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
            name = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
            seen = found.get(name, 0)
            found[name] = seen + 1
            names.add(f"{name}-{seen}" if seen else name)
    return names


def read(file: pathlib.Path) -> str:
    return file.read_text(encoding="utf-8", errors="replace")


def links(line: str) -> list[str]:
    """Targets of the relative links of a line of prose."""
    # Code is blanked out, but for links whose words are code.
    bare = re.sub(r"`[^`]*`", lambda m: "x" * len(m[0]), line)
    return [target for target in LINK.findall(bare) if not re.match(r"[a-z]+:", target)]


def resolved(page: pathlib.Path, target: str) -> tuple[pathlib.Path, str]:
    path, _, anchor = target.partition("#")
    place = page.parent / path if path else page
    return pathlib.Path(os.path.normpath(place)), anchor


def dead_links(root: pathlib.Path, page: pathlib.Path) -> list[str]:
    found = []
    for number, line in prose(read(page)):
        for target in links(line):
            place, anchor = resolved(page, target)
            where = f"{page.relative_to(root)}:{number}"
            if not place.exists():
                found.append(f"{where}: the link ({target}) leads nowhere")
            elif anchor and (place.suffix != ".md" or anchor not in anchors(read(place))):
                found.append(f"{where}: the link ({target}) names no heading of its page")
    return found


def spelt_out(word: str) -> list[str]:
    """a/{b,c}.d as a/b.d and a/c.d."""
    parts = re.split(r"\{([^{}]*)\}", word)
    choices = [part.split(",") if i % 2 else [part] for i, part in enumerate(parts)]
    return ["".join(choice) for choice in itertools.product(*choices)]


def is_there(root: pathlib.Path, page: pathlib.Path, path: str) -> bool:
    for base in (*(root / b for b in BASES), page.parent):
        if "*" in path:
            if any(base.glob(path)):
                return True
        elif (base / path).exists():
            return True
    return False


def dead_paths(root: pathlib.Path, page: pathlib.Path) -> list[str]:
    found = []
    for number, line in prose(read(page)):
        for code in CODE.findall(line):
            for word in WORD.findall(code):
                word = word.rstrip(".,")
                to_be_filled_in = "<" in word or re.search(r"(^|/|_)[A-Z]+(\.|/|_|$)", word.replace("CMakeLists", ""))
                if to_be_filled_in or not (word.startswith(tuple(r + "/" for r in ROOTS)) or word.endswith(SOURCE)):
                    continue
                for path in spelt_out(word):
                    if not is_there(root, page, path):
                        found.append(f"{page.relative_to(root)}:{number}: there is no {path}")
    for number, line in enumerate(read(page).split("\n"), 1):
        for header in INCLUDE.findall(line):
            if not (root / "include" / header).is_file():
                found.append(f"{page.relative_to(root)}:{number}: there is no include/{header}")
    return found


def dead_comments(root: pathlib.Path, source: pathlib.Path, ends: set[str]) -> list[str]:
    found = []
    mark = r"//" if source.suffix in (".hpp", ".cpp") else r"#"
    for number, line in enumerate(read(source).split("\n"), 1):
        comment = re.search(rf"(?:^|\s){mark}\s(.*)", line)
        if not comment or "#include" in line:
            continue
        for word in re.findall(r"(?<![\w./{}<>*])[\w./-]+\.(?:hpp|cpp|cmake|md|py)\b", comment[1]):
            stem = word.split("/")[-1].split(".")[0]
            to_be_filled_in = stem.isupper() or len(stem) == 1  # NAME.hpp, a.cpp
            if not to_be_filled_in and word not in ends and not is_there(root, source, word):
                found.append(f"{source.relative_to(root)}:{number}: there is no {word}")
    return found


def leads_to(page: pathlib.Path, place: pathlib.Path, anchor: str) -> bool:
    for _, line in prose(read(page)):
        for target in links(line):
            there, there_anchor = resolved(page, target)
            if there == place and there_anchor in ("", anchor):
                return True
    return False


def lost_questions(root: pathlib.Path) -> list[str]:
    page = root / "docs" / "questions.md"
    if not page.exists():
        return ["docs/questions.md: there is none"]
    found, asked, answered = [], {}, set()
    question = None
    for number, line in prose(read(page)):
        if line.startswith("## "):
            question = line[3:].strip()
            asked[question] = number
        if not line.startswith("Path:") or question is None:
            continue
        answered.add(question)
        where = f"docs/questions.md:{number}"
        steps = [resolved(page, target) for target in links(line)]
        if not steps or steps[0][0] != root / "README.md":
            found.append(f"{where}: the path does not begin at README.md")
            continue
        if not 1 <= len(steps) - 1 <= STEPS:
            found.append(f"{where}: {len(steps) - 1} steps from README; at most {STEPS}, at least one")
        for (here, _), (place, anchor) in zip(steps, steps[1:]):
            if not here.is_file() or here.suffix != ".md" or not leads_to(here, place, anchor):
                found.append(f"{where}: {here.relative_to(root)} does not link to {place.relative_to(root)}")
        last = steps[-1][0]
        for word in CODE.findall(line[line.rfind("](") :]):
            if not last.is_file() or word not in read(last):
                found.append(f"{where}: `{word}` does not stand in {last.relative_to(root)}")
    found += [f"docs/questions.md:{asked[q]}: no path answers '{q}'" for q in asked if q not in answered]
    if len(asked) < QUESTIONS:
        found.append(f"docs/questions.md: {len(asked)} questions; at least {QUESTIONS}")
    return found


def dead_ends(root: pathlib.Path) -> list[str]:
    root = root.resolve()
    everything = list(files(root))
    ends = {"/".join(parts[i:]) for parts in (file.relative_to(root).parts for file in everything)
            for i in range(len(parts))}
    found = []
    for file in everything:
        if file.suffix == ".md":
            found += dead_links(root, file) + dead_paths(root, file)
        elif file.suffix in (".hpp", ".cpp", ".cmake") or file.name == "CMakeLists.txt":
            found += dead_comments(root, file, ends)
    return found + lost_questions(root)


if __name__ == "__main__":
    report(dead_ends, "every link leads somewhere")
