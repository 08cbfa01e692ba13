# SPDX-License-Identifier: Apache-2.0
"""The BSDF `reflectree` with a texture of one parameter, inside Mitsuba 3: members of a family."""

import numpy as np
import pytest
from mitsuba_parts import (  # noqa: F401, fixtures among them
    PRINCIPLED, ball, cache, direction, dr, drawn_in_agreement, gradient, interactions, llvm, mean_z2, mi,
    needs_llvm, nothing_left, rt, variant,
)

import reflectree.mitsuba


@pytest.fixture(scope="module")
def bitmap(tmp_path_factory):
    """A texture from 0.2 at the left to 0.6 at the right, as a file: Mitsuba takes the tensor out of a dictionary."""
    mi.set_variant("scalar_rgb")
    path = tmp_path_factory.mktemp("textures") / "ramp.exr"
    mi.Bitmap(np.broadcast_to(np.linspace(0.2, 0.6, 5, dtype=np.float32)[None, :, None], (3, 5, 1)).copy()).write(str(path))
    return {"type": "bitmap", "filename": str(path), "raw": True, "wrap_mode": "clamp"}


def rough(alpha):
    return {"type": "roughconductor", "distribution": "ggx", "alpha": alpha}


def textured(bitmap, cache, **more):
    return {"type": "reflectree", "family": "alpha=0.15..0.7", "nested": rough(bitmap), "cache": cache, **more}


def value_at(u):
    """Of the texture."""
    return np.interp(u, (np.arange(5) + 0.5) / 5, np.linspace(0.2, 0.6, 5))


def chi2_at(description, degrees, u, count):
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    sample, pdf = BSDFAdapter(description["type"], description, wi=direction(degrees), uv=[u, 0.4])
    test = ChiSquareTest(SphericalDomain(), sample, pdf, sample_dim=3, sample_count=300_000, ires=16)
    return test.run(test_count=count, quiet=True)


@needs_llvm
def test_mitsubas_own_judge_of_members(llvm, cache, bitmap):
    hows = ({}, {"uniforms": "monotone"})
    for how in hows:
        for degrees in (10, 60):
            for u in (0.1, 0.45, 0.9):
                assert chi2_at(textured(bitmap, cache, **how), degrees, u, 12)


@needs_llvm
def test_principled_with_a_texture(llvm, cache, bitmap):
    description = {"type": "reflectree", "family": "roughness", "cache": cache,
                   "nested": {**PRINCIPLED, "roughness": bitmap}}
    for u in (0.1, 0.9):
        assert chi2_at(description, 50, u, 2)


@needs_llvm
def test_exact_mode_of_members(llvm, cache, bitmap):
    exact = {**textured(bitmap, cache, mode="exact"), "family": "alpha=0.2..0.6"}
    for u in (0.1, 0.9):
        assert chi2_at(exact, 60, u, 2)
    si, u1, u2 = interactions(5000)
    si.uv = mi.Point2f(u1, 0.3)
    drawn, weight = mi.load_dict(exact).sample(mi.BSDFContext(), si, u1, u2)
    target = np.linalg.norm(np.array(weight), axis=0)  # is the albedo, which does not depend on the direction
    again, weight = mi.load_dict(exact).sample(mi.BSDFContext(), si, u1, mi.Point2f(u2.y, u2.x))
    assert np.allclose(target, np.linalg.norm(np.array(weight), axis=0), rtol=1e-3)
    assert not np.allclose(np.array(drawn.wo), np.array(again.wo), atol=0.1)


@needs_llvm
def test_twin_directions_of_another_member(llvm, cache, bitmap, monkeypatch):
    from reflectree._drjit import DrJitSampler

    own = DrJitSampler.sample
    monkeypatch.setattr(DrJitSampler, "sample", lambda self, wo, u1, u2, active, monotone, at: own(
        self, wo, u1, u2, active, monotone, tuple(1.1 * x for x in at)))
    assert not chi2_at(textured(bitmap, cache), 60, 0.45, 12)


@needs_llvm
@pytest.mark.parametrize("name", ["llvm_ad_rgb", "llvm_ad_mono", "llvm_ad_spectral"])
def test_values_densities_and_weights_of_members_agree(cache, bitmap, name):
    variant(name)
    nested, bsdf, context, n = mi.load_dict(rough(bitmap)), mi.load_dict(textured(bitmap, cache)), mi.BSDFContext(), 20000
    si, u1, u2 = interactions(n)
    si.uv = mi.Point2f(mi.Float(np.random.default_rng(5).random(n, dtype=np.float32)), 0.3)
    drawn, _, pdf = drawn_in_agreement(bsdf, nested, si, u1, u2)
    alpha = value_at(np.array(si.uv.x))
    wo, wi = (np.stack([np.array(w[k]) for k in range(3)], axis=1) for w in (si.wi, drawn.wo))
    expected = bsdf.sampler.pdf(wo, wi, mode="one-shot", alpha=alpha)
    assert np.quantile(np.abs(np.array(pdf) / expected - 1), 0.99) < 1e-3
    # The sampler's values outside of a render are those of its members.
    single = mi.load_dict(rough(0.3))
    si.uv = mi.Point2f(0.5)
    ours = bsdf.sampler.eval(wo, wi, cosine=True, alpha=0.3)[:, 0]
    if not mi.is_spectral:
        assert np.allclose(ours, np.array(single.eval(context, si, drawn.wo))[0], rtol=1e-3, atol=1e-6)


def textured_pictures(bsdf, first_seed):
    scene = ball(bsdf)
    rendered = np.stack([np.array(mi.render(scene, spp=64, seed=first_seed + k)) for k in range(24)])
    return rendered.reshape(24, 6, 4, 6, 4, 3).mean(axis=(2, 4))


@needs_llvm
def test_pictures_of_a_texture_are_mitsubas(llvm, cache, bitmap):
    theirs, ours = textured_pictures(rough(bitmap), 1), textured_pictures(textured(bitmap, cache), 1001)
    assert mean_z2(theirs, ours) < 2
    assert mean_z2(theirs * 1.03, ours) > 2  # the twin
    assert mean_z2(textured_pictures(rough(0.4), 2001), ours) > 2  # without the texture


@needs_llvm
def test_a_family_follows_its_texture(llvm, cache, bitmap):
    bsdf = mi.load_dict(textured(bitmap, cache))
    parameters, sampler = mi.traverse(bsdf), bsdf.sampler
    key = next(k for k in parameters.keys() if k.endswith("alpha.data"))
    assert np.allclose(np.asarray(parameters[key])[0, :, 0], np.linspace(0.2, 0.6, 5))  # as it was before the build
    si, u1, u2 = interactions(1000)
    before = np.array(bsdf.sample(mi.BSDFContext(), si, u1, u2)[0].pdf)
    parameters[key] = mi.TensorXf(np.full((3, 5, 1), 0.7, np.float32))
    parameters.update()
    drawn, _ = bsdf.sample(mi.BSDFContext(), si, u1, u2)
    assert bsdf.sampler is sampler and not np.allclose(before, np.array(drawn.pdf), rtol=0.1)
    wo, wi = (np.stack([np.array(w[k]) for k in range(3)], axis=1) for w in (si.wi, drawn.wo))
    assert np.allclose(np.array(drawn.pdf), sampler.pdf(wo, wi, mode="one-shot", alpha=0.7), rtol=1e-2)
    parameters[key] = mi.TensorXf(np.full((3, 5, 1), 0.8, np.float32))
    with pytest.raises(rt.Error, match="alpha goes from 0.8 to 0.8, and the family from 0.15 to 0.7"):
        parameters.update()


@needs_llvm
def test_a_texture_is_differentiated(llvm, cache, bitmap):
    theirs, ours = (np.sum(gradient(bsdf, "alpha.data")) for bsdf in (rough(bitmap), textured(bitmap, cache)))
    assert abs(theirs) > 1e-3 and np.isclose(ours, theirs, rtol=0.1)


@needs_llvm
def test_two_textures_are_set_for_every_lane(llvm, bitmap):
    from reflectree._mitsuba_nested import Surface, parameters_of
    from reflectree._mitsuba_textures import VariedTextures

    def blend(alpha_u, alpha_v):
        return mi.load_dict({"type": "blendbsdf", "weight": 0.5, "a": {"type": "diffuse"}, "b": {
            "type": "roughconductor", "alpha_u": alpha_u, "alpha_v": alpha_v}})

    scaled = {**bitmap, "to_uv": mi.ScalarTransform3f().scale([2, 1])}
    nested = blend(bitmap, {"type": "checkerboard", "color0": scaled, "color1": 0.3})
    u, v = "bsdf_1.alpha_u", "bsdf_1.alpha_v"
    textures = VariedTextures(mi, dr, nested, [u, v], "")
    textures.set_ranges({u: None, v: (0.1, 1.5)})
    textures.check()
    assert textures.ranges == {u: (0.2, 0.6), v: (0.1, 1.5)} and not any(k.startswith(u) for k in textures.others())
    surface = Surface(mi, dr, nested, textures)
    others, n, rng = parameters_of(surface), 12, np.random.default_rng(1)
    at = {name: rng.uniform(*ends, n).astype(np.float32) for name, ends in textures.ranges.items()}
    wo = rt.direction(rng.uniform(0, 1.2, n), rng.uniform(0, 6, n)).astype(np.float32)
    wi = rt.direction(rng.uniform(0, 1.2, n), rng.uniform(0, 6, n)).astype(np.float32)
    before = surface.cosine_values(wo, wi, 0.3)
    with textures.varied():
        values = surface.cosine_values(wo, wi, **at)
        with pytest.raises(rt.Error, match="another family"):
            with VariedTextures(mi, dr, nested, [u], "").varied():
                pass
    assert np.array_equal(surface.cosine_values(wo, wi, 0.3), before) and parameters_of(surface) == others
    expected = np.concatenate([Surface(mi, dr, blend(float(at[u][k]), float(at[v][k]))).cosine_values(
        wo[k:k + 1], wi[k:k + 1]) for k in range(n)])
    assert np.allclose(values, expected, rtol=1e-4)
    assert not np.allclose(values, np.roll(expected, 1, axis=0), rtol=0.1)  # the twin
    shared = blend(bitmap, {"type": "checkerboard", "color0": bitmap, "color1": 0.3})  # Mitsuba makes one of the two
    textures = VariedTextures(mi, dr, shared, [u, v], "")
    textures.set_ranges({u: None, v: (0.1, 1.5)})
    with textures.varied(), pytest.raises(rt.Error, match="another parameter has the same one"):
        textures.follows(at, surface.interactions(mi.Vector3f(0, 0, 1), n, textures.coordinates(at)))


@needs_llvm
def test_two_families_of_one_texture_in_a_scene(llvm, cache, bitmap):
    bsdfs = [textured(bitmap, cache), textured(bitmap, cache, uniforms="monotone")]
    scene = mi.load_dict({"type": "scene", **{f"ball_{k}": {"type": "sphere", "bsdf": b} for k, b in enumerate(bsdfs)}})
    parameters = mi.traverse(scene)
    data = [np.asarray(parameters[key])[0, :, 0] for key in parameters.keys() if key.endswith("alpha.data")]
    assert data and all(np.allclose(d, np.linspace(0.2, 0.6, 5)) for d in data)


@needs_llvm
def test_a_family_in_xml(llvm, cache, bitmap):
    bsdf = mi.load_string(f"""<bsdf version="3.0.0" type="reflectree">
        <string name="family" value="alpha=0.15..0.7"/><string name="cache" value="{cache}"/>
        <bsdf type="roughconductor"><string name="distribution" value="ggx"/>
          <texture name="alpha" type="bitmap"><string name="filename" value="{bitmap["filename"]}"/>
            <boolean name="raw" value="true"/><string name="wrap_mode" value="clamp"/></texture></bsdf></bsdf>""")
    assert np.allclose(bsdf.sampler.ranges["alpha"], (0.15, 0.7)) and "FamilySampler" in str(bsdf)


@needs_llvm
def test_families_are_kept_and_found(llvm, bitmap, tmp_path):
    first = mi.load_dict(textured(bitmap, str(tmp_path)))
    assert first.sampler.build_seconds is not None
    assert mi.load_dict(textured(bitmap, str(tmp_path))).sampler.build_seconds is None
    # Whatever the texture holds; not of another range.
    assert mi.load_dict({**textured(bitmap, str(tmp_path)), "nested": rough(
        {**bitmap, "to_uv": mi.ScalarTransform3f().scale([2, 1])})}).sampler.build_seconds is None
    (path,) = tmp_path.iterdir()
    named = {"type": "reflectree", "family": "alpha=0.15..0.7", "sampler": str(path)}
    assert mi.load_dict({**named, "nested": rough(bitmap)}).sampler.build_seconds is None
    for family, alpha, sentence in (("alpha", bitmap, "the sampler is of alpha=0.15..0.7"),
                                    ("eta=0..1", 0.3, "the sampler is of alpha, and family names eta")):
        with pytest.raises(RuntimeError, match=sentence):
            mi.load_dict({**named, "family": family, "nested": rough(alpha)})
    with pytest.raises(RuntimeError, match="another BRDF"):
        mi.load_dict({**named, "nested": {**rough(bitmap), "distribution": "beckmann"}})


@pytest.mark.parametrize("given, sentence", [
    ({"family": "alpha=0.3..0.7"}, "alpha goes from 0.2 to 0.6, and the family from 0.3 to 0.7"),
    ({"family": "roughness"}, "no parameter roughness.*alpha"),
    ({"family": "alpha=0.3"}, "'alpha=0.3' is no range"),
    ({"family": "a,b,c"}, "no one or two parameters"),
    ({"nested": {"type": "roughplastic"}}, "alpha is one number"),
    ({"nested": rough(0.3)}, "alpha is 0.3 everywhere"),
    ({"filter_type": "nearest"}, "cannot be set to given values"),
    ({"specular_reflectance": {"type": "checkerboard"}}, "vary over the surface by more than alpha"),
    ({"material": "oren_nayar:sigma=0.1..0.5"}, "sigma is missing"),
    ({"material": "oren_nayar:sigma=0.1..0.5", "beta": 0.3}, "no range of beta"),
    ({"material": "oren_nayar:sigma=0.1..0.5", "sigma": 0.6}, "sigma goes from 0.6 to 0.6"),
    ({"material": "oren_nayar:sigma=0.1..0.5", "family": "alpha"}, "there is none"),
], ids=str)
@needs_llvm
def test_what_is_no_family_is_refused(llvm, bitmap, given, sentence):
    description = {"type": "reflectree", "cache": "none", **given}
    if "material" not in given:
        nested = rough({**bitmap, "filter_type": given.get("filter_type", "bilinear")})
        description = {"family": "alpha", "nested": nested, **description}
        for key in ("filter_type", "specular_reflectance"):
            description.pop(key, None)
        if "specular_reflectance" in given:
            nested["specular_reflectance"] = given["specular_reflectance"]
    with pytest.raises(RuntimeError, match=sentence):
        mi.load_dict(description)


def test_families_are_refused_in_scalar_variants(bitmap):
    variant("scalar_rgb")
    with pytest.raises(RuntimeError, match="in LLVM variants alone"):
        mi.load_dict({"type": "reflectree", "family": "alpha", "nested": rough(bitmap), "cache": "none"})


@needs_llvm
def test_a_family_of_ours_with_a_texture(llvm, bitmap):
    material = {"type": "reflectree", "material": "ggx:alpha=0.2..0.8", "alpha": bitmap}
    si, u1, u2 = interactions(5000)
    si.uv = mi.Point2f(mi.Float(np.random.default_rng(5).random(5000, dtype=np.float32)), 0.3)
    drawn, weight = mi.load_dict(material).sample(mi.BSDFContext(), si, u1, u2)
    wo, wi = (np.stack([np.array(w[k]) for k in range(3)], axis=1) for w in (si.wi, drawn.wo))
    family = rt.FamilySampler(material["material"])
    alpha = value_at(np.array(si.uv.x))
    values = np.array(weight * drawn.pdf).T
    assert np.allclose(values, family.eval(wo, wi, cosine=True, alpha=alpha), rtol=1e-3, atol=1e-5)
    assert not np.allclose(values, family.eval(wo, wi, cosine=True, alpha=0.4), rtol=0.1)  # the twin
    assert np.quantile(np.abs(np.array(drawn.pdf) / family.pdf(wo, wi, mode="one-shot", alpha=alpha) - 1), 0.99) < 1e-3
    with reflectree.mitsuba.evaluated():
        assert np.all(np.isfinite(np.array(mi.render(ball(material, 8), spp=4))))
    # A texture that is looked at in many places, and lies elsewhere.
    class Liar(mi.Texture):
        def eval_1(self, si, active=True):
            return dr.select(si.uv.x == 0.25, mi.Float(0.9), 0.4)

        def to_string(self):
            return "Liar[]"

    mi.register_texture("liar", lambda props: Liar(props))
    bsdf = mi.load_dict({**material, "alpha": {"type": "liar"}})
    bsdf.eval(mi.BSDFContext(), si, drawn.wo)
    si.uv = mi.Point2f(0.25, 0.3)
    with pytest.raises(rt.Error, match="0.9 is outside of its range"):
        bsdf.eval(mi.BSDFContext(), si, drawn.wo)
