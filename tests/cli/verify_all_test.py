# SPDX-License-Identifier: Apache-2.0
"""The command `verify`, as a user runs it, holds for every registered model and every shared file of measured
data (REFLECTREE_DATA; without it that part is skipped): each RGL file, and of each table of networks or fits some
members spread over it, since all of them take a day. Every material that fails is told with its lines.

    verify_all_test.py           the test
    verify_all_test.py --all     every member
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
NETWORKS, FITS = 6, 2  # members of each table


def run(*args):
    return subprocess.run([PROGRAM, *args], capture_output=True, stdin=subprocess.DEVNULL, timeout=SECONDS, check=False)


def models():
    return [m["name"] for m in json.loads(run("--json", "list").stdout)["models"]]


def files():
    """Materials of the data folder as texts of the command line."""
    found = [f"rgl/{f.name}" for f in sorted((pathlib.Path(DATA) / "rgl").glob("*.bsdf"))]
    for folder, wanted in (("nbrdf", NETWORKS), ("fits", FITS)):
        for table in sorted((pathlib.Path(DATA) / folder).glob("*.csv")):
            listed = run("--json", "list", str(table))
            if listed.returncode != 0:
                print(f"SKIPPED: {folder}/{table.name}: {listed.stderr.decode().strip()}", flush=True)
                continue
            members = json.loads(listed.stdout).get("members", [])
            step = 1 if "--all" in sys.argv else max(1, len(members) // wanted)
            chosen = members[step // 2::step]
            if len(chosen) < len(members):
                print(f"SKIPPED: {len(members) - len(chosen)} of {len(members)} members of {folder}/{table.name}",
                      flush=True)
            found += chosen
    return found  # members are listed as the command line takes them


def verify(material):
    """(exit code, lines worth telling)"""
    try:
        done = run("--quiet", "verify", material)
    except subprocess.TimeoutExpired:
        return 1, [f"not at an end after {SECONDS} s"]
    lines = [line.strip() for line in (done.stdout.decode() + done.stderr.decode()).splitlines()]
    return done.returncode, [line for line in lines if line.startswith(("FAIL", "open", "note", "error"))]


def main():
    materials = models()
    if DATA:
        materials += files()
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
