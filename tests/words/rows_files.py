# SPDX-License-Identifier: Apache-2.0
"""How a scene's files come together: includes, folders, other names, $names, files of Mitsuba 0.6."""
from pixels import png
from rows import HEADLIGHT, Row, bitmap, diffuse, scene
from rows_numbers import PANEL, number

SPOTS = png([[(230, 40, 10), (30, 160, 90)], [(60, 60, 200), (250, 250, 240)]])
RED = diffuse(number("reflectance", "0.8, 0.2, 0.1", "rgb"))
WALL = PANEL.format(RED) + HEADLIGHT


def included(inside, version="3.0.0"):
    return f'<?xml version="1.0"?>\n<!-- a part -->\n<scene version="{version}">\n{inside}\n</scene>\n'.encode()


def alone(element, version="3.0.0"):
    return element.replace(" type=", f' version="{version}" type=', 1).encode()


def files(word, body, parts=None, error="", **more):
    return Row("files", word, scene(body, **more), parts or {}, error=error)


def old(body):
    """A scene of Mitsuba 0.6."""
    return scene(body).replace("3.0.0", "0.6.0").replace('"sample_count"', '"sampleCount"').replace('"max_depth"', '"maxDepth"')


PART = "parts/wall.xml"
MANY = ['<bsdf type="diffuse">', number("reflectence", "0.5", "rgb").rstrip(), "</bsdf>"]
ROWS = [
    files("include: a scene", '<include filename="wall.xml"/>', {"wall.xml": included(WALL)}),
    files("include: with a comment and an end tag", '<!-- <include filename="none.xml"/> --><include filename="wall.xml">\n</include>',
          {"wall.xml": included(WALL)}),
    files("include: an empty scene", '<include filename="a.xml"/>' + WALL, {"a.xml": b'<scene version="3.0.0"/>'}),
    files("include: a material of its own", PANEL.format('<include filename="red.xml"/>') + HEADLIGHT, {"red.xml": alone(RED)}),
    files("include: a texture with a name", PANEL.format(
        '<bsdf type="diffuse"><include filename="t.xml" name="reflectance"/></bsdf>') + HEADLIGHT,
        {"t.xml": alone(bitmap("a.png", name="other")), "a.png": SPOTS}),
    files("include: in an include, beside it", '<include filename="parts/all.xml"/>',
          {"parts/all.xml": included('<include filename="wall.xml"/>'), "parts/wall.xml": included(WALL)}),
    files("include: pictures are beside the scene", '<include filename="parts/wall.xml"/>' + HEADLIGHT,
          {PART: included(PANEL.format(diffuse(bitmap("a.png")))), "a.png": SPOTS}),
    files("include: by a $name", '<default name="part" value="wall"/><include filename="$part.xml"/>', {"wall.xml": included(WALL)}),
    files("include: with defaults", '<default name="grey" value="0.7"/><include filename="a.xml"/>' + PANEL.format(diffuse(
        number("reflectance", "$grey, $green, 0.2", "rgb"))) + HEADLIGHT,
        {"a.xml": included('<default name="grey" value="0.1"/><default name="green" value="0.4"/>')}),
    files("include: ids from there", '<include filename="a.xml"/>' + PANEL.format('<ref id="red"/>') + HEADLIGHT,
          {"a.xml": included(RED.replace("<bsdf", '<bsdf id="red"'))}),
    files("include: no such file", '\n<include filename="none.xml"/>' + WALL, error="no file 'none.xml'"),
    files("include: a circle", '\n<include filename="scene.xml"/>' + WALL, error="nested deeper than 15"),
    files("include: without a file", '\n<include name="wall"/>' + WALL, error="<include> without 'filename'"),
    files("path: a folder for includes", '<path value="parts"/><include filename="wall.xml"/>', {PART: included(WALL)}),
    files("path: a folder for pictures", '<path value="maps"/>' + PANEL.format(diffuse(bitmap("a.png"))) + HEADLIGHT,
          {"maps/a.png": SPOTS}),
    files("path: the last is looked into first", '<path value="one"/><path value="two"/><include filename="wall.xml"/>',
          {"one/wall.xml": included(WALL.replace("0.8, 0.2", "0.1, 0.9")), "two/wall.xml": included(WALL)}),
    files("path: in an include, for that alone", '<include filename="parts/all.xml"/>' + PANEL.format(diffuse(bitmap("a.png")))
          + HEADLIGHT, {"parts/all.xml": included('<path value="deep"/><include filename="red.xml"/>'),
                        "parts/deep/red.xml": included(""), "parts/deep/a.png": png([[(9, 9, 9)]]), "a.png": SPOTS}),
    files("path: no such folder", '\n<path value="none"/>' + WALL, error="no folder 'none'"),
    files("alias", RED.replace("<bsdf", '<bsdf id="red"') + '<alias id="red" as="skin"/>' + PANEL.format('<ref id="skin"/>')
          + HEADLIGHT),
    files("alias of an alias", RED.replace("<bsdf", '<bsdf id="red"') + '<alias id="red" as="a"/><alias id="a" as="b"/>'
          + PANEL.format('<ref id="b"/>') + HEADLIGHT),
    files("alias of nothing", '\n<alias id="red" as="skin"/>' + WALL, error="no element before it has the id 'red'"),
    files("alias that is there", '<bsdf type="diffuse" id="red"/><bsdf type="diffuse" id="skin"/>\n<alias id="red" as="skin"/>'
          + WALL, error="a second element has the id 'skin'"),
    files("$name: longer names first", '<default name="r" value="0.1"/><default name="red" value="0.8"/>' + PANEL.format(diffuse(
        number("reflectance", "$red, $r, 0.3", "rgb"))) + HEADLIGHT),
    files("$name: followed by letters", '<default name="a" value="0"/>' + PANEL.format(diffuse(bitmap("$a_x.png"))) + HEADLIGHT,
          {"0_x.png": SPOTS}),
    Row("files", "0.6: names without underscores", old(PANEL.format(diffuse(number("diffuseReflectance", "0.8, 0.2, 0.1", "rgb")))
                                                     .replace("to_world", "toWorld") + HEADLIGHT)),
    Row("files", "0.6: uscale and uoffset", old(PANEL.format(diffuse(
        '<texture type="bitmap" name="reflectance"><string name="filename" value="a.png"/><string name="filterType" value="nearest"/>'
        + number("uscale", "1.5") + number("vscale", "0.7") + number("uoffset", "0.3") + number("voffset", "0.1") + "</texture>"))
        + HEADLIGHT), {"a.png": SPOTS}),
    Row("files", "0.6: in an include alone", scene('<include filename="old.xml"/>'), {"old.xml": included(
        WALL.replace("to_world", "toWorld"), "0.6.0")}),
    Row("files", "3.0: names without underscores", scene(PANEL.format("").replace("<transform name=\"to_world\"", "\n<transform name=\"toWorld\"")
                                                         + HEADLIGHT), error="is not known"),
    files("every unknown word at once", "\n".join(["", PANEL.format("\n".join(MANY)), PANEL.format('<bsdf type="fur"/>'),
                                                  '<emitter type="sun"/>']) + WALL, error="'reflectence' is not known"),
]
