#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the micro benchmark and prints a table: nanoseconds per direction, and their ratio to the floor.

The floor is cosine_hemisphere of the same run. Figures are medians of CPU time over repetitions that are
interleaved at random, so that what else the machine does falls on all of them alike.

Usage: bench_ratios.py [--bench PATH] [--repetitions N] [--seconds S] [--filter REGEX] [--limits]
Exit code 1 with --limits if a ratio at alpha = 0.1 is above its limit.
"""
import argparse
import json
import pathlib
import subprocess
import sys

FLOOR = "cosine_hemisphere"
# Ratio to the floor, GGX alpha = 0.1, wo random, evaluation and weight included.
LIMITS = {"exact_batch/100": 4.5, "one_shot_alias_batch/100": 3.5, "one_shot_monotone_batch/100": 5.5}


def medians(arguments: argparse.Namespace) -> dict[str, float]:
    """Nanoseconds per direction of every benchmark."""
    command = [
        str(arguments.bench),
        "--benchmark_format=json",
        f"--benchmark_repetitions={arguments.repetitions}",
        f"--benchmark_min_time={arguments.seconds}",
        "--benchmark_enable_random_interleaving=true",
        "--benchmark_report_aggregates_only=true",
        f"--benchmark_filter=^{FLOOR}$|{arguments.filter}",
    ]
    report = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)
    return {
        run["run_name"]: 1e9 / run["items_per_second"] if "items_per_second" in run else run["cpu_time"]
        for run in report["benchmarks"]
        if run["aggregate_name"] == "median"
    }


def table(nanoseconds: dict[str, float]) -> str:
    floor = nanoseconds[FLOOR]
    rows = ["| benchmark | ns per direction | ratio to the floor |", "|---|---:|---:|"]
    for name, time in sorted(nanoseconds.items(), key=lambda item: (item[0] != FLOOR, item[0])):
        title, _, milli = name.partition("/")
        alpha = f", alpha = {int(milli) / 1000:g}" if milli else ""
        rows.append(f"| {title}{alpha} | {time:.1f} | {time / floor:.2f} |")
    return "\n".join(rows)


def main() -> int:
    root = pathlib.Path(__file__).resolve().parent.parent
    parser = argparse.ArgumentParser(description="Ratios of the micro benchmark to its floor.")
    parser.add_argument("--bench", type=pathlib.Path, default=root / "build" / "bin" / "bench_micro")
    parser.add_argument("--repetitions", type=int, default=9)
    parser.add_argument("--seconds", type=float, default=0.05, help="least time of one repetition")
    parser.add_argument("--filter", default=".", help="which benchmarks, besides the floor")
    parser.add_argument("--limits", action="store_true", help="fail where a ratio is above its limit")
    arguments = parser.parse_args()
    if not arguments.bench.is_file():
        parser.error(f"no file {arguments.bench}: build it with ./x bench, or name it with --bench")
    nanoseconds = medians(arguments)
    print(table(nanoseconds))
    if not arguments.limits:
        return 0
    broken = 0
    for name, limit in LIMITS.items():
        ratio = nanoseconds.get(name, float("inf")) / nanoseconds[FLOOR]
        if ratio > limit:
            print(f"{name}: ratio {ratio:.2f} is above {limit}", file=sys.stderr)
            broken = 1
    return broken


if __name__ == "__main__":
    sys.exit(main())
