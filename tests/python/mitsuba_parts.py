# SPDX-License-Identifier: Apache-2.0
"""What the tests inside Mitsuba 3 share: variants, viewers, Mitsuba's own chi-square test, pictures. Skips the test that
imports it where Mitsuba is not installed; LLVM variants are marked where Dr.Jit finds no LLVM that it can use
(DRJIT_LIBLLVM_PATH)."""

import gc
import subprocess
import sys

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is not installed: its plug-in is not tested (pip install mitsuba)")
import drjit as dr  # noqa: E402

import reflectree as rt  # noqa: E402

# An LLVM that Dr.Jit cannot use ends the process, so that another one has to ask.
PROBE = """import drjit as dr, mitsuba as mi; mi.set_variant('llvm_ad_rgb')
dr.eval(mi.load_dict({'type': 'principled'}).eval_pdf(mi.BSDFContext(), dr.zeros(mi.SurfaceInteraction3f, 64),
        dr.minimum(mi.Vector3f(dr.arange(mi.Float, 64) * 0.01, 0, 1), 0.5)))"""
HAS_LLVM = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, check=False).returncode == 0
needs_llvm = pytest.mark.skipif(not HAS_LLVM, reason="no LLVM that Dr.Jit can use; set DRJIT_LIBLLVM_PATH")

mi.set_variant("scalar_rgb")
import reflectree.mitsuba  # noqa: E402

PRINCIPLED = {"type": "principled", "roughness": 0.6, "base_color": {"type": "rgb", "value": [0.7, 0.3, 0.1]}}


def variant(name):
    mi.set_variant(name)
    mi.set_log_level(mi.LogLevel.Error)


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return str(tmp_path_factory.mktemp("cache"))


@pytest.fixture(autouse=True)
def nothing_left():
    yield
    gc.collect()  # Dr.Jit compiles every BSDF that exists


@pytest.fixture
def llvm():
    variant("llvm_ad_rgb")


def direction(degrees, azimuth=37):
    return rt.direction(np.radians(float(degrees)), np.radians(float(azimuth))).astype(float).tolist()


def interactions(n, wi=None):
    """n viewers above the surface, or one, and n times three uniforms."""
    rng = np.random.default_rng(1)
    known = rt.direction(np.arccos(rng.uniform(0.05, 1, n)), rng.uniform(0, 6.28, n)).astype(np.float32)
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    si.wi = mi.Vector3f(wi) if wi else mi.Vector3f(*(mi.Float(np.ascontiguousarray(known[:, k])) for k in range(3)))
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    u = rng.random((3, n), dtype=np.float32)
    return si, mi.Float(u[0]), mi.Point2f(mi.Float(u[1]), mi.Float(u[2]))


def chi2(description, degrees, count=1):
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    sample, pdf = BSDFAdapter(description["type"], description, wi=direction(degrees))
    test = ChiSquareTest(SphericalDomain(), sample, pdf, sample_dim=3, sample_count=300_000)
    return test.run(test_count=count, quiet=True)


def drawn_in_agreement(bsdf, nested, si, u1, u2):
    """bsdf.sample and the density of its directions: values, density and weight must be those of eval_pdf, and values
    those of the nested BSDF."""
    context = mi.BSDFContext()
    if mi.is_spectral:
        si.wavelengths = type(si.wavelengths)([450, 520, 590, 660])
    drawn, weight = bsdf.sample(context, si, u1, u2)
    values, pdf = bsdf.eval_pdf(context, si, drawn.wo)
    assert dr.all(drawn.pdf > 0)
    assert np.quantile(np.abs(np.array(pdf / drawn.pdf) - 1), 0.99) < 1e-3
    assert dr.allclose(values, nested.eval(context, si, drawn.wo))
    assert dr.allclose(weight * drawn.pdf, values, rtol=1e-4, atol=1e-6)
    return drawn, weight, pdf


def ball(bsdf, pixels=24):
    return mi.load_dict({
        "type": "scene", "integrator": {"type": "path", "max_depth": 3},
        "sensor": {"type": "perspective", "fov": 30, "to_world": mi.ScalarTransform4f().look_at(
            [0, 4, 1.5], [0, 0, 0], [0, 0, 1]), "film": {"type": "hdrfilm", "width": pixels, "height": pixels,
                                                         "rfilter": {"type": "box"}}},
        "sky": {"type": "constant", "radiance": 0.3},
        "lamp": {"type": "sphere", "center": [3, 3, 3], "emitter": {"type": "area", "radiance": 8.0}},
        "ball": {"type": "sphere", "bsdf": bsdf},
    })


def mean_z2(a, b):
    return np.mean(((a.mean(axis=0) - b.mean(axis=0)) ** 2 / (a.var(axis=0) + b.var(axis=0) + 1e-12) * (len(a) - 1)))


def pictures(bsdf, first_seed, count=24, spp=16):
    scene = ball(bsdf)
    rendered = np.stack([np.array(mi.render(scene, spp=spp, seed=first_seed + k)) for k in range(count)])
    return rendered.reshape(count, 6, 4, 6, 4, 3).mean(axis=(2, 4))


def gradient(bsdf, key):
    """Of the mean of a picture, by a parameter."""
    scene = ball(bsdf, 8)
    parameters = mi.traverse(scene)
    key = next(k for k in parameters.keys() if k.endswith(key))
    dr.enable_grad(parameters[key])
    parameters.update()
    integrator = mi.load_dict({"type": "prb", "max_depth": 3})
    dr.backward(dr.mean(mi.render(scene, parameters, integrator=integrator, spp=512), axis=None))
    return np.array(dr.grad(parameters[key])).reshape(-1)
