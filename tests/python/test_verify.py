# SPDX-License-Identifier: Apache-2.0
"""rt.verify: sound samplers pass, of materials, files and functions; each wrong one has a check that fails."""

import json
import subprocess
import sys
import textwrap

import numpy as np
import pytest
from conftest import ggx

import reflectree as rt

WAYS = {"sample", "sample_n", "sample_one_shot", "sample_one_shot(u)", "sample_n(mode='one-shot')"}


class Spoiled:
    """A function that turns into another once it is built: its sampler keeps the tables of the first."""

    def __init__(self, good, bad):
        self.f, self.bad = good, bad

    def __call__(self, wo, wi):
        return self.f(wo, wi)

    def spoil(self):
        self.f = self.bad


def lambert(wo, wi):
    return np.full(len(wo), 0.3)


@pytest.fixture(scope="module")
def report(gold):
    return rt.verify(gold, effort=0.01)


def test_a_sound_sampler(report):
    assert report and report.passed and not report.failed, repr(report)
    assert {c.way for c in report.checks} >= WAYS
    assert {"chi_square", "weight_agrees", "overshoot_mass", "albedo_table", "round_trip"} <= {c.name for c in report.checks}
    assert all(0 <= c.p_value <= 1 and c.sentence for c in report.checks)
    assert {f.name for f in report.figures} >= {"largest_albedo", "one_shot_relative_variance"}


def test_what_it_tells(report):
    n = len(report.checks)
    assert repr(report).startswith(f"<reflectree.VerifyReport: {n} of {n} checks of ggx:alpha=0.2")
    assert str(report).count("\n") >= n and "pass  chi_square" in str(report)
    assert "chi_square" in report._repr_html_() and "<script" not in report._repr_html_()
    assert json.loads(report.to_json())["checks"][0] == report.checks[0]._asdict()


def test_a_file_is_as_good_and_threads_do_not_matter(report, gold, tmp_path):
    gold.save(tmp_path / "gold.rfl")
    again = rt.verify(rt.load_sampler(tmp_path / "gold.rfl"), effort=0.01, threads=1)
    assert again.checks == report.checks


def test_a_function_of_one_thread():
    import threading

    seen = set()

    def f(wo, wi):
        seen.add(threading.get_ident())
        return lambert(wo, wi)

    report = rt.verify(f, effort=0.01)
    assert report, repr(report)
    assert seen == {threading.get_ident()}


# The bad function keeps below the bounds of the good one, so that sampling goes on; what is drawn is another thing.
def test_a_wrong_sampler():
    f = Spoiled(lambert, lambda wo, wi: 0.3 - 0.02 * (wi[:, 0] > 0))
    sampler = rt.Sampler(f)
    f.spoil()
    report = rt.verify(sampler, effort=0.01)
    assert not report
    assert {c.name for c in report.failed} >= {"albedo_table", "isotropy", "mean_weight"}, repr(report)
    assert all(c.verdict == "FAIL" and c.statistic > c.threshold for c in report.failed)
    assert "FAIL  mean_weight" in str(report) and "mean_weight" in repr(report)


def test_bad_input(gold):
    for call, match in ((lambda: rt.verify(gold, effort=0), "is no effort; give a factor from 0.01"),
                        (lambda: rt.verify(gold, effort=np.nan), "is no effort"),
                        (lambda: rt.verify(gold, effort="much"), "is no number"),
                        (lambda: rt.verify(gold, seed=-1), "no whole number"),
                        (lambda: rt.verify(gold, threads=1.5), "no whole number"),
                        (lambda: rt.verify(gold, progress=3), "cannot be called"),
                        (lambda: rt.verify(3), "no reflectance function"),
                        (lambda: rt.verify("gxg"), "gxg")):
        with pytest.raises(rt.Error, match=match):
            call()


def test_without_judges(gold, monkeypatch):
    monkeypatch.setattr("reflectree._core.has_judges", False)
    for call in (lambda: rt.verify(gold), lambda: rt.doctor(gold), rt.causes, rt.samplers):
        with pytest.raises(rt.Error, match="libboost-dev libeigen3-dev"):
            call()


def test_a_function_that_raises():
    def raising(wo, wi):
        raise RuntimeError("out of paint")

    f = Spoiled(lambert, raising)
    sampler = rt.Sampler(f)
    f.spoil()
    with pytest.raises(RuntimeError, match="out of paint"):
        rt.verify(sampler, effort=0.01)


def test_progress_ends_it(gold):
    told = []

    class Enough(Exception):
        pass

    def stop(fraction, stage):
        told.append((fraction, stage))
        if fraction > 0:
            raise Enough

    with pytest.raises(Enough):
        rt.verify(gold, effort=0.02, progress=stop)
    assert told[0] == (0, "checking")


def test_ctrl_c_ends_it():
    program = textwrap.dedent("""
        import os, signal, threading
        import reflectree as rt
        sampler = rt.Sampler("lambert")
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        try:
            rt.verify(sampler, effort=100)
        except KeyboardInterrupt:
            print("interrupted")
    """)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.stdout == "interrupted\n", done.stderr
