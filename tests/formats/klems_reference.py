#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Independent values of a reflection in a WINDOW/Radiance XML file of Klems matrices, by the standard library.

usage: klems_reference.py FILE WAVELENGTH front|back PAIRS OUT
PAIRS: float32 wo.xyz wi.xyz, one pair after the other. OUT: float64 f.
"""
import array
import math
import re
import sys
import xml.etree.ElementTree as ElementTree


def read(path, wavelength, side):
    """[(theta in degrees where a ring ends, patches)] and the numbers of one block, incident patches fastest."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    root = ElementTree.fromstring(re.sub(r"\sxmlns=(\"[^\"]*\"|'[^']*')", "", text[text.index("<WindowElement"):]))
    layer = root.find("Optical/Layer")
    rings = [(float(ring.findtext("ThetaBounds/UpperTheta")), int(ring.findtext("nPhis")))
             for ring in layer.iter("AngleBasisBlock")]
    columns = layer.findtext("DataDefinition/IncidentDataStructure").strip() == "Columns"
    for data in layer.findall("WavelengthData"):
        for block in data.findall("WavelengthDataBlock"):
            words = block.findtext("WavelengthDataDirection").split()
            if data.findtext("Wavelength") == wavelength and words == ["Reflection", side.capitalize()]:
                return rings, [float(w) for w in re.findall(r"[^\s,]+", block.findtext("ScatteringData"))], columns
    raise SystemExit("no such block")


def patch(rings, x, y, z):
    theta, phi, first = math.degrees(math.acos(min(z, 1.0))), math.degrees(math.atan2(y, x)) % 360, 0
    for end, count in rings:
        if theta < end or end == rings[-1][0]:
            return first + round(phi * count / 360) % count
        first += count
    return None


def main():
    path, wavelength, side, pairs_path, out_path = sys.argv[1:]
    rings, values, columns = read(path, wavelength, side)
    count = sum(n for _, n in rings)
    pairs = array.array("f")
    with open(pairs_path, "rb") as file:
        pairs.frombytes(file.read())
    mirror = -1 if side == "front" else 1  # Radiance's back side, seen from there
    out = array.array("d")
    for i in range(0, len(pairs), 6):
        ox, oy, oz, ix, iy, iz = pairs[i:i + 6]
        incident, exiting = patch(rings, -mirror * ox, -oy, oz), patch(rings, mirror * ix, iy, iz)
        out.append(values[exiting * count + incident if columns else incident * count + exiting])
    with open(out_path, "wb") as file:
        out.tofile(file)


if __name__ == "__main__":
    main()
