# SPDX-License-Identifier: Apache-2.0
"""Materials that know directions on the surface: brushed metals on every shape, along its texture coordinates."""
import rows_shapes as shapes
from pixels import png
from rows import Row, bitmap, scene
from rows_numbers import bsdf, number

SPOT = ('<shape type="rectangle"><transform name="to_world"><scale value="0.5"/><lookat origin="-1.5, 0.8, 0.3" '
        'target="0, 0, 3" up="0, 1, 0"/></transform><emitter type="area"><rgb name="radiance" value="8"/></emitter></shape>'
        '<emitter type="constant"><rgb name="radiance" value="0.1, 0.2, 0.3"/></emitter>')
TILT = shapes.TURN + '<translate z="3"/>'
WIDTHS = png([[(40, 40, 40), (120, 120, 120)], [(200, 200, 200), (80, 80, 80)]])


def metal(along=0.35, across=0.08, kind="ggx", more=""):
    return bsdf("roughconductor", number("distribution", kind, "string") + number("alpha_u", along)
                + number("alpha_v", across) + number("material", "Al", "string") + more)


def brushed(word, kind, words="", transform=TILT, material=None, files=None, **more):
    material = metal() if material is None else material
    body = (f'<shape type="{kind}">\n{words}<transform name="to_world">{transform}</transform>\n'
            f'<bsdf type="twosided">{material}</bsdf></shape>\n{SPOT}')
    return Row("tangents", word, scene(body, sensor='<float name="fov" value="50"/>'), files or {}, **{"spp": 1024, **more})


def mesh(word, kind, data, words="", **more):
    return brushed(word, kind, f'<string name="filename" value="m.{kind}"/>{words}', files={f"m.{kind}": data}, **more)


SOLIDS = ("sphere", "rectangle", "cube", "disk")
ROWS = [
    *[brushed(f"{k}: brushed", k) for k in SOLIDS],
    *[brushed(f"{k}: brushed, flip_normals", k, shapes.FLIPPED) for k in SOLIDS],
    *[brushed(f"{k}: brushed, mirrored", k, transform=shapes.MIRROR) for k in SOLIDS],
    *[brushed(f"{k}: brushed, scaled unevenly and sheared", k, transform='<scale x="1.4" y="0.6"/><matrix value='
              '"1 .3 0 0 0 1 0 0 .2 0 1 0 0 0 0 1"/><translate z="3"/>') for k in ("rectangle", "cube", "disk")],
    mesh("obj: brushed", "obj", shapes.obj()),
    mesh("obj: brushed, normals of its own", "obj", shapes.obj(normals=True)),
    mesh("obj: brushed, flip_normals", "obj", shapes.obj(), shapes.FLIPPED),
    mesh("ply: brushed, without texture coordinates", "ply", shapes.ply(())),
    mesh("ply: brushed, without texture coordinates, flip_normals", "ply", shapes.ply(()), shapes.FLIPPED),
    mesh("ply: brushed, face_normals", "ply", shapes.ply(), shapes.word("face_normals")),
    mesh("ply: brushed, mirrored", "ply", shapes.ply(), transform=shapes.MIRROR),
    *[brushed(f"roughconductor: {k}, widths {a} and {b}", "sphere", material=metal(a, b, k))
      for k in ("ggx", "beckmann") for a, b in ((0.05, 0.4), (0.5, 0.02))],
    *[brushed(f"roughconductor: {k}, two widths, sample_visible false", "sphere",
              material=metal(0.15, 0.4, k, number("sample_visible", "false", "boolean"))) for k in ("ggx", "beckmann")],
    brushed("roughconductor: alpha_u a picture", "rectangle", files={"a.png": WIDTHS}, material=bsdf(
        "roughconductor", number("distribution", "ggx", "string") + bitmap("a.png", shapes.word("raw"), "alpha_u")
        + number("alpha_v", 0.1))),
    brushed("roughconductor: alpha_v a checkerboard", "disk", material=bsdf(
        "roughconductor", number("distribution", "ggx", "string") + number("alpha_u", 0.1) + '<texture type="checkerboard"'
        ' name="alpha_v"><float name="color0" value="0.05"/><float name="color1" value="0.5"/></texture>')),
    brushed("roughconductor: alpha_v of 0", "sphere", material="\n" + metal(0.2, 0), error="not positive"),
]
