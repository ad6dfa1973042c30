"""Floating-point operations of a time step, counted in the very sources of the kernel.

The kernel's C, generated and written by hand, is compiled once more with `double` replaced by a number that counts
(`counted.h`): flexapod takes the compiler that ``CC`` names, here a script that does this. Nothing has to be kept in
step with the sources. An independent count of the generated part comes from CasADi's own list of instructions.
"""

from __future__ import annotations

import ctypes
import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import casadi
import numpy as np

from flexapod.mechanics.symbolic.functions import operations

__all__ = ["Count", "casadi_count", "counted", "main"]

HERE = Path(__file__).parent
#: A vector of bodies is a type of `counted.h` with one lane; zero plus a value, which makes
#: a vector of it, is not a sum.
REWRITTEN = (
    (r"typedef double lanes __attribute__\(\(.*\)\);", ""),
    (r"enum \{ LANES = \d+ \};", "enum { LANES = 1 };"),
    (r"\((lanes|double)\)\{0\} \+ ", r"(\1)"),
    (r"\(lanes \*const\[\]\)\{", "Parts{"),
)
KINDS = ("additions", "multiplications", "divisions", "roots", "exponentials", "circular")


@dataclass(frozen=True, kw_only=True)
class Count:
    """Operations: additions (and subtractions), multiplications, divisions, square roots, exponentials, sines and
    cosines."""

    additions: float = 0
    multiplications: float = 0
    divisions: float = 0
    roots: float = 0
    exponentials: float = 0
    circular: float = 0

    @property
    def arithmetic(self) -> float:
        """Additions, multiplications and divisions, one each: the flop that rates are quoted in."""
        return self.additions + self.multiplications + self.divisions

    def times(self, factor: float) -> Count:
        """All of it `factor` times."""
        return Count(**{kind: factor * getattr(self, kind) for kind in KINDS})

    def plus(self, other: Count) -> Count:
        """Sum of two counts."""
        return Count(**{kind: getattr(self, kind) + getattr(other, kind) for kind in KINDS})


def counted(action: str) -> Count:
    """Operations of compiled code while `action` runs in a process of its own, per unit of what it reports.

    Parameters
    ----------
    action : str
        ``module:function``; the function takes a callable that reads the counters, (6,) int, and returns a Count.

    Raises
    ------
    RuntimeError
        There is no C++ compiler, or the sources are not C++ with another number type: with the words of what failed.
    """
    with tempfile.TemporaryDirectory() as name:
        script = Path(name) / "counting-cc"
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m benchmarks.operations compile "$@"\n', "utf-8")
        script.chmod(0o755)
        path = os.pathsep.join([str(HERE.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
        setting = {"CC": str(script), "FLEXAPOD_CACHE": str(Path(name) / "cache"), "PYTHONPATH": path}
        line = [sys.executable, "-W", "ignore", "-m", "benchmarks.operations", "run", action]
        run = subprocess.run(line, capture_output=True, text=True, env=os.environ | setting, check=False)
    if run.returncode:
        raise RuntimeError((run.stderr.strip() or "no words").splitlines()[-1])
    return Count(**json.loads(run.stdout.splitlines()[-1]))


def reader(library: ctypes.CDLL) -> np.ndarray:
    """The counters of a counting library, a view (6,)."""
    return np.ctypeslib.as_array((ctypes.c_longlong * len(KINDS)).in_dll(library, "operation_counts"))


def casadi_count(function: casadi.Function) -> Count:
    """Operations in the list of instructions of a CasADi function."""
    return Count(**operations(function))


def compile_counting(arguments: list[str]) -> int:
    """Take the place of a C compiler: C++ with the counting number in place of double."""
    sources = [a for a in arguments if a.endswith(".c")]
    if not sources:  # what is compiled is linked
        return subprocess.run(["c++", *(a for a in arguments if not a.startswith("-std="))], check=False).returncode
    source = Path(sources[0])
    text = source.with_suffix(".cpp")
    body = source.read_text(encoding="utf-8")
    for pattern, words in REWRITTEN:
        body = re.sub(pattern, words, body)
    text.write_text(f'#include "{HERE / "counted.h"}"\nextern "C" {{\n{body}\n}}\n', encoding="utf-8")
    flags = [str(text) if a == str(source) else a for a in arguments if not a.startswith("-std=")]
    line = ["c++", "-std=gnu++20", "-fpermissive", "-w", *flags, "-O0"]
    return subprocess.run(line, check=False).returncode


def main(task: str, *arguments: str) -> int:
    """``compile ...`` as the compiler, ``run module:function`` as the process that is counted."""
    if task == "compile":
        return compile_counting(list(arguments))
    module, function = arguments[0].split(":")
    count: Count = getattr(__import__(module, fromlist=[function]), function)()
    print(json.dumps({kind: getattr(count, kind) for kind in KINDS}))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
