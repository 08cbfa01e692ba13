#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""bindings/pbrt/register.py on files that hold the places alone: every line lands once, and all or nothing is written.

    register_test.py REGISTER.py SCRATCH
"""

import pathlib
import re
import runpy
import shutil
import subprocess
import sys


def main(program, scratch):
    edits = runpy.run_path(program)["EDITS"]
    scratch = pathlib.Path(scratch)
    shutil.rmtree(scratch, ignore_errors=True)

    def checkout(name, left_out=None):
        for file, mark, _ in edits:
            path = scratch / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            if (file, mark) != left_out:
                path.write_text((path.read_text() if path.exists() else "before\n") + mark + "\nafter\n")
        return scratch / name

    def texts(folder):
        return {path: path.read_text() for path in folder.rglob("*") if path.is_file()}

    def run(folder):
        return subprocess.run([sys.executable, program, str(folder)], capture_output=True, text=True, check=False)

    whole = checkout("whole")
    assert run(whole).returncode == 0
    for file, _, wanted in edits:
        assert (whole / file).read_text().count(wanted) == 1, (file, wanted)
    once = texts(whole)
    again = run(whole)
    assert again.returncode == 0 and "already" in again.stdout and texts(whole) == once

    for number, (file, mark, _) in enumerate(edits):
        folder = checkout(f"other{number}", (file, mark))
        before = texts(folder)
        ran = run(folder)
        assert ran.returncode == 2 and re.search(f"{re.escape(file)}.*(0 times|not there)", ran.stderr), ran.stderr
        assert texts(folder) == before, f"{file}: half written"
    assert run(scratch / "nowhere").returncode == 2
    print(f"{len(edits)} lines: written once, all or nothing")


if __name__ == "__main__":
    main(*sys.argv[1:])
