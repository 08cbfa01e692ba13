# SPDX-License-Identifier: Apache-2.0
"""One wheel for CPython 3.12 and later: built by the first interpreter of REFLECTREE_ABI3_PYTHONS, or of the PATH,
judged by abi3audit, and tried in all of them."""

import json
import os
import pathlib
import shutil
import subprocess

import pytest
from wheels import ENVIRONMENT, environment_with, judges, planted_wheel, run, smoke

LATER = [f"python3.{minor}" for minor in range(12, 20)]


def interpreters():
    named = [name for name in os.environ.get("REFLECTREE_ABI3_PYTHONS", "").split(",") if name]
    code = "import sys; sys.exit(sys.implementation.name != 'cpython' or sys.version_info < (3, 12))"
    found = [name for name in named or filter(shutil.which, LATER)
             if subprocess.run([name, "-c", code], capture_output=True).returncode == 0]
    assert not named or found == named, f"of {named} only {found} are CPython 3.12 or later"
    if not found:
        pytest.skip("the wheel is not judged: REFLECTREE_ABI3_PYTHONS names no CPython 3.12 or later, nor has the PATH any")
    return found


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """Built from the source distribution that test_install.py has unpacked, with what pip finds for the build."""
    first = interpreters()[0]
    python = environment_with("abi3-builder", "scikit-build-core>=1.1,<2", "nanobind>=3.1,<4", python=first) / "python"
    where = tmp_path_factory.mktemp("abi3")
    run(python, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps", "--wheel-dir", where,
        f"--config-settings=build-dir={pathlib.Path.cwd() / 'abi3-objects'}", pathlib.Path.cwd() / "pip-source")
    (found,) = where.glob("*.whl")
    return found


def verdict_on(wheel):
    """abi3audit's, for each module: its exit code is 0 for modules that it cannot judge, so that the report is read."""
    done = subprocess.run([judges() / "abi3audit", "--report", wheel], capture_output=True, text=True, env=ENVIRONMENT)
    (spec,) = json.loads(done.stdout)["specs"].values()
    return [module["result"] for module in spec["wheel"]]


def keeps_the_abi(verdict):
    return bool(verdict) and all(module["is_abi3"] and module["is_abi3_baseline_compatible"] for module in verdict)


def test_it_keeps_to_the_stable_interface(wheel):
    print(wheel.name, wheel.stat().st_size, "bytes")
    assert "-cp312-abi3-" in wheel.name
    verdict = verdict_on(wheel)
    assert keeps_the_abi(verdict), verdict
    assert [module["baseline"] for module in verdict] == ["3.12"], verdict


def test_every_later_interpreter_runs_it(wheel):
    for number, name in enumerate(interpreters()):
        python = environment_with(f"abi3-user-{number}", "numpy", python=name) / "python"
        run(python, "-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall", wheel)
        assert f"-{smoke(python)}-" in wheel.name


@pytest.mark.parametrize("symbol, kept", [("PyType_GetSlot", True),
                                          ("_PyType_Lookup", False),       # of CPython's inside
                                          ("PyList_GetItemRef", False)])   # since 3.13
def test_twins_are_told_apart(tmp_path, symbol, kept):
    planted = planted_wheel(tmp_path, "cp312-abi3-linux_x86_64", "_core.abi3.so",
                            f"void *{symbol}(void *, int); void *PyInit__core(void) {{ return {symbol}(0, 0); }}")
    assert keeps_the_abi(verdict_on(planted)) == kept
