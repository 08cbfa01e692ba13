#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Independent values of the models read from tables, in double precision, from their published formulas.

usage: fits_reference.py TABLE MATERIAL PAIRS OUT
PAIRS: float32 wo.xyz wi.xyz, one pair after the other. OUT: float64 f, r g b. Only the standard library.
"""
import array
import csv
import math
import sys


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    n = math.sqrt(dot(a, a))
    return [x / n for x in a]


def rotate_z(a, angle):
    c, s = math.cos(angle), math.sin(angle)
    return [c * a[0] - s * a[1], s * a[0] + c * a[1], a[2]]


def rotate_y(a, angle):
    c, s = math.cos(angle), math.sin(angle)
    return [c * a[0] + s * a[2], a[1], c * a[2] - s * a[0]]


def neural(p, wo, wi):
    h = unit([a + b for a, b in zip(wo, wi)])
    theta, phi = math.acos(min(h[2], 1.0)), math.atan2(h[1], h[0])
    x = [math.sin(theta), 0.0, math.cos(theta)] + rotate_y(rotate_z(wi, -phi), -theta)
    for layer, outputs in ((1, 21), (2, 21), (3, 3)):
        y = [p[f"b{layer}_{j}"] + sum(x[i] * p[f"w{layer}_{i}_{j}"] for i in range(len(x))) for j in range(outputs)]
        x = y if layer == 3 else [max(v, 0.0) for v in y]
    return [max(math.expm1(v), 0.0) for v in x]


def sgd(p, wo, wi):
    h = unit([a + b for a, b in zip(wo, wi)])
    cos_d, tan2 = dot(h, wi), (1 - h[2] ** 2) / h[2] ** 2
    out = []
    for s in ("_r", "_g", "_b"):
        fresnel = p["F0" + s] - cos_d * p["F1" + s] + (1 - p["F0" + s]) * (1 - cos_d) ** 5
        x = p["alpha" + s] + tan2 / p["alpha" + s]
        d = p["kap" + s] * math.exp(-x) / (math.pi * x ** p["p" + s] * h[2] ** 4)

        def g(w):
            x = max(math.acos(min(w[2], 1.0)) - p["theta0" + s], 0.0)
            inner = min(p["c" + s] * x ** p["k" + s], 700.0)
            return min(max(1 + p["lambda" + s] * (1 - math.exp(inner)), 0.0), 1.0)

        facets = fresnel * d * g(wo) * g(wi) / (wo[2] * wi[2])
        out.append(max((p["kd" + s] + p["ks" + s] * facets) / math.pi, 0.0))
    return out


def abc(p, wo, wi):
    h = unit([a + b for a, b in zip(wo, wi)])
    c, n = dot(h, wi), p["ior"]
    g = math.sqrt(n * n - 1 + c * c)
    fresnel = 0.5 * ((g - c) / (g + c)) ** 2 * (1 + ((c * (g + c) - 1) / (c * (g - c) + 1)) ** 2)
    masking = min(1.0, 2 * h[2] * wo[2] / c, 2 * h[2] * wi[2] / c)
    lobe = masking * fresnel / (1 + p["B"] * (1 - h[2])) ** p["C"] / (math.pi * wo[2] * wi[2])
    return [p["kd_" + s] / math.pi + p["A_" + s] * lobe for s in "rgb"]


def main():
    table, material, pairs, out = sys.argv[1:]
    rows = list(csv.reader(open(table)))
    row = next(r for r in rows if r[0] == material)
    p = dict(zip(rows[0][1:], map(float, row[1:])))
    model = neural if "w1_0_0" in p else sgd if "kap_r" in p else abc
    directions = array.array("f", open(pairs, "rb").read())
    values = array.array("d")
    for i in range(0, len(directions), 6):
        values.extend(model(p, unit(directions[i : i + 3]), unit(directions[i + 3 : i + 6])))
    values.tofile(open(out, "wb"))


if __name__ == "__main__":
    main()
