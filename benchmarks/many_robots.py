"""Sweeps on all cores: what `benchmarks.sweep` prints, line by line."""

from __future__ import annotations

import re
import subprocess
import sys

from benchmarks.machine import all_cores, one_core
from benchmarks.report import Section

__all__ = ["many_robots"]

ARGUMENTS = ("--points", "200", "--step", "8e-4")  # the step that keeps 1 % with the default rho_inf


def many_robots() -> list[Section]:
    """One section; empty of rows, with the reason, if the sweep fails."""
    all_cores()
    run = subprocess.run(
        [sys.executable, "-m", "benchmarks.sweep", *ARGUMENTS], capture_output=True, text=True, check=False
    )
    one_core()
    lines = [line.strip() for line in run.stdout.splitlines() if line.strip()]
    failed = [] if run.returncode == 0 else [f"Failed: {(run.stderr.strip() or 'no words').splitlines()[-1]}"]
    return [
        Section(
            title="Many robots: sweeps",
            command=f"python -m benchmarks.sweep {' '.join(ARGUMENTS)}",
            header=["what", "measured"],
            rows=[_cells(line) for line in lines],
            remarks=["On all cores.", *failed],
        )
    ]


def _cells(line: str) -> list[str]:
    """Words and numbers, which stand apart by several blanks."""
    found = re.match(r"(.*?)\s{2,}(\S.*)$", line)
    return [found[1], found[2]] if found else [line, ""]
