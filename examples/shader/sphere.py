#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws examples/shader/sphere.frag without a window, on a graphics card or in Mesa's software driver.

    reflectree build phong:kd=0.2/0.05/0.02,ks=0.6/0.5/0.4,n=60 -o phong.rfl
    reflectree export phong.rfl --glsl phong.glsl
    pip install moderngl numpy
    python3 sphere.py phong.glsl sphere.ppm --mode one-shot --frames 16
"""

import argparse
import pathlib

import moderngl
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
MODES = ("one-shot", "exact", "uniform")


def shader_text(words, mode):
    """All of the fragment shader: the array, the runtime, the picture."""
    array = pathlib.Path(words).read_text(encoding="utf-8")
    name = array.split("[", 1)[0].split()[-1]
    return "\n".join(["#version 430", array, f"#define RFL_WORD(i) {name}[i]", f"#define MODE {MODES.index(mode)}",
                      (HERE / "../../runtime/reflectree_sample.glsl").read_text(encoding="utf-8"),
                      (HERE / "sphere.frag").read_text(encoding="utf-8")])


def pictures(words, mode, size, samples, frames):
    """`frames` independent pictures, bottom row first: arrays of (height, width, 4), the mean radiance and the mean of
    its squared luminance over `samples` paths per pixel."""
    context = moderngl.create_standalone_context(backend="egl", require=430)
    program = context.program(
        vertex_shader="#version 430\nin vec2 corner; void main() { gl_Position = vec4(corner, 0.0, 1.0); }",
        fragment_shader=shader_text(words, mode))
    corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype="f4").tobytes())
    triangle = context.vertex_array(program, [(corners, "2f", "corner")])
    target = context.framebuffer([context.texture((size, size), 4, dtype="f4")])
    target.use()
    program["size"].value, program["samples"].value = (size, size), samples
    for frame in range(frames):
        program["frame"].value = frame
        triangle.render(moderngl.TRIANGLES)
        yield np.frombuffer(target.read(components=4, dtype="f4"), dtype="f4").reshape(size, size, 4)
    context.release()


def write_ppm(path, linear):
    """Linear radiance, bottom row first, as an 8-bit sRGB picture."""
    x = np.clip(linear[::-1], 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    header = f"P6 {x.shape[1]} {x.shape[0]} 255\n".encode()
    pathlib.Path(path).write_bytes(header + np.rint(255 * encoded).astype("u1").tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", help="what `reflectree export --glsl` wrote")
    parser.add_argument("picture", help="a .ppm file")
    parser.add_argument("--mode", choices=MODES, default="one-shot")
    parser.add_argument("--size", type=int, default=384, help="pixels along each side")
    parser.add_argument("--samples", type=int, default=8, help="paths per pixel and frame")
    parser.add_argument("--frames", type=int, default=8)
    asked = parser.parse_args()
    frames = [p[..., :3] for p in pictures(asked.words, asked.mode, asked.size, asked.samples, asked.frames)]
    write_ppm(asked.picture, np.mean(frames, axis=0))


if __name__ == "__main__":
    main()
