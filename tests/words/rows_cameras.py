# SPDX-License-Identifier: Apache-2.0
"""Windows of a film, lenses and parallel rays, parts by reference, samples of direct light, projectors, raw values."""
from pixels import png
from rows import HEADLIGHT, WHITE_SKY, Row, bitmap, diffuse, scene, wall
from rows_more import HEIGHTS, LAMP_BEFORE, NORMALS, covered, mapped
from rows_numbers import AREA, BALL, PANEL, RAW, bsdf, emitter, integrator, number, sensor
from rows_tangents import metal

FOV = number("fov", "60")
SPOTS = png([[(230, 40, 10), (30, 160, 90), (90, 10, 200)], [(60, 60, 200), (250, 250, 240), (15, 190, 190)]])


def window(x=None, y=None, width=None, height=None):
    """Words of a film, on a line of their own."""
    given = {"crop_offset_x": x, "crop_offset_y": y, "crop_width": width, "crop_height": height}
    return "".join(number(n, v, "integer") for n, v in given.items() if v is not None)


def cropped(word, words, error="", sensor_words=FOV, rfilter="box"):
    row = sensor("film: " + word, sensor_words, error, 24, 18, words)
    row.scene = row.scene.replace('<film', '\n<film').replace('<rfilter type="box"/>', f'<rfilter type="{rfilter}"/>')
    return row


def camera(kind, word, words="", error="", transform="", body=None, spp=1024):
    row = sensor(f"{kind}: {word}", words, error)
    if body:
        row.scene = scene(body, 12, 8, words)
    to_world = f'<transform name="to_world">{transform}</transform>' if transform else ""
    row.scene = row.scene.replace('<sensor type="perspective">', f'<sensor type="{kind}">{to_world}')
    row.spp = spp
    return row


TURNED = '<rotate z="1" angle="20"/><translate x="0.3" y="-0.2"/>'
# A ball that is textured, and a lamp out of focus behind it.
DEEP = BALL.format(diffuse('<texture type="checkerboard" name="reflectance"><transform name="to_uv"><scale value="4"/></transform></texture>')
                   ) + '<shape type="rectangle"><transform name="to_world"><scale value="0.7"/><rotate y="1" angle="180"/>' \
    f'<translate x="1.5" y="0.8" z="6"/></transform>{AREA.format("")}</shape>' + HEADLIGHT + WHITE_SKY
LENS = number("aperture_radius", "0.4") + number("focus_distance", "2.5") + FOV
CAMERAS = [
    cropped("crop_width", window(width=10)), cropped("a window", window(5, 4, 9, 12)),
    cropped("a window beside the axis", window(2, 3, 8, 7), sensor_words=FOV + number("principal_point_offset_x", "0.1")
            + number("principal_point_offset_y", "-0.2")),
    cropped("a window, gaussian", window(9, 6, 6, 8), rfilter="gaussian"),
    cropped("a window beyond it", window(20, 0, 5, 5), "a crop window that is not inside"),
    cropped("a window without pixels", window(0, 0, 0, 5), "a crop window that is not inside"),
    cropped("a window before it", window(-1, 0, 5, 5), "a crop window that is not inside"),
    camera("orthographic", "default"), camera("orthographic", "to_world", transform='<scale x="2" y="1.5"/>' + TURNED),
    camera("orthographic", "to_world, mirrored and sheared", transform='<matrix value="-1.5 .4 0 0 0 1.2 0 0 0 .1 1 0 0 0 0 1"/>'),
    camera("orthographic", "clips", number("near_clip", "2.5") + number("far_clip", "3.5"), transform='<scale value="1.3"/>'),
    camera("orthographic", "clips under a scale along", number("near_clip", "1.5") + number("far_clip", "3"), transform='<scale x="2" y="2" z="2"/>'),
    camera("orthographic", "fov", "\n" + FOV, "'fov' is not known"),
    camera("orthographic", "to_world that is flat", "", "looks nowhere", '<scale z="0"/>'),
    camera("thinlens", "in focus", LENS.replace("2.5", "2.1"), body=DEEP), camera("thinlens", "out of focus", LENS, body=DEEP),
    camera("thinlens", "focus_distance default", number("aperture_radius", "0.2") + FOV, body=DEEP),
    camera("thinlens", "to_world and clips", LENS + number("near_clip", "2.4") + number("far_clip", "4"), transform=TURNED, body=DEEP),
    camera("thinlens", "aperture_radius 0", LENS.replace("0.4", "0"), body=DEEP),
    camera("thinlens", "no aperture_radius", FOV, "without 'aperture_radius'"),
    camera("thinlens", "aperture_radius below 0", LENS.replace("0.4", "-1"), "aperture_radius >= 0"),
    camera("radiancemeter", "unknown", "", "no sensor 'radiancemeter'"),
]


def referring(word, parts, inside, error=""):
    """A sensor whose parts stand before it."""
    text = f"""<scene version="3.0.0">
{integrator("path", number("max_depth", 4, "integer"))}
{parts}
<sensor type="perspective">{FOV}
{inside}
</sensor>
{LAMP_BEFORE}
</scene>
"""
    return Row("files", "ref: " + word, text, error=error, spp=1024)


SAMPLER = '<sampler type="independent" id="s"><integer name="sample_count" value="16"/></sampler>'
FILM = '<film type="hdrfilm" id="f"><integer name="width" value="8"/><integer name="height" value="8"/>{}</film>'
BOX = '<rfilter type="box" id="r"/>'
REFERENCES = [
    referring("a sampler", SAMPLER, '<ref id="s"/>' + FILM.format(BOX)), referring("a film", FILM.format(BOX), '<ref id="f"/>' + SAMPLER),
    referring("a filter", BOX, FILM.format('<ref id="r"/>') + SAMPLER),
    referring("an alias of a sampler", SAMPLER + '<alias id="s" as="t"/>', '<ref id="t" name="points"/>' + FILM.format(BOX)),
    referring("a sensor to a bsdf", '<bsdf type="diffuse" id="b"/>', '\n<ref id="b"/>' + FILM.format(BOX) + SAMPLER, "cannot refer to a <bsdf>"),
    referring("two samplers", SAMPLER, '\n<ref id="s"/>\n<sampler type="independent"/>' + FILM.format(BOX), "a second <sampler>"),
]


LAMP = '<shape type="sphere"><transform name="to_world"><scale value="0.4"/><translate x="0.8" z="1"/></transform>' \
    + emitter("area", number("radiance", "5, 3, 1", "rgb")) + "</shape>"


def direct(word, words, error="", material=diffuse(""), light=LAMP + WHITE_SKY, why=""):
    made = scene(BALL.format(material) + light, integrator=integrator("direct", "".join(number(n, v, "integer") for n, v in words.items())))
    made = made.replace("<integrator", "\n<integrator").replace('<integer name="bsdf_samples"', '\n<integer name="bsdf_samples"')
    return Row("integrators", "direct: " + word, made, error=error, why=why, spp=4096)


DIRECT = [
    direct("shading_samples", {"shading_samples": 3}), direct("both", {"emitter_samples": 3, "bsdf_samples": 2}),
    direct("emitter_samples", {"emitter_samples": 4}),
    direct("emitter_samples, a sun", {"emitter_samples": 4}, light=LAMP + HEADLIGHT,
           why="Mitsuba counts a light of a point or a direction once for each sample; its share is meant"),
    direct("lamps alone", {"bsdf_samples": 0}, material=metal(0.2, 0.2), light=LAMP + HEADLIGHT),
    direct("surfaces alone", {"emitter_samples": 0}, material=metal(0.3, 0.3), light=LAMP + HEADLIGHT),
    direct("surfaces alone, a mirror", {"emitter_samples": 0}, material=bsdf("conductor")),
    direct("lamps alone, a mirror", {"bsdf_samples": 0}, "mirrors, glass and masks", material=bsdf("conductor")),
    direct("none at all", {"emitter_samples": 0, "bsdf_samples": 0}, "negative or all 0"),
    direct("told twice", {"shading_samples": 2, "bsdf_samples": 1}, "both shading_samples and"),
]

WALL = PANEL.format(diffuse("")) + '<shape type="sphere"><float name="radius" value="0.2"/><transform name="to_world">' \
    '<translate x="0.2" y="0.3" z="0.7"/></transform></shape>'
AIM = '<transform name="to_world"><lookat origin="0.3, -0.2, -0.4" target="0.1, 0.1, 1" up="0, 1, 0"/></transform>'


def projector(word, words, error="", files=None):
    return Row("lights", "projector: " + word, scene(WALL + "\n" + emitter("projector", words)), files or {"a.png": SPOTS}, error=error, spp=1024)


SHOWN = bitmap("a.png", '<string name="filter_type" value="nearest"/>', "irradiance")
PROJECTORS = [
    projector("default", ""), projector("a colour, scale", AIM + FOV + number("irradiance", "1, 0.5, 0.2", "rgb") + number("scale", "2.5")),
    projector("a picture", AIM + FOV + SHOWN), projector("a picture, fov_axis y", AIM + FOV + number("fov_axis", "y", "string") + SHOWN),
    projector("a picture, focal_length", AIM + number("focal_length", "30mm", "string") + SHOWN),
    projector("a bilinear picture", AIM + FOV + bitmap("a.png", "", "irradiance")),
    projector("to_world that scales", FOV + '\n<transform name="to_world"><scale value="2"/></transform>', "scales"),
    projector("scale below 0", number("scale", "-1"), "a negative scale"),
]


def raw(inside, name="reflectance"):
    return f'\n<texture type="rawconstant" name="{name}">{inside}</texture>'


FLAT = '<vector name="value" value="0.5, 0.5, 1"/>'
RAWS = [
    Row("numbers", "rawconstant: three", wall(diffuse(raw('<vector name="value" value="0.7, 0.3, 0.2"/>')))),
    Row("numbers", "rawconstant: one", wall(diffuse(raw(number("value", "0.6"))))),
    covered("rawconstant: alpha", bsdf("roughconductor", raw(number("value", "0.3"), "alpha")), light=HEADLIGHT + WHITE_SKY),
    covered("rawconstant: normalmap", mapped("normalmap", raw(FLAT, "normalmap"), metal(0.4, 0.1))),
    covered("rawconstant: normalmap, leaning", mapped("normalmap", raw(FLAT.replace("0.5, 0.5", "0.6, 0.45"), "normalmap"))),
    Row("numbers", "rawconstant: below 0", wall(diffuse(raw('\n<vector name="value" value="0.7, -0.3, 0.2"/>'))), error="a value below 0"),
    Row("numbers", "rawconstant: of nothing", wall(diffuse(raw(""))), error="no 'value'"),
    covered("normalmap: format variant", mapped("normalmap", bitmap("n.png", RAW + number("format", "variant", "string"), "normalmap")),
            {"n.png": NORMALS}),
    covered("bumpmap: accel", mapped("bumpmap", bitmap("h.png", RAW + number("accel", "false", "boolean"), "any")), {"h.png": HEIGHTS}),
    Row("numbers", "spectrum of type bitmap", wall(diffuse(bitmap("a.png").replace("texture", "spectrum"))), {"a.png": SPOTS}),
    Row("numbers", "spectrum of type bitmap, a wrong word", wall(diffuse(bitmap("a.png", "\n" + number("gamma", "2")).replace(
        "texture", "spectrum"))), {"a.png": SPOTS}, error="'gamma' is not known"),
    Row("numbers", "bitmap: format fp8", wall(diffuse("\n" + bitmap("a.png", number("format", "fp8", "string")))), {"a.png": SPOTS}, error="no format 'fp8'"),
]

BLENDS = "Mitsuba adds a delta's probability to the density of the other part"
NULLS = [covered("null", bsdf("null")), covered("null: in a blend", bsdf("blendbsdf", number("weight", "0.4") + bsdf("null") + diffuse("")), why=BLENDS),
         covered("blendbsdf: of a mirror", bsdf("blendbsdf", number("weight", "0.4") + diffuse("") + bsdf("conductor")), why=BLENDS),
         covered("null: in twosided", "\n" + bsdf("twosided", bsdf("null")), error="two sides already")]

ROWS = [*CAMERAS, *REFERENCES, *DIRECT, *PROJECTORS, *RAWS, *NULLS]
