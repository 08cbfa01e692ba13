# SPDX-License-Identifier: Apache-2.0
"""How shapes enter: texture coordinates, which side is the front, transforms, meshes of both formats."""
import struct

from pixels import png
from rows import FACING, HEADLIGHT, Row, bitmap, diffuse, scene

SPOTS = [[(230, 40, 10), (30, 160, 90), (60, 60, 200), (250, 250, 240)],
         [(10, 20, 30), (120, 90, 40), (200, 10, 120), (77, 128, 33)],
         [(250, 180, 20), (5, 66, 160), (140, 140, 140), (20, 230, 60)],
         [(90, 10, 200), (245, 120, 130), (15, 190, 190), (170, 70, 5)]]
PICTURE = png(SPOTS)
NEAREST = '<string name="filter_type" value="nearest"/>'
SKIN = f'<bsdf type="twosided">{diffuse(bitmap("a.png", NEAREST))}</bsdf>'
TURN = '<rotate x="0.285714286" y="0.428571429" z="0.857142857" angle="40"/>'  # of unit length, as Mitsuba needs it


def shown(kind, words="", transform=TURN + '<translate z="3"/>', inside=SKIN, files=None, lights=HEADLIGHT):
    """A textured shape three units away, lit from the camera."""
    body = f'<shape type="{kind}">\n{words}<transform name="to_world">{transform}</transform>\n{inside}</shape>\n{lights}'
    return scene(body, sensor='<float name="fov" value="50"/>'), {"a.png": PICTURE, **(files or {})}


def shape(word, *args, more=None, **others):
    made = shown(*args, **others)
    return Row("shapes", word, *made, **(more or {}))


# Its front shines, its back is black.
LAMP = '<emitter type="area"><rgb name="radiance" value="1, 0.5, 0.2"/></emitter>'


def side(word, kind, words="", transform=TURN + '<translate z="3"/>', files=None):
    return shape(word + ", which side shines", kind, words, transform, LAMP, files, "")


# A bent pair of triangles; every corner has its own coordinates.
CORNERS = [(-1, -1, 0), (1, -1, .3), (1, 1, 0), (-1, 1, -.4)]
UVS = [(.1, .05), (.9, .2), (.7, .95), (.0, .8)]
NORMALS = [(-.3, 0, -1), (.2, .3, -1), (0, .2, -1), (.1, -.3, -1)]


def obj(uv=True, normals=False, faces=((1, 2, 3), (1, 3, 4))):
    lines = [f"v {x} {y} {z}" for x, y, z in CORNERS]
    lines += [f"vt {u} {v}" for u, v in UVS] if uv else []
    lines += [f"vn {x} {y} {z}" for x, y, z in NORMALS] if normals else []
    corner = {(0, 0): "{0}", (1, 0): "{0}/{0}", (0, 1): "{0}//{0}", (1, 1): "{0}/{0}/{0}"}[int(uv), int(normals)]
    lines += ["f " + " ".join(corner.format(i) for i in f) for f in faces]
    return "\n".join(lines).encode() + b"\n"


def ply(uv=("u", "v"), normals=False, binary=False, faces=((0, 1, 2), (0, 2, 3))):
    names = ["x", "y", "z"] + (["nx", "ny", "nz"] if normals else []) + list(uv)
    head = "\n".join(["ply", "format binary_little_endian 1.0" if binary else "format ascii 1.0", "element vertex 4",
                      *[f"property float {n}" for n in names], f"element face {len(faces)}",
                      "property list uchar int vertex_indices", "end_header", ""]).encode()
    rows = [(*c, *(n if normals else ()), *t[:len(uv)]) for c, n, t in zip(CORNERS, NORMALS, UVS)]
    if binary:
        return (head + b"".join(struct.pack(f"<{len(r)}f", *r) for r in rows)
                + b"".join(struct.pack("<B3i", 3, *f) for f in faces))
    return head + "".join(" ".join(map(str, r)) + "\n" for r in [*rows, *((len(f), *f) for f in faces)]).encode()


def mesh(word, kind, data, words="", **others):
    return shape(word, kind, f'<string name="filename" value="m.{kind}"/>{words}', files={f"m.{kind}": data}, **others)


def word(name, value="true"):
    return f'<boolean name="{name}" value="{value}"/>\n'


FLIPPED = word("flip_normals")
MIRROR = '<scale x="-1"/>' + TURN + '<translate z="3"/>'
ROWS = [
    *[shape(f"{k}: texture coordinates", k) for k in ("sphere", "rectangle", "cube", "disk")],
    *[shape(f"{k}: from its other side", k, transform='<rotate y="1" angle="180"/>' + TURN + '<translate z="3"/>')
      for k in ("sphere", "rectangle", "cube", "disk")],
    *[shape(f"{k}: flip_normals, texture coordinates", k, FLIPPED) for k in ("sphere", "rectangle", "cube", "disk")],
    *[shape(f"{k}: mirrored, texture coordinates", k, transform=MIRROR) for k in ("sphere", "rectangle", "cube", "disk")],
    *[shape(f"{k}: scaled unevenly and sheared", k, transform='<scale x="1.4" y="0.6"/><matrix value="1 .3 0 0 0 1 0 0 '
            '.2 0 1 0 0 0 0 1"/><translate z="3"/>') for k in ("rectangle", "cube", "disk")],
    *[side(k, k) for k in ("sphere", "rectangle", "cube", "disk")],
    *[side(f"{k}: flip_normals", k, FLIPPED) for k in ("sphere", "rectangle", "cube", "disk")],
    *[side(f"{k}: mirrored", k, transform=MIRROR) for k in ("sphere", "rectangle", "cube", "disk")],
    *[side(f"{k}: turned over", k, transform='<rotate y="1" angle="180"/>' + TURN + '<translate z="3"/>')
      for k in ("rectangle", "disk")],
    shape("sphere: center and radius", "sphere", '<point name="center" x="0.3" y="-0.2" z="0.5"/>'
          '<float name="radius" value="0.7"/>'),
    shape("sphere: center and radius under a scale", "sphere", '<point name="center" value="0.3, -0.2, 0.5"/>'
          '<float name="radius" value="0.7"/>', transform='<scale value="1.2"/>' + TURN + '<translate z="3"/>'),
    shape("sphere: scaled unevenly", "sphere", transform='<scale x="1.4"/><translate z="3"/>',
          more={"error": "makes no sphere"}),
    mesh("obj: texture coordinates", "obj", obj()),
    mesh("obj: flip_tex_coords false", "obj", obj(), word("flip_tex_coords", "false")),
    mesh("obj: without texture coordinates", "obj", obj(uv=False)),
    mesh("obj: normals of its own", "obj", obj(normals=True)),
    mesh("obj: normals of its own, face_normals", "obj", obj(normals=True), word("face_normals")),
    mesh("obj: face_normals", "obj", obj(), word("face_normals")),
    mesh("obj: a face of four corners", "obj", obj(faces=[(1, 2, 3, 4)])),
    mesh("obj: corners counted from the end", "obj", obj(uv=False).replace(b"f 1 2 3", b"f -4 -3 -2"),
         more={"why": "Mitsuba refuses numbers below 0; the format has them", "like": "obj: without texture coordinates"}),
    mesh("obj: some corners without texture coordinates", "obj", obj().replace(b"f 1/1 3/3 4/4", b"f 1 3 4"),
         more={"why": "Mitsuba leaves theirs to chance; ours are 0"}),
    mesh("obj: some corners without normals", "obj", obj(normals=True).replace(b"f 1/1/1 3/3/3 4/4/4",
                                                                              b"f 1/1 3/3 4/4"),
         more={"why": "Mitsuba leaves theirs to chance; ours are the triangle's own"}),
    mesh("obj: a texture coordinate that is not there", "obj", obj().replace(b"f 1/1", b"f 1/9"),
         more={"error": "does not exist"}),
    mesh("obj: four corners whose shorter diagonal is the other", "obj", obj(faces=[(2, 3, 4, 1)])),
    mesh("obj: smooth normals under an uneven scale", "obj", obj(), transform='<scale x="0.4" z="2"/>' + TURN
         + '<translate z="3"/>'),
    mesh("ply: smooth normals under an uneven scale", "ply", ply(), transform='<scale x="0.4" z="2"/>' + TURN
         + '<translate z="3"/>'),
    mesh("ply: texture coordinates u, v", "ply", ply()),
    mesh("ply: texture coordinates s, t", "ply", ply(("s", "t"))),
    mesh("ply: texture coordinates texture_u, texture_v", "ply", ply(("texture_u", "texture_v"))),
    mesh("ply: u alone", "ply", ply(("u",))),
    mesh("ply: without texture coordinates", "ply", ply(())),
    mesh("ply: without texture coordinates, flip_normals", "ply", ply(()), FLIPPED),
    mesh("ply: flip_tex_coords true", "ply", ply(), word("flip_tex_coords")),
    mesh("ply: normals of its own", "ply", ply(normals=True)),
    mesh("ply: normals of its own, face_normals", "ply", ply(normals=True), word("face_normals")),
    mesh("ply: nx alone", "ply", ply(normals=True).replace(b"float ny", b"float a").replace(b"float nz", b"float b")),
    mesh("ply: texture coordinates of faces", "ply", ply(()).replace(
        b"end_header", b"property list uchar float texcoord\nend_header").replace(b"3 0 1 2\n", b"3 0 1 2 6 0 0 1 0 1 1\n").replace(
            b"3 0 2 3\n", b"3 0 2 3 6 0 0 1 1 0 1\n"), more={"error": "texture coordinates of faces"}),
    mesh("ply: binary", "ply", ply(normals=True, binary=True)),
    mesh("ply: a face of four corners", "ply", ply(faces=[(0, 1, 2, 3)]),
         more={"why": "Mitsuba takes triangles alone", "like": "ply: texture coordinates u, v"}),
    *[mesh(f"{k}: {w}, which side shines", k, d, words, inside=LAMP, lights="", transform=t)
      for k, d in (("obj", obj()), ("ply", ply())) for w, words, t in (
          ("as it is", "", TURN + '<translate z="3"/>'), ("flip_normals", FLIPPED, TURN + '<translate z="3"/>'),
          ("mirrored", "", MIRROR), ("face_normals", word("face_normals"), TURN + '<translate z="3"/>'),
          ("face_normals, mirrored", word("face_normals"), MIRROR),
          ("face_normals, flip_normals", word("face_normals") + FLIPPED, TURN + '<translate z="3"/>'),
          ("turned over", "", '<rotate y="1" angle="180"/>' + TURN + '<translate z="3"/>'))],
    *[mesh(f"{k}: own normals, {w}, which side shines", k, d, words, inside=LAMP, lights="", transform=t)
      for k, d in (("obj", obj(normals=True)), ("ply", ply(normals=True))) for w, words, t in (
          ("as it is", "", TURN + '<translate z="3"/>'), ("flip_normals", FLIPPED, TURN + '<translate z="3"/>'),
          ("mirrored", "", MIRROR))],
    Row("shapes", "ply: a lamp with leaning normals", scene(
        f'<shape type="rectangle">{FACING}</shape><shape type="ply"><string name="filename" value="m.ply"/>'
        f'<transform name="to_world"><rotate y="1" angle="180"/><translate z="-0.5"/></transform>{LAMP}</shape>'),
        {"m.ply": ply(normals=True)}, spp=4096,
        why="Mitsuba's density of a sampled point takes the leaning normal's cosine, and its picture hangs on how lamps "
            "are sampled; ours takes the triangle's"),
    Row("shapes", "ply: a lamp without leaning normals", scene(
        f'<shape type="rectangle">{FACING}</shape><shape type="ply"><string name="filename" value="m.ply"/>{word("face_normals")}{FLIPPED}'
        f'<transform name="to_world"><rotate y="1" angle="180"/><translate z="-0.5"/></transform>{LAMP}</shape>'),
        {"m.ply": ply(normals=True)}, spp=4096),
    Row("shapes", "no material: grey", scene(f'<shape type="sphere"><transform name="to_world"><translate z="3"/></transform></shape>{HEADLIGHT}')),
    Row("shapes", "no material, shines: black", scene(f'<shape type="sphere"><transform name="to_world"><translate z="3"/></transform>{LAMP}</shape>{HEADLIGHT}')),
    shape("two materials", "sphere", inside=SKIN + "\n" + diffuse(""), more={"error": "a second material"}),
    shape("a misspelt word", "sphere", '\n<float name="raduis" value="2"/>', more={"error": "'raduis' is not known"}),
    shape("the same word twice", "sphere", '<float name="radius" value="1"/>\n<float name="radius" value="2"/>',
          more={"error": "'radius' is given twice"}),
    shape("radius as a texture", "sphere", f'\n{bitmap("a.png", name="radius")}', more={"error": "'radius' is a number"}),
    shape("radius as rgb", "sphere", '\n<rgb name="radius" value="1"/>', more={"error": "'radius' is a number"}),
    shape("radius without a value", "sphere", '\n<float name="radius" valeu="1"/>', more={"error": "no attribute 'valeu'"}),
    shape("a file that is none", "obj", '<string name="filename" value="m.obj"/>\n',
          files={"m.obj": b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n"},
          more={"error": "m.obj"}),
    shape("transform: rotate about the same axis of unit length", "cube",
          transform='<rotate x="0.801783726" y="0.267261242" z="-0.534522484" angle="70"/><translate z="3"/>'),
    shape("transform: rotate about an axis of no unit length", "cube",
          transform='<rotate x="3" y="1" z="-2" angle="70"/><translate z="3"/>',
          more={"why": "Mitsuba scales and shears by such an axis, ours turns about it",
                "like": "transform: rotate about the same axis of unit length"}),
    *[shape(f"transform: {w}", "cube", transform=t) for w, t in (
        ("order", '<translate x="0.4"/><rotate z="1" angle="50"/><scale x="0.5"/><translate z="3"/>'),
        ("scale by one number", '<scale value="0.6"/>' + TURN + '<translate value="0.3, 0, 3"/>'),
        ("matrix of 9", '<matrix value="0 -1 0 1 0 0 0 0 1"/>' + TURN + '<translate z="3"/>'),
        ("lookat", '<lookat origin="0.2, 0.1, 3" target="1, 2, 5" up="0, 1, 0"/>'))],
    shape("transform: rotate without an angle", "cube", transform='\n<rotate x="1" angel="40"/>',
          more={"error": "no attribute 'angel'"}),
    shape("transform: translate with a misspelt X", "cube", transform='\n<translate X="1"/>',
          more={"error": "no attribute 'X'"}),
]
