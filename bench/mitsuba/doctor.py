#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the doctor says of Mitsuba 3's BSDFs, and beside it a check by other means: Mitsuba's pdf on a fine grid in
NumPy, its samples counted in bins of that grid, mean weights beside the grid's albedo. In Markdown. Lobes that are too
narrow for the grid are seen by the doctor alone.

    python bench/mitsuba/doctor.py build/bin/reflectree [parts of names] > report.md

Needs mitsuba and numpy; LLVM 16 or later (DRJIT_LIBLLVM_PATH). REFLECTREE_DATA names the folder of measured files;
without it they are left out, with a sentence. EFFORT is the doctor's, default if it is not set."""

import glob
import json
import math
import os
import pathlib
import resource
import shlex
import subprocess
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

CLIENT = pathlib.Path(__file__).resolve().parents[2] / "examples" / "doctor" / "mitsuba_client.py"
ANGLES = (0, 30, 55, 75, 86)
DRAWS, PER_CALL = 2_000_000, 1_000_000
ROWS, COLUMNS, FINE = 64, 128, 16  # bins over cos theta and phi, points of each along both


def rgb(*value):
    return {"type": "rgb", "value": list(value)}


def ggx(**more):
    return {"type": "roughconductor", "distribution": "ggx", **more}


ORANGE = {"base_color": rgb(0.7, 0.3, 0.1)}
MATERIALS = {
    "diffuse": {"type": "diffuse", "reflectance": rgb(0.8, 0.4, 0.2)},
    "roughconductor GGX 0.1": ggx(alpha=0.1),
    "roughconductor GGX 0.4, gold": ggx(alpha=0.4, material="Au"),
    "roughconductor GGX 0.1 × 0.3": ggx(alpha_u=0.1, alpha_v=0.3),
    "roughconductor GGX 0.4, all normals": ggx(alpha=0.4, sample_visible=False),
    "roughconductor GGX 0.1 × 0.3, all normals": ggx(alpha_u=0.1, alpha_v=0.3, sample_visible=False),
    "roughconductor GGX 0.001": ggx(alpha=0.001),
    "roughconductor GGX 0.001, all normals": ggx(alpha=0.001, sample_visible=False),
    "roughconductor Beckmann 0.1": {"type": "roughconductor", "alpha": 0.1},
    "roughconductor Beckmann 0.4": {"type": "roughconductor", "alpha": 0.4},
    "roughconductor Beckmann 1": {"type": "roughconductor", "alpha": 1.0},
    "roughconductor Beckmann 0.4, all normals": {"type": "roughconductor", "alpha": 0.4, "sample_visible": False},
    "roughconductor Beckmann 0.1 × 0.3, all normals": {"type": "roughconductor", "alpha_u": 0.1, "alpha_v": 0.3,
                                                       "sample_visible": False},
    "roughplastic Beckmann 0.1": {"type": "roughplastic", "alpha": 0.1},
    "roughplastic Beckmann 0.3": {"type": "roughplastic", "alpha": 0.3},
    "roughplastic Beckmann 0.4, nonlinear": {"type": "roughplastic", "alpha": 0.4, "nonlinear": True},
    "roughplastic GGX 0.3": {"type": "roughplastic", "distribution": "ggx", "alpha": 0.3},
    "roughplastic GGX 0.3, all normals": {"type": "roughplastic", "distribution": "ggx", "alpha": 0.3,
                                          "sample_visible": False},
    "pplastic Beckmann 0.2": {"type": "pplastic", "alpha": 0.2},
    "pplastic GGX 0.2": {"type": "pplastic", "distribution": "ggx", "alpha": 0.2},
    "principled": {"type": "principled"},
    "principled 0.3": {"type": "principled", "roughness": 0.3, **ORANGE},
    "principled 0.4, metallic": {"type": "principled", "roughness": 0.4, "metallic": 1.0, **ORANGE},
    "principled 0.5, metallic, anisotropic": {"type": "principled", "roughness": 0.5, "metallic": 0.8, "anisotropic": 0.8},
    "principled 0.5, clearcoat, gloss 0": {"type": "principled", "roughness": 0.5, "clearcoat": 1.0, "clearcoat_gloss": 0.0},
    "principled 0.5, clearcoat, gloss 0.9": {"type": "principled", "roughness": 0.5, "clearcoat": 1.0,
                                             "clearcoat_gloss": 0.9},
    "principled 0.5, clearcoat, gloss 1": {"type": "principled", "roughness": 0.5, "clearcoat": 1.0, "clearcoat_gloss": 1.0},
    "principled 0.6, sheen, flatness": {"type": "principled", "roughness": 0.6, "sheen": 1.0, "sheen_tint": 0.5,
                                        "flatness": 0.5, **ORANGE},
    "principled 0.4, spec_tint": {"type": "principled", "roughness": 0.4, "spec_tint": 1.0, "specular": 0.9, **ORANGE},
    "blendbsdf, Beckmann and diffuse": {"type": "blendbsdf", "weight": 0.4, "a": {"type": "roughconductor", "alpha": 0.35},
                                        "b": {"type": "diffuse"}},
    "blendbsdf, GGX plastic and metal": {"type": "blendbsdf", "weight": 0.7,
                                         "a": {"type": "roughplastic", "distribution": "ggx", "alpha": 0.2},
                                         "b": ggx(alpha_u=0.15, alpha_v=0.4)},
    "twosided, GGX 0.3": {"type": "twosided", "b": ggx(alpha=0.3)},
    "normalmap, GGX 0.3": {"type": "normalmap", "normalmap": rgb(0.6, 0.5, 0.9), "b": ggx(alpha=0.3)},
    "dielectric": {"type": "dielectric"},
    "plastic": {"type": "plastic"},
    "roughdielectric": {"type": "roughdielectric"},
}
NARROW = ("0.001", "gloss 0.9", "gloss 1")  # lobes that fall between the points of the grid
SOME_MEASURED = ("paper_white", "satin_purple", "vch_dragon_eye_red", "aurora_white")


def measured():
    folder = os.path.join(os.environ.get("REFLECTREE_DATA", "-"), "rgl")
    found = {name: glob.glob(os.path.join(folder, f"{name}_rgb.bsdf")) for name in SOME_MEASURED}
    return {f"measured {name}": {"type": "measured", "filename": paths[0]} for name, paths in found.items() if paths}


def row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


# ---- The doctor


def diagnosed(program, description):
    """Its findings as (a cell, sentences), its seconds by the clock and of the processor, with those of the client."""
    client = shlex.join([sys.executable, str(CLIENT), json.dumps(description)])
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run([program, "--json", "doctor", "--effort", os.environ.get("EFFORT", "default"), "--exec", client],
                          capture_output=True, text=True, check=False)
    clock, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode == 2:
        said = [line for line in done.stderr.splitlines() if line.startswith("mitsuba_client.py: ")]
        return "refused", [(said or done.stderr.splitlines())[-1].removeprefix("mitsuba_client.py: ")], clock, cpu
    findings = json.loads(done.stdout)["findings"]
    cell = ", ".join(("**fault** " if f["fault"] else "remark ") + f"`{f['cause']}`" for f in findings)
    return cell or "no fault", [f["words"] for f in findings], clock, cpu


# ---- The same by other means


def viewer(degrees, n, azimuth=37.0):
    t, p = np.radians(degrees), np.radians(azimuth)
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    si.wi = mi.Vector3f(float(np.sin(t) * np.cos(p)), float(np.sin(t) * np.sin(p)), float(np.cos(t)))
    si.n, si.sh_frame, si.uv = mi.Normal3f(0, 0, 1), mi.Frame3f(mi.Vector3f(0, 0, 1)), mi.Point2f(0.5)
    return si


def channels(color, n):
    return np.stack([np.broadcast_to(np.array(c, dtype=np.float64), n) for c in color])


def on_a_grid(bsdf, degrees):
    """(mass of pdf per bin, albedo per channel, mass below the horizon), by midpoints and sums in double precision."""
    def at(z):
        phi = (np.arange(COLUMNS * FINE) + 0.5) / (COLUMNS * FINE) * 2 * np.pi
        z, phi = np.meshgrid(z, phi, indexing="ij")
        r = np.sqrt(1 - z * z)
        wo = mi.Vector3f(*(mi.Float(x.ravel().astype(np.float32)) for x in (r * np.cos(phi), r * np.sin(phi), z)))
        value, pdf = bsdf.eval_pdf(mi.BSDFContext(), viewer(degrees, z.size), wo)
        return channels(value, z.size), np.broadcast_to(np.array(pdf, dtype=np.float64), z.size)

    mass, albedo = np.zeros((ROWS, COLUMNS)), np.zeros(3)
    solid_angle = 2 * np.pi / (ROWS * COLUMNS * FINE**2)
    for k in range(ROWS):
        value, pdf = at((np.arange(k * FINE, (k + 1) * FINE) + 0.5) / (ROWS * FINE))
        mass[k] = pdf.reshape(FINE, COLUMNS, FINE).sum(axis=(0, 2)) * solid_angle
        albedo += value.sum(axis=1) * solid_angle
    below = at(-(np.arange(200) + 0.5) / 200)[1].mean() * 2 * np.pi
    return mass, albedo, below


def drawn(bsdf, degrees, seed):
    """(counts per bin, share of lost draws, mean weight and its standard error per channel, draws that are NaN, and the
    largest relative distances of weight * pdf from eval and of pdf() from sample's, but for one draw in 1000)."""
    count, lost, nan = np.zeros(ROWS * COLUMNS), 0, 0
    total, squares, off_value, off_pdf = np.zeros(3), np.zeros(3), 0.0, 0.0
    rng = np.random.default_rng(seed)
    for _ in range(DRAWS // PER_CALL):
        u = [mi.Float(x) for x in rng.random((3, PER_CALL), dtype=np.float32)]
        si = viewer(degrees, PER_CALL)
        sample, weight = bsdf.sample(mi.BSDFContext(), si, u[0], mi.Point2f(u[1], u[2]))
        wo, pdf = channels(sample.wo, PER_CALL), np.array(sample.pdf, dtype=np.float64)
        weight = channels(weight, PER_CALL)
        broken = ~np.all(np.isfinite(weight), axis=0)
        nan += np.sum(broken)
        kept = ~broken & (np.any(weight != 0, axis=0) | ((pdf > 0) & (wo[2] > 0)))
        lost += np.sum(~kept)
        value, density = bsdf.eval_pdf(mi.BSDFContext(), si, sample.wo)
        value, density = channels(value, PER_CALL)[:, kept], np.array(density, dtype=np.float64)[kept]
        wo, pdf, weight = wo[:, kept], pdf[kept], weight[:, kept]
        total += weight.sum(axis=1)
        squares += (weight**2).sum(axis=1)
        off = np.abs(weight * pdf - value).max(axis=0) / np.maximum(np.abs(value).max(axis=0), 1e-12)
        off_value = max(off_value, np.quantile(off, 0.999))
        off_pdf = max(off_pdf, np.quantile(np.abs(density / pdf - 1), 0.999))
        i = np.clip((wo[2] * ROWS).astype(int), 0, ROWS - 1)
        j = np.clip((np.arctan2(wo[1], wo[0]) % (2 * np.pi) / (2 * np.pi) * COLUMNS).astype(int), 0, COLUMNS - 1)
        count += np.bincount(i * COLUMNS + j, minlength=count.size)
    mean = total / DRAWS
    return count, lost / DRAWS, mean, np.sqrt(np.maximum(squares / DRAWS - mean**2, 0) / DRAWS), nan, off_value, off_pdf


def chi_square_tail(x, dof):
    """Wilson and Hilferty's approximation."""
    z = ((x / dof) ** (1 / 3) - (1 - 2 / (9 * dof))) / math.sqrt(2 / (9 * dof))
    return 0.5 * math.erfc(z / math.sqrt(2))


def shape_p(mass, count):
    """Do the draws have the shape of pdf? Bins that expect fewer than 20 draws are one bin."""
    expected = mass.ravel() / mass.sum() * count.sum()
    small = expected < 20
    e, c = list(expected[~small]), list(count[~small])
    if expected[small].sum() > 5:
        e.append(expected[small].sum())
        c.append(count[small].sum())
    e, c = np.array(e), np.array(c)
    return chi_square_tail(np.sum((c - e) ** 2 / e), len(e) - 1) if len(e) > 1 else 1.0


def checked(bsdf, seed):
    """The worst of all viewers."""
    sums, least_p, bias, below_excess, nan, off_value, off_pdf = [], 1.0, (0, 0), 0.0, 0, 0.0, 0.0
    for degrees in ANGLES:
        mass, albedo, below = on_a_grid(bsdf, degrees)
        count, lost, mean, error, broken, a, b = drawn(bsdf, degrees, (seed, degrees))
        sums.append(mass.sum() + lost)
        least_p = min(least_p, shape_p(mass, count))
        c = np.argmax(albedo)
        bias = max(bias, (mean[c] / albedo[c] - 1, error[c] / albedo[c]), key=lambda x: abs(x[0]))
        below_excess = max(below_excess, below)
        nan, off_value, off_pdf = nan + broken, max(off_value, a), max(off_pdf, b)
    return (f"{min(sums):.5f} to {max(sums):.5f}", f"{least_p:.2g}", f"{100 * bias[0]:+.3f} ± {100 * bias[1]:.3f} %",
            f"{off_value:.0e} / {off_pdf:.0e}", f"{below_excess:.4f}", nan)


def main(program, parts):
    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    materials = {**MATERIALS, **measured()}
    if len(materials) == len(MATERIALS):
        print("REFLECTREE_DATA names no folder with rgl/*.bsdf: measured materials are left out.\n")
    print(f"Mitsuba {mi.__version__}, {DRAWS} draws and {ROWS * COLUMNS * FINE**2} points of the grid per viewer, at "
          f"{', '.join(map(str, ANGLES))} degrees; the worst of the viewers.\n")
    row("material", "the doctor", "s (processor)", "integral of pdf + lost", "least p of χ²", "mean weight / albedo - 1",
        "weight × pdf, and pdf(): off by", "integral below", "NaN")
    row("---", "---", "---:", "---:", "---:", "---:", "---:", "---:", "---:")
    sentences = []
    for number, (name, description) in enumerate(materials.items()):
        if parts and not any(part in name for part in parts):
            continue
        said, words, clock, cpu = diagnosed(program, description)
        sentences += [f"* {name}: {sentence}." for sentence in words]
        skipped = said == "refused" or any(part in name for part in NARROW)
        found = ["–"] * 6 if skipped else checked(mi.load_dict(description), number)
        row(name, said, f"{clock:.1f} ({cpu:.1f})", *found)
    print("\nIn its words:\n\n" + "\n".join(sentences))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("doctor.py: name the program reflectree, and perhaps parts of names of materials")
    main(sys.argv[1], sys.argv[2:])
