#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Words of Mitsuba's XML thrown together: random small scenes rendered by both programs.

    bench/mitsuba/words_random.py [--first 1] [--count 100] [--reflectree build/bin/reflectree] [--venv build/mitsuba]

What differs is rendered again with 16 times the samples before it is called so. Left out, because Mitsuba's own
pictures are not sure there: stratified points, and lamps whose normals lean. Exits with 1 where one scene
differs, or where one program alone refuses one.
"""
import argparse
import dataclasses
import math
import pathlib
import random
import sys
import tempfile

from words import Mitsuba, mitsuba_python, render  # finds tests/words as well

from judge import LIMIT, means, worst
from pixels import exr, hdr, png
from rows import Row
from rows_shapes import obj, ply

SLACK = .006


class Scenes:
    """Scene number `seed`."""

    def __init__(self, seed):
        self.r, self.files = random.Random(seed), {}

    def u(self, low, high):
        return round(self.r.uniform(low, high), 3)

    def maybe(self, text, chance=.6):
        return text if self.r.random() < chance else ""

    def file(self, kind, data):
        name = f"f{len(self.files)}.{kind}"
        self.files[name] = data
        return f'<string name="filename" value="{name}"/>'

    def flag(self, name, chance=.3):
        return self.maybe(f'<boolean name="{name}" value="{self.r.choice(["true", "true", "false"])}"/>', chance)

    def choice(self, name, *words):
        return f'<string name="{name}" value="{self.r.choice(words)}"/>'

    def pixels(self, largest, hdr_too=False):
        kind, (w, h) = self.r.choice(["png", "png", "exr"] + ["hdr"] * hdr_too), (self.r.randint(1, 9), self.r.randint(1, 5))

        def rows(channels, pick):
            return [[tuple(pick() for _ in range(channels)) for _ in range(w)] for _ in range(h)]

        if kind == "png":
            bits = self.r.choice([4, 8, 8, 16])
            return self.file(kind, png(rows(self.r.randint(1, 4) if bits > 4 else 1,
                                            lambda: self.r.randrange(2 ** bits)), bits))
        if kind == "hdr":
            return self.file(kind, hdr([[(*p, 128) for p in row] for row in rows(3, lambda: self.r.randrange(3, 256))]))
        channels = self.r.choice(["RGB", "RGBA", "Y", "YA"])
        return self.file(kind, exr(rows(len(channels), lambda: self.u(0, largest)), channels,
                                   self.r.choice(["half", "float"])))

    def steps(self, evenly=False, flat=False):
        out = ""
        for kind in self.r.choices(["translate", "scale", "rotate", "matrix"], k=self.r.randint(0, 3)):
            if kind == "translate":
                out += f'<translate x="{self.u(-.5, .5)}" y="{self.u(-.5, .5)}" z="{0 if flat else self.u(-.5, .5)}"/>'
            elif kind == "scale" and evenly:
                out += f'<scale value="{self.u(.6, 1.3)}"/>'
            elif kind == "scale":
                out += f'<scale x="{self.r.choice([1, 1, -1]) * self.u(.5, 1.5)}" y="{self.u(.5, 1.5)}" z="{self.u(.5, 1.5)}"/>'
            elif kind == "rotate":
                axis = [0, 0, 1] if flat else [self.r.gauss(0, 1) for _ in range(3)]
                x, y, z = (v / math.hypot(*axis) for v in axis)
                out += f'<rotate x="{x:.7f}" y="{y:.7f}" z="{z:.7f}" angle="{self.u(-180, 180)}"/>'
            elif not evenly:
                out += f'<matrix value="1 {self.u(-.3, .3)} 0 {self.u(-.3, .3)} 0 1 0 0 0 0 1 0 0 0 0 1"/>'
        return out

    def bitmap(self, name):
        return (f'<texture type="bitmap" name="{name}">{self.pixels(1)}'
                + self.maybe(self.choice("wrap_mode", "repeat", "mirror", "clamp"))
                + self.maybe(self.choice("filter_type", "nearest", "bilinear")) + self.flag("raw")
                + self.maybe(f'<transform name="to_uv">{self.steps(flat=True)}</transform>') + "</texture>")

    def colour(self, name, largest=1., textures=True):
        rgb = f'{self.u(0, largest)}, {self.u(0, largest)}, {self.u(0, largest)}'
        pairs = ", ".join(f"{w}:{self.u(0, largest)}" for w in (380, 450, self.r.randint(500, 560), 640, 720))
        kind = self.r.randrange(7 if textures else 5)
        if kind < 5:
            tag, value = [("rgb", rgb), ("rgb", self.u(0, largest)), ("float", self.u(0, largest)),
                          ("spectrum", self.u(0, largest)), ("spectrum", pairs)][kind]
            return f'<{tag} name="{name}" value="{value}"/>'
        if kind == 5:
            return (f'<texture type="checkerboard" name="{name}">' + self.maybe(self.colour("color0", 1, False))
                    + self.maybe(self.colour("color1", 1, False))
                    + f'<transform name="to_uv"><scale x="{self.u(1, 4)}" y="{self.u(1, 4)}"/></transform></texture>')
        return self.bitmap(name)

    def number(self, name, low, high):
        if self.r.random() < .6:
            return f'<float name="{name}" value="{self.u(low, high)}"/>'
        if self.r.random() < .5:
            return f'<rgb name="{name}" value="{self.u(low, high)}, {self.u(low, high)}, {self.u(low, high)}"/>'
        return self.bitmap(name)

    def bsdf(self, inside=False):
        def index():
            return self.r.choice([f'<float name="int_ior" value="{self.u(1.1, 1.9)}"/>',
                                  self.choice("int_ior", "water", "bk7", "amber", "diamond")])

        kinds = ["diffuse", "diffuse", "roughconductor", "roughplastic"]
        kind = self.r.choice(kinds if inside else kinds + ["plastic", "conductor", "dielectric", "twosided", "blendbsdf"])
        rough = (self.maybe(self.choice("distribution", "ggx", "beckmann")) + self.flag("sample_visible"))
        metal = self.r.choice(["", self.choice("material", "Cu", "Au", "Al", "TiN", "Se"), self.colour("eta", 3, False),
                               self.colour("eta", 3, False) + self.colour("k", 4, False), self.colour("k", 4, False)])
        specular = self.maybe(self.colour("specular_reflectance"))
        if kind == "plastic":  # near 1.5, where Mitsuba's fit is good
            index_words = self.maybe(f'<float name="int_ior" value="{self.u(1.3, 1.6)}"/>')
        else:
            index_words = self.maybe(index())
        ground = self.maybe(self.colour("diffuse_reflectance")) + self.flag("nonlinear")
        inner = {
            "diffuse": lambda: self.maybe(self.colour("reflectance")),
            "conductor": lambda: metal + specular,
            "roughconductor": lambda: metal + specular + rough + self.maybe(self.number("alpha", .15, .6)),
            "plastic": lambda: index_words + ground + specular,
            "roughplastic": lambda: index_words + ground + specular + rough
            + self.maybe(f'<float name="alpha" value="{self.u(.15, .6)}"/>'),
            "dielectric": lambda: index_words + specular + self.maybe(self.colour("specular_transmittance")),
            "twosided": lambda: "".join(self.bsdf(True) for _ in range(self.r.randint(1, 2))),
            "blendbsdf": lambda: self.bsdf(True) + self.bsdf(True) + self.number("weight", 0, 1)}[kind]()
        return f'<bsdf type="{kind}">{inner}</bsdf>'

    def shape(self, lamp=False):
        kind = self.r.choice(["sphere", "rectangle", "cube", "disk", "obj", "ply"])
        inner = ""
        if kind in ("obj", "ply"):
            own = self.r.random() < .5
            data = obj(self.r.random() < .7, own) if kind == "obj" else ply(
                self.r.choice([(), ("u", "v"), ("s", "t")]), own, self.r.random() < .5)
            inner += self.file(kind, data) + self.flag("flip_tex_coords")
            inner += '<boolean name="face_normals" value="true"/>' if lamp else self.flag("face_normals")
        if kind == "sphere":
            inner += self.maybe(f'<float name="radius" value="{self.u(.3, 1.1)}"/>')
            inner += self.maybe(f'<point name="center" x="{self.u(-.5, .5)}" y="{self.u(-.5, .5)}" z="{self.u(-.5, .5)}"/>')
        inner += self.flag("flip_normals")
        inner += (f'<transform name="to_world">{self.steps(kind == "sphere")}'
                  f'<translate x="{self.u(-1, 1)}" y="{self.u(-1, 1)}" z="{self.u(-.5, 1)}"/></transform>')
        if lamp:
            inner += f'<emitter type="area">{self.maybe(self.colour("radiance", 5, False))}</emitter>'
        return f'<shape type="{kind}">{inner}{self.maybe(self.bsdf(), .8)}</shape>'

    def lights(self):
        out = self.maybe(self.shape(True), .4)
        out += self.maybe(f'<emitter type="point">{self.maybe(self.colour("intensity", 3, False))}'
                          f'<point name="position" x="{self.u(-2, 2)}" y="{self.u(-2, 2)}" z="3"/></emitter>', .4)
        way = self.r.choice([f'<vector name="direction" x="{self.u(-1, 1)}" y="{self.u(-1, 1)}" z="-2"/>',
                             f'<transform name="to_world"><rotate x="1" angle="{self.u(120, 240)}"/></transform>'])
        out += self.maybe(f'<emitter type="directional">{self.maybe(self.colour("irradiance", 3, False))}{way}</emitter>', .4)
        turn = f'<transform name="to_world"><rotate x="1" angle="90"/><rotate z="1" angle="{self.u(0, 360)}"/></transform>'
        return out + self.r.choice([
            "", f'<emitter type="constant">{self.maybe(self.colour("radiance", 2, False))}</emitter>',
            f'<emitter type="envmap">{self.pixels(2, True)}<float name="scale" value="{self.u(.3, 2)}"/>{turn}</emitter>'])

    def row(self, seed):
        floor = ('<shape type="rectangle"><transform name="to_world"><scale value="4"/><translate z="-1"/></transform>'
                 f'<bsdf type="twosided"><bsdf type="diffuse">{self.maybe(self.colour("reflectance"))}</bsdf></bsdf></shape>')
        body = floor + "".join(self.shape() for _ in range(self.r.randint(1, 3))) + self.lights()
        width, height = self.r.choice([(6, 6), (9, 5), (5, 8)])
        sensor = self.r.choice([
            "", f'<float name="fov" value="{self.u(20, 70)}"/>', self.choice("focal_length", "35mm", "50mm", "85"),
            f'<float name="fov" value="{self.u(20, 60)}"/>' + self.choice("fov_axis", "x", "y", "diagonal", "smaller", "larger")])
        sensor += self.maybe(f'<float name="near_clip" value="{self.u(3, 4.5)}"/>', .2)
        sensor += self.maybe(f'<float name="far_clip" value="{self.u(4.6, 7)}"/>', .2)
        sensor += self.maybe(f'<float name="principal_point_offset_x" value="{self.u(-.2, .2)}"/>', .3)
        sensor += (f'<transform name="to_world"><lookat origin="{self.u(-2, 2)}, -4, {self.u(1, 3)}" target="0, 0, 0" '
                   'up="0, 0, 1"/></transform>')
        filters = ["", '<rfilter type="box"/>', '<rfilter type="tent"/>',
                   f'<rfilter type="tent"><float name="radius" value="{self.u(.5, 1.8)}"/></rfilter>']
        integrator = self.r.choice(['<integrator type="path"/>', '<integrator type="direct"/>',
                                    f'<integrator type="path"><integer name="max_depth" value="{self.r.randint(1, 5)}"/></integrator>'])
        xml = (f'<scene version="3.0.0">{integrator}<sensor type="perspective">{sensor}<film type="hdrfilm">'
               f'<integer name="width" value="{width}"/><integer name="height" value="{height}"/>{self.r.choice(filters)}'
               f"</film></sensor>{body}</scene>")
        return Row("random", f"seed {seed}", xml.replace("><", ">\n<"), self.files, spp=1024)


def main():
    parser = argparse.ArgumentParser(description="Random scenes by both programs")
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--venv", default="build/mitsuba", type=pathlib.Path)
    parser.add_argument("--first", default=1, type=int)
    parser.add_argument("--count", default=100, type=int)
    o = parser.parse_args()
    program, mitsuba = o.reflectree.resolve(), Mitsuba(mitsuba_python(o.venv.resolve()))

    def both(row):
        with tempfile.TemporaryDirectory() as folder:
            theirs = mitsuba.render(row, pathlib.Path(folder))
        with tempfile.TemporaryDirectory() as folder:
            ours, said = render(program, row, pathlib.Path(folder))
        return ours, said, theirs

    wrong = refused = 0
    for seed in range(o.first, o.first + o.count):
        row = Scenes(seed).row(seed)
        ours, said, theirs = both(row)
        if ours is None or "error" in theirs:
            refused += 1
            if (ours is None) != ("error" in theirs):
                wrong += 1
                print(f"{row.word}: one refuses: {(said or theirs.get('error', '')).strip()[:300]}", flush=True)
            continue
        if worst(ours, theirs["numbers"], SLACK) < LIMIT:
            continue
        ours, _, theirs = both(dataclasses.replace(row, spp=16 * row.spp))
        distance = worst(ours, theirs["numbers"], SLACK)
        if distance >= LIMIT:
            wrong += 1
            print(f"{row.word}: differs by {distance:.1f}; ours {means(ours)}, Mitsuba {means(theirs['numbers'])}\n{row.scene}",
                  flush=True)
    print(f"{o.count} scenes, {refused} refused, {wrong} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
