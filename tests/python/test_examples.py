# SPDX-License-Identifier: Apache-2.0
"""The tutorials run, and print what they promise; the programs of the documents run, too."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["REFLECTREE_SOURCE"])
EXPECTED = {
    "first_sampler": r"reflected radiance 0\.48[0-9]\n",
    "low_discrepancy": r" 4096 points: .* even, ([3-9]|[1-9]\d)\.\d times",
    "measured_file": r"KiB on disk\ntheta_o  0: albedo 0\.\d+ ",
    "my_brdf": r"f at the mirror direction 0\.[89]\d+, .*\nalbedo (0\.\d\d\d)\d, mean weight \1",
    "path_tracer": r"48 x 32, 16 samples per pixel: mean 0\.\d+",
}


def run(program, cwd):
    done = subprocess.run([sys.executable, "-X", "dev", "-W", "error", *program], capture_output=True, text=True, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_tutorial_is_expected_to_print_something():
    assert sorted(p.stem for p in (SOURCE / "examples" / "python").glob("*.py")) == sorted(EXPECTED)


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_tutorial(name, tmp_path):
    printed = run([str(SOURCE / "examples" / "python" / f"{name}.py")], tmp_path)
    assert re.search(EXPECTED[name], printed), printed


def programs(path):
    """Indented blocks of a document that import the package."""
    for block in re.findall(r"(?:^(?:    .*|)\n)+", (SOURCE / path).read_text(), re.MULTILINE):
        if "import reflectree" in block:
            yield "\n".join(line[4:] for line in block.split("\n"))


@pytest.mark.parametrize("path", ["README.md", "docs/python.md", "bindings/python/reflectree/__init__.py"])
def test_programs_of_documents(path, tmp_path):
    found = list(programs(path))
    assert found
    for program in found:
        run(["-c", program], tmp_path)
