#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the lines into a checkout of pbrt-v4 that make its material "reflectree".

    python3 register.py PBRT_SOURCE

Each is one edit of a file there, listed in EDITS and in docs/pbrt.md. What is there already is left alone; where pbrt
has changed and a place is not found, nothing at all is written.
"""

import os
import pathlib
import sys

# file, the text that marks the place, what stands there afterwards
EDITS = (
    ("src/pbrt/base/bxdf.h", "class CoatedConductorBxDF;", "class CoatedConductorBxDF;\nclass ReflectreeBxDF;"),
    ("src/pbrt/base/bxdf.h", "NormalizedFresnelBxDF> {", "NormalizedFresnelBxDF, ReflectreeBxDF> {"),
    ("src/pbrt/bxdfs.h", "#include <pbrt/base/bxdf.h>", "#include <pbrt/base/bxdf.h>\n#include <reflectree_bxdf.h>"),
    ("src/pbrt/base/material.h", "class MixMaterial;", "class MixMaterial;\nclass ReflectreeMaterial;"),
    ("src/pbrt/base/material.h", "ThinDielectricMaterial, MixMaterial",
     "ThinDielectricMaterial, MixMaterial, ReflectreeMaterial"),
    ("src/pbrt/materials.h", "#include <pbrt/base/material.h>",
     "#include <pbrt/base/material.h>\n#include <reflectree_material.h>"),
    ("src/pbrt/materials.cpp", "    else if (name == \"measured\")",
     "    else if (name == \"reflectree\")\n"
     "        material = ReflectreeMaterial::Create(parameters, normalMap, loc, alloc);\n"
     "    else if (name == \"measured\")"),
    ("CMakeLists.txt", "add_sanitizers (pbrt_lib)",
     "add_sanitizers (pbrt_lib)\n\n"
     "find_package (PkgConfig REQUIRED)\n"
     "pkg_check_modules (REFLECTREE REQUIRED IMPORTED_TARGET reflectree_c)\n"
     "target_link_libraries (pbrt_lib PUBLIC PkgConfig::REFLECTREE)"),
)


def edited(source):
    """The files that change: path -> text."""
    texts = {}
    for name, mark, wanted in EDITS:
        path = source / name
        if not path.is_file():
            raise ValueError(f"{path}: not there; give the folder of a pbrt-v4 checkout")
        text = texts.get(path) or path.read_text(encoding="utf-8")
        if wanted not in text:
            if text.count(mark) != 1:
                raise ValueError(f"{path}: {mark!r} stands there {text.count(mark)} times, once was expected: this is "
                                 f"another pbrt; write by hand what docs/pbrt.md lists")
            text = text.replace(mark, wanted)
        texts[path] = text
    return {path: text for path, text in texts.items() if text != path.read_text(encoding="utf-8")}


def main(arguments):
    if len(arguments) != 1 or arguments[0] in ("-h", "--help"):
        print(__doc__.strip(), file=sys.stdout if arguments else sys.stderr)
        return 0 if arguments and len(arguments) == 1 else 2
    try:
        files = edited(pathlib.Path(arguments[0]))
    except (OSError, ValueError) as error:
        print(f"register.py: {error}", file=sys.stderr)
        return 2
    for path, text in files.items():
        beside = path.with_name(path.name + ".new")
        beside.write_text(text, encoding="utf-8")
        os.replace(beside, path)
        print(f"changed {path}")
    if not files:
        print("nothing to change: registered already")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
