# SPDX-License-Identifier: Apache-2.0
"""Shapes, types, outputs, seeds: what goes in, what comes out."""

import numpy as np
import pytest
from conftest import directions

import reflectree as rt


@pytest.mark.parametrize("lead", [(), (1,), (7,), (2, 3), (0,)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_shapes_and_types(gold, mine, lead, dtype):
    wo = directions(int(np.prod(lead))).reshape(lead + (3,)).astype(dtype)
    for sampler, value in ((gold, (3,)), (mine, ())):
        for drawn in (sampler.sample(wo, rng=1), sampler.sample_one_shot(wo, rng=1),
                      sampler.sample_one_shot(wo, np.full(lead + (2,), 0.3, dtype))):
            assert [a.shape for a in drawn] == [lead + (3,), lead, lead + value, lead]
            assert [np.asarray(a).dtype for a in drawn] == [dtype, dtype, dtype, np.bool_]
            assert np.all(drawn.valid)
        many = sampler.sample(wo, 5, rng=1)
        assert many.wi.shape == lead + (5, 3) and many.weight.shape == lead + (5,) + value
        assert sampler.pdf(wo, many.wi[..., 0, :]).dtype == dtype
        assert sampler.sample_n(wo, 4, rng=1).pdf.shape == lead + (4,)
        assert sampler.albedo(wo).shape == sampler.expected_trials(wo).shape == lead


def test_broadcasting(gold):
    wo, wi = directions(4)[:, None, :], directions(5, seed=2)
    table = gold.pdf(wo, wi)
    assert table.shape == (4, 5)
    assert np.array_equal(table[2], gold.pdf(np.broadcast_to(wo[2], (5, 3)), wi))
    f, pdf = gold.eval_pdf(wo, wi, mode="one-shot")
    assert f.shape == (4, 5, 3) and np.array_equal(pdf, gold.pdf(wo, wi, mode="one-shot"))
    assert np.array_equal(f, gold.eval(wo, wi))
    drawn = gold.sample_one_shot(wo, np.random.default_rng(1).random((5, 2)))
    assert drawn.wi.shape == (4, 5, 3)
    assert gold.sample(wo, 6, u=[0.5, 0.5]).pdf.shape == (4, 1, 6)


def test_strides_and_lists(gold):
    wo = directions(50)
    wide = np.zeros((50, 2, 6), np.float32)
    wide[:, 1, ::2] = wo
    backwards = wo[::-1].copy()[::-1]
    expected = gold.albedo(wo.astype(np.float32))
    assert np.array_equal(gold.albedo(wide[:, 1, ::2]), expected)
    assert np.array_equal(gold.albedo(np.asfortranarray(wo.astype(np.float32))), expected)
    assert np.array_equal(gold.albedo(backwards), gold.albedo(wo))
    assert gold.albedo([0, 0, 1]) == gold.albedo(np.array([0.0, 0.0, 1.0]))
    assert np.array_equal(gold.albedo(wo.astype(">f8")), gold.albedo(wo))


def test_out_is_written_to(gold):
    wo = directions(300)
    expected = gold.sample(wo, rng=5)
    out = rt.Samples(np.full((300, 3), np.nan), np.full(300, np.nan), np.full((300, 3), np.nan), np.zeros(300, bool))
    drawn = gold.sample(wo, rng=5, out=out)
    for new, given, wanted in zip(drawn, out, expected):
        assert new is given and np.array_equal(given, wanted)
    # Float32 into a strided view.
    room = np.full((300, 4), -1, np.float32)
    assert gold.pdf(wo, drawn.wi, out=room[:, 2]) is not room
    assert np.allclose(room[:, 2], drawn.pdf, rtol=1e-4) and np.all(room[:, [0, 1, 3]] == -1)


class _Tensor:
    """What another library's tensor shows of itself."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **how):
        return self.array.__dlpack__(**how)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_dlpack(gold):
    wo = directions(20)
    assert np.array_equal(gold.albedo(_Tensor(wo)), gold.albedo(wo))
    out = np.empty(20)
    gold.albedo(wo, out=_Tensor(out))
    assert np.array_equal(out, gold.albedo(wo))


def test_seeds(gold, mine):
    wo = directions(200)
    for sampler in (gold, mine):
        a, b = sampler.sample(wo, rng=3), sampler.sample(wo, rng=np.random.default_rng(3))
        assert all(np.array_equal(x, y) for x, y in zip(a, b))
        assert not np.array_equal(a.wi, sampler.sample(wo, rng=4).wi)
        rng = np.random.default_rng(3)
        first, second = sampler.sample(wo, rng=rng), sampler.sample(wo, rng=rng)
        assert np.array_equal(first.wi, a.wi) and not np.array_equal(second.wi, a.wi)
        assert not np.array_equal(sampler.sample(wo).wi, sampler.sample(wo).wi)
    assert gold.sample(wo, rng=np.random.Generator(np.random.MT19937(1))).valid.all()


def test_no_sample_is_zeros(gold, mine):
    wo = np.array([[0, 0, 1.0], [0, 0, -1], [1, 0, 0], [0.6, 0, 0.8]])
    for sampler in (gold, mine):
        for drawn in (sampler.sample(wo, rng=1), sampler.sample_one_shot(wo, rng=1),
                      sampler.sample_n(wo, 1, rng=1)):
            assert np.array_equal(np.ravel(drawn.valid), [True, False, False, True])
            assert all(np.all(a[1:3] == 0) for a in drawn)
        assert np.array_equal(sampler.albedo(wo) > 0, [True, False, False, True])
        assert np.all(sampler.eval([0, 0, 1], wo)[1:3] == 0) and np.all(sampler.pdf([0, 0, 1], wo)[1:3] == 0)


def test_pdf_weight_and_value_agree(gold, mine, pair):
    wo = directions(2000, lowest=0.1)
    for sampler in (gold, mine, pair):
        for mode, drawn in (("exact", sampler.sample(wo, rng=1)), ("one-shot", sampler.sample_one_shot(wo, rng=1)),
                            ("exact", sampler.sample_n(wo, 1, rng=1))):
            wi = drawn.wi.reshape(-1, 3)
            f, pdf = sampler.eval_pdf(wo, wi, mode=mode, cosine=True)
            assert np.allclose(pdf, drawn.pdf.ravel(), rtol=4e-3)  # float32 directions, a sharp lobe
            weight = f / (pdf if f.ndim == 1 else pdf[:, None])
            assert np.allclose(weight, drawn.weight.reshape(weight.shape), rtol=4e-3)
        assert np.allclose(np.linalg.norm(drawn.wi, axis=-1), 1, atol=1e-6)


def test_uniforms_and_back(gold):
    wo = directions(1000, lowest=0.2)
    u = np.random.default_rng(2).random((1000, 2))
    drawn = gold.sample_one_shot(wo, u)
    assert np.array_equal(drawn.wi, gold.sample_one_shot(wo, u, rng=9).wi)
    assert np.quantile(np.abs(gold.invert(wo, drawn.wi) - u), 0.99) < 1e-3
    assert np.all(np.isnan(gold.invert(wo, -drawn.wi)))
    # In exact mode uniforms choose the leaf of the first trial: most directions of one u lie close together.
    viewer = np.broadcast_to(rt.direction(0.6, 0.0), (400, 3))

    def spread_of_half(drawn):
        return np.subtract(*np.quantile(drawn.wi[:, 0], [0.75, 0.25]))

    together = [spread_of_half(gold.sample(viewer, u=np.full((400, 2), x), rng=1)) for x in np.linspace(0.1, 0.9, 9)]
    assert np.median(together) < 0.7 * spread_of_half(gold.sample(viewer, rng=1))
