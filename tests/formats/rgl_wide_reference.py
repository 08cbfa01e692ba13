#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An independent reading of a tensor_file of any number of azimuths and channels, in double precision, from the
format's description, by the standard library alone.

usage: rgl_wide_reference.py FILE PAIRS OUT
PAIRS: float32 wo.xyz wi.xyz, one pair after the other. OUT: float64 f cos_theta_i of every channel, not clipped.
"""
import array
import bisect
import itertools
import math
import struct
import sys

from tensor_file import read_tensor_file


def bytes_and_floats(path):
    """name -> (shape, numbers)"""
    return {name: (shape, data if dtype == 1 else struct.unpack(f"<{len(data) // 4}f", data))
            for name, (shape, dtype, data) in read_tensor_file(path).items() if dtype in (1, 10)}


def between(nodes, x):
    """[(index, weight)] of the nodes beside x."""
    if len(nodes) == 1:
        return [(0, 1.0)]
    i = min(max(bisect.bisect_right(nodes, x) - 1, 0), len(nodes) - 2)
    t = min(max((x - nodes[i]) / (nodes[i + 1] - nodes[i]), 0.0), 1.0)
    return [(i, 1 - t), (i + 1, t)]


def cell(x, size):
    x = min(max(x, 0.0), 1.0) * (size - 1)
    i = min(int(x), size - 2)
    return i, x - i


class Material:
    def __init__(self, path):
        self.fields = bytes_and_floats(path)
        self.phi, self.theta = self.fields["phi_i"][1], self.fields["theta_i"][1]
        self.isotropic = len(self.phi) <= 2
        self.reduction = 1 if self.isotropic else round(2 * math.pi / (self.phi[-1] - self.phi[0]))
        self.colours = self.fields["spectra" if "spectra" in self.fields else "rgb"]
        self.jacobian = self.fields["jacobian"][1][0]
        (_, _, self.height, self.width), density = self.fields["vndf"]
        size = self.height * self.width
        self.slices = [self.normalised(density[s * size:(s + 1) * size]) for s in range(len(density) // size)]

    def normalised(self, density):
        """Rows of a slice of unit mass."""
        rows = [list(density[y * self.width:(y + 1) * self.width]) for y in range(self.height)]
        masses = [sum(a + b for a, b in zip(r, r[1:])) / 2 for r in rows]
        total = sum(a + b for a, b in zip(masses, masses[1:])) / 2
        return [[v / total for v in r] for r in rows]

    def square(self, name, u, v):
        (height, width), table = self.fields[name]
        (x, fx), (y, fy) = cell(u, width), cell(v, height)
        return sum(wx * wy * table[(y + j) * width + x + i]
                   for (i, wx), (j, wy) in itertools.product(((0, 1 - fx), (1, fx)), ((0, 1 - fy), (1, fy))))

    def evaluate(self, wo, wi):
        wo, wi = list(wo), list(wi)
        if self.reduction == 2 and (wo[1] > 0 or (wo[1] == 0 and wo[0] >= 0)):
            wo[:2], wi[:2] = [-wo[0], -wo[1]], [-wi[0], -wi[1]]
        if self.reduction == 4:
            for k in (0, 1):
                if wo[k] >= 0:
                    wo[k], wi[k] = -wo[k], -wi[k]
        m = [a + b for a, b in zip(wo, wi)]
        theta_o, phi_o = math.atan2(math.hypot(wo[0], wo[1]), wo[2]), math.atan2(wo[1], wo[0])
        theta_m, phi_m = math.atan2(math.hypot(m[0], m[1]), m[2]), math.atan2(m[1], m[0])
        u = math.sqrt(2 * theta_m / math.pi)
        v = ((phi_m - phi_o if self.isotropic else phi_m) / (2 * math.pi) + .5) % 1
        around = [(p * len(self.theta) + t, wp * wt) for p, wp in between(self.phi, phi_o)
                  for t, wt in between(self.theta, theta_o)]

        # V^-1, with the masses of the mixed density.
        (x, fx), (y, fy) = cell(u, self.width), cell(v, self.height)
        rows = [[sum(w * self.slices[s][r][c] for s, w in around) for c in range(self.width)]
                for r in range(self.height)]
        masses = [sum(a + b for a, b in zip(r, r[1:])) / 2 for r in rows]

        def along(row):
            return (sum(a + b for a, b in zip(row[:x + 1], row[1:x + 1])) / 2
                    + fx * (row[x] + fx / 2 * (row[x + 1] - row[x])))

        mass = (1 - fy) * masses[y] + fy * masses[y + 1]
        sx = ((1 - fy) * along(rows[y]) + fy * along(rows[y + 1])) / mass if mass else 0.0
        sy = (sum(a + b for a, b in zip(masses[:y + 1], masses[1:y + 1])) / 2
              + fy * (masses[y] + fy / 2 * (masses[y + 1] - masses[y])))

        (_, _, channels, height, width), table = self.colours
        (x, fx), (y, fy) = cell(sx, width), cell(sy, height)
        scale = 1.0
        if self.jacobian:
            sigma = self.square("sigma", math.sqrt(2 * theta_o / math.pi), phi_o / (2 * math.pi) + .5)
            scale = self.square("ndf", u, v) / (4 * sigma)
        return [scale * sum(w * wx * wy * table[((s * channels + c) * height + y + j) * width + x + i]
                            for s, w in around for i, wx in ((0, 1 - fx), (1, fx)) for j, wy in ((0, 1 - fy), (1, fy)))
                for c in range(channels)]


def main():
    material = Material(sys.argv[1])
    pairs = array.array("f")
    with open(sys.argv[2], "rb") as file:
        pairs.frombytes(file.read())
    out = array.array("d")
    for i in range(0, len(pairs), 6):
        out.extend(material.evaluate(pairs[i:i + 3], pairs[i + 3:i + 6]))
    with open(sys.argv[3], "wb") as file:
        out.tofile(file)


if __name__ == "__main__":
    main()
