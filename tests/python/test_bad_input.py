# SPDX-License-Identifier: Apache-2.0
"""Each bad input is an exception with what, where and how, and leaves everything usable."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import directions, ggx

import reflectree as rt

UP = np.array([0.0, 0.0, 1.0])


def refuses(match, call):
    with pytest.raises(rt.Error, match=match) as caught:
        call()
    error = caught.value
    assert error.what and error.where and error.how
    assert str(error) == f"{error.where}: {error.what}; {error.how}"


@pytest.mark.parametrize("wo, match", [
    ([[0, 0, 1], [0, np.nan, 1]], r"wo\[1\]: \(0, nan, 1\) is no direction"),
    ([0, 0, np.inf], r"wo: .* is no direction"),
    ([[[0, 0, 1], [0, 0, 2]]], r"wo\[0, 1\]: \(0, 0, 2\) is not of unit length; divide it by its length"),
    ([0, 0, 0], "not of unit length"),
    ([0, 1], r"its shape is \(2,\)"),
    (3.0, r"its shape is \(\)"),
    (np.zeros((3, 5)), r"give it the shape \(\.\.\., 3\)"),
    (["a", "b", "c"], "its type is"),
    (np.zeros(3, complex), "complex"),
    (np.array([0, 0, 1], np.float16), "float16"),
    ([[0, 0, 1], [0, 0]], "no array"),
    (None, "its type is object"),
    (np.ma.array([[0.0, 0, 1], [0, 0, 1]], mask=[[0, 0, 0], [1, 1, 1]]), "it has masked entries"),
])
def test_directions(gold, wo, match):
    for call in (lambda: gold.sample(wo), lambda: gold.sample_one_shot(wo), lambda: gold.sample_n(wo, 3),
                 lambda: gold.albedo(wo), lambda: gold.pdf(wo, UP), lambda: gold.eval(wo, UP)):
        refuses(match, call)
    refuses(match.replace("wo", "wi"), lambda: gold.pdf(UP, wo))


@pytest.mark.parametrize("call, match", [
    (lambda s: s.sample(directions(3), u=np.zeros((4, 2))), r"wo and u: their leading shapes \(3,\) and \(4,\)"),
    (lambda s: s.sample(UP, u=[0.5, 1.5]), r"u: \(0\.5, 1\.5\) is not in the unit square"),
    (lambda s: s.sample_one_shot(UP, [np.nan, 0]), "not in the unit square"),
    (lambda s: s.sample_one_shot(UP, [0.5]), r"u: its shape is \(1,\)"),
    (lambda s: s.sample(UP, n=-1), "no number of directions"),
    (lambda s: s.sample(UP, n=2.5), "2.5 is no number of directions"),
    (lambda s: s.sample(UP, n=2**62), "fit into no memory"),
    (lambda s: s.sample(UP, rng="seed"), "no source of random numbers"),
    (lambda s: s.sample(UP, rng=-1), "no source of random numbers"),
    (lambda s: s.pdf(UP, UP, mode="quick"), "'quick' is no mode; say 'exact' or 'one-shot'"),
    (lambda s: s.pdf(directions(2), directions(3)), "cannot be broadcast together"),
    (lambda s: s.albedo(UP, out=np.empty(2)), r"out: its shape is \(2,\); the result has the shape \(\)"),
    (lambda s: s.albedo(directions(2), out=np.empty(2, int)), "make it float32 or float64"),
    (lambda s: s.albedo(directions(2), out=[0, 0]), "a list cannot be written to"),
    (lambda s: s.albedo(directions(2), out=np.broadcast_to(0.0, 2)), "read-only"),
    (lambda s: s.sample(directions(2), out=(np.empty((2, 3)),)), "it has 1 arrays"),
])
def test_arguments(gold, call, match):
    refuses(match, lambda: call(gold))


def test_an_output_that_is_an_input(gold):
    wo = directions(4)
    drawn = gold.sample(wo)
    refuses("shares memory with an argument", lambda: gold.sample(wo, out=drawn._replace(wi=wo)))
    refuses("out.weight: it shares memory with another field", lambda: gold.sample(wo, out=drawn._replace(weight=drawn.wi)))
    columns = np.empty((4, 7))  # of one array, side by side
    parts = rt.Samples(columns[:, :3], columns[:, 3], columns[:, 4:], drawn.valid)
    assert np.array_equal(gold.sample(wo, rng=1, out=parts).wi, gold.sample(wo, rng=1).wi)


def test_tensors_of_another_device(gold):
    class Tensor:
        def __dlpack__(self, **options):
            raise BufferError("it is on a GPU")

        def __dlpack_device__(self):
            return 2, 0

    refuses("DLPack gives no NumPy array", lambda: gold.sample(Tensor()))
    refuses("out: DLPack gives no NumPy array", lambda: gold.albedo(UP, out=Tensor()))


@pytest.mark.parametrize("text, match", [
    ("gxg:alpha=0.1", "ggx"), ("ggx:alpha=7", "alpha"), ("no_such.bsdf", "no_such.bsdf"), ("", "material")])
def test_materials(text, match):
    refuses(match, lambda: rt.material(text))
    refuses(match, lambda: rt.Sampler(text))


@pytest.mark.parametrize("text, match", [(3, "a int is no text"), (None, "is no text"), ("ggx\udcff", "none of Unicode")])
def test_what_is_no_text(text, match):
    refuses(match, lambda: rt.material(text))


def test_what_is_no_path(gold, tmp_path):
    path = tmp_path / "gold.rfl"
    gold.save(path)
    closed = open(path, "rb")
    closed.close()
    with open(path, "rb") as opened:
        for what in (closed, opened, 3, None, b"gold.rfl"):
            for call in (rt.load, rt.members, rt.load_sampler, rt.load_family, gold.save):
                refuses(r"path: a \w+ is no path; give a str or a pathlib.Path", lambda: call(what))
    refuses("none of Unicode", lambda: rt.load_sampler("\udcff.rfl"))


def test_what_is_no_function():
    refuses("int is no reflectance function", lambda: rt.Sampler(3))
    refuses("cannot be called", lambda: rt.function(3, name="three"))
    refuses("is no type for directions", lambda: rt.function(ggx, dtype=np.int32))


@pytest.mark.parametrize("f, match", [
    (lambda wo, wi: 0.3, r"it returned the shape \(\) for n = 1021 .* return the shape \(n,\) or \(n, channels\)"),
    (lambda wo, wi: np.zeros(len(wo) + 1), r"the shape \(1022,\)"),
    (lambda wo, wi: np.zeros((3, len(wo))), r"the shape \(3, 1021\)"),
    (lambda wo, wi: np.zeros((len(wo), 0)), "0 channels"),
    (lambda wo, wi: np.zeros((len(wo), 257)), "257 channels"),
    (lambda wo, wi: np.zeros((len(wo), 2, 2)), "shape"),
    (lambda wo, wi: None, "it returned a NoneType instead of an array of numbers"),
    (lambda wo, wi: np.full(len(wo), 1j), "instead of an array of numbers"),
    (lambda wo, wi: np.full(len(wo), -0.1), r"<lambda> at wo = \(.*\), wi = \(.*\): it returned -0.1"),
    (lambda wo, wi: np.full(len(wo), np.nan), "it returned nan"),
    (lambda wo, wi: np.full(len(wo), 1e60), "it returned 1e\\+60"),
    (lambda wo, wi: np.ma.array(wi[:, 2], mask=wi[:, 2] < 0.5), "it returned nan"),
])
def test_results_of_functions(f, match):
    refuses(match, lambda: rt.function(f))


@pytest.mark.parametrize("kind", [list, np.ma.array, lambda a: a.astype(">f8"), lambda a: a.astype(">i4"),
                                  lambda a: a.astype(np.float16), lambda a: a.astype(np.longdouble)])
def test_results_that_are_as_good(kind):
    assert rt.function(lambda wo, wi: kind(np.ones(len(wo)))).eval(UP, UP) == 1


def after(calls, good, bad):
    """A function that turns bad after some calls."""
    state = {"calls": 0}

    def f(wo, wi):
        state["calls"] += 1
        return (good if state["calls"] <= calls else bad)(wo, wi)

    return f


def lambert(wo, wi):
    return np.full(len(wo), 0.3)


def raising(wo, wi):
    raise RuntimeError("out of paint")


def test_a_function_that_raises():
    with pytest.raises(RuntimeError, match="out of paint"):
        rt.Sampler(raising)
    with pytest.raises(RuntimeError, match="out of paint"):
        rt.Sampler(after(20, lambert, raising))
    state = {"angry": False}
    sampler = rt.Sampler(lambda wo, wi: raising(wo, wi) if state["angry"] else lambert(wo, wi))
    state["angry"] = True
    for call in (sampler.sample, lambda wo: sampler.pdf(wo, UP), lambda wo: sampler.sample_n(wo, 5)):
        with pytest.raises(RuntimeError, match="out of paint") as caught:
            call(UP)
        assert caught.traceback[-1].name == "raising"
    state["angry"] = False
    assert sampler.sample(UP).valid


def test_a_function_that_changes_its_mind():
    refuses("the shape", lambda: rt.Sampler(after(3, lambert, lambda wo, wi: np.full((len(wo), 2), 0.3))))
    refuses("it returned -1", lambda: rt.Sampler(after(9, lambert, lambda wo, wi: np.full(len(wo), -1.0))))
    refuses("different values", lambda: rt.Sampler(lambda wo, wi: np.random.random(len(wo))))
    noisy = {"noise": 0.0}
    sampler = rt.Sampler(lambda wo, wi: np.full(len(wo), 0.3 + noisy["noise"]))
    noisy["noise"] = np.nan
    refuses("it returned nan", lambda: sampler.sample(directions(10)))


def test_a_function_that_keeps_or_changes_its_arguments():
    kept = []

    def keeping(wo, wi):
        kept.append((wo, wi, wo.copy(), wi.copy()))
        return np.abs(wi[:, 2]) + 0.1

    def changing(wo, wi):
        value = np.abs(wi[:, 2]) + 0.1
        wo[:] = 7
        wi[:] = 8
        return value

    a, b = rt.Sampler(keeping), rt.Sampler(changing)
    assert a._core.to_bytes() == b._core.to_bytes()
    assert all(np.array_equal(wo, wo2) and np.array_equal(wi, wi2) for wo, wi, wo2, wi2 in kept)


@pytest.mark.parametrize("options, match", [
    ({"target": "red"}, "no target is called 'red'"), ({"target": 3}, "channel 3 of 3"),
    ({"expected_trials": 0.5}, "trials"), ({"albedo_error": -1}, "albedo"), ({"threads": -1}, "threads"),
    ({"progress": 3}, "cannot be called"), ({"expected_trials": "x"}, "'x' is no number"), ({"seed": -1}, "seed: -1 is no"),
    ({"seed": 1.5}, "seed: 1.5 is no"), ({"max_evaluations": 2.5}, "max_evaluations: 2.5 is no"),
    ({"one_shot_variance": []}, "is no number"), ({"threads": 10**6}, "1000000 threads are too many"),
    ({"threads": 0.5}, "threads: 0.5 is no"), ({"target": "\udcff"}, "none of Unicode"), ({"target": 2**40}, "channel")])
def test_options(options, match):
    refuses(match, lambda: rt.Sampler("lambert", **options))
    if "channel 3" not in match:
        refuses(match, lambda: rt.FamilySampler("ggx:alpha=0.3..0.4", **options))


@pytest.mark.skipif("REFLECTREE_SANITIZED" in os.environ, reason="AddressSanitizer needs terabytes of addresses")
def test_threads_that_the_system_does_not_start():
    """Under a limit of memory, since root may start any number: 1000 stacks need more than is left."""
    code = """
import pathlib, resource, reflectree as rt
used = int(pathlib.Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 500_000_000,) * 2)
try:
    rt.Sampler("lambert", threads=1000)
except rt.Error as error:
    print(error)
rt.Sampler("lambert", threads=2)
"""
    done = subprocess.run([sys.executable, "-X", "dev", "-W", "error", "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert re.fullmatch(r"threads: the system starts only \d+ of 1000; ask for fewer\n", done.stdout)


def test_files(gold, mine, tmp_path):
    missing, noise, good = tmp_path / "none.rfl", tmp_path / "noise.rfl", tmp_path / "mine.rfl"
    noise.write_bytes(b"\x00" * 100)
    refuses("none.rfl", lambda: rt.load_sampler(missing))
    refuses("noise.rfl", lambda: rt.load_sampler(noise))
    refuses("noise.rfl", lambda: rt.load(noise))
    refuses(str(tmp_path), lambda: rt.load(tmp_path))
    mine.save(good)
    refuses("give the function, too", lambda: rt.load_sampler(good))
    refuses("built for another BRDF", lambda: rt.load_sampler(good, lambda wo, wi: ggx(wo, wi, alpha=0.21)))
    for end in (9, 100, 2000):
        (tmp_path / "cut.rfl").write_bytes(good.read_bytes()[:end])
        refuses("cut.rfl", lambda: rt.load_sampler(tmp_path / "cut.rfl", ggx))
    refuses("folder.rfl", lambda: gold.save(tmp_path / "no" / "folder.rfl"))


def test_the_message_is_one_line(gold):
    with pytest.raises(rt.Error) as caught:
        rt.material("ggx:alpha=\n\x07")
    assert not re.search(r"[\x00-\x1f]", str(caught.value))
