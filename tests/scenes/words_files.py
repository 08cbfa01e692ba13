# SPDX-License-Identifier: Apache-2.0
"""Pictures, meshes and a material that the scenes of words/ name: small, and made from formulas.

    tests/scenes/words_files.py     writes them into words/files
"""
import pathlib
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "words"))

from pixels import bmp, exr, hdr, jpeg, png, tga  # noqa: E402
from rows_more import serialized  # noqa: E402
from rows_shapes import CORNERS, SPOTS, UVS, obj, ply  # noqa: E402

SKY = [[(.3 + .2 * x * (y == 0), .4 + .1 * y, .9 - .2 * y - .05 * x) for x in range(8)] for y in range(4)]
NORMALS = [[(128, 128, 255), (190, 140, 220)], [(90, 100, 230), (128, 200, 200)]]
HEIGHTS = [[(v,) for v in row] for row in ((0, 90, 200, 40), (250, 30, 60, 160), (10, 200, 140, 0), (70, 0, 255, 90))]


def rgbe(colour):
    """Four bytes with a common exponent of 128: sixteenths of 16."""
    return tuple(max(1, round(128 * v)) for v in colour) + (129,)


def coloured_ply():
    """Four corners and two triangles with colours of their own."""
    corners = [(.9, .2, .1), (.1, .8, .3), (.2, .3, .9), (.8, .8, .2)]
    lines = ["ply", "format ascii 1.0", "element vertex 4", *[f"property float {n}" for n in "x y z u v r g b".split()],
             "element face 2", "property list uchar int vertex_indices", *[f"property float {n}" for n in "rgb"], "end_header"]
    lines += [" ".join(map(str, (*p, *t, *c))) for p, t, c in zip(CORNERS, UVS, corners)]
    lines += ["3 0 1 2 .7 .2 .2", "3 0 2 3 .2 .3 .8"]
    return ("\n".join(lines) + "\n").encode()


def measured():
    """A material of the RGL database's layout: glossy, alike for all azimuths; 2 x 8 normals, 4 x 4 colours."""
    theta, n = [0., .5, 1.1, 1.5707964], 8
    row = [i / (n - 1) for i in range(n)]
    square = [(y / 7, x / 7) for y in range(8) for x in range(8)]
    vndf = [1 + .5 * (1 - u) + .1 * t * u for t in range(4) for _, u in square]
    inside = [(t, y, x) for t in range(4) for y in (0, .4, .7, 1) for x in (0, .3, .6, 1)]
    luminance = [.2 + .02 * t * (1 - x) + .1 * y for t, y, x in inside]
    rgb = [.15 + .05 * c + luminance[16 * t + i] for t in range(4) for c in range(3) for i in range(16)]
    fields = [("description", 1, (4,), b"made"), ("jacobian", 1, (1,), b"\1")]
    for name, shape, values in (("phi_i", (1,), [0.]), ("theta_i", (4,), theta), ("sigma", (2, n), 2 * [1 - .8 * u for u in row]),
                                ("ndf", (2, n), 2 * [.3 + 1.5 * (1 - u) for u in row]), ("vndf", (1, 4, 8, 8), vndf),
                                ("luminance", (1, 4, 4, 4), luminance), ("rgb", (1, 4, 3, 4, 4), rgb)):
        fields.append((name, 10, shape, struct.pack(f"<{len(values)}f", *values)))
    at = 18 + sum(2 + len(name) + 2 + 1 + 8 + 8 * len(shape) for name, _, shape, _ in fields)
    head = b"tensor_file\0" + struct.pack("<BBI", 1, 0, len(fields))
    for name, kind, shape, data in fields:
        head += struct.pack("<H", len(name)) + name.encode() + struct.pack(f"<HBQ{len(shape)}Q", len(shape), kind, at, *shape)
        at += len(data)
    return head + b"".join(data for *_, data in fields)


FILES = {
    "spots.png": png(SPOTS),
    "grey16.png": png([[(9000,), (60000,)], [(40000,), (20000,)]], bits=16),
    "holes.png": png([[(255,), (60,)], [(0,), (128,)]]),
    "normals.png": png(NORMALS),
    "heights.png": png(HEIGHTS),
    "widths.png": png([[(40,), (120,)], [(200,), (70,)]]),
    "blocks.jpg": jpeg([[(90, 120, 180), (160, 100, 100)], [(200, 128, 128), (30, 128, 150)]]),
    "spots.bmp": bmp(SPOTS),
    "spots.tga": tga(SPOTS),
    "lamp.exr": exr([[(4., 1., .5), (1., 3., 2.)], [(.5, 1., 5.), (2., 2., 2.)]], ("R", "G", "B"), "half"),
    "sky.exr": exr(SKY, ("R", "G", "B")),
    "sky.hdr": hdr([[rgbe(p) for p in row] for row in SKY]),
    "bent.obj": obj(normals=True),
    "bent.ply": ply(normals=True, binary=True),
    "coloured.ply": coloured_ply(),
    "bent.serialized": serialized(normals=True, meshes=2),
    "glossy.bsdf": measured(),
}


if __name__ == "__main__":
    for file, content in FILES.items():
        (HERE / "words" / "files").mkdir(parents=True, exist_ok=True)
        (HERE / "words" / "files" / file).write_bytes(content)
