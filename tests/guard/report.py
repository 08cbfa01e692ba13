# SPDX-License-Identifier: Apache-2.0
"""How a guard ends: one line per fault, exit code 1 if there is one."""
import pathlib
import sys


def report(faults_of, all_is_well: str):
    """Judges the folder that the command line names by faults_of(folder)."""
    found = faults_of(pathlib.Path(sys.argv[1]))
    print("\n".join(found) or all_is_well)
    sys.exit(1 if found else 0)
