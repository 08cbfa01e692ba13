# SPDX-License-Identifier: Apache-2.0
"""Runs the program in a folder of its own, without the caller's settings."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["REFLECTREE_PROGRAM"]


def environment(**changes):
    """The caller's, without what steers the program."""
    kept = {k: v for k, v in os.environ.items() if k not in ("REFLECTREE_DATA", "NO_COLOR")}
    return {**kept, **changes}


class ProgramTest(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def run_program(self, *args, code=0, **changes):
        """Runs it, checks the exit code, returns what it wrote to stdout and stderr."""
        done = subprocess.run([PROGRAM, *map(str, args)], cwd=self.folder, env=environment(**changes),
                              stdin=subprocess.DEVNULL, capture_output=True, timeout=300, check=False)
        out, words = done.stdout.decode(), done.stderr.decode()
        self.assertEqual(done.returncode, code, f"{args}\n{out}\n{words}")
        return out, words

    def json_of(self, *args, code=0, **changes):
        out, _ = self.run_program("--json", *args, code=code, **changes)
        result = json.loads(out)
        self.assertEqual(result["schema_version"], 1)
        return result

    def write(self, name, data):
        path = self.folder / name
        path.write_bytes(data)
        return path
