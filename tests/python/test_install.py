# SPDX-License-Identifier: Apache-2.0
"""`pip install .`: wheel and source distribution in environments of their own, and a smoke test of each.

What builds is taken from the environment that runs the tests, so that no network is needed.
"""

import os
import pathlib
import shutil
import sys
import tarfile
import venv

import pytest
from wheels import run, smoke

SOURCE = pathlib.Path(os.environ["REFLECTREE_SOURCE"])


def unpack(archive, folder):
    """So that a second build compiles what has changed: files that are as they were keep their times."""
    prefix = archive.getnames()[0].split("/")[0] + "/"
    wanted = {folder / m.name[len(prefix):]: archive.extractfile(m).read() for m in archive.getmembers() if m.isfile()}
    assert all(file.resolve().is_relative_to(folder.resolve()) for file in wanted)
    for file in list(folder.rglob("*")):
        if file.is_file() and file not in wanted:
            file.unlink()
    for file, data in wanted.items():
        if not file.exists() or file.read_bytes() != data:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)


@pytest.fixture(scope="module")
def distributions(tmp_path_factory):
    """Built from the source distribution, as those are who install from an index. Its files and the folder of
    objects are kept beside the build, so that a second run compiles nothing, and the wheel for its judges."""
    where = tmp_path_factory.mktemp("dist")
    backend = [sys.executable, "-c", "import sys; from scikit_build_core import build; build.build_sdist(sys.argv[1])"]
    run(*backend, where, cwd=SOURCE)
    (sdist,) = where.glob("*.tar.gz")
    source, kept, wheels = (pathlib.Path.cwd() / name for name in ("pip-source", "pip-objects", "wheels"))
    with tarfile.open(sdist) as archive:
        names = archive.getnames()
        unpack(archive, source)
    shutil.rmtree(wheels, ignore_errors=True)
    run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "--wheel-dir", wheels,
        f"--config-settings=build-dir={kept}", source)
    (wheel,) = wheels.glob("*.whl")
    return {"sdist": sdist, "names": names, "wheel": wheel}


def test_the_source_distribution_is_whole(distributions):
    names = {name.split("/", 1)[1] for name in distributions["names"] if "/" in name}
    assert {"CMakeLists.txt", "LICENSE", "README.md", "pyproject.toml", "include/reflectree/error.hpp",
            "src/sampler/build/build.cpp", "bindings/python/src/module.cpp",
            "bindings/python/reflectree/_core.pyi"} <= names
    assert not [name for name in names if name.startswith(("tests/", "build", ".git/"))]
    assert distributions["sdist"].stat().st_size < 3e6


def test_the_wheel_works_alone(distributions, tmp_path):
    venv.create(tmp_path / "fresh", with_pip=False)
    python = tmp_path / "fresh" / "bin" / "python"
    site = pathlib.Path(run(python, "-c", "import site; print(site.getsitepackages()[0])").strip())
    run(sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", site, distributions["wheel"])
    # NumPy as it is here; it is the only package that is needed.
    numpy = pathlib.Path(__import__("numpy").__file__).parents[1]
    (site / "numpy.pth").write_text(f"{numpy}\n")
    version = smoke(python)
    lines = (SOURCE / "CMakeLists.txt").read_text().split("\n")
    assert f"project(reflectree VERSION {version} LANGUAGES CXX)" in lines
    assert f"-{version}-" in distributions["wheel"].name


def test_the_wheel_holds_the_package_and_nothing_else(distributions):
    import zipfile

    names = zipfile.ZipFile(distributions["wheel"]).namelist()
    assert {"reflectree/__init__.py", "reflectree/py.typed", "reflectree/_core.pyi"} <= set(names)
    assert all(name.startswith("reflectree") for name in names)
    assert sum("_core" in name and name.endswith(".so") for name in names) == 1
