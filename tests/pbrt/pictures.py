#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pictures by pbrt of its own materials and of the same functions as "reflectree", compared block by block.

    pictures.py PBRT_BUILD SCRATCH [--fault]

With --fault the two differ by a tenth of their roughness, which must be seen. Prints the largest |z| and the seconds
of both.
"""

import array
import pathlib
import shutil
import subprocess
import sys
import time
import zlib

SIZE, BLOCK, SEEDS = 64, 8, 12

SCENE = """
Film "rgb" "integer xresolution" {size} "integer yresolution" {size} "string filename" "{picture}"
LookAt 0 1.2 4  0 0 0  0 1 0
Camera "perspective" "float fov" 34
Sampler "independent" "integer pixelsamples" 64 "integer seed" {seed}
Integrator "path" "integer maxdepth" 4
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.3 0.4 ]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 20 16 12 ]
  Translate 2 3 1.5
  Shape "sphere" "float radius" 0.4
AttributeEnd
{material}
Shape "sphere" "float radius" 1
Material "diffuse" "rgb reflectance" [ 0.4 0.4 0.3 ]
Translate 0 -1 0
Shape "disk" "float radius" 5
"""

# name -> pbrt's material and ours. A metal with a huge k reflects all light, as f0 = 1 does.
METAL = ('Material "conductor" "spectrum eta" [ 300 1 900 1 ] "spectrum k" [ 300 100000 900 100000 ] '
         '"bool remaproughness" false "float uroughness" {} "float vroughness" {}')
PAIRS = {
    "diffuse": ('Material "diffuse" "rgb reflectance" [ 0.5 0.3 0.1 ]',
                'Material "reflectree" "string material" "lambert:rho={0}/0.3/0.1"'.format, ("0.5", "0.6")),
    "metal": (METAL.format(0.3, 0.3),
              'Material "reflectree" "string material" "ggx:alpha={0},f0=1"'.format, ("0.3", "0.33")),
    "metal, exact mode": (METAL.format(0.3, 0.3),
                          'Material "reflectree" "string mode" "exact" "string material" "ggx:alpha={0},f0=1"'.format,
                          ("0.3", "0.33")),
    "brushed metal": (METAL.format(0.3, 0.1),
                      'Material "reflectree" "string material" "ggx:alpha_x={0},alpha_y=0.1,f0=1"'.format,
                      ("0.3", "0.33")),
}


def read_pfm(path):
    data = path.read_bytes()
    header, rest = data.split(b"\n", 3)[:3], data.split(b"\n", 3)[3]
    width, height = map(int, header[1].split())
    assert header[0] == b"PF" and float(header[2]) < 0, header
    pixels = array.array("f", rest)
    assert len(pixels) == 3 * width * height
    return pixels


def render(program, scratch, material, seed):
    """The sums over blocks of a picture."""
    scene, picture = scratch / "scene.pbrt", scratch / "picture.pfm"
    if "reflectree" in material:  # built once; the other seeds read the file
        material += f' "string cache" "{scratch}/{zlib.crc32(material.encode())}.rfl"'
    scene.write_text(SCENE.format(size=SIZE, picture=picture, material=material, seed=seed))
    began = time.monotonic()
    subprocess.run([program, "--quiet", "--nthreads", "2", scene], check=True)
    seconds = time.monotonic() - began
    blocks = [0.0] * (SIZE // BLOCK) ** 2
    for i, value in enumerate(read_pfm(picture)):
        x, y = i // 3 % SIZE, i // 3 // SIZE
        blocks[y // BLOCK * (SIZE // BLOCK) + x // BLOCK] += value
    return blocks, seconds


def mean_and_variance(values):
    mean = sum(values) / len(values)
    return mean, sum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values)


def main(build, scratch, *options):
    scratch = pathlib.Path(scratch).resolve()
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    program = pathlib.Path(build) / "pbrt"
    fault, wrong = "--fault" in options, []
    for name, (theirs, ours, (right, other)) in PAIRS.items():
        both, seconds = [], []
        for material in (theirs, ours(other if fault else right)):
            runs = [render(program, scratch, material, seed) for seed in range(len(both) * SEEDS, (len(both) + 1) * SEEDS)]
            both.append([mean_and_variance(block) for block in zip(*(blocks for blocks, _ in runs))])
            seconds.append(sorted(time for _, time in runs)[SEEDS // 2])
        z = [(a - b) / max((va + vb) ** 0.5, 1e-9) for (a, va), (b, vb) in zip(*both)]
        total = sum(a - b for (a, _), (b, _) in zip(*both)) / sum(va + vb for (_, va), (_, vb) in zip(*both)) ** 0.5
        root = (sum(v * v for v in z) / len(z)) ** 0.5
        print(f"{name}: largest |z| {max(map(abs, z)):.2f}, root mean square {root:.2f}, of the whole {total:.2f}; "
              f"{seconds[0]:.2f} s and {seconds[1]:.2f} s", flush=True)
        # Student's t with 11 + 11 degrees of freedom: |t| > 6.5 once in 3 10^5 blocks, > 5 for the whole in 2 10^4.
        if max(map(abs, z)) > 6.5 or root > 1.5 or abs(total) > 5:
            wrong.append(name)
    if fault:
        print(f"rejected: {', '.join(wrong)}")
        return 0 if len(wrong) == len(PAIRS) else 1
    print(f"different: {', '.join(wrong) or 'none'}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
