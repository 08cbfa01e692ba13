# SPDX-License-Identifier: Apache-2.0
"""mypy accepts the package, strictly, and a user's program; a wrong program it does not. Names are documented."""

import inspect
import pathlib
import subprocess
import sys

import reflectree as rt

PACKAGE = pathlib.Path(rt.__file__).parent

GOOD = """
import numpy as np
import reflectree as rt

sampler = rt.Sampler(lambda wo, wi: np.asarray(wi[:, 2]), progress=True)
drawn: rt.Samples = sampler.sample([0, 0, 1], 5, rng=1)
total: float = float(drawn.weight.sum()) + float(sampler.build_seconds or 0)
wo, wi = rt.from_angles(0.1, 0.2, 0.3, azimuth="forward")
rt.plot.lobe("lambert", wo)
report: rt.VerifyReport = rt.verify(sampler, effort=0.1, progress=lambda fraction, stage: None)
names = [check.name for check in report.checks if not check.passed]
diagnosis = rt.doctor(eval=lambda wo, wi: wi[:, 2], sample=lambda wo, rng: (wo, wo[:, 2]), effort="quick")
text: str = diagnosis.to_json() + repr(diagnosis.faults[0].evidence)
picture: np.ndarray = rt.render(spp=1, defines={"size": 8})
table: rt.Comparison = rt.compare(["lambert", "plastic"], theta_o=[0.1])
"""
BAD = """
import reflectree as rt

rt.from_angles(0.1, 0.2, 0.3)
rt.material(3)
rt.material("lambert").sample([0, 0, 1])
rt.verify(sampler="lambert", effort="much")
"""


def mypy(tmp_path, *arguments):
    return subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path / "cache"), *arguments],
                          capture_output=True, text=True, cwd=PACKAGE.parent)


def test_the_package_is_strict(tmp_path):
    result = mypy(tmp_path, "--strict", "-p", "reflectree")
    assert result.returncode == 0, result.stdout


def test_programs(tmp_path):
    (tmp_path / "good.py").write_text(GOOD)
    (tmp_path / "bad.py").write_text(BAD)
    good = mypy(tmp_path, str(tmp_path / "good.py"))
    assert good.returncode == 0, good.stdout
    bad = mypy(tmp_path, str(tmp_path / "bad.py"))
    assert [bad.stdout.count(f"bad.py:{line}: error") for line in (4, 5, 6, 7)] == [1, 1, 1, 1], bad.stdout


def test_every_name_is_documented():
    for name in rt.__all__:
        thing = getattr(rt, name)
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert inspect.getdoc(value), f"{name}.{member}"


def test_the_stub_of_the_core_is_complete():
    stub = (PACKAGE / "_core.pyi").read_text()
    core = sys.modules["reflectree._core"]
    for thing in (core, core.Brdf, core.Sampler):
        for name in vars(thing):
            if not name.startswith("_"):
                assert f" {name}(" in stub or f"{name}:" in stub or f"class {name}" in stub, name
