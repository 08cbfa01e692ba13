#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An independent reading of an isotropic RGB tensor_file, in double precision, from the format's description.

usage: rgl_reference.py FILE PAIRS OUT
PAIRS: float32 wo.xyz wi.xyz, one pair after the other. OUT: float64 f cos_theta_i, r g b, not clipped.
"""
import sys

import numpy as np

from tensor_file import read_tensor_file

DTYPES = {1: "u1", 2: "i1", 3: "u2", 4: "i2", 5: "u4", 6: "i4", 7: "u8", 8: "i8", 9: "f2", 10: "f4", 11: "f8"}


def arrays(path):
    return {name: np.frombuffer(data, "<" + DTYPES[dtype]).reshape(shape)
            for name, (shape, dtype, data) in read_tensor_file(path).items()}


def cell(x, size):
    x = np.clip(x, 0, 1) * (size - 1)
    i = np.minimum(x.astype(int), size - 2)
    return i, x - i


def evaluate(fields, wo, wi):
    theta_o = np.arctan2(np.hypot(wo[:, 0], wo[:, 1]), wo[:, 2])
    m = wo + wi
    theta_m = np.arctan2(np.hypot(m[:, 0], m[:, 1]), m[:, 2])
    phi = np.arctan2(m[:, 1], m[:, 0]) - np.arctan2(wo[:, 1], wo[:, 0])
    v = phi / (2 * np.pi) + 0.5
    v -= np.floor(v)
    u = np.sqrt(2 * theta_m / np.pi)

    nodes = fields["theta_i"].astype(float)
    k = np.clip(np.searchsorted(nodes, theta_o, side="right") - 1, 0, len(nodes) - 2)
    t = np.clip((theta_o - nodes[k]) / (nodes[k + 1] - nodes[k]), 0, 1)

    def line(table, x):
        i, w = cell(x, len(table))
        return table[i] * (1 - w) + table[i + 1] * w

    # The warp: each slice of the density has unit mass under bilinear interpolation between its nodes.
    density = np.maximum(fields["vndf"][0].astype(float), 0)
    mass = lambda d: (0.5 * (d[..., 1:] + d[..., :-1])).sum(-1)
    density = density / mass(mass(density))[:, None, None]
    height, width = density.shape[1:]

    def accumulate(d):
        out = np.zeros_like(d)
        np.cumsum(0.5 * (d[..., 1:] + d[..., :-1]), axis=-1, out=out[..., 1:])
        return out

    cdf = accumulate(density)
    totals = cdf[..., -1]
    row_cdf = accumulate(totals)
    x, fx = cell(u, width)
    y, fy = cell(v, height)

    def across(table, *index):  # linear in theta_o
        return (1 - t) * table[(k,) + index] + t * table[(k + 1,) + index]

    def along(row):
        p0, p1 = across(density, row, x), across(density, row, x + 1)
        return across(cdf, row, x) + fx * (p0 + 0.5 * fx * (p1 - p0))

    r0, r1 = across(totals, y), across(totals, y + 1)
    row_mass = (1 - fy) * r0 + fy * r1
    sx = ((1 - fy) * along(y) + fy * along(y + 1)) / np.where(row_mass > 0, row_mass, 1)
    sy = across(row_cdf, y) + fy * (r0 + 0.5 * fy * (r1 - r0))

    rgb = fields["rgb"][0].astype(float)
    i, a = cell(sx, rgb.shape[3])
    j, b = cell(sy, rgb.shape[2])
    out = np.empty((len(wo), 3))
    scale = 1.0
    if fields["jacobian"][0]:
        sigma = line(fields["sigma"][0].astype(float), np.sqrt(2 * theta_o / np.pi))
        scale = line(fields["ndf"][0].astype(float), u) / (4 * sigma)
    for c in range(3):
        low = across(rgb[:, c], j, i) * (1 - a) + across(rgb[:, c], j, i + 1) * a
        high = across(rgb[:, c], j + 1, i) * (1 - a) + across(rgb[:, c], j + 1, i + 1) * a
        out[:, c] = scale * (low * (1 - b) + high * b)
    return out


def main():
    path, pairs, out = sys.argv[1:]
    directions = np.fromfile(pairs, "<f4").astype(float).reshape(-1, 2, 3)
    # The unit vectors that the floats stand for: where wo and wi nearly cancel, rounded lengths alone would
    # turn the half vector.
    directions /= np.linalg.norm(directions, axis=2, keepdims=True)
    evaluate(arrays(path), directions[:, 0], directions[:, 1]).astype("<f8").tofile(out)


if __name__ == "__main__":
    main()
