# SPDX-License-Identifier: Apache-2.0
"""The tutorials run cell by cell, as notebooks do, and print what they promise; their scripts have the same cells; the
programs of the documents run, too."""

import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

SOURCE = pathlib.Path(os.environ["REFLECTREE_SOURCE"])
EXPECTED = {
    "doctor_report": r"not healthy\n(?s:.*)half_vector_density(?s:.*)"
                     r"is (\S+), expected (?!\1).*\n(?s:.*)mended: no fault was found",
    "first_sampler": r"reflected radiance 0\.48[0-9]\n",
    "low_discrepancy": r" 4096 points: .* even, ([3-9]|[1-9]\d)\.\d times",
    "measured_file": r"KiB on disk\ntheta_o  0: albedo 0\.\d+ ",
    "my_brdf": r"f at the mirror direction 0\.[89]\d+, .*\nalbedo (0\.\d\d\d)\d, mean weight \1",
    "path_tracer": r"48 x 32, 16 samples per pixel: mean 0\.2[34]\d",
}


def run(program, cwd):
    done = subprocess.run([sys.executable, "-X", "dev", "-W", "error", *program], capture_output=True, text=True, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_tutorial_is_expected_to_print_something():
    assert sorted(p.stem for p in (SOURCE / "examples" / "python").glob("*.py")) == sorted(EXPECTED)


# What a kernel does: the cells of code one after the other in one module; a last expression is shown, as HTML too.
KERNEL = """
import ast, json, sys
for cell in json.load(open(sys.argv[1], encoding="utf-8"))["cells"]:
    if cell["cell_type"] == "code":
        body = ast.parse("".join(cell["source"])).body
        last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
        exec(compile(ast.Module(body, []), "cell", "exec"), globals())
        if last:
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), globals())
            if value is not None:
                print(repr(value), getattr(value, "_repr_html_", str)())
"""


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_tutorial(name, tmp_path):
    printed = run(["-c", KERNEL, str(SOURCE / "examples" / "python" / "notebooks" / f"{name}.ipynb")], tmp_path)
    assert re.search(EXPECTED[name], printed), printed


def test_notebooks_are_those_of_the_scripts(tmp_path):
    """And the guard sees one that is not."""
    guard = [sys.executable, str(SOURCE / "tools" / "notebooks.py")]
    done = subprocess.run([*guard, str(SOURCE), "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    (tmp_path / "examples" / "python").mkdir(parents=True)
    script = tmp_path / "examples" / "python" / "one.py"
    script.write_text('"""One."""\n\n# %% [markdown]\n# Text.\n\n# %%\nprint(1)\n')
    assert subprocess.run([*guard, str(tmp_path)]).returncode == 0
    made = json.loads((tmp_path / "examples" / "python" / "notebooks" / "one.ipynb").read_text())
    assert [("".join(c["source"]), c["cell_type"]) for c in made["cells"]] == [
        ("# One", "markdown"), ("Text.", "markdown"), ("print(1)", "code")]
    script.write_text(script.read_text().replace("1", "2"))
    stale = subprocess.run([*guard, str(tmp_path), "--check"], capture_output=True, text=True)
    assert stale.returncode == 1 and "one.ipynb" in stale.stdout


def test_scripts_are_programs():
    """Whoever runs a script runs the cells of its notebook: it has no code before the first."""
    for script in (SOURCE / "examples" / "python").glob("*.py"):
        head = script.read_text().split("# %%")[0]
        assert head.startswith("# SPDX") and head.count('"""') == 2 and head.rstrip().endswith('"""'), script.name


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
