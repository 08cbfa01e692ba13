#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The models' reference values: one file values/MODEL.py per model. It holds value(p, parameters...), the formula
as the papers write it, in angles and trigonometric functions where the C++ models use vectors and forms free of
cancellation; and VALUES, materials with few bits in each number, so that C++ and Python mean the same, under
each of which stand its values in 40 digits of precision. model_values_test.cpp reads them.

    python3 reference_values.py            fills in the values under each material  (needs mpmath)
    python3 reference_values.py --check    exit code 1 where they differ; 77 without mpmath
"""
import importlib
import inspect
import pathlib
import re
import sys

sys.dont_write_bytecode = True
try:
    from mpmath import acos, atan2, cos, mp, mpf, pi, sin, sqrt
except ImportError:
    sys.exit(77)

mp.dps = 40
FOLDER = pathlib.Path(__file__).resolve().parent / "values"

# theta_o, phi_o, theta_i, phi_i in radians: an arbitrary pair, near the mirror direction, exactly on it but for
# a thousandth, near the back direction, and both grazing.
PAIRS = [
    (0.5, 0.25, 1.0, 2.0),
    (0.75, 0.5, 0.71875, 3.625),
    (0.75, 0.0, 0.7509765625, 3.1416015625),
    (1.0, 1.0, 1.03125, 1.0625),
    (1.5625, 0.0, 1.55859375, 3.0),
]


def direction(theta, phi):
    return [sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def half(wo, wi):
    h = [x + y for x, y in zip(wo, wi)]
    length = sqrt(dot(h, h))
    return [x / length for x in h]


def schlick(f0, c):
    return f0 + (1 - f0) * (1 - c) ** 5


class Pair:
    """Two directions with every angle that a paper may name."""

    def __init__(self, theta_o, phi_o, theta_i, phi_i):
        self.to, self.po, self.ti, self.pi = (mpf(a) for a in (theta_o, phi_o, theta_i, phi_i))
        self.wo, self.wi = direction(self.to, self.po), direction(self.ti, self.pi)
        self.h = half(self.wo, self.wi)
        self.co, self.ci = cos(self.to), cos(self.ti)
        self.cd = dot(self.wo, self.h)
        self.th = acos(self.h[2])
        self.ph = atan2(self.h[1], self.h[0])
        self.dphi = self.po - self.pi


def parameters(material, value):
    """The arguments of value() for red, green and blue; NAME stands for NAME_x and NAME_y."""
    names = list(inspect.signature(value).parameters)[1:]
    given = {}
    for word in material.split(":", 1)[1].split(","):
        name, text = word.split("=")
        rgb = [mpf(number) for number in text.split("/")]
        for target in [name] if name in names else [name + "_x", name + "_y"]:
            given[target] = rgb if len(rgb) == 3 else rgb * 3
    assert sorted(given) == sorted(names), f"{material}: wanted {names}"
    return [{name: given[name][c] for name in names} for c in range(3)]


def rows(material, value):
    for angles in PAIRS:
        pair = Pair(*angles)
        rgb = [value(pair, **arguments) for arguments in parameters(material, value)]
        kept = [v if v > mpf("1e-300") else mpf(0) for v in rgb]  # the range of double
        yield f"  {' '.join(map(str, angles))}  {' '.join(mp.nstr(v, 17) for v in kept)}"


def filled(file):
    """The text of a file with the values of its formula."""
    text = file.read_text(encoding="utf-8")
    head, listed, tail = re.fullmatch(r'(.*^VALUES = """\n)(.*?)(^"""\n)', text, re.DOTALL | re.MULTILINE).groups()
    value = importlib.import_module(file.stem).value
    lines = []
    for material in listed.split("\n"):
        if material and not material.startswith(" "):
            lines += [material, *rows(material, value)]
    return head + "\n".join(lines) + "\n" + tail


def main():
    sys.path.insert(0, str(FOLDER))
    stale = 0
    for file in sorted(FOLDER.glob("*.py")):
        text = filled(file)
        if text == file.read_text(encoding="utf-8"):
            continue
        stale = 1
        if "--check" in sys.argv:
            print(f"{file.name}: its values are not those of its formula")
        else:
            file.write_text(text, encoding="utf-8")
            print(f"{file.name}: written")
    return stale if "--check" in sys.argv else 0


if __name__ == "__main__":
    sys.exit(main())
