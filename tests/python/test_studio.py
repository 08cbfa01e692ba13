# SPDX-License-Identifier: Apache-2.0
"""rt.render and rt.compare, a diagnosis as a page; and what is said where the studio is missing."""

import sys

import numpy as np
import pytest

import reflectree as rt

try:
    import reflectree._studio_core  # noqa: F401
except ModuleNotFoundError:
    pytest.skip("built without the studio", allow_module_level=True)

FURNACE = """<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective">
    <float name="fov" value="30"/>
    <transform name="to_world"><lookat origin="0, -5, 0" target="0, 0, 0" up="0, 0, 1"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/><rfilter type="box"/></film>
  </sensor>
  <emitter type="constant"><rgb name="radiance" value="1, 2, 4"/></emitter>
  <shape type="sphere"><bsdf type="reflectree"><string name="material" value="$material"/></bsdf></shape>
</scene>
"""


@pytest.fixture
def furnace(tmp_path):
    (tmp_path / "furnace.xml").write_text(FURNACE)
    return tmp_path / "furnace.xml"


def test_a_furnace_is_white(furnace):
    """A ball that reflects all light cannot be seen in a furnace; one that reflects half of it can."""
    only_the_ball = {"sampler": "exact", "technique": "brdf", "spp": 4}
    white = rt.render(furnace, material="lambert:rho=1", **only_the_ball)
    assert white.shape == (16, 24, 3) and white.dtype == np.float32
    assert np.allclose(white, [1, 2, 4], rtol=1e-3)
    grey = rt.render(furnace, material="lambert:rho=0.5", **only_the_ball)
    assert np.allclose(grey[8, 12], [0.5, 1, 2], rtol=1e-3) and np.allclose(grey[0, 0], [1, 2, 4], rtol=1e-3)


def test_the_demo():
    small = {"spp": 2, "defines": {"size": 16}, "sampler": "cosine"}
    picture = rt.render(**small)
    assert picture.shape == (16, 16, 3) and np.isfinite(picture).all() and picture.min() >= 0 and picture.mean() > 0.1
    assert np.array_equal(picture, rt.render(**small, threads=1))
    assert not np.array_equal(picture, rt.render(**small, seed=2))
    assert picture[0].mean(axis=0)[2] > picture[0].mean(axis=0)[0]  # the sky is blue, and above


@pytest.mark.parametrize("options, match", [
    ({"scene": "no_such.xml"}, "no_such.xml"), ({"spp": 0}, "0 samples per pixel"), ({"spp": -3}, "no whole number"),
    ({"material": "gxg"}, "gxg"), ({"integrator": "magic"}, "say path, direct, recursive or photons"),
    ({"technique": "magic"}, "say one of balance,"), ({"sampler": "magic"}, "magic"), ({"defines": {"size": "big"}}, "big")])
def test_bad_scenes(options, match):
    with pytest.raises(rt.Error, match=match):
        rt.render(**{"spp": 1, "defines": {"size": 8}, **options})


def test_words_without_effect_are_told(furnace):
    furnace.write_text(FURNACE.replace('<float name="fov" value="30"/>', '<float name="fov" value="30"/>'
                                       '<float name="shutter_open" value="0"/>'))
    with pytest.warns(rt.RenderWarning, match="shutter_open"):
        rt.render(furnace, material="lambert", spp=1)


def test_progress_ends_it():
    class Enough(Exception):
        pass

    stages = []

    def stop(fraction, stage):
        stages.append(stage)
        if stage == "rendering":
            raise Enough

    with pytest.raises(Enough):
        rt.render(spp=64, sampler="cosine", progress=stop)
    assert stages[0] == "building"


@pytest.fixture(scope="module")
def compared():
    return rt.compare("ggx:alpha=0.3", samplers=["one-shot", "cosine"], theta_o=[np.radians(45)])


def test_compare(compared):
    assert [r["sampler"] for r in compared.rows] == ["one-shot", "cosine"]
    assert all(r["theta_o_deg"] == pytest.approx(45) and not r["biased"] for r in compared.rows)
    ours, cosine = compared.rows
    assert ours["target_variance"] < 0.1 < cosine["target_variance"]
    assert [s["kind"] for s in compared.scores] == ["ours", "general"]
    assert compared.scores[1]["efficiency"] < 1 and (compared.materials, compared.won) == (1, 1)
    text = str(compared)
    assert text.splitlines()[0].startswith("ggx:alpha=0.3") and "best of all general methods on 1 of 1" in text
    assert "2 samplers" in repr(compared) and "<table>" in compared._repr_html_()


@pytest.mark.parametrize("call, match", [
    (lambda: rt.compare(lambda wo, wi: wi[:, 2]), "a function of Python is no material to compare samplers on"),
    (lambda: rt.compare([]), "there is no material"), (lambda: rt.compare("lambert", samplers=["fast"]), "'fast'"),
    (lambda: rt.compare("lambert", samplers="exact"), r"write \['exact'\]"),
    (lambda: rt.compare("lambert", theta_o=[2.0]), "no elevations"), (lambda: rt.compare("gxg"), "gxg")])
def test_bad_comparisons(call, match):
    with pytest.raises(rt.Error, match=match):
        call()


def test_a_page(tmp_path):
    d = rt.doctor("lambert", sampler="cosine", effort="quick")
    page = d.to_html(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page
    assert "healthy" in page and "<svg" in page and "<script" not in page and 'src="http' not in page


def test_without_the_studio(monkeypatch):
    monkeypatch.setitem(sys.modules, "reflectree._studio_core", None)
    for call in (lambda: rt.render(spp=1), lambda: rt.compare("lambert")):
        with pytest.raises(rt.Error, match="REFLECTREE_PYTHON_STUDIO=ON"):
            call()
