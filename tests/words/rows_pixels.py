# SPDX-License-Identifier: Apache-2.0
"""How pixels enter: file format, depth, channels, alpha, colour space, raw, wrap and filter."""
from pixels import exr, hdr, png
from rows import Row, bitmap, diffuse, picture, sky, wall

# A picture without symmetry, of whole numbers up to 255.
SPOTS = [[(230, 40, 10), (30, 160, 90), (60, 60, 200), (250, 250, 240)],
         [(10, 20, 30), (120, 90, 40), (200, 10, 120), (77, 128, 33)],
         [(250, 180, 20), (5, 66, 160), (140, 140, 140), (20, 230, 60)]]


def grey(rows):
    return [[(p[1],) for p in r] for r in rows]


def with_alpha(rows):
    return [[(*p, 40 + 50 * ((x + y) % 4)) for x, p in enumerate(r)] for y, r in enumerate(rows)]


def share(rows, by=255):
    return [[tuple(v / by for v in p) for p in r] for r in rows]


def both(word, file, data, more="", sky_why="", like="", **others):
    """As a texture and as a sky."""
    of = {kind: f"{kind}: {like}" if like else "" for kind in ("texture", "sky")}
    in_sky = {"why": sky_why, **others}
    return [Row("pixels", f"texture: {word}", *picture(file, data, more), like=of["texture"] if others.get("why") else "",
                **others),
            Row("pixels", f"sky: {word}", *sky(file, data), like=of["sky"] if in_sky["why"] else "", **in_sky)]


LINEAR = share(SPOTS)
ROWS = [
    *both("PNG, 8 bits, RGB", "a.png", png(SPOTS)),
    *both("PNG, 8 bits, RGBA", "a.png", png(with_alpha(SPOTS))),
    *both("PNG, 8 bits, grey", "a.png", png(grey(SPOTS))),
    *both("PNG, 8 bits, grey and alpha", "a.png", png([[(p[0], p[3]) for p in r] for r in with_alpha(SPOTS)])),
    *both("PNG, 16 bits, RGB", "a.png", png([[tuple(257 * v for v in p) for p in r] for r in SPOTS], 16)),
    *both("PNG, 16 bits, RGBA", "a.png", png([[tuple(257 * v for v in p) for p in r] for r in with_alpha(SPOTS)], 16)),
    *both("PNG, 16 bits, grey", "a.png", png([[tuple(257 * v for v in p) for p in r] for r in grey(SPOTS)], 16)),
    *both("PNG, 4 bits, grey", "a.png", png([[(p[0] // 16,) for p in r] for r in SPOTS], 4)),
    *both("PNG, 1 bit, grey", "a.png", png([[(p[0] // 128,) for p in r] for r in SPOTS], 1)),
    *both("PNG, palette of 4 bits", "a.png", png([[(4 * y + x,) for x in range(4)] for y in range(3)], 4,
                                                palette=[p for r in SPOTS for p in r])),
    *both("PNG, palette with alpha", "a.png", png([[(4 * y + x,) for x in range(4)] for y in range(3)], 8,
                                                 palette=[p for r in SPOTS for p in r],
                                                 transparent=bytes(range(0, 240, 20)))),
    *both("PNG with a gAMA chunk", "a.png", png(SPOTS, gamma=1.0)),
    *both("PNG under the name a.PNG", "a.PNG", png(SPOTS)),
    *both("PNG under the name a.hdr", "a.hdr", png(SPOTS)),
    Row("pixels", "texture: PNG, 8 bits, raw", *picture("a.png", png(SPOTS), '<boolean name="raw" value="true"/>')),
    Row("pixels", "texture: PNG, 16 bits, raw", *picture("a.png", png([[tuple(257 * v for v in p) for p in r]
                                                                     for r in SPOTS], 16),
                                                       '<boolean name="raw" value="true"/>')),
    *both("OpenEXR, float, RGB", "a.exr", exr(LINEAR, "RGB")),
    *both("OpenEXR, half, RGB", "a.exr", exr(LINEAR, "RGB", "half")),
    *both("OpenEXR, float, RGBA", "a.exr", exr(share(with_alpha(SPOTS)), "RGBA")),
    *both("OpenEXR, Y", "a.exr", exr(share(grey(SPOTS)), "Y")),
    *both("OpenEXR, Y and A", "a.exr", exr([[(p[0], p[3]) for p in r] for r in share(with_alpha(SPOTS))], "YA")),
    *both("OpenEXR, X, Y, Z", "a.exr", exr(LINEAR, "XYZ")),
    *both("OpenEXR, R half, G and B float", "a.exr", exr(LINEAR, "RGB", ["half", "float", "float"])),
    *both("OpenEXR, layer diffuse alone", "a.exr", exr(LINEAR, ["diffuse.R", "diffuse.G", "diffuse.B"]),
          sky_why="Mitsuba takes such textures and refuses such skies", like="OpenEXR, float, RGB"),
    *both("OpenEXR, small letters r, g, b", "a.exr", exr(LINEAR, "rgb"),
          sky_why="Mitsuba takes such textures and refuses such skies", like="OpenEXR, float, RGB"),
    *both("OpenEXR, ACES chromaticities", "a.exr", exr(LINEAR, "RGB", chromaticities=(
        .7347, .2653, 0, 1, .0001, -.077, .32168, .33767))),
    *both("OpenEXR, data window off 0", "a.exr", exr(LINEAR, "RGB", window=(3, -5)),
          why="Mitsuba reads beyond its memory; the window's own pixels are meant",
          like="OpenEXR, float, RGB"),
    *both("OpenEXR, uint, RGB", "a.exr", exr([[tuple(v << 23 for v in p) for p in r] for r in SPOTS], "RGB", "uint"),
          error="whole numbers"),
    *both("OpenEXR, R and B without G", "a.exr", exr([[(p[0], p[2]) for p in r] for r in LINEAR], "RB"),
          error="no channel G"),
    *both("OpenEXR, R, G, B and a layer", "a.exr", exr([[p + p for p in r] for r in LINEAR],
                                                      ["R", "G", "B", "z.R", "z.G", "z.B"]),
          why="Mitsuba refuses several layers; the one without a name is meant",
          like="OpenEXR, float, RGB"),
    *both("OpenEXR, two layers", "a.exr", exr([[p + p for p in r] for r in LINEAR],
                                              ["a.R", "a.G", "a.B", "z.R", "z.G", "z.B"]), error="several layers"),
    *both("OpenEXR, a NaN", "a.exr", exr([[(float("nan"), .5, .5)] * 4] * 3, "RGB"), error="not finite"),
    *both("Radiance", "a.hdr", hdr([[(*p, 129) for p in r] for r in SPOTS])),
    *both("Radiance with EXPOSURE", "a.hdr", hdr([[(*p, 129) for p in r] for r in SPOTS], ["EXPOSURE=4.0"])),
    *both("Radiance, flat pixels of 2, 2", "a.hdr", hdr([[(2, 2, 0, 135), (2, 2, 9, 133)] * 2, [(2, 2, 0, 135)] * 4])),
    *both("Radiance, XYZE", "a.hdr", hdr([[(*p, 129) for p in r] for r in SPOTS], form="32-bit_rle_xyze"),
          error="RGBE"),
    *[Row("pixels", f"texture: wrap_mode {w}, {f}", *picture(
        "a.png", png(SPOTS), f'<string name="wrap_mode" value="{w}"/><string name="filter_type" value="{f}"/>'
        '<transform name="to_uv"><scale x="1.7" y="1.4"/><translate x="-0.35" y="-0.2"/></transform>')) for w in ("repeat", "mirror", "clamp")
      for f in ("nearest", "bilinear")],
    Row("pixels", "texture: to_uv, turned and shifted", *picture(
        "a.png", png(SPOTS), '<transform name="to_uv"><translate x="0.3" y="0.1"/><rotate z="1" angle="30"/>'
        '<scale x="1.5"/></transform>')),
    Row("pixels", "texture: 1 x 1 pixel", *picture("a.png", png([[(200, 100, 50)]]))),
    Row("pixels", "sky: 1 x 1 pixel", *sky("a.png", png([[(200, 100, 50)]]))),
    Row("pixels", "sky: 2 x 2 pixels", *sky("a.png", png([r[:2] for r in SPOTS[:2]]))),
    Row("pixels", "sky: 1 x 4 pixels", *sky("a.png", png([[r[0]] for r in [*SPOTS, SPOTS[1]]]))),
]
