#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Independent values of a Zemax .bsdf of one wavelength, in double precision, by the standard library alone.

usage: zemax_reference.py FILE PAIRS OUT [zeros]
PAIRS: float32 wo.xyz wi.xyz, one pair after the other. OUT: float64 f.
"""
import array
import bisect
import math
import sys

NAMES = ("SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial")


def read(path):
    """The four lists of angles in degrees, whether the plane of incidence is a mirror, and all numbers."""
    with open(path, encoding="utf-8") as file:
        words = " ".join(line for line in file if not line.startswith("#")).split()
    angles = []
    for name in NAMES:
        at = words.index(name)
        angles.append([float(w) for w in words[at + 2:at + 2 + int(words[at + 1])]])
    data = words[words.index("DataBegin") + 1:words.index("DataEnd")]
    block = 2 + len(angles[2]) * len(angles[3])  # TIS and its number first
    values = [float(w) for i, w in enumerate(data) if i % block >= 2]
    return angles, words[words.index("Symmetry") + 1] == "PlaneSymmetrical", values


def unit(theta, phi):
    return [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def hold(angles, values):
    """Zeros at the outer end of a row, more than 60 degrees from the normal, become the value before."""
    _, incidences, azimuths, radials = angles
    width = len(radials)
    for start in range(0, len(values), width):
        row = start // width
        incidence = math.radians(incidences[row // len(azimuths) % len(incidences)])
        mirror = unit(incidence, math.pi)
        towards_normal = unit(math.pi / 2 - incidence, 0)
        aside = cross(mirror, towards_normal)
        azimuth = math.radians(azimuths[row % len(azimuths)])

        def height(i):
            r = math.radians(radials[i])
            return (math.cos(r) * mirror[2] + math.sin(r) * math.cos(azimuth) * towards_normal[2]
                    + math.sin(r) * math.sin(azimuth) * aside[2])

        last = width - 1
        while last > 0 and values[start + last] == 0 and height(last) < .5:
            last -= 1
        if last > 0 or values[start] != 0:
            for i in range(last + 1, width):
                values[start + i] = values[start + last]


def locate(nodes, x):
    """[(index, weight)] of the nodes beside x."""
    i = min(max(bisect.bisect_right(nodes, x), 1), len(nodes) - 1)
    if len(nodes) == 1 or x <= nodes[0]:
        return [(0, 1.0)]
    t = min((x - nodes[i - 1]) / (nodes[i] - nodes[i - 1]), 1.0)
    return [(i - 1, 1 - t), (i, t)]


def value(angles, mirrored, values, wo, wi):
    rotations, incidences, azimuths, radials = angles
    theta, phi = math.atan2(math.hypot(wo[0], wo[1]), wo[2]), math.atan2(wo[1], wo[0])
    mirror, towards_normal = unit(theta, phi + math.pi), unit(math.pi / 2 - theta, phi)
    aside = cross(mirror, towards_normal)
    x, y, z = dot(wi, towards_normal), dot(wi, aside), dot(wi, mirror)
    azimuth = math.degrees(math.atan2(y, x))
    if mirrored:
        azimuth = abs(azimuth)
    sums = 0.0
    for r, wr in locate(rotations, (90 - math.degrees(phi)) % 360):
        for i, w_i in locate(incidences, math.degrees(theta)):
            for a, wa in locate(azimuths, azimuth % 360):
                for s, ws in locate(radials, math.degrees(math.atan2(math.hypot(x, y), z))):
                    at = ((r * len(incidences) + i) * len(azimuths) + a) * len(radials) + s
                    sums += wr * w_i * wa * ws * values[at]
    return max(sums, 0.0)


def main():
    angles, mirrored, values = read(sys.argv[1])
    if len(sys.argv) < 5:
        hold(angles, values)
    pairs = array.array("f")
    with open(sys.argv[2], "rb") as file:
        pairs.frombytes(file.read())
    out = array.array("d", (value(angles, mirrored, values, pairs[i:i + 3], pairs[i + 3:i + 6])
                            for i in range(0, len(pairs), 6)))
    with open(sys.argv[3], "wb") as file:
        out.tofile(file)


if __name__ == "__main__":
    main()
