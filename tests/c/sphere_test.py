#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The picture of examples/c/sphere.c is right: means of 5 x 5 pixels against the same integral by quadrature, in Python alone.

Usage: sphere_test.py PROGRAM FOLDER [--twin]. --twin: against a sky without a sun it must fail.
"""
import array
import math
import pathlib
import subprocess
import sys

SIZE, TINT = 128, (0.9, 0.6, 0.4)
RINGS, SPOKES = 64, 128


def sky(x, y, z, sun):
    up, glare = 0.5 + 0.5 * y, sun * math.exp(6 * (0.64 * x + 0.48 * y + 0.6 * z - 1))
    return [0.1 + up * (0.2 + 0.2 * c) + glare for c in range(3)]


def integral(x, y, sun):
    """Reflected radiance at a pixel by the midpoint rule over the hemisphere; the normal is (x, y, z)."""
    z, r = math.sqrt(1 - x * x - y * y), math.hypot(x, y)
    cx, cy = (x / r, y / r) if r else (1, 0)
    total = [0.0] * 3
    for i in range(RINGS):
        c = (i + 0.5) / RINGS
        for j in range(SPOKES):
            phi = 2 * math.pi * (j + 0.5) / SPOKES
            a, b = math.sqrt(1 - c * c) * math.cos(phi), math.sqrt(1 - c * c) * math.sin(phi)
            out = a * z + c * r
            light = sky(out * cx - b * cy, out * cy + b * cx, c * z - a * r, sun)
            sheen = 0.2 * math.exp(8 * (-r * a + z * c - 1))
            for k in range(3):
                total[k] += (0.25 * TINT[k] / (z + c) + sheen) * c * light[k] * 2 * math.pi / (RINGS * SPOKES)
    return total


def main() -> int:
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    file = folder / f"sphere{'_twin' if '--twin' in sys.argv else ''}.pfm"
    subprocess.run([program, str(file)], check=True, timeout=120)
    data = file.read_bytes()
    header = b"PF\n%d %d\n-1.0\n" % (SIZE, SIZE)
    if not data.startswith(header) or len(data) != len(header) + 12 * SIZE * SIZE:
        print("no picture of that size")
        return 1
    pixels = array.array("f", data[len(header):])
    if sys.byteorder == "big":
        pixels.byteswap()
    sun = 0 if "--twin" in sys.argv else 4
    worst, ratios = 0.0, []
    for column, row in [(64, 64), (30, 64), (98, 64), (64, 20), (64, 110), (90, 90), (40, 95), (100, 40), (84, 70)]:
        x, y = 2 * (column + 0.5) / SIZE - 1, 2 * (row + 0.5) / SIZE - 1
        wanted = integral(x, y, sun)
        for k in range(3):
            block = [pixels[3 * ((row + v) * SIZE + column + u) + k] for u in range(-2, 3) for v in range(-2, 3)]
            ratios.append(sum(block) / len(block) / wanted[k])
            worst = max(worst, abs(ratios[-1] - 1))
    mean = sum(ratios) / len(ratios)
    corner = pixels[0] + pixels[1] + pixels[2]
    print(f"worst block of 5 x 5 pixels {worst:.3f} off, mean ratio {mean:.4f}, outside the sphere {corner}")
    good = worst < 0.06 and abs(mean - 1) < 0.01 and corner == 0
    return int(good) if "--twin" in sys.argv else int(not good)


if __name__ == "__main__":
    sys.exit(main())
