# SPDX-License-Identifier: Apache-2.0
"""`pip install .`: wheel and source distribution in environments of their own, and a smoke test of each.

What builds is taken from the environment that runs the tests, so that no network is needed.
"""

import os
import pathlib
import subprocess
import sys
import tarfile
import venv

import pytest

SOURCE = pathlib.Path(os.environ["REFLECTREE_SOURCE"])
SMOKE = """
import numpy as np, pathlib, sys
import reflectree as rt
assert pathlib.Path(rt.__file__).is_relative_to(sys.prefix), rt.__file__
sampler = rt.Sampler(lambda wo, wi: 0.3 / (wo[:, 2] + wi[:, 2]))
drawn = sampler.sample(rt.direction(0.8, 0.0), n=100_000, rng=1)
assert 0.48 < np.mean(drawn.weight * (drawn.wi[:, 2] > 0.5)) < 0.49
for call, hint in ((lambda: rt.verify("lambert", effort=0.01), "libboost-dev"),
                   (lambda: rt.render(spp=1, defines={"size": 8}) + 1 > 0, "REFLECTREE_PYTHON_STUDIO=ON")):
    try:  # each part is whole, or says what is missing
        assert np.all(call())
    except rt.Error as error:
        assert hint in str(error), error
print(rt.__version__)
"""


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    return done.stdout


@pytest.fixture(scope="module")
def environment():
    """Without PYTHONPATH: what is imported is what was installed."""
    return {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}


@pytest.fixture(scope="module")
def distributions(tmp_path_factory, environment):
    """Built from the source distribution, as those are who install from an index. The folder of objects is kept
    beside the build, so that a second run compiles nothing."""
    where = tmp_path_factory.mktemp("dist")
    backend = [sys.executable, "-c", "import sys; from scikit_build_core import build; build.build_sdist(sys.argv[1])"]
    run(*backend, str(where), cwd=SOURCE, env=environment)
    (sdist,) = where.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = archive.getnames()
        archive.extractall(where / "source", **({"filter": "data"} if hasattr(tarfile, "data_filter") else {}))
    (source,) = (where / "source").iterdir()
    kept = pathlib.Path.cwd() / "pip-objects"
    run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "--wheel-dir", str(where),
        f"--config-settings=build-dir={kept}", str(source), env=environment)
    (wheel,) = where.glob("*.whl")
    return {"sdist": sdist, "names": names, "wheel": wheel}


def test_the_source_distribution_is_whole(distributions):
    names = {name.split("/", 1)[1] for name in distributions["names"] if "/" in name}
    assert {"CMakeLists.txt", "LICENSE", "README.md", "pyproject.toml", "include/reflectree/error.hpp",
            "src/sampler/build/build.cpp", "bindings/python/src/module.cpp",
            "bindings/python/reflectree/_core.pyi"} <= names
    assert not [name for name in names if name.startswith(("tests/", "build", ".git/"))]
    assert distributions["sdist"].stat().st_size < 3e6


def test_the_wheel_works_alone(distributions, tmp_path, environment):
    venv.create(tmp_path / "fresh", with_pip=False)
    python = tmp_path / "fresh" / "bin" / "python"
    site = pathlib.Path(run(str(python), "-c", "import site; print(site.getsitepackages()[0])").strip())
    run(sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(site), str(distributions["wheel"]),
        env=environment)
    # NumPy as it is here; it is the only package that is needed.
    numpy = pathlib.Path(__import__("numpy").__file__).parents[1]
    (site / "numpy.pth").write_text(f"{numpy}\n")
    version = run(str(python), "-X", "dev", "-W", "error", "-c", SMOKE, env=environment).strip()
    lines = (SOURCE / "CMakeLists.txt").read_text().split("\n")
    assert f"project(reflectree VERSION {version} LANGUAGES CXX)" in lines
    assert f"-{version}-" in distributions["wheel"].name


def test_the_wheel_holds_the_package_and_nothing_else(distributions):
    import zipfile

    names = zipfile.ZipFile(distributions["wheel"]).namelist()
    assert {"reflectree/__init__.py", "reflectree/py.typed", "reflectree/_core.pyi"} <= set(names)
    assert all(name.startswith("reflectree") for name in names)
    assert sum("_core" in name and name.endswith(".so") for name in names) == 1
