# SPDX-License-Identifier: Apache-2.0
"""The native plug-in of Mitsuba's scalar variants: compiled here, judged by the doctor and by Mitsuba's own pictures.
Skipped where Mitsuba is not installed."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

mi = pytest.importorskip("mitsuba", reason="Mitsuba 3 is not installed: its plug-in is not tested (pip install mitsuba)")

import reflectree as rt  # noqa: E402  (and not reflectree.mitsuba, which has a BSDF of this name, too)

PRINCIPLED = {"type": "principled", "roughness": 0.6, "base_color": {"type": "rgb", "value": [0.7, 0.3, 0.1]}}


@pytest.fixture(scope="module", autouse=True)
def plugin(tmp_path_factory):
    """The folder of the compiled plug-in, in which Mitsuba looks from now on."""
    folder = tmp_path_factory.mktemp("plugin")
    source = pathlib.Path(os.environ["REFLECTREE_SOURCE"]) / "bindings/mitsuba"
    for command in (["cmake", "-S", source, "-B", folder, f"-DMITSUBA={pathlib.Path(mi.__file__).parent}",
                     f"-DREFLECTREE_C_LIBRARY={os.environ['REFLECTREE_C_LIBRARY']}",
                     f"-DNANOBIND_INCLUDE={os.environ['REFLECTREE_NANOBIND_INCLUDE']}", "-DCMAKE_CXX_FLAGS=-Wall -Werror"],
                    ["cmake", "--build", folder]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    mi.set_variant("scalar_rgb")
    mi.file_resolver().prepend(str(folder))
    return folder


def load(description):
    return mi.load_dict(description)


def interaction(wo):
    si = mi.SurfaceInteraction3f()
    si.t, si.wi, si.sh_frame = 1, mi.Vector3f(*map(float, wo)), mi.Frame3f(mi.Vector3f(0, 0, 1))
    si.n = mi.Normal3f(0, 0, 1)
    return si


def examined(bsdf, pdf_factor=1.0):
    """The doctor's verdict. Calls come one by one, so that few viewers are asked."""
    context = mi.BSDFContext()

    def values(wo, wi):
        return np.array([bsdf.eval(context, interaction(o), mi.Vector3f(*map(float, i))) for o, i in zip(wo, wi)])

    def draw(wo, rng):
        drawn = [bsdf.sample(context, interaction(o), u[0], [u[1], u[2]])
                 for o, u in zip(wo, rng.random((len(wo), 3), dtype=np.float32))]
        return (np.array([[s.wo[0], s.wo[1], s.wo[2]] for s, _ in drawn]), np.array([s.pdf for s, _ in drawn]),
                np.array([list(w) for _, w in drawn]))

    def density(wo, wi):
        p = np.array([bsdf.pdf(context, interaction(o), mi.Vector3f(*map(float, i))) for o, i in zip(wo, wi)])
        return p * np.where(wi[:, 1] > 0, pdf_factor, 1)

    return rt.doctor(eval=values, sample=draw, pdf=density, eval_returns="f_cos", sample_returns="weight",
                     effort="quick")


@pytest.mark.parametrize("given", [
    {"nested": PRINCIPLED},
    {"nested": PRINCIPLED, "uniforms": "monotone"},
    {"material": "ggx:alpha_x=0.25,alpha_y=0.5"},
    {"material": "plastic:alpha=0.3", "mode": "exact"},
], ids=["alias", "monotone", "anisotropic", "exact"])
def test_the_doctor_finds_nothing(given):
    diagnosis = examined(load({"type": "reflectree", "cache": "none", **given}))
    assert diagnosis, str(diagnosis)


def test_twin_the_doctor_finds_a_wrong_density():
    assert not examined(load({"type": "reflectree", "cache": "none", "nested": PRINCIPLED}), 1.1)


def test_values_are_the_nested_ones():
    nested, mine = load(PRINCIPLED), load({"type": "reflectree", "cache": "none", "nested": PRINCIPLED})
    context, rng = mi.BSDFContext(), np.random.default_rng(1)
    for u in rng.random((200, 3)):
        si = interaction(rt.direction(np.arccos(u[0]), 0.3))
        drawn, weight = mine.sample(context, si, u[0], [u[1], u[2]])
        assert np.allclose(weight * drawn.pdf, nested.eval(context, si, drawn.wo), rtol=1e-5)
        assert np.allclose(mine.pdf(context, si, drawn.wo), drawn.pdf, rtol=1e-3)


def test_materials_of_ours():
    bsdf, expected = load({"type": "reflectree", "material": "ggx:alpha=0.3"}), rt.material("ggx:alpha=0.3")
    wo, wi = rt.direction(0.6, 0.2), rt.direction(0.5, 3.0)
    values = bsdf.eval(mi.BSDFContext(), interaction(wo), mi.Vector3f(*map(float, wi)))
    assert np.allclose(values, expected.eval(wo, wi, cosine=True), rtol=1e-5)


def test_a_bsdf_of_python_with_eval_alone():
    """Its eval is called by the threads that build, while Python waits for them."""
    class Dust(mi.BSDF):
        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.m_flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [self.m_flags]

        def eval(self, context, si, wo, active=True):
            above = si.wi.z > 0 and wo.z > 0
            return mi.Color3f(0.3 / (si.wi.z + wo.z) * wo.z if above else 0)

        def to_string(self):
            return "Dust[]"

    mi.register_bsdf("dust_of_the_test", lambda props: Dust(props))
    bsdf = load({"type": "reflectree", "cache": "none", "nested": {"type": "dust_of_the_test"}})
    drawn, weight = bsdf.sample(mi.BSDFContext(), interaction([0.6, 0, 0.8]), 0.3, [0.4, 0.7])
    assert np.allclose(np.array(weight) * drawn.pdf, 0.3 / (0.8 + drawn.wo.z) * drawn.wo.z, rtol=1e-5)


@pytest.mark.parametrize("given, sentence", [
    ({}, "0 functions"),
    ({"material": "lambert", "file": "x.bsdf"}, "2 functions"),
    ({"material": "nix"}, "unknown model"),
    ({"material": "lambert", "roughness": 0.5}, "roughness"),
    ({"material": "lambert", "uniforms": "some"}, "uniforms .some. is none"),
    ({"material": "lambert", "member": "x"}, "member is one of a file"),
    ({"sampler": "nowhere.rfl"}, "nowhere.rfl"),
    ({"nested": {"type": "conductor"}}, "delta"),
    ({"nested": {"type": "roughdielectric"}}, "transmits"),
    ({"nested": {"type": "twosided", "inside": {"type": "diffuse"}}}, "from the back side"),
    ({"nested": {"type": "diffuse", "reflectance": {"type": "checkerboard"}}}, "vary over the surface"),
])
def test_bad_parameters(given, sentence):
    with pytest.raises(RuntimeError, match=sentence):
        load({"type": "reflectree", "cache": "none", **given})


def test_samplers_are_kept_and_found(tmp_path):
    mine = {"type": "reflectree", "cache": str(tmp_path), "nested": PRINCIPLED}
    load(mine)
    (path,) = tmp_path.iterdir()
    first = path.stat().st_mtime_ns
    load(mine)
    load({**mine, "nested": {**PRINCIPLED, "roughness": 0.61}})
    assert len(list(tmp_path.iterdir())) == 2 and path.stat().st_mtime_ns == first
    whole = path.read_bytes()
    path.write_bytes(whole[:-20])
    load(mine)  # built again, with a warning
    assert path.read_bytes() == whole
    with pytest.raises(RuntimeError, match="another BRDF"):
        load({"type": "reflectree", "sampler": str(path), "nested": {"type": "diffuse"}})


SCENE = """<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="3"/></integrator>
<sensor type="perspective"><float name="fov" value="30"/>
  <transform name="to_world"><lookat origin="0, 4, 1.5" target="0, 0, 0" up="0, 0, 1"/></transform>
  <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/><rfilter type="box"/></film>
</sensor>
<emitter type="constant"><spectrum name="radiance" value="0.3"/></emitter>
<shape type="sphere"><point name="center" x="3" y="3" z="3"/>
  <emitter type="area"><spectrum name="radiance" value="8"/></emitter></shape>
<shape type="sphere">{}</shape>
</scene>"""
INSIDE = '<bsdf type="roughconductor"><float name="alpha" value="{}"/></bsdf>'


def rendered(bsdf, seed, count=12, spp=64):
    scene = mi.load_string(SCENE.format(bsdf))
    pictures = np.stack([np.array(mi.render(scene, spp=spp, seed=seed + k)) for k in range(count)])
    return pictures.reshape(count, 6, 4, 6, 4, 3).mean(axis=(2, 4))


@pytest.mark.parametrize("variant", ["scalar_rgb", "scalar_spectral"])
def test_pictures_are_mitsubas(variant):
    mi.set_variant(variant)
    mi.set_log_level(mi.LogLevel.Error)
    mine = '<bsdf type="reflectree"><string name="cache" value="none"/>' + INSIDE + "</bsdf>"
    theirs, ours, other = (rendered(b, seed) for b, seed in
                           ((INSIDE.format(0.3), 1), (mine.format(0.3), 101), (mine.format(0.35), 201)))
    mi.set_variant("scalar_rgb")

    def mean_z2(a, b):
        return np.mean((a.mean(axis=0) - b.mean(axis=0)) ** 2 / (a.var(axis=0) + b.var(axis=0) + 1e-12) * (len(a) - 1))

    assert mean_z2(theirs, ours) < 2
    assert mean_z2(theirs, other) > 3  # the twin: another roughness


def test_the_program_mitsuba_has_it_without_python(plugin, tmp_path):
    program = pathlib.Path(mi.__file__).parent / "mitsuba"
    scene = tmp_path / "scene.xml"
    scene.write_text(SCENE.format('<bsdf type="reflectree"><string name="material" value="ggx:alpha=0.2"/></bsdf>'))
    done = subprocess.run([program, "-m", "scalar_rgb", "-a", plugin, "-o", tmp_path / "scene.exr", scene],
                          capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert np.isfinite(np.array(mi.Bitmap(str(tmp_path / "scene.exr")))).all()
