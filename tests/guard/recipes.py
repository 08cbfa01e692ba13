#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Follows the recipes of CONTRIBUTING.md to the letter on a copy of the tree: their code goes where they say, the
files that each recipe touches are counted and printed, and the tests that look after models, formats, checks and
competitors are built and run.

Usage: recipes.py SOURCE SCRATCH [--count]      --count: nothing is built
Exit code 1 if a recipe cannot be followed, touches another number of files than it says, or a test fails.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

LIBRARY = ("include/", "src/")
# Where each stands in CONTRIBUTING.md, and how many files of the library it may touch.
WANTED = {"a model": 2, "a file format": 2, "a check of verify": 2, "a competitor": 2}
TARGETS = ("test_brdf_models", "test_brdf_material", "test_simd_lanes", "test_formats_table", "test_fuzz_replay",
           "test_verify_ways", "test_peers_registry")


def sections(text: str) -> dict[str, str]:
    """The recipes by their titles."""
    parts = re.split(r"^## ", text, flags=re.MULTILINE)
    return {p.split("\n", 1)[0].removeprefix("Recipe: "): p for p in parts if p.startswith("Recipe: ")}


def blocks(section: str) -> list[str]:
    """The indented code of a section, each without what all of its lines share."""
    found, lines = [], []
    for line in [*section.split("\n"), "end"]:
        if line.startswith(" " * 7) or (lines and not line.strip()):
            lines.append(line)
        elif lines:
            while not lines[-1].strip():
                lines.pop()
            shared = min(len(x) - len(x.lstrip()) for x in lines if x.strip())
            found.append("\n".join(x[shared:] for x in lines) + "\n")
            lines = []
    return found


class Tree:
    """A copy of the source tree that knows what was changed."""

    def __init__(self, source: pathlib.Path, root: pathlib.Path):
        self.root = root
        shutil.rmtree(root, ignore_errors=True)
        shutil.copytree(source, root, symlinks=True, ignore=lambda folder, names: [
            n for n in names if n in (".git", "__pycache__")
            or (pathlib.Path(folder) == source and n.startswith(("build", "reflectree-demo", ".")))])
        self.known = self.contents()

    def contents(self) -> dict[str, bytes]:
        return {str(f.relative_to(self.root)): f.read_bytes() for f in self.root.rglob("*") if f.is_file()}

    def touched(self) -> list[str]:
        """Files that are new or different since the last call."""
        before, self.known = self.known, self.contents()
        return sorted(name for name, data in self.known.items() if before.get(name) != data)

    def create(self, path: str, text: str):
        file = self.root / path
        assert not file.exists(), f"{path} is there already"
        file.write_text(text, encoding="utf-8")

    def insert(self, path: str, anchor: str, text: str, before=False):
        """Beside the one place that holds `anchor`."""
        file = self.root / path
        whole = file.read_text(encoding="utf-8")
        assert whole.count(anchor) == 1, f"{path}: {whole.count(anchor)} places read {anchor!r}"
        file.write_text(whole.replace(anchor, text + anchor if before else anchor + text), encoding="utf-8")

    def include(self, path: str, header: str):
        file = self.root / path
        whole = file.read_text(encoding="utf-8")
        at = whole.index('#include "reflectree/')
        file.write_text(whole[:at] + f'#include "{header}"\n' + whole[at:], encoding="utf-8")


def one(pattern: str, text: str) -> str:
    return re.search(pattern, text).group(1)


def follow_model(tree: Tree, code: list[str]):
    header, name_in_list, values, rows = code[:4]
    name = one(r'return \{"(\w+)"', header)
    tree.create(f"include/reflectree/brdf/models/{name}.hpp", header)
    tree.include("include/reflectree/brdf/models/all.hpp", f"reflectree/brdf/models/{name}.hpp")
    tree.insert("include/reflectree/brdf/models/all.hpp", "using AllModels = ModelList<\n", "    " + name_in_list)
    indented = "".join(f"  {row}\n" for row in rows.splitlines())
    tree.create(f"tests/brdf/values/{name}.py", re.sub(r'("""\n)$', lambda end: indented + end.group(1), values))


def follow_format(tree: Tree, code: list[str]):
    reader, declared, row, command = code[:4]
    table = "src/formats/format_table.cpp"
    key = one(r'key = "(\w+)"', row)
    tree.create(f"src/formats/{key}.cpp", reader)
    tree.insert(table, "its functions are declared here.\n", declared)
    tree.insert(table, "};\n// clang-format on\n", row, before=True)
    (tree.root / "tests/formats/examples").mkdir(exist_ok=True)
    subprocess.run(["sh", "-c", command], cwd=tree.root, check=True)


def follow_check(tree: Tree, code: list[str]):
    header, line, twin = code[:3]
    name = one(r"CheckResult check_(\w+)\(", header)
    tree.create(f"include/reflectree/verify/{name}.hpp", header)
    tree.include("src/verify/verify.cpp", f"reflectree/verify/{name}.hpp")
    tree.insert("src/verify/verify.cpp", "  void directions() {\n", "    " + line)
    test = "tests/verify/ways_test.cpp"
    tree.include(test, f"reflectree/verify/{name}.hpp")
    tree.insert(test, "\n}  // namespace\n}  // namespace reflectree\n", "\n" + twin, before=True)


def follow_competitor(tree: Tree, code: list[str]):
    header, make, row = code[:3]
    name = one(r"Made (\w+)\(", make)
    registry = "src/peers/registry.cpp"
    tree.create(f"include/reflectree/peers/{name}.hpp", header)
    tree.include(registry, f"reflectree/peers/{name}.hpp")
    tree.insert(registry, 'constexpr const char* ours = ', make + "\n", before=True)
    tree.insert(registry, "constexpr SamplerInfo all[] = {\n", row)


def run(command: list, **more):
    env = dict(os.environ, CCACHE_NOHASHDIR="1", CCACHE_BASEDIR=str(more["cwd"]))
    done = subprocess.run(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)
    return done.returncode, done.stdout


def build_and_test(scratch: pathlib.Path) -> bool:
    good = True
    for command in (["cmake", "-S", "tree", "-B", "build", "-G", "Ninja", "-DREFLECTREE_TESTS=ON",
                     "-DREFLECTREE_APPS=OFF", "-DREFLECTREE_WERROR=ON", "-DCMAKE_BUILD_TYPE=Release"],
                    ["ninja", "-C", "build", *TARGETS]):
        code, out = run(command, cwd=scratch)
        if code != 0:
            print(out[-4000:])
            return False

    def test(target, wanted=0, more=()):
        code, out = run([str(scratch / "build/bin" / target), *more], cwd=scratch)
        print(f"{target}: {'passes' if code == 0 else 'fails'}{'' if wanted == 0 else ', as it must'}")
        if (code != 0) != (wanted != 0):
            print(out[-3000:])
            return False
        return True

    for target in TARGETS:
        good = test(target) and good
    # What a recipe asks for besides code is missed where it is missing.
    for beside, target in (("tests/brdf/values/seeliger.py", TARGETS[0]), ("tests/formats/examples/toy.toy", TARGETS[3])):
        (scratch / "tree" / beside).unlink()
        good = test(target, wanted=1) and good
    return good


def main() -> int:
    source, scratch = (pathlib.Path(a).resolve() for a in sys.argv[1:3])
    recipes = sections((source / "CONTRIBUTING.md").read_text(encoding="utf-8"))
    tree = Tree(source, scratch / "tree")
    good = True
    for title, follow in (("a model", follow_model), ("a file format", follow_format),
                          ("a check of verify", follow_check), ("a competitor", follow_competitor)):
        follow(tree, blocks(recipes[title]))
        touched = tree.touched()
        library = [f for f in touched if f.startswith(LIBRARY)]
        print(f"{title}: {len(library)} files of the library ({', '.join(library)})"
              + "".join(f", {f}" for f in touched if f not in library))
        good = good and len(library) == WANTED[title]
    if "--count" not in sys.argv:
        good = build_and_test(scratch) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
