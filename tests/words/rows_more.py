# SPDX-License-Identifier: Apache-2.0
"""Words of real scenes: further pictures and meshes, masks, maps of normals, spots, lamps with pictures, instances."""
import struct
import zlib

import rows_shapes as shapes
from pixels import bmp, jpeg, png, tga
from rows import HEADLIGHT, WHITE_SKY, Row, bitmap, diffuse, picture, scene, sky
from rows_numbers import BALL, OBLIQUE, PANEL, RAW, bsdf, emitter, integrator, number
from rows_tangents import SPOT, TILT, metal

SPOTS = [[(230, 40, 10), (30, 160, 90)], [(60, 60, 200), (250, 250, 240)]]
GREY = [[(20,), (90,)], [(160,), (250,)]]
WITH_ALPHA = [[(*p, 100 + 30 * i) for i, p in enumerate(row)] for row in SPOTS]
INDICES, COLOURS = [[(0,), (1,)], [(2,), (3,)]], [c for row in SPOTS for c in row] + [(0, 0, 0)] * 252
YCC = [[(90, 120, 180), (160, 100, 100), (60, 200, 128)], [(200, 128, 128), (30, 128, 150), (220, 110, 140)]]


def shown(word, file, data, **more):
    made = picture(file, data)
    return Row("pictures", "texture: " + word, *made, **more)


NEAREST = '<string name="filter_type" value="nearest"/>'
PICTURES = [
    shown("JPEG, colour", "a.jpg", jpeg(YCC)), shown("JPEG, grey", "a.jpg", jpeg(GREY)),
    shown("JPEG under the name a.png", "a.png", jpeg(YCC)),
    Row("pictures", "texture: JPEG, raw", *picture("a.jpg", jpeg(YCC), RAW)),
    Row("pictures", "sky: JPEG, colour", *sky("a.jpg", jpeg(YCC))),
    shown("JPEG, cut off", "a.jpg", jpeg(YCC)[:-9], error="libjpeg cannot read it"),
    shown("BMP, 24 bits", "a.bmp", bmp(SPOTS)), shown("BMP, 32 bits", "a.bmp", bmp(WITH_ALPHA, 32)),
    shown("BMP, 24 bits, from the top", "a.bmp", bmp(SPOTS, from_top=True)),
    shown("BMP, palette", "a.bmp", bmp(INDICES, 8, COLOURS), why="Mitsuba takes indices of a palette for grey values",
          like="texture: BMP, 24 bits"),
    Row("pictures", "sky: BMP, 24 bits", *sky("a.bmp", bmp(SPOTS))),
    shown("TGA, 24 bits", "a.tga", tga(SPOTS)), shown("TGA, 32 bits", "a.tga", tga(WITH_ALPHA)),
    shown("TGA, grey", "a.tga", tga(GREY)), shown("TGA, 24 bits, coded", "a.tga", tga(SPOTS, True)),
    shown("TGA, grey, coded, from the top", "a.tga", tga(GREY, True, True)),
    shown("TGA, cut off", "a.tga", tga(SPOTS)[:-31], error="a.tga"),
]


def serialized(normals=False, uv=True, wide=False, version=4, meshes=1):
    """The corners of rows_shapes; the last of several meshes is theirs, the others are one triangle."""
    out, starts = b"", []
    for m in range(meshes):
        last = m == meshes - 1
        corners, faces = (shapes.CORNERS, [(0, 1, 2), (0, 2, 3)]) if last else ([(0, 0, 0), (.1, 0, 0), (0, .1, 0)], [(0, 1, 2)])
        flags = (0x2000 if wide else 0x1000) | (1 if normals and last else 0) | (2 if uv and last else 0)
        raw = struct.pack("<I", flags) + (b"part\0" if version == 4 else b"") + struct.pack("<QQ", len(corners), len(faces))
        for rows in (corners, shapes.NORMALS if normals and last else [], shapes.UVS if uv and last else []):
            for row in rows:
                raw += struct.pack(f"<{len(row)}{'d' if wide else 'f'}", *row)
        raw += b"".join(struct.pack("<3I", *f) for f in faces)
        starts.append(len(out))
        out += struct.pack("<HH", 0x041c, version) + zlib.compress(raw, 0)
    return out + b"".join(struct.pack("<Q" if version == 4 else "<I", s) for s in starts) + struct.pack("<I", meshes)


def mesh(word, data, words="", **more):
    return shapes.mesh("serialized: " + word, "serialized", data, words, **more)


MESHES = [
    mesh("texture coordinates", serialized()), mesh("normals of its own", serialized(True)),
    mesh("normals of its own, face_normals", serialized(True), shapes.word("face_normals")),
    mesh("doubles", serialized(True, wide=True)), mesh("without texture coordinates", serialized(uv=False)),
    mesh("version 3", serialized(version=3)), mesh("flip_normals", serialized(), shapes.FLIPPED),
    mesh("shape_index", serialized(meshes=3), number("shape_index", 2, "integer")),
    mesh("shape_index, version 3", serialized(version=3, meshes=2), number("shape_index", 1, "integer")),
    mesh("shape_index beyond", serialized(), "\n" + number("shape_index", 1, "integer"), more={"error": "no mesh 1 in it"}),
    mesh("cut off", serialized()[:60], more={"error": "ends early"}),
    mesh("another file", b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", more={"error": "m.serialized"}),
]

COLOURS4 = [(.9, .1, .2), (.1, .8, .3), (.2, .3, .9), (.9, .9, .1)]


def coloured(names=("r", "g", "b"), kind="float", of="vertex", scale=1):
    values = [[round(scale * v, 3) if kind == "float" else int(scale * v) for v in c[:len(names)]] for c in COLOURS4]
    head = ["ply", "format ascii 1.0", "element vertex 4", *[f"property float {n}" for n in ("x", "y", "z", "u", "v")]]
    fields = [f"property {kind} {n}" for n in names]
    head += fields if of == "vertex" else []
    head += ["element face 2", "property list uchar int vertex_indices", *(fields if of == "face" else []), "end_header"]
    rows = [[*c, *t, *(v if of == "vertex" else [])] for c, t, v in zip(shapes.CORNERS, shapes.UVS, values)]
    rows += [[3, 0, 1, 2, *(values[0] if of == "face" else [])], [3, 0, 2, 3, *(values[1] if of == "face" else [])]]
    return ("\n".join(head) + "\n" + "".join(" ".join(map(str, r)) + "\n" for r in rows)).encode()


def attribute(name, data, where="reflectance", material="diffuse", more="", **others):
    texture = (f'<texture type="mesh_attribute" name="{where}"><string name="name" value="{name}"/>{more}</texture>')
    skin = bsdf("twosided", bsdf(material, texture))
    return shapes.shown("ply", '<string name="filename" value="m.ply"/>', inside=skin, files={"m.ply": data}, **others)


ATTRIBUTES = [
    Row("shapes", "mesh_attribute: " + w, *attribute(n, d, **o), **m) for w, n, d, o, m in (
        ("vertex_color by r, g, b", "vertex_color", coloured(), {}, {}),
        ("vertex_color by red, green, blue", "vertex_color", coloured(("red", "green", "blue")), {}, {}),
        ("vertex_color, scale", "vertex_color", coloured(), {"more": number("scale", "0.5")}, {}),
        ("face_color", "face_color", coloured(of="face"), {}, {}),
        ("of another name", "vertex_tint", coloured(("tint_x", "tint_y", "tint_z")), {}, {}),
        ("of one number", "vertex_wear", coloured(("wear_0",)), {}, {}),
        ("as alpha of a metal", "vertex_wear", coloured(("wear_0",)), {"where": "alpha", "material": "roughconductor",
                                                                    "lights": SPOT}, {"spp": 1024}),
        ("not there", "vertex_colour", coloured(), {}, {"error": "no attribute 'vertex_colour'"}),
        ("of no such kind", "colour", coloured(), {}, {"error": "is called vertex_... or face_..."}))
] + [Row("shapes", "mesh_attribute: on a sphere", scene(BALL.format('\n' + bsdf(
    "diffuse", '<texture type="mesh_attribute" name="reflectance"><string name="name" value="vertex_color"/></texture>'))
    + HEADLIGHT), error="no attribute 'vertex_color'")]

HOLES = png([[(255, 255, 255), (60, 60, 60)], [(0, 0, 0), (128, 128, 128)]])
NORMALS = png([[(128, 128, 255), (190, 140, 220)], [(90, 100, 230), (128, 200, 200)]])
HEIGHTS = png([[(v, v, v) for v in row] for row in ((0, 90, 200, 40), (250, 30, 60, 160), (10, 200, 140, 0), (70, 0, 255, 90))])
PANE = bsdf("thindielectric")
BEHIND = '<shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate y="1" angle="180"/><translate z="5"/>' \
         '</transform>' + diffuse('<texture type="checkerboard" name="reflectance"><transform name="to_uv"><scale value="6"/>' \
                                  '</transform></texture>') + '</shape>'


def covered(word, material, files=None, light=WHITE_SKY + OBLIQUE, spp=1024, **more):
    return Row("materials", word, scene(BALL.format(material) + BEHIND + light, sensor='<float name="fov" value="45"/>'),
               files or {}, spp=spp, **more)


def mapped(kind, texture, inner=diffuse(""), more=""):
    return bsdf(kind, texture + more + inner)


NORMAL = bitmap("n.png", RAW, "normalmap")
HEIGHT = bitmap("h.png", RAW, "any")
WORDS = {w: number(w, "false", "boolean") for w in ("flip_invalid_normals", "use_shadowing_function")}
MATERIALS = [
    covered("mask: opacity 0.3", bsdf("mask", number("opacity", "0.3") + diffuse(""))),
    covered("mask: default", bsdf("mask", diffuse(""))),
    covered("mask: a picture", bsdf("mask", bitmap("a.png", RAW, "opacity") + bsdf("twosided", diffuse(""))), {"a.png": HOLES}),
    covered("mask: a checkerboard", bsdf("mask", '<texture type="checkerboard" name="opacity"><transform name="to_uv">'
                                         '<scale value="5"/></transform></texture>' + metal())),
    covered("mask: of a mirror", bsdf("mask", bsdf("conductor"))),
    covered("mask: of glass", bsdf("mask", bsdf("dielectric"))),
    covered("mask: before a lamp", bsdf("mask", diffuse("")), light='<shape type="sphere"><transform name="to_world">'
            '<scale value="0.4"/><translate x="0.5" z="1.2"/></transform>' + emitter("area") + "</shape>", spp=4096),
    covered("mask: of nothing", "\n" + bsdf("mask"), error="one bsdf is needed"),
    covered("mask: in twosided", "\n" + bsdf("twosided", bsdf("mask", diffuse(""))), error="two sides already"),
    covered("thindielectric: default", PANE),
    covered("thindielectric: int_ior", bsdf("thindielectric", number("int_ior", "2"))),
    covered("thindielectric: specular words", bsdf("thindielectric", number("specular_reflectance", "0.2, 0.4, 0.9", "rgb")
                                                   + number("specular_transmittance", "0.9, 0.7, 0.5", "rgb"))),
    covered("normalmap", mapped("normalmap", NORMAL), {"n.png": NORMALS}),
    covered("normalmap: of a metal", mapped("normalmap", NORMAL, metal(0.2, 0.2)), {"n.png": NORMALS}, SPOT),
    covered("normalmap: of a brushed metal", mapped("normalmap", NORMAL, metal(0.4, 0.1)), {"n.png": NORMALS}, SPOT),
    covered("normalmap: of a mirror", mapped("normalmap", NORMAL, bsdf("conductor")), {"n.png": NORMALS}),
    covered("normalmap: in twosided", bsdf("twosided", mapped("normalmap", NORMAL)), {"n.png": NORMALS}),
    *[covered(f"normalmap: {w} false", mapped("normalmap", NORMAL, more=x), {"n.png": NORMALS}) for w, x in WORDS.items()],
    covered("normalmap: by ref", mapped("normalmap", '<ref name="normalmap" id="t"/>'), {"n.png": NORMALS},
            WHITE_SKY + OBLIQUE + bitmap("n.png", RAW, "x").replace('name="x"', 'id="t"')),
    covered("normalmap: without a texture", "\n" + bsdf("normalmap", diffuse("")), error="without 'normalmap'"),
    covered("normalmap: in grey", "\n" + mapped("normalmap", "\n" + bitmap("n.png", RAW, "normalmap")),
            {"n.png": png([[(9,), (99,)]])}, error="a normal map in grey"),
    covered("bumpmap", mapped("bumpmap", HEIGHT), {"h.png": HEIGHTS}),
    covered("bumpmap: scale", mapped("bumpmap", HEIGHT, more=number("scale", "0.3")), {"h.png": HEIGHTS}),
    covered("bumpmap: of a metal", mapped("bumpmap", HEIGHT, metal(0.2, 0.2), number("scale", "0.2")), {"h.png": HEIGHTS}, SPOT),
    *[covered(f"bumpmap: {w} false", mapped("bumpmap", HEIGHT, more=x), {"h.png": HEIGHTS}) for w, x in WORDS.items()],
    covered("bumpmap: to_uv", mapped("bumpmap", bitmap("h.png", RAW + '<transform name="to_uv"><scale x="3" y="2"/></transform>', "any"),
                                     more=number("scale", "0.3")), {"h.png": HEIGHTS}),
    covered("bumpmap: without a texture", "\n" + bsdf("bumpmap", diffuse("")), error="without a texture"),
    *[shapes.shape(f"{k}: bumpmap", k, inside=mapped("bumpmap", bitmap("a.png", "", "any")) + "", lights=HEADLIGHT + WHITE_SKY)
      for k in ("rectangle", "disk", "cube")],
    *[shapes.shape(f"{k}: normalmap", k, inside=mapped("normalmap", bitmap("a.png", RAW, "normalmap")), lights=HEADLIGHT)
      for k in ("rectangle", "disk", "cube")],
]

WALL = PANEL.format(diffuse("")) + '<shape type="sphere"><float name="radius" value="0.2"/><transform name="to_world">' \
    '<translate x="0.2" y="0.3" z="0.7"/></transform></shape>'
AIM = '<transform name="to_world"><lookat origin="0.3, -0.2, -0.4" target="0.1, 0.1, 1" up="0, 1, 0"/></transform>'


def spot(word, inside="", files=None, **more):
    return Row("lights", "spot: " + word, scene(WALL + emitter("spot", inside)), files or {}, **{"spp": 1024, **more})


def shining(word, kind, files=None, words="", light='<texture type="checkerboard" name="radiance"/>', transform=TILT, **more):
    body = (f'<shape type="{kind}">\n{words}<transform name="to_world">{transform}</transform>{emitter("area", light)}</shape>'
            f'<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/>'
            f'<translate y="-1.6" z="3"/></transform></shape>')
    return Row("lights", "area: " + word, scene(body, sensor='<float name="fov" value="70"/>'), files or {}, **{"spp": 2048, **more})


MAP = bitmap("a.png", "", "radiance")
LIGHTS = [
    spot("default"), spot("to_world", AIM), spot("angles", AIM + number("cutoff_angle", 40) + number("beam_width", 10)),
    spot("intensity", AIM + number("intensity", "2, 5, 9", "rgb")), spot("beam as wide as the cutoff", AIM + number(
        "cutoff_angle", 30) + number("beam_width", 30)),
    spot("texture", AIM + number("cutoff_angle", 40) + bitmap("a.png", name="texture"), {"a.png": png(SPOTS)}),
    spot("beam wider than the cutoff", "\n" + number("beam_width", 50), error="angles that are not"),
    *[shining(f"a picture on a {k}", k, {"a.png": png(SPOTS)}, light=MAP) for k in ("rectangle", "sphere", "disk")],
    shining("a picture on a cube", "cube", {"a.png": png(SPOTS)}, light=MAP,
            why="Mitsuba draws such a lamp by texture coordinates, which are six places of a cube at once"),
    shining("a checkerboard on a rectangle", "rectangle"),
    shining("a picture on a mesh", "obj", {"a.png": png(SPOTS), "m.obj": shapes.obj()}, '<string name="filename" value="m.obj"/>',
            MAP, transform='<rotate y="1" angle="180"/>' + TILT),
    shining("a picture on a cylinder", "cylinder", {"a.png": png(SPOTS)}, light=MAP),
]

TUBE = '<float name="radius" value="0.6"/><point name="p0" value="0.2, -0.9, 0.1"/><point name="p1" value="-0.3, 0.8, -0.2"/>'
CYLINDERS = [
    shapes.shape("cylinder: texture coordinates", "cylinder"), shapes.shape("cylinder: radius, p0 and p1", "cylinder", TUBE),
    shapes.shape("cylinder: flip_normals, texture coordinates", "cylinder", shapes.FLIPPED),
    shapes.shape("cylinder: mirrored, texture coordinates", "cylinder", TUBE, transform=shapes.MIRROR),
    shapes.shape("cylinder: scaled along", "cylinder", transform='<scale z="2"/>' + TILT),
    shapes.shape("cylinder: scaled across", "cylinder", transform='\n<scale x="2"/>' + TILT, more={"error": "makes no cylinder"}),
    shapes.shape("cylinder: without a radius", "cylinder", '\n<float name="radius" value="0"/>', more={"error": "without a size"}),
    *[shapes.side(f"cylinder: {w}", "cylinder", TUBE + x, transform=t) for w, x, t in (
        ("as it is", "", TILT), ("flip_normals", shapes.FLIPPED, TILT), ("mirrored", "", shapes.MIRROR))],
    Row("shapes", "cylinder: lights a wall", scene(PANEL.format(diffuse("")) + '<shape type="cylinder">' + TUBE.replace("0.6", "0.1")
        + emitter("area", number("radiance", "1, 2, 3", "rgb")) + "</shape>"), spp=4096),
    Row("shapes", "cylinder: brushed", scene('<shape type="cylinder">' + TUBE + f'<transform name="to_world">{TILT}</transform>'
        + metal() + "</shape>" + SPOT, sensor='<float name="fov" value="50"/>'), spp=1024),
]


def group(inside, instances, extra=""):
    return (f'<shape type="shapegroup" id="g">{inside}</shape>' + "".join(
        f'<shape type="instance"><ref id="g"/><transform name="to_world">{t}</transform></shape>' for t in instances) + extra)


PLACES = (TILT, '<scale value="0.4"/><translate x="-0.9" y="0.6" z="2.5"/>', '<scale x="-0.5" y="0.3"/><translate x="0.8" y="-0.7" z="2.3"/>')


def instanced(word, inside, places=PLACES, files=None, **more):
    return Row("shapes", "instance: " + word, scene(group(inside, places) + HEADLIGHT, sensor='<float name="fov" value="60"/>'),
               {"a.png": shapes.PICTURE, **(files or {})}, **more)


def one(kind, words="", transform=""):
    return f'<shape type="{kind}">{words}<transform name="to_world">{transform}</transform>{shapes.SKIN}</shape>'


INSTANCES = [
    instanced("of a cube", one("cube")), instanced("of a rectangle and a disk", one("rectangle") + one(
        "disk", transform='<translate z="-0.5" x="0.4"/>')),
    instanced("of a sphere", one("sphere"), PLACES[:2]),
    instanced("of a sphere, unevenly", "\n" + one("sphere"), error="makes no sphere"),
    instanced("of a mesh", one("obj", '<string name="filename" value="m.obj"/>'), files={"m.obj": shapes.obj()}),
    instanced("of a moved mesh", one("ply", '<string name="filename" value="m.ply"/>', '<scale x="0.5"/><rotate z="1" angle="30"/>'),
              files={"m.ply": shapes.ply()}),
    Row("shapes", "instance: in a group", scene('<shape type="shapegroup" id="h">' + one("cube") + '</shape>' + group(
        '<shape type="instance"><ref id="h"/><transform name="to_world"><rotate z="1" angle="20"/></transform></shape>', [TILT])
        + HEADLIGHT), {"a.png": shapes.PICTURE}, why="Mitsuba does not nest instances", like=""),
    Row("shapes", "instance: of no group", scene('<shape type="cube" id="c"/>\n<shape type="instance"><ref id="c"/></shape>'.replace(
        '<ref', '\n<ref')), error="an instance of a <shape>"),
    Row("shapes", "instance: of nothing", scene('\n<shape type="instance"/>'), error="an instance of nothing"),
    Row("shapes", "shapegroup alone", scene(group(one("cube"), []) + BALL.format("") + HEADLIGHT), {"a.png": shapes.PICTURE}),
    instanced("of a lamp", '<shape type="cube">\n' + emitter("area") + "</shape>", error="a lamp in a group"),
]

LAMP_BEFORE = BALL.format(diffuse("")) + '<shape type="sphere"><transform name="to_world"><scale value="0.3"/><translate x="0.3" z="1.2"/>' \
    '</transform>' + emitter("area", number("radiance", "5, 3, 1", "rgb")) + '</shape><shape type="rectangle"><transform name="to_world">' \
    '<scale value="0.4"/><rotate y="1" angle="180"/><translate x="0.3" z="1.8"/></transform>' + emitter("area") + "</shape>"
HIDE = number("hide_emitters", "true", "boolean")


def hidden(word, kind, body, inside=HIDE, **more):
    return Row("integrators", "hide_emitters: " + word, scene(body, integrator=integrator(kind, inside)), **{"spp": 4096, **more})


def inner(kind, words=""):
    return integrator(kind, words + integrator("path", number("max_depth", 3, "integer")))


INTEGRATORS = [
    *[hidden(f"{k}, lamps before a ball", k, LAMP_BEFORE) for k in ("path", "direct")],
    *[hidden(f"{k}, a sky", k, BALL.format(diffuse("")) + WHITE_SKY) for k in ("path", "direct")],
    hidden("a mirror sees them", "path", BALL.format(bsdf("conductor")) + emitter("constant")),
    hidden("volpath, lamps before a ball", "volpath", LAMP_BEFORE),
    *[Row("integrators", w, scene(LAMP_BEFORE, integrator=x), spp=4096, **m) for w, x, m in (
        ("volpath: depth", integrator("volpath", number("max_depth", 3, "integer")), {}),
        ("volpathmis", integrator("volpathmis", number("max_depth", 3, "integer")), {}),
        ("moment", inner("moment"), {}), ("aov", inner("aov", number("aovs", "dd:depth,nn:sh_normal", "string")), {}),
        ("aov of nothing", "\n" + integrator("aov", number("aovs", "dd:depth", "string")), {"error": "no integrator inside"}))],
    Row("integrators", "volpath: a lamp of a point behind a mask", scene(BALL.format(bsdf("mask", diffuse(""))) + emitter("point"),
                                                                        integrator="\n" + integrator("volpath")), error="through masks and panes"),
    *[Row("sensor", f"sampler {k}", scene(LAMP_BEFORE, sampler=k), spp=4096) for k in ("multijitter", "orthogonal", "ldsampler")],
]

ROWS = [*PICTURES, *MESHES, *ATTRIBUTES, *MATERIALS, *LIGHTS, *CYLINDERS, *INSTANCES, *INTEGRATORS]
