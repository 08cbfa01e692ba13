# SPDX-License-Identifier: Apache-2.0
"""rt.doctor: sound triples of NumPy functions, samplers of ours and competitors are healthy; faults are named."""

import json
import os
import pathlib
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from conftest import ggx

import reflectree as rt

ALPHA = 0.2
UP = np.array([0.0, 0.0, 1.0])


def half_pdf(wo, wi):
    """Of ggx's half vectors, carried over to wi."""
    wh = wo + wi
    wh /= np.linalg.norm(wh, axis=1, keepdims=True)
    d = ALPHA**2 / (np.pi * (wh[:, 2] ** 2 * (ALPHA**2 - 1) + 1) ** 2)
    return d * wh[:, 2] / (4 * (wo * wh).sum(axis=1))


def draw(wo, rng):
    """Directions and weights of a GGX sampled by its normals (Walter et al. 2007); zeros below the surface."""
    u, phi = rng.random(len(wo)), 2 * np.pi * rng.random(len(wo))
    tan = ALPHA * np.sqrt(u / (1 - u))
    wh = np.stack([tan * np.cos(phi), tan * np.sin(phi), np.ones(len(wo))], axis=1)
    wh /= np.linalg.norm(wh, axis=1, keepdims=True)
    cosine = (wo * wh).sum(axis=1)
    wi = 2 * cosine[:, None] * wh - wo
    wi /= np.linalg.norm(wi, axis=1, keepdims=True)
    pdf, weight = np.zeros(len(wo)), np.zeros(len(wo))
    good = (cosine > 0) & (wi[:, 2] > 0)
    pdf[good] = half_pdf(wo[good], wi[good])
    weight[good] = ggx(wo[good], wi[good]) * wi[good, 2] / pdf[good]
    wi[~good] = 0
    return wi, pdf, weight


def cosine_lobe(wo, rng):
    """For Lambert: rho is 0.5, every weight is 0.5."""
    r, phi = np.sqrt(rng.random(len(wo))), 2 * np.pi * rng.random(len(wo))
    wi = np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r * r)], axis=1)
    return wi, wi[:, 2] / np.pi, np.full(len(wo), 0.5)


def lambert(wo, wi):
    return np.full(len(wo), 0.5 / np.pi)


def cosine_pdf(wo, wi):
    return wi[:, 2] / np.pi


@pytest.fixture(scope="module")
def healthy():
    return rt.doctor(eval=ggx, sample=draw, pdf=half_pdf, effort="quick")


def test_sound_functions(healthy):
    assert healthy and healthy.healthy and not healthy.faults, str(healthy)
    assert "eval returns f, without cosine" in healthy.conventions[0]
    assert {"chi_square_pdf", "light", "pdf_agrees", "weight_agrees", "pdf_integral"} <= {c.name for c in healthy.checks}
    assert any(f.name == "relative_variance" for f in healthy.figures)


def test_calls_come_in_batches(healthy):
    assert healthy.directions >= 1e4 * healthy.calls, (healthy.calls, healthy.directions)


@pytest.mark.parametrize("functions, cause", [
    ({"pdf": lambda wo, wi: np.full(len(wo), 1 / np.pi)}, "projected_solid_angle"),
    ({"sample": lambda wo, rng: (lambda wi, p, w: (wi, p, w * wi[:, 2]))(*cosine_lobe(wo, rng))}, "weight_cosine_twice"),
    ({"eval": lambda wo, wi: np.where(wi[:, 2] < 0.1, -0.01, 0.5 / np.pi)}, "negative"),
])
def test_faults_are_named(functions, cause):
    """The same triple is healthy without the fault: test_forms_of_answers."""
    d = rt.doctor(**{"eval": lambert, "sample": cosine_lobe, "pdf": cosine_pdf, **functions}, eval_returns="f",
                  sample_returns="weight", effort="quick")
    assert not d and cause in [f.cause for f in d.faults], str(d)
    assert cause in rt.causes()


def test_the_jacobian_is_missed():
    def pdf(wo, wi):
        wh = wo + wi
        wh /= np.linalg.norm(wh, axis=1, keepdims=True)
        return half_pdf(wo, wi) * 4 * (wo * wh).sum(axis=1)

    d = rt.doctor(eval=ggx, sample=draw, pdf=pdf, effort="quick")
    assert [f.cause for f in d.faults][0] == "half_vector_density", str(d)
    e = d.faults[0].evidence
    assert e.wo.shape == (3,) and e.found == pytest.approx(pdf(e.wo[None], e.wi[None])[0], rel=1e-3)


@pytest.mark.parametrize("sample, options", [
    (lambda wo, rng: cosine_lobe(wo, rng)[:2], {}),
    (lambda wo, rng: cosine_lobe(wo, rng)[0], {}),
    (lambda wo, rng: rt.Samples(*(a.astype(np.float32) for a in cosine_lobe(wo, rng)), np.ones(len(wo), bool)),
     {"eval_returns": "f", "sample_returns": "weight"}),
])
def test_forms_of_answers(sample, options):
    d = rt.doctor(eval=lambert, sample=sample, pdf=cosine_pdf, effort="quick", name="mine", **options)
    assert d and d.subject == "mine", str(d)


def test_other_readings():
    """Channels, f with the cosine, and a value in the place of the weight."""
    def eval_cos(wo, wi):
        return lambert(wo, wi)[:, None] * wi[:, 2:] * [1, 0.5, 0.2]

    def sample(wo, rng):
        wi, p, _ = cosine_lobe(wo, rng)
        return wi, p, eval_cos(wo, wi)

    d = rt.doctor(eval=eval_cos, sample=sample, pdf=cosine_pdf, effort="quick")
    assert d, str(d)
    assert "f cos_theta_i (detected" in d.conventions[0] and "f cos_theta_i (detected" in d.conventions[1]


def test_samplers_of_ours(gold, mine):
    for sampler, mode in ((gold, "one-shot-monotone"), (mine, "exact")):
        d = rt.doctor(sampler, sampler=mode, effort="quick")
        assert d and d.subject == f"{mode} of {sampler.brdf.name}", str(d)


def test_competitors():
    d = rt.doctor("lambert", sampler="uniform", effort="quick")
    assert d, str(d)
    with pytest.raises(rt.Error, match="does not serve this material"):
        rt.doctor("retro_reflector", sampler="textbook", effort="quick")
    assert {"exact", "proxy", "paper"} <= set(rt.samplers())


def test_a_sampler_of_another_function():
    """The table was built for one f, and f has changed since."""
    state = {"scale": 0.3}
    sampler = rt.Sampler(lambda wo, wi: state["scale"] * (1 + 0.5 * wi[:, 2]))
    state["scale"] = 0.27
    d = rt.doctor(sampler, effort="quick")
    assert not d, str(d)


def test_json_is_that_of_the_command_line():
    program = pathlib.Path(rt.__file__).parents[2] / "bin" / "reflectree"
    if not program.exists():
        pytest.skip("the command line was not built")
    done = subprocess.run([program, "doctor", "lambert", "--sampler", "uniform", "--effort", "quick", "--json", "-q"],
                          capture_output=True, text=True)
    theirs, mine = json.loads(done.stdout), json.loads(rt.doctor("lambert", sampler="uniform", effort="quick").to_json())
    for d in (theirs, mine):
        d["figures"] = [f for f in d["figures"] if "nanoseconds" not in f["name"] and "our_" not in f["name"]]
        for f in d["figures"] + d["checks"]:
            for key in ("value", "statistic", "p_value", "threshold"):
                if key in f:
                    f[key] = pytest.approx(f[key], rel=1e-12)
        d["subject"] = d["subject"].split(":")[0]
    assert theirs == mine


def test_what_it_tells(healthy, tmp_path):
    ill = rt.doctor(eval=lambert, sample=cosine_lobe, pdf=lambda wo, wi: np.full(len(wo), np.nan), name="<ill>",
                    effort="quick")
    assert "NaN or infinite" in repr(ill) and "FAULT" in str(ill) and "&lt;ill&gt;" in ill._repr_html_()
    assert "no fault was found" in repr(healthy)
    ill.to_json(tmp_path / "ill.json")
    read = json.loads((tmp_path / "ill.json").read_text())
    assert read["healthy"] is False and read["command"] == "doctor"
    with pytest.raises(rt.Error, match="cannot be written"):
        healthy.to_json(tmp_path / "no" / "folder.json")
    assert os.listdir(tmp_path) == ["ill.json"]


def twice(wo, wi):
    return np.full(2 * len(wo), 0.1)


@pytest.mark.parametrize("functions, match", [
    ({}, "one subject is wanted"),
    ({"subject": "lambert", "eval": lambert}, "one subject is wanted"),
    ({"eval": lambert}, "sample: there is none"),
    ({"sample": cosine_lobe}, "eval: there is none"),
    ({"eval": 3, "sample": cosine_lobe}, "eval: a int cannot be called"),
    ({"eval": twice, "sample": cosine_lobe}, r"eval: it returned the shape \(2042,\) for n = 1021"),
    ({"eval": lambda wo, wi: "red", "sample": cosine_lobe}, "returned an array of type"),
    ({"eval": lambert, "sample": cosine_lobe, "pdf": twice}, r"pdf: it returned the shape"),
    ({"eval": lambert, "sample": cosine_lobe, "pdf": lambda wo, wi: np.zeros((len(wo), 2))}, r"return the shape \(n,\)"),
    ({"eval": lambert, "sample": lambda wo, rng: 3}, "sample: it returned a int"),
    ({"eval": lambert, "sample": lambda wo, rng: (wo,)}, "neither it nor a function pdf gives the density"),
    ({"eval": lambert, "sample": lambda wo, rng: (wo[:, :2], wo[:, 0], wo[:, 0])}, r"directions wi of the shape \(n, 3\)"),
    ({"eval": lambert, "sample": lambda wo, rng: (wo, wo[:, 0], wo)}, r"weights of the shape \(n, 1\)"),
    ({"eval": lambert, "sample": lambda wo, rng: (wo, wo[:, 2]), "sample_returns": "weight"}, "it returns no weight"),
    ({"eval": lambert, "sample": cosine_lobe, "effort": "great"}, "say quick, default or thorough"),
    ({"eval": lambert, "sample": cosine_lobe, "eval_returns": "g"}, "say f, f_cos or detect"),
    ({"eval": lambert, "sample": cosine_lobe, "sample_returns": "g"}, "say weight, f_cos, f, none or detect"),
    ({"subject": "lambert", "sampler": "fast"}, "no sampler 'fast'; choose of exact,"),
    ({"subject": 3}, "no reflectance function"),
    ({"subject": "lambert", "seed": "one"}, "no whole number"),
])
def test_bad_input(functions, match):
    with pytest.raises(rt.Error, match=match):
        rt.doctor(**functions)


def test_functions_that_raise_or_change():
    calls = {"n": 0}

    def tired(wo, wi):
        calls["n"] += 1
        if calls["n"] > 6:
            raise RuntimeError("out of paint")
        return cosine_pdf(wo, wi)

    with pytest.raises(RuntimeError, match="out of paint"):
        rt.doctor(eval=lambert, sample=cosine_lobe, pdf=tired, effort="quick")
    with pytest.raises(rt.Error, match="one row for each direction"):
        rt.doctor(eval=lambda wo, wi: lambert(wo, wi)[:1021], sample=cosine_lobe, pdf=cosine_pdf, effort="quick")


def test_ctrl_c_ends_it():
    program = textwrap.dedent("""
        import os, signal, threading
        import reflectree as rt
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        try:
            rt.doctor("lambert", sampler="cosine", effort="thorough")
        except KeyboardInterrupt:
            print("interrupted")
    """)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.stdout == "interrupted\n", done.stderr
