# SPDX-License-Identifier: Apache-2.0
"""The BSDF `reflectree` inside Mitsuba 3, judged by Mitsuba's own chi-square test."""

import gc
import os

import numpy as np
import pytest
from mitsuba_parts import (  # noqa: F401, fixtures among them
    HAS_LLVM, PRINCIPLED, ball, cache, chi2, dr, drawn_in_agreement, gradient, interactions, llvm, mean_z2,
    mi, needs_llvm, nothing_left, pictures, rt, variant,
)

import reflectree.mitsuba

needs_data = pytest.mark.skipif("REFLECTREE_DATA" not in os.environ,
                                reason="REFLECTREE_DATA names no folder of measured files")


def eval_alone():
    class EvalAlone(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0]

        def eval(self, context, si, wo, active=True):
            value = mi.Color3f(1, 0.7, 0.4) * (0.3 / (si.wi.z + wo.z) * wo.z)
            return dr.select(active & (si.wi.z > 0) & (wo.z > 0), value, 0)

    mi.register_bsdf("eval_alone", lambda props: EvalAlone(props))
    return {"type": "eval_alone"}


WRAPPED = [
    PRINCIPLED,
    {"type": "roughplastic", "alpha": 0.3},
    {"type": "roughconductor", "distribution": "ggx", "alpha_u": 0.3, "alpha_v": 0.5},
    "eval alone",
]


@needs_llvm
@pytest.mark.parametrize("nested", WRAPPED, ids=str)
def test_mitsubas_own_judge(llvm, cache, nested):
    nested = eval_alone() if nested == "eval alone" else nested
    for how in ({}, {"uniforms": "monotone"}, {"mode": "exact"}):
        for degrees in (10, 50, 75):
            assert chi2({"type": "reflectree", "nested": nested, "cache": cache, **how}, degrees, 9 * len(WRAPPED))


@needs_llvm
@needs_data
def test_measured(llvm, cache):
    path = os.path.join(os.environ["REFLECTREE_DATA"], "rgl", "paper_white_rgb.bsdf")
    assert chi2({"type": "reflectree", "nested": {"type": "measured", "filename": path}, "cache": cache}, 40)


@needs_llvm
@pytest.mark.parametrize("fault", ["slopes", "alias"])
def test_twin_with_a_planted_fault(llvm, cache, fault, monkeypatch):
    from reflectree import _drjit_forest

    if fault == "slopes":
        monkeypatch.setattr(_drjit_forest, "_linear", lambda dr, slope, u: u)
    else:
        monkeypatch.setattr(_drjit_forest.Forest, "choose",
                            lambda self, slab, word, active: slab.x + dr.mul_hi(word, slab.y))
    assert not chi2({"type": "reflectree", "nested": PRINCIPLED, "cache": cache}, 50)


@needs_llvm
@pytest.mark.parametrize("name", ["llvm_ad_rgb", "llvm_ad_mono", "llvm_ad_spectral"])
def test_values_densities_and_weights_agree(cache, name):
    variant(name)
    nested = mi.load_dict(PRINCIPLED)
    bsdf = mi.load_dict({"type": "reflectree", "nested": PRINCIPLED, "cache": cache})
    n, context = 20000, mi.BSDFContext()
    si, u1, u2 = interactions(n)
    drawn, weight, _ = drawn_in_agreement(bsdf, nested, si, u1, u2)
    weight = np.array(weight).reshape(-1, n)
    assert np.all(weight.std(axis=1) < 0.2 * weight.mean(axis=1) + 0.2)
    down = mi.Vector3f(drawn.wo.x, drawn.wo.y, -drawn.wo.z)
    assert dr.all(bsdf.pdf(context, si, down) == 0)
    si.wi = mi.Vector3f(si.wi.x, si.wi.y, -si.wi.z)
    drawn, weight = bsdf.sample(context, si, u1, u2)
    assert dr.all(drawn.pdf == 0) and dr.all(weight == 0, axis=None)
    only_diffuse = mi.BSDFContext()
    only_diffuse.type_mask = int(mi.BSDFFlags.DiffuseReflection)
    assert dr.all(bsdf.eval(only_diffuse, si, drawn.wo) == 0, axis=None)


@pytest.mark.parametrize("nested, sentence", [
    ({"type": "conductor"}, "mirror-like"),
    ({"type": "plastic"}, "mirror-like"),
    ({"type": "roughdielectric"}, "transmits"),
    ({"type": "principled", "spec_trans": 0.5}, "transmits"),
    ({"type": "twosided", "inside": {"type": "diffuse"}}, "twosided around"),
    ({"type": "diffuse", "reflectance": {"type": "checkerboard"}}, "vary over the surface"),
], ids=lambda x: x["type"] if isinstance(x, dict) else "")
@pytest.mark.parametrize("name", ["scalar_rgb", pytest.param("llvm_ad_rgb", marks=needs_llvm)])
def test_what_cannot_be_wrapped_is_refused(name, nested, sentence):
    variant(name)
    with pytest.raises(RuntimeError, match=sentence):
        mi.load_dict({"type": "reflectree", "nested": nested, "cache": "none"})


@pytest.mark.parametrize("given, sentence", [
    ({}, "0 functions"),
    ({"material": "lambert", "file": "x.bsdf"}, "2 functions"),
    ({"material": "nix"}, "unknown model"),
    ({"material": "lambert", "roughness": 0.5}, "no parameter 'roughness'"),
    ({"material": "lambert", "uniforms": "some"}, "uniforms 'some' is none"),
    ({"material": "lambert", "mode": "exact"}, "exact mode is there for nested"),
    ({"sampler": "nowhere.rfl"}, "nowhere.rfl"),
])
def test_bad_parameters(given, sentence):
    variant("scalar_rgb")
    with pytest.raises(RuntimeError, match=sentence):
        mi.load_dict({"type": "reflectree", **given})


@needs_llvm
def test_samplers_are_kept_and_found(llvm, tmp_path):
    def load(nested):
        return mi.load_dict({"type": "reflectree", "nested": nested, "cache": str(tmp_path)})

    assert load(PRINCIPLED).sampler.build_seconds is not None
    assert load(PRINCIPLED).sampler.build_seconds is None
    (path,) = tmp_path.iterdir()
    assert load({**PRINCIPLED, "roughness": 0.61}).sampler.build_seconds is not None
    assert len(list(tmp_path.iterdir())) == 2
    path.write_bytes(path.read_bytes()[:-20])
    assert load(PRINCIPLED).sampler.build_seconds is not None
    assert load(PRINCIPLED).sampler.build_seconds is None
    # A sampler file by its name, for the BSDF that it was built for and for no other.
    named = {"type": "reflectree", "sampler": str(path)}
    assert mi.load_dict({**named, "nested": PRINCIPLED}).sampler.build_seconds is None
    with pytest.raises(RuntimeError, match="another BRDF"):
        mi.load_dict({**named, "nested": {"type": "diffuse"}})


@needs_llvm
def test_xml(llvm, cache):
    bsdf = mi.load_string(f"""<bsdf version="3.0.0" type="twosided"><bsdf type="reflectree">
        <string name="cache" value="{cache}"/>
        <bsdf type="principled"><float name="roughness" value="0.6"/></bsdf></bsdf></bsdf>""")
    assert "Reflectree" in str(bsdf)


@pytest.mark.parametrize("name", ["scalar_rgb", pytest.param("llvm_ad_rgb", marks=needs_llvm)])
def test_pictures_are_mitsubas(name, cache):
    variant("llvm_ad_rgb" if HAS_LLVM else name)
    nested = {"type": "roughconductor", "alpha": 0.3}
    mine = {"type": "reflectree", "nested": nested, "cache": cache}
    mi.load_dict(mine)  # builds
    variant(name)
    few = {"count": 12, "spp": 1} if name == "scalar_rgb" else {}
    theirs, ours = pictures(nested, 1, **few), pictures(mine, 1001, **few)
    assert mean_z2(theirs, ours) < 2
    assert mean_z2(theirs * 1.3 if few else theirs * 1.05, ours) > 2  # the twin


@needs_llvm
def test_materials_of_ours(llvm):
    material = {"type": "reflectree", "material": "0.5*lambert + 0.5*ggx:alpha=0.3"}
    si, u1, u2 = interactions(5000)
    bsdf = mi.load_dict(material)
    drawn, weight = bsdf.sample(mi.BSDFContext(), si, u1, u2)
    wo, wi = (np.stack([np.array(w[k]) for k in range(3)], axis=1) for w in (si.wi, drawn.wo))
    expected = rt.material(material["material"]).eval(wo, wi, cosine=True)
    assert np.allclose(np.array(weight * drawn.pdf).T, expected, rtol=1e-3, atol=1e-5)
    with pytest.raises(RuntimeError) as caught:
        mi.render(ball(material), spp=1)
    chain, error = [], caught.value
    while error:
        chain.append(str(error))
        error = error.__cause__ or error.__context__
    assert any("reflectree.mitsuba.evaluated()" in text for text in chain)


@needs_llvm
def test_pictures_of_materials_of_ours(llvm):
    with reflectree.mitsuba.evaluated():
        ours = pictures({"type": "reflectree", "material": "lambert:rho=0.5"}, 1)
    gc.collect()
    assert mean_z2(pictures({"type": "diffuse", "reflectance": 0.5}, 1001), ours) < 1.5


@needs_llvm
def test_evaluation_is_differentiated_and_sampling_is_not(llvm, cache):
    theirs = gradient(PRINCIPLED, "base_color.value")
    ours = gradient({"type": "reflectree", "nested": PRINCIPLED, "cache": cache}, "base_color.value")
    assert np.all(theirs > 0) and np.allclose(ours, theirs, rtol=0.05)
