#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The BSDF `reflectree` inside Mitsuba 3: Mitsuba's own chi-square test, times and variances, pictures, in Markdown.

    PYTHONPATH=build/python python bench/mitsuba/plugin.py [PART...] > report.md

PART is chi2, table, pictures, loads, families or scenes; without any, all of them. Needs mitsuba and numpy; LLVM
variants need LLVM 16 or later (DRJIT_LIBLLVM_PATH). REFLECTREE_DATA names the folder of measured files; without it they
are left out, with a sentence. EFFORT=quick makes the scenes small.

    VARIANT=scalar_rgb NATIVE=build-mitsuba PYTHONPATH=build/python python bench/mitsuba/plugin.py chi2 pictures

judges the native plug-in in the folder NATIVE instead: its samples are drawn one by one in the scalar variant, and
judged by the same test."""

import glob
import os
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

VARIANT = os.environ.get("VARIANT", "llvm_ad_rgb")
mi.set_variant(VARIANT)
mi.set_log_level(mi.LogLevel.Error)
import reflectree as rt  # noqa: E402
NATIVE = os.environ.get("NATIVE")
if NATIVE:  # both plug-ins have the same name
    mi.file_resolver().prepend(NATIVE)
else:
    import reflectree.mitsuba  # noqa: E402
import lit_scenes  # noqa: E402
from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain  # noqa: E402

ANGLES = (0, 30, 60, 80, 85)
CACHE = os.environ.get("REFLECTREE_MITSUBA_CACHE", "none" if NATIVE else "")
ONLY = os.environ.get("REFLECTREE_RGL", "").split(",")  # parts of names of measured files
RGL = [path for path in sorted(glob.glob(os.path.join(os.environ.get("REFLECTREE_DATA", "-"), "rgl", "*.bsdf")))
       if any(part in os.path.basename(path) for part in ONLY)]


class EvalAlone(mi.BSDF):
    """Somebody's own: Lommel and Seeliger's dust, with a haze about the mirror direction; no sample and no pdf."""

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]
        self.color = mi.Color3f(1, 0.7, 0.4)  # of the variant that loads it

    def eval(self, ctx, si, wo, active=True):
        active &= (si.wi.z > 0) & (wo.z > 0)
        half = dr.normalize(si.wi + wo)
        value = 0.1 / (si.wi.z + wo.z) + 2 * dr.power(dr.maximum(half.z, 0), 60)
        return self.color * dr.select(active, value * wo.z, 0)

    def to_string(self):  # the native plug-in asks for it
        return "EvalAlone[]"


mi.register_bsdf("eval_alone", lambda props: EvalAlone(props))

# Wide enough for the grid of Mitsuba's test; the narrow ones are under NARROW.
MATERIALS = {
    "diffuse": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.4, 0.2]}},
    "roughplastic 0.3": {"type": "roughplastic", "alpha": 0.3},
    "roughplastic Beckmann 0.4, nonlinear": {"type": "roughplastic", "alpha": 0.4, "distribution": "beckmann",
                                             "nonlinear": True},
    "roughconductor 0.4, gold": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.4, "material": "Au"},
    "roughconductor Beckmann 0.3": {"type": "roughconductor", "alpha": 0.3, "distribution": "beckmann"},
    "roughconductor 0.25 × 0.5": {"type": "roughconductor", "distribution": "ggx", "alpha_u": 0.25, "alpha_v": 0.5},
    "principled 0.6": {"type": "principled", "roughness": 0.6, "base_color": {"type": "rgb", "value": [0.7, 0.3, 0.1]}},
    "principled, metal and sheen": {"type": "principled", "roughness": 0.6, "metallic": 0.7, "sheen": 0.6,
                                    "spec_tint": 0.4},
    "principled, clearcoat": {"type": "principled", "roughness": 0.7, "clearcoat": 0.8, "clearcoat_gloss": 0.2},
    "principled, anisotropic": {"type": "principled", "roughness": 0.7, "metallic": 0.8, "anisotropic": 0.5},
    "blendbsdf": {"type": "blendbsdf", "weight": 0.4, "a": {"type": "roughconductor", "alpha": 0.35},
                  "b": {"type": "diffuse"}},
    "a Python BSDF with eval alone": {"type": "eval_alone"},
}
NARROW = {
    "roughplastic 0.1": {"type": "roughplastic", "alpha": 0.1},
    "roughconductor 0.1": {"type": "roughconductor", "distribution": "ggx", "alpha": 0.1},
    "roughconductor 0.1 × 0.2": {"type": "roughconductor", "distribution": "ggx", "alpha_u": 0.1, "alpha_v": 0.2},
    "principled 0.3": {"type": "principled", "roughness": 0.3},
    "principled 0.4, metal, clearcoat": {"type": "principled", "roughness": 0.4, "metallic": 0.7, "clearcoat": 0.5},
}


def name_of(path):
    return "measured " + os.path.basename(path).replace("_rgb.bsdf", "")


MEASURED = {name_of(path): {"type": "measured", "filename": path} for path in RGL}


def ours(nested, **more):
    return {"type": "reflectree", "nested": nested, "cache": CACHE, **more}


def direction(degrees, azimuth=37.0):
    t, p = np.radians(degrees), np.radians(azimuth)
    return [float(np.sin(t) * np.cos(p)), float(np.sin(t) * np.sin(p)), float(np.cos(t))]


def row(*cells):
    print("| " + " | ".join(str(c) for c in cells) + " |", flush=True)


# ---- Mitsuba's own judge


class TiltedDomain(SphericalDomain):
    """Mitsuba's, with another pole: at normal incidence the pole of our map is that of the grid, where the density has
    a peak that can be integrated, though not by the grid's trapezoids."""

    C, S = float(np.cos(1)), float(np.sin(1))

    def map_forward(self, p):
        w = super().map_forward(p)
        return mi.Vector3f(w.x * self.C + w.z * self.S, w.y, w.z * self.C - w.x * self.S)

    def map_backward(self, w):
        return super().map_backward(mi.Vector3f(w.x * self.C - w.z * self.S, w.y, w.z * self.C + w.x * self.S))


class Scalar:
    """Calls one by one in the scalar variant; the judge needs another variant, which is set meanwhile. turn: a fault,
    in degrees of azimuth."""

    def __init__(self, description, wi, turn=0.0):
        self.bsdf, self.context, self.vector = mi.load_dict(description), mi.BSDFContext(), mi.Vector3f
        self.si = mi.SurfaceInteraction3f()
        self.si.t, self.si.wi, self.si.n = 1, mi.Vector3f(wi), mi.Normal3f(0, 0, 1)
        self.si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
        c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
        self.turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])

    def sample(self, u):
        wo, alive = [], []
        for a, b, c in np.array(u).T.tolist():
            drawn, weight = self.bsdf.sample(self.context, self.si, a, [b, c])
            wo.append((drawn.wo.x, drawn.wo.y, drawn.wo.z))
            alive.append(any(weight))
        return mi.Vector3f((np.array(wo) @ self.turn).T.astype(np.float32)), mi.Float(np.array(alive, dtype=np.float32))

    def pdf(self, wo):
        values = [self.bsdf.pdf(self.context, self.si, self.vector(w)) for w in np.array(wo).T.tolist()]
        return mi.Float(np.array(values, dtype=np.float32))


def patient(description, degrees, turn, uv):
    """(sample, pdf) for the judge."""
    if not VARIANT.startswith("scalar"):
        return BSDFAdapter(description["type"], description, wi=direction(degrees), uv=list(uv))
    mi.set_variant(VARIANT)
    one_by_one = Scalar(description, direction(degrees), turn)
    mi.set_variant(VARIANT.replace("scalar", "llvm_ad"))
    return one_by_one.sample, one_by_one.pdf


def judged(description, degrees, count, finest=128, turn=0.0, uv=(0.5, 0.5), cut=False):
    """(accepted, text) of mitsuba.chi2.ChiSquareTest. What is rejected is judged again by finer trapezoids for the
    expected counts, of the same samples: their error goes away, a fault stays. cut: pdf counts as 0 below the horizon."""
    ires = 4
    tilted = degrees == 0 and description["type"] == "reflectree"
    sample, pdf = patient(description, degrees, turn, uv)
    density = (lambda wo: dr.select(wo.z > 0, pdf(wo), 0)) if cut else pdf
    while True:
        test = ChiSquareTest(TiltedDomain() if tilted else SphericalDomain(), sample, density, sample_dim=3, ires=ires)
        accepted = test.run(test_count=count, quiet=True)
        if accepted or ires >= finest:
            text = f"{test.p_value:.3f}" if not test.fail else f"sum {float(test.pdf_sum[0]):.2f}"
            return accepted, text + (f" ({ires})" if ires > 4 else "")
        ires = 4 * ires if ires < 64 else finest


def own_sampler(description, count):
    """(text, how many angles do not pass, how many of them do not where pdf is 0 below the horizon)."""
    if description["type"] == "eval_alone":
        return "has none", 0, 0
    failed = [a for a in ANGLES if not judged(description, a, count)[0]]
    still = [a for a in failed if not judged(description, a, count, cut=True)[0]]
    text = f"{len(ANGLES) - len(failed)} of {len(ANGLES)}"
    return text + (f"; cut at the horizon {len(ANGLES) - len(still)}" if failed else ""), len(failed), len(still)


def chi2_table(title, materials):
    count = len(materials) * len(ANGLES)
    print(f"\n### {title}\n")
    row("material", *(f"{a}°" for a in ANGLES), "ours", "Mitsuba's own sampler")
    row("---", *["---:"] * len(ANGLES), "---", "---")
    all_passed, own_failed, own_failed_cut = 0, 0, 0
    for name, description in materials.items():
        found = [judged(ours(description), a, count) for a in ANGLES]
        passed = sum(ok for ok, _ in found)
        all_passed += passed
        own = own_sampler(description, count)
        own_failed, own_failed_cut = own_failed + own[1], own_failed_cut + own[2]
        row(name, *(text for _, text in found), f"{passed} of {len(found)}", own[0])
    print(f"\n{all_passed} of {count} pass with ours; of Mitsuba's own samplers {own_failed} do not, and {own_failed_cut} where "
          "pdf counts as 0 below the horizon.")
    return all_passed == count


def scalar_faults():
    row("fault, principled 0.6 at 60°", "verdict", "p or sum")
    row("---", "---", "---:")
    right = True
    for turn in (0, 2):
        accepted, text = judged(ours(MATERIALS["principled 0.6"]), 60, 1, 16, turn)
        right &= accepted == (turn == 0)
        row(f"directions are {turn}° off in azimuth", "accepted" if accepted else "rejected", text)
    return right


def scalar_chi2():
    """Nested BSDFs that are isotropic, since the build calls them one by one; anisotropic ones by our materials."""
    isotropic = {k: ours(v) for k, v in {**MATERIALS, **NARROW, **MEASURED}.items() if "×" not in k and "aniso" not in k}
    materials = {**isotropic, **{f"material {m}{', exact' if mode else ''}": {"type": "reflectree", "material": m, **mode}
                                 for m in ("ggx:alpha_x=0.25,alpha_y=0.5", "plastic:alpha=0.3")
                                 for mode in ({}, {"mode": "exact"})}}
    print()
    good = scalar_faults()
    print()
    row("material", *(f"{a}°" for a in ANGLES), "passed")
    row("---", *["---:"] * len(ANGLES), "---")
    for name, description in materials.items():
        found = [judged(description, a, len(materials) * len(ANGLES), 64) for a in ANGLES]
        good &= all(ok for ok, _ in found)
        row(name, *(text for _, text in found), f"{sum(ok for ok, _ in found)} of {len(found)}")
    return good


def faults():
    """The same test with three faults planted into the plug-in."""
    from reflectree import _drjit_forest as forest

    print("\n### Planted faults, principled 0.6 at 60°\n")
    row("fault", "verdict", "p or sum")
    row("---", "---", "---:")
    description = ours(MATERIALS["principled 0.6"])
    linear, choose, leave = forest._linear, forest.Forest.choose, forest.View.leave
    planted = {
        "none": (linear, choose, leave),
        "slopes of leaves are ignored when drawing": (lambda dr, slope, u: u, choose, leave),
        "the alias table is ignored": (linear, lambda s, slab, word, active: slab.x + dr.mul_hi(word, slab.y), leave),
        "directions are 2° off in azimuth": (linear, choose, lambda v, w: leave(
            v._replace(cosine=v.cosine * 0.99939 - v.sine * 0.0349, sine=v.sine * 0.99939 + v.cosine * 0.0349), w)),
    }
    right = True
    try:
        for name, (a, b, c) in planted.items():
            forest._linear, forest.Forest.choose, forest.View.leave = a, b, c
            accepted, text = judged(description, 60, 1)
            right &= accepted == (name == "none")
            row(name, "accepted" if accepted else "rejected", text)
    finally:
        forest._linear, forest.Forest.choose, forest.View.leave = linear, choose, leave
    return right


def chi2():
    print(f"\n## Mitsuba's chi-square test, {VARIANT}\n\nmitsuba.chi2.ChiSquareTest with BSDFAdapter, 10⁶ samples, "
          "significance 0.01 with the Šidák correction of each table. The p-value, and in brackets ires, the points per cell "
          "and axis from which expected counts are made, where Mitsuba's own 4 were too few. At 0° the grid's pole is tilted away by one "
          "radian for ours: our map's own pole is there, where the density has an integrable peak that the trapezoids of the "
          "grid overrate.")
    wide = dict(MATERIALS)
    if not MEASURED:
        print("\nREFLECTREE_DATA names no folder with rgl/*.bsdf: measured materials are left out.")
    if NATIVE:
        return scalar_chi2()
    good = faults()
    good &= chi2_table("Wide lobes", wide)
    return chi2_table("Narrow lobes and measured ones", {**NARROW, **MEASURED}) and good


# ---- What a sample costs, and what its weight is worth


def weights(bsdf, degrees, n, seed=1, uv=(0.5, 0.5)):
    """Interactions at one place, and uniforms, for n samples."""
    rng = mi.PCG32(size=n, initstate=seed)
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    si.wi, si.sh_frame = mi.Vector3f(direction(degrees)), mi.Frame3f(mi.Vector3f(0, 0, 1))
    si.uv = mi.Point2f(list(uv))
    u1, u2 = rng.next_float32(), mi.Point2f(rng.next_float32(), rng.next_float32())
    dr.eval(si, u1, u2)
    return si, u1, u2


def seconds(work, repeats=5):
    """CPU seconds of one thread, the least of some runs, without the first, which compiles."""
    least = np.inf
    for k in range(repeats + 1):
        start = time.process_time()
        dr.eval(work())
        dr.sync_thread()
        if k:
            least = min(least, time.process_time() - start)
    return least


def costs(bsdf, n=1 << 19):
    """(ns per sample, ns per eval_pdf), over all angles and over the texture together."""
    context = mi.BSDFContext()
    si, u1, u2 = weights(bsdf, 30, n)
    si.uv = mi.Point2f(mi.Float(np.random.default_rng(2).random(n, dtype=np.float32)), 0.5)
    dr.eval(si)
    angle = mi.Float(np.radians(np.resize(np.asarray(ANGLES, dtype=np.float32), n)))
    si.wi = mi.Vector3f(dr.sin(angle), 0, dr.cos(angle))
    drawn, _ = bsdf.sample(context, si, u1, u2)
    wo = mi.Vector3f(drawn.wo)
    dr.eval(si, wo)

    def sample():
        drawn, weight = bsdf.sample(context, si, u1, u2)
        return drawn.wo, drawn.pdf, weight

    return seconds(sample) / n * 1e9, seconds(lambda: bsdf.eval_pdf(context, si, wo)) / n * 1e9


def variance(bsdf, degrees, n=1 << 19, uv=(0.5, 0.5)):
    """Of the weight, relative: its channels together."""
    si, u1, u2 = weights(bsdf, degrees, n, uv=uv)
    _, weight = bsdf.sample(mi.BSDFContext(), si, u1, u2)
    w = np.stack([np.broadcast_to(np.array(c, dtype=np.float64), n) for c in weight], axis=1)
    mean = w.mean(axis=0)
    return float(np.sum(w.var(axis=0)) / np.sum(mean**2)) if np.any(mean) else float("nan")


def table():
    dr.set_thread_count(1)
    print(f"\n## Cost and variance, {VARIANT}\n\nCPU nanoseconds of one thread, values included, all angles together; "
          "relative variance of the weight, channels together. Mitsuba's sampler / ours.\n")
    row("material", "ns per sample", "ns per eval_pdf", *(f"variance {a}°" for a in ANGLES), "KiB")
    row("---", "---:", "---:", *["---:"] * len(ANGLES), "---:")
    chosen = {k: v for k, v in {**NARROW, **MATERIALS}.items() if v["type"] in ("roughconductor", "roughplastic",
                                                                               "principled")}
    ratios = []
    for name, description in {**chosen, **MEASURED}.items():
        own, mine = mi.load_dict(description), mi.load_dict(ours(description))
        (a, b), (c, d) = costs(own), costs(mine)
        pairs = [(variance(own, angle), variance(mine, angle)) for angle in ANGLES]
        ratios.append((description["type"], c / a, d / b, np.median([y / x for x, y in pairs if x > 0])))
        row(name, f"{a:.1f} / {c:.1f}", f"{b:.1f} / {d:.1f}", *(f"{x:.3g} / {y:.3g}" for x, y in pairs),
            f"{mine.sampler.nbytes / 1024:.0f}")
    print("\nOurs over Mitsuba's, medians:\n")
    row("plug-in", "ns per sample", "ns per eval_pdf", "variance")
    row("---", "---:", "---:", "---:")
    for kind in dict.fromkeys(r[0] for r in ratios):
        row(kind, *(f"{np.median([r[k] for r in ratios if r[0] == kind]):.3g}" for k in (1, 2, 3)))
    return True


# ---- Loading


def loads():
    import tempfile

    print("\n## Loading\n")
    print("Seconds of the processor; on two free cores less by the clock.\n")
    row("material", "built", "from the file", "leaves of one-shot mode", "KiB")
    row("---", "---:", "---:", "---:", "---:")
    with tempfile.TemporaryDirectory() as folder:
        some = ("principled 0.3", "roughplastic 0.1", "a Python BSDF with eval alone", "roughconductor 0.1 × 0.2")
        for name, description in {**{n: {**NARROW, **MATERIALS}[n] for n in some}, **MEASURED}.items():
            times = []
            for _ in range(2):
                start = time.process_time()
                bsdf = mi.load_dict({**ours(description), "cache": folder})
                times.append(time.process_time() - start)
            row(name, f"{times[0]:.2f}", f"{times[1]:.2f}", bsdf.sampler._core.leaf_counts[1],
                f"{bsdf.sampler.nbytes / 1024:.0f}")
    return True


# ---- Families


# The parameter, its ends, and the BSDF, with a texture that goes from one end to the other.
FAMILIES = {
    "roughconductor": ("alpha", 0.05, 0.8, {"type": "roughconductor", "distribution": "ggx"}),
    "roughconductor Beckmann": ("alpha", 0.1, 0.5, {"type": "roughconductor", "distribution": "beckmann"}),
    "principled": ("roughness", 0.2, 0.8, {"type": "principled",
                                           "base_color": {"type": "rgb", "value": [0.7, 0.3, 0.1]}}),
}
PLACES = (0.0, 0.5, 1.0)  # of the texture, from end to end


def varied(name, folder):
    """A BSDF with its texture, and what wraps it, cached in a folder."""
    parameter, low, high, bsdf = FAMILIES[name]
    ramp = np.array([[low, high]] * 2, dtype=np.float32)[..., None]
    nested = {**bsdf, parameter: {"type": "bitmap", "bitmap": mi.Bitmap(ramp), "raw": True}}
    return nested, {**ours(nested, family=f"{parameter}={low}..{high}"), "cache": folder}


def u_of(place):
    """Between the centres of two texels."""
    return 0.25 + 0.5 * place


def families():
    import tempfile

    dr.set_thread_count(1)
    print(f"\n## Families, {VARIANT}\n\nA texture varies the parameter; every sample is from another place of it. CPU "
          "nanoseconds of one thread and relative variances at three places, as above: Mitsuba's sampler / ours.\n")
    angles = (0, 60, 80)
    row("BSDF", "parameter", "ns per sample", "ns per eval_pdf", *(f"variance {a}°" for a in angles), "built, s",
        "from the file, s", "KiB")
    row("---", "---", *["---:"] * 8)
    with tempfile.TemporaryDirectory() as folder:
        for name, (parameter, low, high, _) in FAMILIES.items():
            times = []
            for _ in range(2):
                start = time.process_time()
                mine = mi.load_dict(varied(name, folder)[1])
                times.append(time.process_time() - start)
            own = mi.load_dict(varied(name, folder)[0])
            (a, b), (c, d) = costs(own), costs(mine)
            for k, place in enumerate(PLACES):
                uv = (u_of(place), 0.5)
                pairs = [(variance(own, angle, uv=uv), variance(mine, angle, uv=uv)) for angle in angles]
                row(name if k == 0 else "", f"{parameter} {low + place * (high - low):.3g}",
                    f"{a:.1f} / {c:.1f}" if k == 0 else "", f"{b:.1f} / {d:.1f}" if k == 0 else "",
                    *(f"{x:.3g} / {y:.3g}" for x, y in pairs), *(f"{t:.1f}" if k == 0 else "" for t in times),
                    f"{mine.sampler.nbytes / 1024:.0f}" if k == 0 else "")
        return family_chi2(folder) & family_pictures(folder)


def family_chi2(folder):
    places, angles = (0.3, 1.0), (30, 60, 80)
    count = len(FAMILIES) * len(places) * len(angles)
    print("\nMitsuba's chi-square test of members:\n")
    row("BSDF", *(f"{place} of the way, {a}°" for place in places for a in angles))
    row("---", *["---:"] * (len(places) * len(angles)))
    good = True
    for name in FAMILIES:
        found = [judged(varied(name, folder)[1], a, count, uv=(u_of(place), 0.5)) for place in places for a in angles]
        good &= all(ok for ok, _ in found)
        row(name, *(text if ok else f"**{text}**" for ok, text in found))
    print("\nAll pass." if good else "\nNOT all pass.")
    return good


def family_pictures(folder):
    print("\nPictures, with the texture around the sphere:\n")
    return picture_table({name: varied(name, folder) for name in FAMILIES})


# ---- Pictures


def scene(bsdf, pixels):
    """A sphere under a lamp and a dim sky."""
    return mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 3},
        "sensor": {"type": "perspective", "fov": 30, "to_world": mi.ScalarTransform4f().look_at(
            [0, 4, 1.5], [0, 0, 0], [0, 0, 1]), "film": {"type": "hdrfilm", "width": pixels, "height": pixels,
                                                         "rfilter": {"type": "box"}},
            "sampler": {"type": "independent"}},
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [0.2, 0.25, 0.3]}},
        "lamp": {"type": "sphere", "center": [3, 3, 3], "radius": 1,
                 "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [8, 7, 6]}}},
        "ball": {"type": "sphere", "bsdf": bsdf},
        "floor": {"type": "rectangle", "to_world": mi.ScalarTransform4f().translate([0, 0, -1]).scale(4),
                  "bsdf": {"type": "diffuse"}},
    })


def batches(bsdf, seed, pixels, spp, count):
    s = scene(bsdf, pixels)
    pictures = [np.array(mi.render(s, spp=spp, seed=seed + k))[..., :3] for k in range(count)]
    blocks = np.stack(pictures).reshape(count, pixels // 4, 4, pixels // 4, 4, 3).mean(axis=(2, 4))
    return blocks.mean(axis=0), blocks.var(axis=0, ddof=1) / count


def z_scores(a, b):
    """Where anything is random: not where the sky is seen."""
    variance = a[1] + b[1]
    seen = np.minimum(a[1], b[1]) > 1e-9 * a[0] ** 2
    return ((a[0] - b[0]) / np.sqrt(np.where(seen, variance, 1)))[seen]


def pictures():
    print(f"\n## Pictures, {VARIANT}\n\nA sphere under a lamp and a sky; means of 4 × 4 pixels over independent "
          "renderings, ours beside Mitsuba's own plug-in. z² has the mean 1 where they are equal.\n")
    names = ["principled 0.6", "roughconductor 0.1", "roughconductor 0.1 × 0.2", "roughplastic 0.1", "principled 0.3"]
    chosen = {n: {**MATERIALS, **NARROW}[n] for n in names}
    chosen.update(list(MEASURED.items())[-4::3])
    return picture_table({name: (description, ours(description)) for name, description in chosen.items()})


def picture_table(chosen):
    row("material", "mean of z²", "largest abs(z)", "variance, ours / Mitsuba's", "twin: 3 % brighter, mean of z²")
    row("---", "---:", "---:", "---:", "---:")
    pixels, spp, count = (32, 16, 12) if VARIANT.startswith("scalar") else (64, 32, 32)
    good = True
    for name, (theirs, wrapped) in chosen.items():
        own = batches(theirs, 1, pixels, spp, count)
        mine = batches(wrapped, 1001, pixels, spp, count)
        z = z_scores(own, mine)
        twin = z_scores((own[0] * 1.03, own[1] * 1.03**2), mine)
        bound = np.sqrt(2 * np.log(len(z))) + 2.5
        good &= np.mean(z**2) < 1.3 and np.max(np.abs(z)) < bound < 10 and np.mean(twin**2) > 1.3
        row(name, f"{np.mean(z**2):.2f}", f"{np.max(np.abs(z)):.1f}", f"{np.sum(mine[1]) / np.sum(own[1]):.2f}",
            f"{np.mean(twin**2):.1f}")
    print("\nEqual by the z-test." if good else "\nNOT equal.")
    return good


# ---- Three scenes at equal time

EFFORTS = {"quick": (48, 16, 8, 16), "default": (96, 64, 24, 64)}  # pixels, spp, seeds, reference over a picture
EPSILON, TRIMMED = 0.01, 0.001


def rel_mse(picture, reference):
    """Mean of squared errors over squares of the reference, without the largest 0.1 % of pixels."""
    error = np.mean((picture - reference) ** 2 / (reference**2 + EPSILON * reference.mean() ** 2), axis=2).reshape(-1)
    return float(np.mean(np.sort(error)[:error.size - int(np.ceil(TRIMMED * error.size))]))


def rendered(scene, spp, seed):
    """(picture, seconds of the processor)"""
    start = time.process_time()
    picture = np.array(mi.render(scene, spp=spp, seed=seed))[..., :3].astype(np.float64)
    return picture, time.process_time() - start


def ratio_of_means(a, b):
    """mean(a) / mean(b) of independent runs, and its standard error."""
    a, b = np.asarray(a), np.asarray(b)
    ratio = a.mean() / b.mean()
    return ratio, ratio * np.sqrt(a.var(ddof=1) / (a.size * a.mean() ** 2) + b.var(ddof=1) / (b.size * b.mean() ** 2))


def sun(pixels, bsdf):
    return lit_scenes.sun(pixels, bsdf, list(MEASURED.values()))


def scenes():
    dr.set_thread_count(1)
    pixels, spp, seeds, longer = EFFORTS[os.environ.get("EFFORT", "default")]
    print(f"\n## Three scenes at equal time, {VARIANT}\n\n{pixels} × {pixels * 2 // 3} pixels, path tracing with both "
          f"strategies combined. Mitsuba's BSDFs with {spp} paths per pixel, and the same BSDFs inside `reflectree`, "
          f"diffuse ones left alone, with as many paths as take the same processor time; {seeds} pictures of each, in "
          "turn, one thread, kernels compiled before. relMSE is the mean over pixels and channels of (x - r)² / "
          f"(r² + {EPSILON} m²) without the largest 0.1 % of pixels; r is the mean of {longer * spp} paths with "
          "Mitsuba's BSDFs, and m the mean of r. Ratios are ours over Mitsuba's; below 1 we win. The first is that of "
          "relMSE times time, the product of the two that follow. With exact mode the weight of a sampled direction is "
          "constant: what the fourth leaves is no sampler's of directions.\n")
    row("scene", "paths", "s", "relMSE", "relMSE at equal time", "relMSE at equal paths", "time per path",
        "relMSE at equal paths, exact mode", "twin: Mitsuba's, 3 % brighter")
    row("---", *["---:"] * 8)
    good = True
    for name, make in {"plates": lit_scenes.plates, "sun": sun, "interior": lit_scenes.interior}.items():
        own, mine = mi.load_dict(make(pixels, lambda d: d)), mi.load_dict(make(pixels, ours))
        reference = np.mean([rendered(own, spp, 10_000 + k)[0] for k in range(longer)], axis=0)
        # How many paths of ours take as long: by the median of some, after one that compiles.
        cost = []
        for scene in (own, mine):
            rendered(scene, spp, 1)
            cost.append(np.median([rendered(scene, spp, k)[1] for k in range(2, 7)]))
        ours_spp = max(1, round(spp * cost[0] / cost[1]))
        rendered(mine, ours_spp, 1)
        found = {own: [], mine: []}
        for k in range(seeds):
            for scene, paths in ((own, spp), (mine, ours_spp)):
                picture, seconds_taken = rendered(scene, paths, 100 + k + (5000 if scene is mine else 0))
                found[scene].append((rel_mse(picture, reference), seconds_taken, rel_mse(picture * 1.03, reference)))
        exact = mi.load_dict(make(pixels, lambda d: ours(d, mode="exact")))
        best = [rel_mse(rendered(exact, spp, 20_000 + k)[0], reference) for k in range(seeds)]
        (a, s, twin), (b, t, _) = (np.array(found[scene]).T for scene in (own, mine))
        s, t = np.median(s), np.median(t)
        quality, error = ratio_of_means(b, a)
        time_ratio, path_ratio = t / s, (t / ours_spp) / (s / spp)
        good &= twin.mean() > a.mean()
        row(name, f"{spp} / {ours_spp}", f"{s:.3f} / {t:.3f}", f"{a.mean():.4g} / {b.mean():.4g}",
            f"{quality * time_ratio:.3f} ± {error * time_ratio:.3f}", f"{quality * ours_spp / spp:.3f}", f"{path_ratio:.3f}",
            "{:.3f} ± {:.3f}".format(*ratio_of_means(best, a)), f"{twin.mean() / a.mean():.2f}")
    return good


def main(parts):
    known = {"chi2": chi2, "table": table, "loads": loads, "pictures": pictures, "families": families, "scenes": scenes}
    unknown = set(parts) - set(known)
    if unknown:
        sys.exit(f"{sorted(unknown)} is no part; say {', '.join(known)}")
    print(f"Mitsuba {mi.__version__}, Dr.Jit {dr.__version__}, reflectree {rt.__version__}, {VARIANT}, "
          f"load {os.getloadavg()[0]:.1f}")
    good = [known[part]() for part in (parts or known)]
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
