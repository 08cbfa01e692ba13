# SPDX-License-Identifier: Apache-2.0
"""Renders a row by the program."""
import pathlib
import subprocess

from judge import numbers_of
from pixels import read_exr


def put(row, folder: pathlib.Path):
    """Its files, in a folder."""
    for name, data in {**row.files, "scene.xml": row.scene.encode()}.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    return folder / "scene.xml"


def render(program, row, folder, seed=1):
    """(numbers, None) or (None, what it said)."""
    path = put(row, folder)
    command = [program, "--seed", str(seed), "render", path.name, "-o", "out.exr", "--spp", str(row.spp)]
    done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=120, check=False)
    if done.returncode != 0:
        return None, done.stderr.decode()
    found = read_exr((folder / "out.exr").read_bytes())
    return numbers_of([found[c] for c in "RGB"], [found["stderr." + c] for c in "RGB"]), None
