# SPDX-License-Identifier: Apache-2.0
"""The command `verify`, as a user runs it, holds for every registered model and every shared file of measured
data (REFLECTREE_DATA; without it that part is skipped). Every material that fails is told with its lines.

    verify_all_test.py                         every one
    verify_all_test.py --every 10              of the tables' members every tenth
"""
import json
import os
import pathlib
import subprocess
import sys
import time

PROGRAM = os.environ["REFLECTREE_PROGRAM"]
DATA = os.environ.get("REFLECTREE_DATA", "")
SECONDS = 1800  # for one material


def run(*args):
    return subprocess.run([PROGRAM, *args], capture_output=True, stdin=subprocess.DEVNULL, timeout=SECONDS, check=False)


def models():
    return [m["name"] for m in json.loads(run("--json", "list").stdout)["models"]]


def files(every):
    """Materials of the data folder as texts of the command line."""
    found = [f"rgl/{f.name}" for f in sorted((pathlib.Path(DATA) / "rgl").glob("*.bsdf"))]
    for table in sorted((pathlib.Path(DATA) / "nbrdf").glob("*.csv")) + sorted((pathlib.Path(DATA) / "fits").glob("*.csv")):
        name = f"{table.parent.name}/{table.name}"
        listed = run("--json", "list", str(table))
        if listed.returncode != 0:
            print(f"skipped: {name}: {listed.stderr.decode().strip()}", flush=True)
            continue
        members = json.loads(listed.stdout).get("members", [])
        found += members[::every]
    return found  # members are listed as the command line takes them


def verify(material):
    """(exit code, lines worth telling)"""
    try:
        done = run("--quiet", "verify", material)
    except subprocess.TimeoutExpired:
        return 1, [f"not at an end after {SECONDS} s"]
    lines = (done.stdout.decode() + done.stderr.decode()).splitlines()
    return done.returncode, [line.strip() for line in lines if line.lstrip().startswith(("FAIL", "open", "note", "error"))]


def main():
    every = int(sys.argv[sys.argv.index("--every") + 1]) if "--every" in sys.argv else 1
    materials = models()
    if DATA:
        materials += files(every)
    else:
        print("SKIPPED: no measured data (REFLECTREE_DATA is not set); models alone", flush=True)
    failed = []
    for material in materials:
        start = time.monotonic()
        code, lines = verify(material)
        print(f"{'pass' if code == 0 else 'FAIL'}  {material}  ({time.monotonic() - start:.0f} s)", flush=True)
        for line in lines:
            print(f"      {line}", flush=True)
        if code != 0:
            failed.append(material)
    print(f"{len(materials)} materials, {len(failed)} failed: {', '.join(failed) or 'none'}")
    return 1 if failed or len(materials) < 10 else 0


if __name__ == "__main__":
    sys.exit(main())
