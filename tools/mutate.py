#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation testing of the sampler: plants each fault of a list, rebuilds what is needed, and tells who noticed.

For every fault of tools/mutations.txt: a copy of the sources is changed, verify_whole (verify() at its default
effort on a small material, tests/verify/whole.cpp) is built and run, and, where it notices nothing or with
--tests, the test programs too, until one notices. The copy and its build stay in the folder of --work, so that a
second run is quick.

    tools/mutate.py                         every fault; the table to standard output
    tools/mutate.py --only eight-trials     one
    tools/mutate.py --write                 and the table to docs/results/mutations.md
    tools/mutate.py --resume --write        the same, but only what the work folder has no result of
    tools/mutate.py --check                 builds nothing: whether every fault can still be planted

Results are kept in the work folder; the table has those of the whole list. The first run asks verify_whole about
the sources without a fault.

Exit code 1 if a fault that is not declared equivalent was noticed by nobody, or one could not be planted.
"""
import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
COPIED = sorted(p.name for p in ROOT.iterdir() if not p.name.startswith((".", "build")))
# In the order in which they are asked: the quickest to build first.
TEST_PROGRAMS = ["test_sampler_data", "test_sampler_build", "test_sampler_sampling", "test_sampler_faults",
                 "test_simd_batch", "test_verify_ways"]
VERIFY_SECONDS, TEST_SECONDS = 200, 600


class Mutation:
    def __init__(self, text):
        self.name, self.what, self.file, self.equivalent = "", "", "", ""
        self.old, self.new = [], []
        for line in text.splitlines():
            key, _, value = line.partition(": ")
            if line.startswith("- "):
                self.old.append(line[2:])
            elif line.startswith("+ "):
                self.new.append(line[2:])
            elif key in ("name", "what", "file", "equivalent"):
                setattr(self, key, value.strip())
            elif line.strip() and not line.startswith("#"):
                sys.exit(f"mutations: cannot read the line '{line}'")

    def planted(self, source):
        """The source with the fault; None unless the old lines are found exactly once, whatever their indent."""
        pattern = r"\n".join(r"[ \t]*" + re.escape(line.strip()) for line in self.old)
        found = list(re.finditer(r"(?m)^" + pattern + r"$", source))
        if len(found) != 1:
            return None
        return source[:found[0].start()] + "\n".join(self.new) + source[found[0].end():]


def read_mutations(path):
    text = path.read_text(encoding="utf-8")
    blocks = re.split(r"\n\s*\n(?=name: )", text)
    return [Mutation(block) for block in blocks if re.search(r"(?m)^name: ", block)]


def run(command, seconds, folder=None):
    """(exit code or None for a timeout, output)"""
    try:
        done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=seconds,
                              text=True, errors="replace")
        return done.returncode, done.stdout
    except subprocess.TimeoutExpired as error:
        return None, (error.stdout or b"").decode(errors="replace") if isinstance(error.stdout, bytes) else ""


class Workshop:
    def __init__(self, work, jobs):
        self.source, self.build, self.jobs = work / "source", work / "build", jobs

    def prepare(self):
        """Copies what changed since the last run; what did not keeps its time, so that little is rebuilt."""
        for top in COPIED:
            files = [ROOT / top] if (ROOT / top).is_file() else [f for f in (ROOT / top).rglob("*") if f.is_file()]
            for file in files:
                copy = self.source / file.relative_to(ROOT)
                if not copy.exists() or copy.read_bytes() != file.read_bytes():
                    copy.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(file, copy)
            if (ROOT / top).is_dir():
                for copy in list((self.source / top).rglob("*")):
                    if copy.is_file() and not (ROOT / copy.relative_to(self.source)).exists():
                        copy.unlink()
        code, out = run(["cmake", "-S", self.source, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                         "-DCMAKE_CXX_FLAGS_RELEASE=-O2", "-DREFLECTREE_TESTS=ON"], 600)
        if code != 0:
            sys.exit("mutate: the copy does not configure\n" + out[-2000:])

    def make(self, target):
        return run(["cmake", "--build", self.build, "--target", target, "--parallel", str(self.jobs)], 1800)

    def noticed_by_verify(self):
        """(names of the failed checks, seconds); raises if the mutant does not compile."""
        code, out = self.make("verify_whole")
        if code != 0:
            raise RuntimeError("does not compile: " + "; ".join(re.findall(r"error: .*", out)[:2]))
        start = time.monotonic()
        code, out = run([self.build / "bin" / "verify_whole"], VERIFY_SECONDS)
        seconds = time.monotonic() - start
        names = list(dict.fromkeys(re.findall(r"(?m)FAIL  (\w+)", out)))
        if code is None:
            names.append("(does not end)")
        elif code < 0:
            names.append("(dies)")
        return names, seconds

    def noticed_by_tests(self):
        for program in TEST_PROGRAMS:
            code, out = self.make(program)
            if code != 0:
                if "unknown target" in out:
                    continue
                return f"{program} (does not compile)"
            code, out = run([self.build / "bin" / program, "--gtest_brief=1"], TEST_SECONDS)
            failed = re.findall(r"\[  FAILED  \] ([\w./]+)", out)
            if failed:
                return f"{program}: {failed[0]}"
            if code != 0:
                return f"{program} ({'does not end' if code is None else 'dies'})"
        return ""


def table(rows):
    lines = ["| fault | what | `verify` | seconds | tests |", "|---|---|---|---|---|"]
    for m, names, seconds, test in rows:
        seen = ", ".join(f"`{n}`" for n in names[:5]) + (f", {len(names) - 5} more" if len(names) > 5 else "")
        if not names:
            seen = "equivalent" if m.equivalent else "nothing"
        by_test = test or ("`verify_whole`" if names else ("equivalent" if m.equivalent else "**nobody**"))
        lines.append(f"| {m.name} | {m.what} | {seen} | {seconds:.0f} | {by_test} |")
    return "\n".join(lines)


def page(rows):
    real = [r for r in rows if not r[0].equivalent]
    by_verify = [r for r in real if r[1]]
    unnoticed = [r[0].name for r in real if not r[1] and not r[3]]
    text = ["# Mutations", "",
            "We plant faults one by one in the sampler's sources and see who notices. Made by", "",
            "    tools/mutate.py --write", "",
            "from the list `tools/mutations.txt`. `verify` is `verify()` at its default effort on a small material, matt "
            "and, where that shows nothing, glossy (`tests/verify/whole.cpp`), itself a test of the suite. Seconds are "
            "its own, beside other work. Where it "
            "notices, the suite notices by that test; where it does not, the other test programs were asked.", "",
            f"{len(real)} faults, and {len(rows) - len(real)} changes that are declared equivalent. `verify` names "
            f"{len(by_verify)} of the faults, the slowest after {max([r[2] for r in by_verify] or [0]):.0f} s; noticed "
            f"by nobody: {', '.join(unnoticed) or 'none'}.", "", table(rows), ""]
    equivalent = [r[0] for r in rows if r[0].equivalent]
    if equivalent:
        text += ["## Equivalent", ""] + [f"* **{m.name}** ({m.what}): {m.equivalent}." for m in equivalent] + [""]
    return "\n".join(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--list", type=pathlib.Path, default=ROOT / "tools" / "mutations.txt")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build" / "mutations")
    parser.add_argument("--only", nargs="*", help="names of faults")
    parser.add_argument("--tests", action="store_true", help="ask the test programs about every fault")
    parser.add_argument("--no-tests", action="store_true", help="ask verify alone")
    parser.add_argument("--resume", action="store_true", help="leave out what has a result")
    parser.add_argument("--check", action="store_true", help="only see whether every fault can be planted")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--write", action="store_true", help="write docs/results/mutations.md")
    options = parser.parse_args()
    all_mutations = mutations = read_mutations(options.list)
    if options.only:
        mutations = [m for m in mutations if m.name in options.only]
        if len(mutations) != len(set(options.only)):
            sys.exit("mutate: not every name is in the list")
    if options.check:
        lost = [m for m in mutations if m.planted((ROOT / m.file).read_text(encoding="utf-8")) is None]
        print("\n".join(f"{m.name}: its lines are not found exactly once in {m.file}" for m in lost)
              or f"{len(mutations)} faults can be planted")
        return 1 if lost else 0
    kept = options.work / "results.json"
    results = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    if options.resume:
        mutations = [m for m in mutations if m.name not in results]
    workshop = Workshop(options.work.resolve(), options.jobs)
    workshop.prepare()
    names, seconds = workshop.noticed_by_verify()
    if names:
        sys.exit(f"mutate: the sources fail without a fault: {', '.join(names)}")
    print(f"without a fault: nothing, {seconds:.0f} s", flush=True)
    trouble = []
    for m in mutations:
        file = workshop.source / m.file
        sound = file.read_text(encoding="utf-8")
        faulty = m.planted(sound)
        if faulty is None:
            trouble.append(f"{m.name}: its lines are not found exactly once in {m.file}")
            print(trouble[-1], flush=True)
            continue
        try:
            file.write_text(faulty, encoding="utf-8")
            names, seconds = workshop.noticed_by_verify()
            test = ""
            if not options.no_tests and (options.tests or not names):
                test = workshop.noticed_by_tests()
            results[m.name] = [names, seconds, test]
            kept.write_text(json.dumps(results, indent=1), encoding="utf-8")
            print(f"{m.name}: {', '.join(names) or 'nothing'} ({seconds:.0f} s){'; ' + test if test else ''}", flush=True)
            if not names and not test and not m.equivalent and not options.no_tests:
                trouble.append(f"{m.name}: noticed by nobody")
        except RuntimeError as error:
            trouble.append(f"{m.name}: {error}")
            print(trouble[-1], flush=True)
        finally:
            file.write_text(sound, encoding="utf-8")
    rows = [(m, *results[m.name]) for m in all_mutations if m.name in results]
    print("\n" + page(rows))
    if options.write:
        (ROOT / "docs" / "results" / "mutations.md").write_text(page(rows), encoding="utf-8")
    print("\n".join(trouble) or "every fault was planted and noticed")
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
