#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Models the material ball of scenes/ball.xml: a hollow ball with an opening and a groove, its turned foot, and
the cove behind it. All are turned on a lathe: profiles of straight lines and arcs that meet without a kink,
so that shading normals are the profiles' own.

Usage: model_ball.py FOLDER. Writes ball.ply, foot.ply and cove.ply there, binary, with normals.
"""
import math
import pathlib
import struct
import sys

# A point of a profile: distance from the axis, height, and the normal's two parts.


def line(start, end, steps=1):
    """From start to end; the surface lies on the right hand."""
    along = (end[0] - start[0], end[1] - start[1])
    size = math.hypot(*along)
    normal = (-along[1] / size, along[0] / size)
    return [(start[0] + along[0] * i / steps, start[1] + along[1] * i / steps, *normal) for i in range(steps + 1)]


def arc(centre, radius, begin, end, steps, hollow=False):
    """Angles in degrees from the outward direction upwards; normals away from the centre, or towards it."""
    points = []
    for i in range(steps + 1):
        angle = math.radians(begin + (end - begin) * i / steps)
        c, s = math.cos(angle), math.sin(angle)
        side = -1 if hollow else 1
        points.append((centre[0] + radius * c, centre[1] + radius * s, side * c, side * s))
    return points


def polar(radius, elevation):
    return radius * math.cos(math.radians(elevation)), radius * math.sin(math.radians(elevation))


def notch(outer, depth, above, below, bevel, steps):
    """A notch of a ball between two elevations, with rounded rims and bottom edges, from above to below; and the
    elevations at which the ball ends and goes on."""
    inner = outer - depth
    rim = math.degrees(math.asin(bevel / (outer - bevel)))  # of the bevels' middles from the notch's walls
    foot = math.degrees(math.asin(bevel / (inner + bevel)))
    high, low = above + rim, below - rim
    return high, low, [
        *arc(polar(outer - bevel, high), bevel, high, above - 90, steps),
        *arc(polar(inner + bevel, above - foot), bevel, above + 90, above + 180 - foot, steps, hollow=True),
        *arc((0, 0), inner, above - foot, below + foot, 2),
        *arc(polar(inner + bevel, below + foot), bevel, below + foot + 180, below + 270, steps, hollow=True),
        *arc(polar(outer - bevel, low), bevel, below + 90, low, steps),
    ]


def ball():
    """Of radius 1 about the origin; open above 50 degrees, down to radius 0.7, where a smaller ball fits in."""
    bevel, edge = .035, 50
    rim = edge - math.degrees(math.asin(bevel / (1 - bevel)))
    high, low, groove = notch(1, .07, 4, -2, .014, 4)
    return [
        *line(polar(.7, edge), polar(math.sqrt((1 - bevel) ** 2 - bevel ** 2), edge), 2),
        *arc(polar(1 - bevel, rim), bevel, edge + 90, rim, 8),
        *arc((0, 0), 1, rim, high, 14),
        *groove,
        *arc((0, 0), 1, low, -90, 18),
    ]


def foot():
    """A turned foot, 0.34 high, hollowed for a ball of radius 1 that stands in it."""
    return [
        *arc((.4, .3), .04, 150, -30, 10),  # the bead on which the ball lies
        *arc((.4 + .16 * math.cos(math.radians(-30)), .3 + .16 * math.sin(math.radians(-30))), .12, 150, 270, 12,
             hollow=True),
        *line((.4 + .16 * math.cos(math.radians(-30)), .1), (.66, .1), 1),
        *arc((.66, .06), .04, 90, 0, 6),
        *line((.7, .06), (.7, 0), 1),
    ]


def cove():
    """A floor that rises into a wall."""
    return [(0, 0, 0, 1), *line((.5, 0), (7, 0), 4), *arc((7, 3), 3, -90, 0, 12, hollow=True), *line((10, 3), (10, 7))]


def turned(profile, around):
    """Vertices and triangles of the profile turned about the axis; ends on the axis are single points."""
    points = [p for i, p in enumerate(profile) if i == 0 or math.dist(p, profile[i - 1]) > 1e-6]
    vertices, rings = [], []
    for r, z, nr, nz in points:
        single = abs(r) < 1e-9
        rings.append([len(vertices) + (0 if single else k) for k in range(around)])
        for k in range(1 if single else around):
            c, s = math.cos(2 * math.pi * k / around), math.sin(2 * math.pi * k / around)
            vertices.append((0, 0, z, 0, 0, math.copysign(1, nz)) if single else (r * c, r * s, z, nr * c, nr * s, nz))
    triangles = []
    for upper, lower in zip(rings, rings[1:]):
        for k in range(around):
            a, b, c, d = upper[k], lower[k], lower[(k + 1) % around], upper[(k + 1) % around]
            triangles += [t for t in ((a, b, c), (a, c, d)) if len(set(t)) == 3]
    return vertices, [facing(t, vertices) for t in triangles]


def facing(triangle, vertices):
    """The triangle, its corners in the order that agrees with their normals."""
    a, b, c = (vertices[i] for i in triangle)
    u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
    cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    agrees = sum(cross[k] * (a[3 + k] + b[3 + k] + c[3 + k]) for k in range(3))
    return triangle if agrees > 0 else triangle[::-1]


def to_ply(vertices, triangles):
    names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    header = (f"ply\nformat binary_little_endian 1.0\ncomment made by tools/model_ball.py\n"
              f"element vertex {len(vertices)}\n{names}element face {len(triangles)}\n"
              f"property list uchar int vertex_indices\nend_header\n")
    return b"".join([header.encode(), *(struct.pack("<6f", *v) for v in vertices),
                     *(struct.pack("<B3i", 3, *t) for t in triangles)])


MESHES = {"ball.ply": (ball, 72), "foot.ply": (foot, 64), "cove.ply": (cove, 48)}


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: model_ball.py FOLDER")
    for name, (profile, around) in MESHES.items():
        (pathlib.Path(sys.argv[1]) / name).write_bytes(to_ply(*turned(profile(), around)))


if __name__ == "__main__":
    main()
