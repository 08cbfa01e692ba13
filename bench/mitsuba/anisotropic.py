#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Anisotropic materials in a small scene, by both programs: metals and measured files by Mitsuba's own plug-ins, Klems
matrices and Zemax tables by table_bsdf.py, which evaluates them independently of us.

    REFLECTREE_DATA=... python bench/mitsuba/anisotropic.py [--reflectree build/bin/reflectree] [--only TEXT]

Needs mitsuba and numpy, and LLVM 16 or later (DRJIT_LIBLLVM_PATH). A row per material, in Markdown: z-scores of the
blocks of 4 x 4 pixels per channel, and of two twins: the same material turned by ten degrees of azimuth, and three per
cent brighter. --sheet writes all pictures side by side, ours above. Exits with 1 where pictures differ, or a twin does
not.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tests" / "words")]

import numpy as np  # noqa: E402
from mitsuba_worker import newest_llvm  # noqa: E402

if newest_llvm():
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", newest_llvm())
import mitsuba as mi  # noqa: E402

mi.set_variant("llvm_ad_rgb")
mi.set_log_level(mi.LogLevel.Error)
import table_bsdf  # noqa: E402
from pixels import read_exr  # noqa: E402

PIXELS, BLOCK, SEEDS = 64, 4, 32
TURN, BRIGHTER = 10, 1.03  # faults: degrees, a factor
# A ball brushed around a leaning axis and a plate beside it, between two lamps and under a dim sky.
SCENE = """<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="3"/></integrator>
<sensor type="perspective"><float name="fov" value="33"/>
  <transform name="to_world"><lookat origin="0, -5, 2.6" target="0.1, 0, 0" up="0, 0, 1"/></transform>
  <sampler type="independent"><integer name="sample_count" value="{spp}"/></sampler>
  <film type="hdrfilm"><integer name="width" value="{pixels}"/><integer name="height" value="{pixels}"/>
    <rfilter type="box"/></film></sensor>
<emitter type="constant"><rgb name="radiance" value="0.15, 0.18, 0.22"/></emitter>
<shape type="rectangle"><transform name="to_world"><scale x="0.9" y="0.5"/>
  <lookat origin="-2.5, -2, 3.2" target="0, 0, 0" up="0, 0, 1"/></transform>
  <emitter type="area"><rgb name="radiance" value="16, 9, 5"/></emitter></shape>
<shape type="rectangle"><transform name="to_world"><scale x="0.4" y="1.2"/>
  <lookat origin="3, 2.5, 3" target="0, 0, 0" up="0, 0, 1"/></transform>
  <emitter type="area"><rgb name="radiance" value="4, 8, 16"/></emitter></shape>
<shape type="sphere"><transform name="to_world"><scale value="0.85"/><rotate x="1" angle="-35"/>
  <rotate z="1" angle="{turn}"/><translate x="-0.55" z="0.2"/></transform>{bsdf}</shape>
<shape type="rectangle"><transform name="to_world"><rotate z="1" angle="{turn}"/><scale x="1.9" y="1.6"/>
  <translate z="-0.7"/></transform>{bsdf}</shape>
</scene>"""


def metal(distribution, alpha_u, alpha_v):
    return (f'<bsdf type="roughconductor"><string name="material" value="Al"/><string name="distribution" '
            f'value="{distribution}"/><float name="alpha_u" value="{alpha_u}"/><float name="alpha_v" value="{alpha_v}"/></bsdf>')


def table(path, member=""):
    return f'<bsdf type="reflectree"><string name="material" value="{path}{"#" + member if member else ""}"/></bsdf>'


def materials(program, data, folder, wanted):
    """{name: BSDF as XML}, with files that are baked here."""
    found = {"roughconductor GGX 0.05 × 0.3": metal("ggx", 0.05, 0.3),
             "roughconductor Beckmann 0.1 × 0.3": metal("beckmann", 0.1, 0.3)}
    for model in ("ggx:alpha_x=0.05,alpha_y=0.3", "ward:alpha_x=0.1,alpha_y=0.4"):
        path = folder / (model.partition(":")[0] + ".bsdf")
        if wanted in f"measured, baked from {model}":
            subprocess.run([program, "bake", model, "--format", "rgl", "-o", path], check=True, capture_output=True)
        found[f"measured, baked from {model}"] = f'<bsdf type="measured"><string name="filename" value="{path}"/></bsdf>'
    if data is None:
        print("REFLECTREE_DATA names no folder: Zemax and Klems files are left out.\n")
        return found
    found["Zemax IMX455"] = table(data / "zemax" / "IMX455.bsdf")
    for path in sorted((data / "radiance_xml").glob("*.xml")):
        listed = subprocess.run([program, "list", path], capture_output=True, text=True).stderr
        sides = [side for side in ("front", "back") if f"#{side}\n" in listed]
        found.update({f"Klems {path.stem} {side}": table(path, side) for side in sides})
    return found


def blocks(picture):
    n = PIXELS // BLOCK
    return picture.reshape(n, BLOCK, n, BLOCK, 3)


def ours(program, scene, folder):
    """(picture, means of blocks, their variances)"""
    out = folder / "ours.exr"
    done = subprocess.run([program, "render", scene, "-o", out], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    channels = {k: np.array(v) for k, v in read_exr(out.read_bytes()).items()}
    picture, error = (np.stack([channels[prefix + c] for c in "RGB"], axis=2) for prefix in ("", "stderr."))
    return picture, blocks(picture).mean(axis=(1, 3)), (blocks(error) ** 2).sum(axis=(1, 3)) / BLOCK**4


def theirs(scene, spp):
    loaded = mi.load_file(str(scene))
    pictures = np.stack([np.array(mi.render(loaded, spp=spp // SEEDS, seed=k))[..., :3] for k in range(SEEDS)])
    means = np.stack([blocks(p).mean(axis=(1, 3)) for p in pictures])
    return pictures.mean(axis=0), means.mean(axis=0), means.var(axis=0, ddof=1) / SEEDS


def scores(a, b):
    """Where anything is random."""
    variance = a[2] + b[2]
    seen = np.minimum(a[2], b[2]) > 1e-9 * b[1] ** 2
    return ((a[1] - b[1]) / np.sqrt(np.where(seen, variance, 1)))[seen]


def equal(z):
    # Channels of a block share their noise.
    return np.mean(z**2) < 1 + 4 * np.sqrt(2 / (len(z) / 3)) and np.max(np.abs(z)) < np.sqrt(2 * np.log(len(z))) + 2.5


def main():
    parser = argparse.ArgumentParser(description="Anisotropic materials by both programs")
    parser.add_argument("--reflectree", default="build/bin/reflectree", type=pathlib.Path)
    parser.add_argument("--data", default=os.environ.get("REFLECTREE_DATA"), type=pathlib.Path)
    parser.add_argument("--only", default="", help="materials whose name has this in it")
    parser.add_argument("--spp", default=1024, type=int)
    parser.add_argument("--longer", default=1, type=int, help="how many times as many paths of Mitsuba's: for narrow patches")
    parser.add_argument("--sheet", type=pathlib.Path, help="a PNG of all pictures")
    o = parser.parse_args()
    program, good, sheet = o.reflectree.resolve(), True, []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        print("| material | mean, ours / Mitsuba's | mean of z² | largest abs(z) | variance, ours / Mitsuba's "
              "| twin, turned: mean of z² | twin, brighter |")
        print("|---|---:|---:|---:|---:|---:|---:|")
        for material, bsdf in materials(program, o.data and o.data.resolve(), folder, o.only).items():
            if o.only not in material:
                continue

            def scene(turn):
                path = folder / f"scene{turn}.xml"
                path.write_text(SCENE.format(spp=o.spp, pixels=PIXELS, bsdf=bsdf, turn=turn))
                return path

            mine, own = ours(program, scene(0), folder), theirs(scene(0), o.longer * o.spp)
            # The table itself is turned where we hold it, else the shapes.
            table_bsdf.TURN = TURN if "reflectree" in bsdf else 0
            turned = theirs(scene(0 if table_bsdf.TURN else TURN), o.longer * o.spp)
            table_bsdf.TURN = 0
            brighter = (None, own[1] * BRIGHTER, own[2] * BRIGHTER**2)
            z, twins = scores(mine, own), [scores(mine, turned), scores(mine, brighter)]
            # A table may be so plain that nobody could tell.
            if equal(scores(own, turned)):
                twins[0] = None
            right = equal(z) and not any(t is not None and equal(t) for t in twins)
            good &= right
            sheet.append(np.concatenate([mine[0], own[0]], axis=0))
            told = [f"{np.mean(t**2):.1f}" if t is not None else "its own pictures are equal" for t in twins]
            print(f"| {material} | {mine[0].mean() / own[0].mean():.4f} | {np.mean(z**2):.2f} | {np.max(np.abs(z)):.1f} "
                  f"| {np.sum(mine[2]) / np.sum(own[2]):.2f} | {told[0]} | {told[1]} |{'' if right else ' **differs**'}",
                  flush=True)
    if o.sheet and sheet:
        mi.util.write_bitmap(str(o.sheet), np.concatenate(sheet, axis=1).astype(np.float32))
    print("\nEqual by the z-test, and every twin is not." if good else "\nNOT equal.")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
