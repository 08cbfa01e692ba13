# SPDX-License-Identifier: Apache-2.0
"""Doxygen's input filter: our plain comments, as Doxygen reads them. Lines stay where they are.

    // Per solid angle.                          /// Per solid angle.
    float pdf(Direction wo, Direction wi);       float pdf(Direction wo, Direction wi);
    float width;  // radians                     float width;  ///< radians

The block at the head of a file describes the file, and what the file is named after: build.hpp has build, and
exact_sampler.hpp ExactSampler. Nothing inside of functions is touched, and what is private is left out.

Usage: cpp_comments.py HEADER
"""

import pathlib
import re
import sys

CODE = re.compile(r"`([^`]*)`")
STRESSED = re.compile(r"(?<!\S)\*(\w[\w ]*)\*(?!\w)")
SCOPE = re.compile(r"\b(namespace|struct|class|union|enum)\b")
NO_DECLARATION = re.compile(r"}|#(?!define)|(public|protected|private):|namespace\b")
FORWARD = re.compile(r"}|(class|struct) \w+;")
DECLARED = re.compile(r"[;,}\w]$")


def without_groups(text, pairs):
    """The text without what stands in brackets, those inside of one another too."""
    for opening, closing in pairs:
        innermost = re.compile(rf"\{opening}[^\{opening}\{closing}]*\{closing}")
        while innermost.search(text):
            text = innermost.sub("", text)
    return text


class Scopes:
    """Which braces are open: "namespace" and its like, or "" for those of a function or of a value."""

    def __init__(self):
        self.open, self.statement, self.parentheses = [], "", 0

    def take(self, code):
        for letter in code + "\n":
            if letter == "{":
                scope = SCOPE.search(without_groups(self.statement, ("()", "<>")))
                self.open.append(scope[0] if scope else "")
            elif letter == "}" and self.open:
                self.open.pop()
            self.parentheses += (letter == "(") - (letter == ")")
            self.statement = "" if letter in "{};" else self.statement + letter

    def declares(self):
        """Whether what stands here is a declaration, and not a piece of one or of a function's body."""
        return all(self.open) and not self.parentheses


def divided(line):
    """The code of a line, and where its comment begins; -1 for none."""
    code, i = "", 0
    while i < len(line):
        if line.startswith("//", i):
            return code, i
        if line[i] == '"' or line[i] == "'" and not (i and line[i - 1].isalnum()):
            quote, i = line[i], i + 1
            while i < len(line) and line[i] != quote:
                i += 2 if line[i] == "\\" else 1
            code += "0"
        else:
            code += line[i]
        i += 1
    return code, -1


def words(text):
    """Every sign as itself; what stands in backticks as code."""
    text = re.sub(r"([\\@&<>#%$\"]|::)", r"\\\1", text)
    return STRESSED.sub(r"<em>\1</em>", CODE.sub(r"<code>\1</code>", text))


def block(lines, numbers, mark):
    """Lines that are comments and nothing else; what is indented keeps its layout."""
    texts = {n: lines[n].split("//", 1)[1] for n in numbers}
    laid_out = {n for n in numbers if texts[n].startswith("   ")}
    for n in numbers:
        before = " <pre>" if n in laid_out and n - 1 not in laid_out else ""
        after = "</pre>" if n in laid_out and n + 1 not in laid_out else ""
        lines[n] = f"{lines[n].split('//', 1)[0]}{mark}{before}{words(texts[n])}{after}"


def namesake(path):
    """Finds the declaration after which a file is named: exact_sampler.hpp has ExactSampler, build.hpp has build."""
    name = path.stem
    camel = "".join(part.capitalize() for part in name.split("_"))
    return re.compile(rf"\b(?:class|struct|concept) {camel}\b(?!;)|^(?!using|return)[^=]*[\w>&*] {name}\(")


def filtered(text, path):
    lines = text.split("\n")
    head = next((n for n, line in enumerate(lines) if not line.startswith("//")), len(lines))
    if head:
        block(lines, range(1, head), "///")
        lines[0] = r"/// \file"
    scopes, pending = Scopes(), []  # the comment just above
    statement, above = head, []  # where the statement begins, and the comment above it
    trailing = -1  # the column of the comment beside the line before
    private = []  # how many braces are open around what is private
    sought = namesake(path) if head > 1 else None
    for n in range(head, len(lines)):
        line = lines[n]
        code, column = divided(line)
        bare = code.strip()
        if column >= 0 and not bare:
            if column == trailing:
                lines[n] = f"{line[:column]}///<{words(line[column + 2:])}"
            elif not line.startswith("// clang-format", column):
                pending.append(n)
            continue
        preprocessor, starts = bare.startswith("#"), scopes.declares()
        if starts and bare and not NO_DECLARATION.match(bare):
            block(lines, pending, "///")
        if starts and not scopes.statement.strip():
            statement, above = n, pending
        if sought and starts and not preprocessor and "" not in scopes.open and sought.search(bare):
            sought, about = None, rf"\brief \copybrief {path.name} \details \copydetails {path.name}"
            if above:
                lines[above[0]] = lines[above[0]].replace("///", rf"/// {about} \n", 1)
            else:
                lines[statement] = f"/** {about} */ {lines[statement]}"
        if not preprocessor:
            scopes.take(code)
        if bare in ("private:", "protected:"):
            private.append(len(scopes.open))
            lines[n] = r"/** \cond */ " + lines[n]
        elif private and (len(scopes.open) < private[-1] or bare == "public:" and len(scopes.open) == private[-1]):
            private.pop()
            lines[n] = r"/** \endcond */ " + lines[n]
        ends = starts and not preprocessor and scopes.declares() and DECLARED.search(bare) and not FORWARD.match(bare)
        trailing = column if column >= 0 and ends else -1
        if trailing >= 0:
            lines[n] = f"{line[:column]}///<{words(line[column + 2:])}"
        pending = []
    return "\n".join(lines)


if __name__ == "__main__":
    header = pathlib.Path(sys.argv[1])
    sys.stdout.write(filtered(header.read_text(encoding="utf-8"), header))
