# SPDX-License-Identifier: Apache-2.0
"""How numbers enter: defaults, units, ranges, textures where numbers are meant and the reverse."""
from pixels import png
from rows import FACING, HEADLIGHT, PI, WHITE_SKY, Row, bitmap, diffuse, scene, sky, wall

GREY60 = png([[(60, 60, 60)] * 2] * 2)
SPOTS = png([[(230, 40, 10), (30, 160, 90)], [(60, 60, 200), (250, 250, 240)]])
RAW = '<boolean name="raw" value="true"/>'
BALL = '<shape type="sphere"><transform name="to_world"><translate z="3"/></transform>\n{}\n</shape>'
OBLIQUE = ('<emitter type="directional"><vector name="direction" x="0.6" y="-0.3" z="1"/>'
           '<rgb name="irradiance" value="3"/></emitter>')


def number(name, value, tag="float"):
    return f'<{tag} name="{name}" value="{value}"/>\n'


def bsdf(kind, inside=""):
    return f'<bsdf type="{kind}">\n{inside}</bsdf>'


def ball(word, material, light=WHITE_SKY + OBLIQUE, files=None, error="", why="", **more):
    return Row("numbers", word, scene(BALL.format(material) + light, sensor='<float name="fov" value="45"/>'),
               files or {}, error=error, why=why, **{"spp": 1024, **more})


def plain(word, body, files=None, error="", why="", slack=.004, spp=256, **more):
    return Row("numbers", word, scene(body, **more), files or {}, error=error, why=why, slack=slack, spp=spp)


def sensor(word, words, error="", width=12, height=8, film="", slack=.004):
    """A ball and a sky of two halves."""
    body = BALL.format('<emitter type="area"><rgb name="radiance" value="1, 0.5, 0.2"/></emitter>')
    body += '<shape type="rectangle"><transform name="to_world"><scale x="1.5" y="0.7"/><rotate y="1" angle="180"/>' \
            '<translate x="0.8" y="0.4" z="4"/></transform><emitter type="area"/></shape>'
    return Row("sensor", word, scene(body, width, height, words, film), error=error, slack=slack)


def lit(word, light, error="", files=None, why="", **more):
    """A wall and a ball before it under a light."""
    body = (f'<shape type="rectangle">{FACING}</shape>\n<shape type="sphere"><float name="radius" value="0.3"/>'
            f'<transform name="to_world"><translate x="0.2" y="0.3" z="0.6"/></transform></shape>\n')
    return Row("lights", word, scene(body + light), files or {}, error=error, why=why, spp=1024, **more)


def emitter(kind, inside=""):
    return f'<emitter type="{kind}">\n{inside}</emitter>'


PANEL = f'<shape type="rectangle">{FACING}\n{{}}\n</shape>'
AREA = '<emitter type="area">{}</emitter>'
GLOSSY = [("roughconductor", ""), ("roughplastic", "")]
ROWS = [
    # Colours.
    *[plain(f"reflectance: {w}", PANEL.format(diffuse(x)) + HEADLIGHT, error=e) for w, x, e in (
        ("default", "", ""), ("rgb of three", number("reflectance", "0.1, 0.5, 0.9", "rgb"), ""),
        ("rgb of one", number("reflectance", "0.3", "rgb"), ""), ("float", number("reflectance", "0.3"), ""),
        ("integer", number("reflectance", "1", "integer"), ""),
        ("spectrum of one", number("reflectance", "0.3", "spectrum"), ""),
        ("spectrum of pairs", number("reflectance", "400:0.1, 500:0.8, 600:0.3, 700:0.9", "spectrum"), ""),
        ("spectrum that ends early", number("reflectance", "450:0.6, 600:0.6", "spectrum"), ""),
        ("spectrum of three numbers", number("reflectance", "0.1, 0.2, 0.3", "spectrum"), "a spectrum is one number"),
        ("rgb over 1", number("reflectance", "0.5, 1.5, 0.2", "rgb"), "more than all"),
        ("rgb below 0", number("reflectance", "0.5, -0.1, 0.2", "rgb"), "is negative"),
        ("rgb of two", number("reflectance", "0.5, 0.1", "rgb"), "one or three"),
        ("rgb in hexadecimal", number("reflectance", "#ff8000", "rgb"), "no finite number"),
        ("float of three", number("reflectance", "0.5, 0.1, 0.2"), "one number"),
        ("string", number("reflectance", "0.5", "string"), "is a colour"),
        ("of another name", number("reflectence", "0.5", "rgb"), "is not known"),
        ("ref to a bsdf", '<ref name="reflectance" id="other"/></bsdf><bsdf type="diffuse" id="other">', "refers to a <bsdf>"),
        ("checkerboard", '<texture type="checkerboard" name="reflectance"><rgb name="color0" value="0.9, 0.2, 0.1"/>'
         '<transform name="to_uv"><scale x="3" y="2"/></transform></texture>', ""),
        ("checkerboard, defaults", '<texture type="checkerboard" name="reflectance"/>', ""))],
    *[plain(f"radiance: {w}", PANEL.format(AREA.format(x)), error=e, files=f) for w, x, e, f in (
        ("default", "", "", {}), ("rgb", number("radiance", "1, 20, 3", "rgb"), "", {}),
        ("float", number("radiance", "3"), "", {}), ("spectrum of one", number("radiance", "2", "spectrum"), "", {}),
        ("spectrum of pairs", number("radiance", "400:1, 500:8, 600:3, 700:9", "spectrum"), "", {}),
        ("texture", bitmap("a.png", name="radiance"), "", {"a.png": SPOTS}))],
    # Lights.
    lit("constant: default", emitter("constant")),
    lit("constant: rgb", emitter("constant", number("radiance", "0.2, 0.5, 1", "rgb"))),
    lit("constant: spectrum of one", emitter("constant", number("radiance", "0.5", "spectrum"))),
    lit("point: default", emitter("point")),
    lit("point: position and intensity", emitter("point", number("position", "0.3, -0.2, 0.1", "point")
                                                 + number("intensity", "0.2, 0.5, 1", "rgb"))),
    lit("point: position by x, y, z", emitter("point", '<point name="position" x="0.3" y="-0.2" z="0.1"/>')),
    lit("point: to_world", emitter("point", '<transform name="to_world"><translate x="0.3" y="0.2" z="-0.4"/></transform>')),
    lit("point: position and to_world", emitter("point", number("position", "0.3, -0.2, 0.1", "point")
                                                + '<transform name="to_world"/>'), "both 'position'"),
    lit("point: position without z", emitter("point", '\n<point name="position" x="0.3" y="0"/>'), "needs x, y and z"),
    lit("directional: default", emitter("directional")),
    lit("directional: direction of no unit length", emitter("directional", number("direction", "0.5, 1, 3", "vector")
                                                            + number("irradiance", "0.2, 0.5, 1", "rgb"))),
    lit("directional: to_world", emitter("directional", '<transform name="to_world"><rotate x="1" angle="30"/></transform>')),
    lit("directional: both", emitter("directional", number("direction", "0.5, 1, 3", "vector")
                                     + '<transform name="to_world"/>'), "both 'direction'"),
    lit("envmap: scale", emitter("envmap", number("filename", "a.png", "string") + number("scale", "2.5")),
        files={"a.png": SPOTS}),
    lit("envmap: scale as a texture", emitter("envmap", number("filename", "a.png", "string") + bitmap("a.png", name="scale")),
        "'scale' is a number", {"a.png": SPOTS}),
    lit("envmap: without a file", emitter("envmap"), "no file is named"),
    lit("envmap: no such file", emitter("envmap", number("filename", "b.png", "string")), "no such file"),
    lit("two skies", emitter("constant") + "\n" + emitter("constant"), "a second environment"),
    lit("envmap: to_world that scales", emitter("envmap", number("filename", "a.png", "string")
                                                + '\n<transform name="to_world"><scale value="2"/></transform>'),
        "scales", {"a.png": SPOTS}),
    *[Row("lights", f"envmap: to_world, {w}", *sky("a.png", png([
        [((37 * x + 91 * y) % 256, (83 * x + 29 * y) % 256, (11 * x + 53 * y) % 256) for x in range(6)] for y in range(5)]),
        f'<transform name="to_world">{t}</transform>')) for w, t in (
            ("none", ""), ("about y", '<rotate y="1" angle="70"/>'), ("about x", '<rotate x="1" angle="90"/>'),
            ("mirrored", '<scale z="-1"/><rotate x="1" angle="30"/>'))],
    lit("area light on a sphere", '<shape type="sphere"><float name="radius" value="0.2"/>' + AREA.format("") + "</shape>"),
    lit("area light on a disk", '<shape type="disk"><transform name="to_world"><scale x="0.5" y="0.2"/></transform>' + AREA.format("") + "</shape>"),
    lit("sampling_weight", emitter("constant", "\n" + number("sampling_weight", "2")), "is not known"),
    # Materials.
    ball("diffuse", bsdf("diffuse")),
    ball("conductor: default", bsdf("conductor")),
    *[ball(f"conductor: material {m}", bsdf("conductor", number("material", m, "string")))
      for m in ("Cu", "Ag", "Al", "Au", "a-C", "AlSb", "TiO2", "VN", "SnTe")],
    ball("conductor: eta and k", bsdf("conductor", number("eta", "0.2, 0.9, 1.1", "rgb") + number("k", "3.9, 2.4, 2.2", "rgb"))),
    ball("conductor: eta alone", bsdf("conductor", number("eta", "0.2, 0.9, 1.1", "rgb"))),
    ball("conductor: k alone", bsdf("conductor", number("k", "3.9, 2.4, 2.2", "rgb"))),
    ball("conductor: eta and k as spectra", bsdf("conductor", number("eta", "400:1.4, 500:0.9, 600:0.3, 700:0.2", "spectrum")
                                                 + number("k", "400:1.9, 500:2.4, 600:3, 700:4", "spectrum"))),
    ball("conductor: eta as one number", bsdf("conductor", number("eta", "1.3") + number("k", "2", "spectrum"))),
    ball("conductor: material and eta", bsdf("conductor", number("material", "Cu", "string") + number("eta", "1")), error="both a material"),
    ball("conductor: material and k", bsdf("conductor", number("material", "Cu", "string") + number("k", "1")), error="both a material"),
    ball("conductor: eta as a texture", bsdf("conductor", bitmap("a.png", name="eta") + number("k", "1")),
         files={"a.png": SPOTS}, error="has one colour here"),
    ball("conductor: no such metal", bsdf("conductor", number("material", "Xx", "string")), error="no metal"),
    ball("conductor: specular_reflectance", bsdf("conductor", number("material", "Au", "string")
                                                 + number("specular_reflectance", "0.3, 0.6, 0.9", "rgb"))),
    *[ball(f"{k}: {w}", bsdf(k, x), error=e, files=f, **m) for k in ("roughconductor", "roughplastic") for w, x, e, f, m in (
        ("default", "", "", {}, {}), ("alpha", number("alpha", "0.4"), "", {}, {}),
        ("alpha as integer", number("alpha", "1", "integer"), "", {}, {"slack": .01}),
        ("distribution ggx", number("distribution", "ggx", "string") + number("alpha", "0.3"), "", {}, {}),
        ("distribution GGX", number("distribution", "GGX", "string") + number("alpha", "0.3"), "", {}, {}),
        ("sample_visible false", number("sample_visible", "false", "boolean") + number("alpha", "0.3"), "", {}, {}),
        ("alpha as a string", number("alpha", "0.4", "string"), "'alpha' is a number", {}, {}),
        ("alpha of 0", number("alpha", "0"), "not positive", {}, {}),
        ("distribution phong", number("distribution", "phong", "string"), "no distribution", {}, {}))],
    ball("roughconductor: alpha as rgb", bsdf("roughconductor", number("alpha", "0.1, 0.5, 0.6", "rgb"))),
    ball("roughconductor: alpha as a grey picture", bsdf("roughconductor", bitmap("a.png", RAW, "alpha")), files={"a.png": GREY60}),
    ball("roughconductor: alpha as a picture in colour, sRGB", bsdf("roughconductor", bitmap("a.png", "", "alpha")), files={"a.png": SPOTS}),
    ball("roughconductor: alpha by ref", bsdf("roughconductor", '<ref name="alpha" id="t"/>'),
         WHITE_SKY + OBLIQUE + bitmap("a.png", RAW, "x").replace('name="x"', 'id="t"'), {"a.png": GREY60}),
    ball("roughconductor: alpha_u and alpha_v alike", bsdf("roughconductor", number("alpha_u", "0.2") + number("alpha_v", "0.2"))),
    ball("roughconductor: alpha_u and alpha_v unlike", bsdf("roughconductor", number("alpha_u", "0.2") + number("alpha_v", "0.3"))),
    ball("roughconductor: alpha_u alone", bsdf("roughconductor", number("alpha_u", "0.2")), error="either alpha"),
    ball("roughplastic: alpha as a texture", bsdf("roughplastic", bitmap("a.png", RAW, "alpha")), files={"a.png": GREY60},
         error="'alpha' is a number"),
    ball("roughplastic: alpha by ref", bsdf("roughplastic", '<ref name="alpha" id="t"/>'),
         WHITE_SKY + OBLIQUE + bitmap("a.png", RAW, "x").replace('name="x"', 'id="t"'), {"a.png": GREY60},
         error="'alpha' is a number"),
    *[ball(f"{k}: {w}", bsdf(k, x), error=e, files=f) for k in ("plastic", "roughplastic") for w, x, e, f in (
        ("int_ior and ext_ior", number("int_ior", "1.8") + number("ext_ior", "1.2"), "", {}),
        ("int_ior by name", number("int_ior", "water", "string"), "", {}),
        ("nonlinear", number("nonlinear", "true", "boolean") + number("diffuse_reflectance", "0.9, 0.4, 0.1", "rgb"), "", {}),
        ("diffuse_reflectance", number("diffuse_reflectance", "0.9, 0.4, 0.1", "rgb"), "", {}),
        ("diffuse_reflectance as a picture", bitmap("a.png", "", "diffuse_reflectance"), "", {"a.png": SPOTS}),
        ("specular_reflectance", number("specular_reflectance", "0.2, 0.4, 0.9", "rgb"), "", {}),
        ("nonlinear as integer", number("nonlinear", "1", "integer"), "is a boolean", {}),
        ("int_ior as a texture", bitmap("a.png", RAW, "int_ior"), "'int_ior' is a number", {"a.png": SPOTS}))],
    ball("plastic: default", bsdf("plastic")),
    ball("plastic: int_ior of diamond", bsdf("plastic", number("int_ior", "diamond", "string")),
         why="Mitsuba takes a fit for the diffuse Fresnel reflectance, good near 1.5; ours is the integral"),
    ball("roughplastic: int_ior of diamond", bsdf("roughplastic", number("int_ior", "diamond", "string"))),
    *[ball(f"dielectric: {w}", bsdf("dielectric", x), error=e) for w, x, e in (
        ("default", "", ""), ("int_ior", number("int_ior", "1.8"), ""), ("int_ior by name", number("int_ior", "water", "string"), ""),
        ("ext_ior by name", number("ext_ior", "Vacuum", "string"), ""), ("below ext_ior", number("int_ior", "1") + number("ext_ior", "1.3"), ""),
        ("no such name", number("int_ior", "wood", "string"), "no index of refraction"),
        ("int_ior as rgb", number("int_ior", "1.5", "rgb"), "'int_ior' is a number"),
        ("specular words", number("specular_reflectance", "0.2, 0.4, 0.9", "rgb") + number("specular_transmittance", "0.9, 0.7, 0.5", "rgb"), ""))],
    ball("twosided: front", bsdf("twosided", diffuse(number("reflectance", "0.8, 0.3, 0.1", "rgb")))),
    plain("one-sided from behind", PANEL.replace("<rotate y=\"1\" angle=\"180\"/>", "").format(diffuse("")) + HEADLIGHT + emitter("constant")),
    plain("twosided from behind", PANEL.replace("<rotate y=\"1\" angle=\"180\"/>", "").format(bsdf("twosided", diffuse(""))) + HEADLIGHT),
    plain("twosided of two, from behind", PANEL.replace("<rotate y=\"1\" angle=\"180\"/>", "").format(bsdf(
        "twosided", diffuse(number("reflectance", "0.9", "rgb")) + diffuse(number("reflectance", "0.1, 0.2, 0.3", "rgb")))) + HEADLIGHT),
    ball("twosided of glass", bsdf("twosided", bsdf("dielectric")), error="two sides already"),
    ball("twosided with a texture by ref", bsdf("twosided", diffuse("") + '\n<ref name="alpha" id="t"/>'),
         WHITE_SKY + bitmap("a.png", RAW, "x").replace('name="x"', 'id="t"'), {"a.png": GREY60}, error="refers to a <texture>"),
    ball("twosided with an unknown word", bsdf("twosided", diffuse("") + "\n" + number("colour", "1")), error="is not known"),
    *[plain(f"blendbsdf: weight {w}", PANEL.format(bsdf("blendbsdf", x + diffuse(number("reflectance", "0.9, 0.1, 0.2", "rgb"))
                                                        + diffuse(number("reflectance", "0.1, 0.8, 0.3", "rgb")))) + HEADLIGHT, f, e)
      for w, x, e, f in (
          ("0.3", number("weight", "0.3"), "", {}), ("over 1", number("weight", "1.3"), "", {}),
          ("as rgb", number("weight", "0.1, 0.5, 0.9", "rgb"), "", {}),
          ("as a raw picture in colour", bitmap("a.png", RAW, "weight"), "", {"a.png": SPOTS}),
          ("as a picture in colour", bitmap("a.png", "", "weight"), "", {"a.png": SPOTS}),
          ("as a checkerboard", '<texture type="checkerboard" name="weight"><rgb name="color0" value="0.9, 0.2, 0.1"/>'
           '<transform name="to_uv"><scale x="3" y="2"/></transform></texture>', "", {}),
          ("as a string", number("weight", "0.3", "string"), "'weight' is", {}), ("missing", "", "without 'weight'", {}))],
    # The camera and its film.
    *[sensor(w, x, e, **m) for w, x, e, m in (
        ("fov: default", "", "", {}), ("fov: default, upright", "", "", {"width": 8, "height": 12}),
        ("fov", number("fov", "60"), "", {}), ("fov as integer", number("fov", "60", "integer"), "", {}),
        *[(f"fov_axis {a}, {'wide' if wide else 'upright'}", number("fov", "60") + number("fov_axis", a, "string"), "",
           {"width": 12 if wide else 8, "height": 8 if wide else 12}) for a in ("x", "y", "diagonal", "smaller", "larger")
          for wide in (True, False)],
        ("focal_length", number("focal_length", "35mm", "string"), "", {}),
        ("focal_length without mm", number("focal_length", "85", "string"), "", {}),
        ("focal_length and fov", number("fov", "60") + number("focal_length", "85", "string"), "both 'fov'", {}),
        ("focal_length as float", number("focal_length", "85"), "'focal_length' is a text", {}),
        ("fov_axis without fov", number("fov_axis", "y", "string"), "without 'fov'", {}),
        ("fov of 180", number("fov", "180"), "between 0 and 180", {}),
        ("fov in words", number("fov", "60deg"), "no finite number", {}),
        ("fov as rgb", number("fov", "60", "rgb"), "'fov' is a number", {}),
        ("near_clip", number("fov", "60") + number("near_clip", "2.5"), "", {}),
        ("far_clip", number("fov", "60") + number("far_clip", "3.5"), "", {}),
        ("far_clip before all", number("fov", "60") + number("far_clip", "1"), "", {}),
        ("near_clip beyond far_clip", number("near_clip", "3") + number("far_clip", "2"), "clips that", {}),
        ("principal_point_offset", number("fov", "60") + number("principal_point_offset_x", "0.1")
         + number("principal_point_offset_y", "-0.2"), "", {}),
        ("to_world", number("fov", "60") + '<transform name="to_world"><rotate z="1" angle="20"/><translate x="0.3"/></transform>', "", {}),
        ("to_world, mirrored", number("fov", "60") + '<transform name="to_world"><scale x="-1"/></transform>', "", {}),
        ("to_world that scales", number("fov", "60") + '\n<transform name="to_world"><scale value="2"/></transform>', "scales", {}),
        ("focus_distance", number("fov", "60") + number("focus_distance", "3"), "", {}),
        ("film: component_format, file_format, pixel_format", number("fov", "60"), "", {"film": number(
            "component_format", "float32", "string") + number("file_format", "openexr", "string") + number("pixel_format", "rgb", "string")}),
        ("film: pixel_format luminance", number("fov", "60"), "no pixel_format", {"film": "\n" + number("pixel_format", "luminance", "string")}),
        ("film: compensate, banner", number("fov", "60"), "", {"film": number("compensate", "true", "boolean") + number("banner", "true", "boolean")}),
    )],
]


def filtered(word, rfilter, error="", film="", **more):
    body = '<shape type="rectangle"><transform name="to_world"><scale x="0.3" y="0.5"/><rotate y="1" angle="180"/>' \
           '<rotate z="1" angle="20"/><translate x="-0.35" y="0.2" z="1"/></transform><emitter type="area"/></shape>'
    return Row("sensor", word, scene(body, rfilter=rfilter, film=film), error=error, spp=4096, **more)


def paths(word, integrator, error="", body=None, why="", like="", **more):
    body = body or ('<shape type="sphere"><float name="radius" value="5"/><boolean name="flip_normals" value="true"/>\n'
                    + diffuse(number("reflectance", "0.8", "rgb")) + '<emitter type="area"><rgb name="radiance" value="0.2"/></emitter></shape>')
    return Row("integrators", word, scene(body, 4, 4, integrator=integrator), error=error, why=why, like=like, spp=1024, **more)


def integrator(kind, inside=""):
    return f'<integrator type="{kind}">\n{inside}</integrator>'


ROWS += [
    *[filtered(f"rfilter {w}", x, error=e) for w, x, e in (
        ("default", "", ""), ("box", "box", ""), ("tent", "tent", ""), ("gaussian", "gaussian", ""),
        ("tent of radius 1.5", '<rfilter type="tent"><float name="radius" value="1.5"/></rfilter>', ""),
        ("gaussian of stddev 0.8", '<rfilter type="gaussian"><float name="stddev" value="0.8"/></rfilter>', ""),
        ("mitchell", '\n<rfilter type="mitchell"/>', "no rfilter"))],
    filtered("sample_border true", "gaussian", film='<boolean name="sample_border" value="true"/>'),
    *[paths(w, x, error=e, **m) for w, x, e, m in (
        ("none given", "", "", {"why": "Mitsuba's renderer asks for one; path without a last bounce is meant",
                                   "like": "path: default depth"}), ("path: default depth", integrator("path"), "", {}),
        *[(f"path: max_depth {d}", integrator("path", number("max_depth", d, "integer")), "", {}) for d in (0, 1, 2, 5, -1)],
        ("path: rr_depth 1", integrator("path", number("rr_depth", 1, "integer")), "", {}),
        ("path: rr_depth 0", integrator("path", number("rr_depth", 0, "integer")), "rr_depth is not positive", {}),
        ("path: max_depth -3", integrator("path", number("max_depth", -3, "integer")), "whole number", {}),
        ("path: max_depth as float", integrator("path", number("max_depth", 3)), "'max_depth' is a whole number", {}),
        ("direct", integrator("direct"), "", {}),
        ("path: hide_emitters false", integrator("path", number("hide_emitters", "false", "boolean")), "", {}),
        ("path: hide_emitters true", integrator("path", number("hide_emitters", "true", "boolean")), "", {}),
        ("path: hide_emitters as integer", integrator("path", number("hide_emitters", "1", "integer")), "is a boolean", {}),
        ("two integrators", integrator("path") + integrator("direct"), "a second <integrator>", {}),
        ("volpath", integrator("volpath"), "", {}),
        ("$name in a type", '<default name="how" value="path"/>' + integrator("$how"), "", {}),
        ("$name by another", '<default name="kind" value="path"/><default name="how" value="$kind"/>' + integrator("$how"), "", {}),
        ("$name that nothing defines", integrator("$how"), "nothing defines $how", {}))],
]


def second_sensor():
    row = sensor("two sensors: the first", number("fov", "60"))
    made = row.scene
    begin, end = made.index("<sensor"), made.index("</sensor>") + len("</sensor>")
    row.scene = made[:end] + made[begin:end].replace('"60"', '"20"') + made[end:]
    return row


ROWS += [second_sensor(),
         plain("text inside an element", PANEL.format(diffuse('<float name="reflectance">0.3</float>')) + HEADLIGHT,
               error="<float> without 'value'"),
         plain("the same id twice", PANEL.format("") + "\n" + diffuse("").replace("<bsdf", '<bsdf id="a"') + "\n"
               + diffuse("").replace("<bsdf", '<bsdf id="a"'), error="a second element has the id"),
         plain("ref to no id", PANEL.format('<ref id="nothing"/>'), error="no element has the id"),
         plain("ref to a nested element", PANEL.format('<ref id="deep"/>') + HEADLIGHT + '<shape type="sphere"><transform name="to_world">'
               '<translate z="-9"/></transform><bsdf type="twosided"><bsdf type="diffuse" id="deep">'
               + number("reflectance", "0.1, 0.9, 0.4", "rgb") + "</bsdf></bsdf></shape>"),
         plain("shape with a ref to a texture", PANEL.format('<ref id="t"/>') + bitmap("a.png", "", "x").replace('name="x"', 'id="t"'),
               {"a.png": SPOTS}, "cannot refer to a <texture>"),
         plain("named parts", PANEL.format(diffuse("").replace("<bsdf", '<bsdf name="skin"')) + HEADLIGHT)]
