"""What the figures were measured on: processor, versions, and the most that one core can do."""

from __future__ import annotations

import ctypes
import os
import platform
import re
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from flexapod.mechanics.symbolic.compiler import compiler

__all__ = ["Machine", "all_cores", "machine", "one_core", "peak"]

PACKAGES = ("flexapod", "numpy", "scipy", "casadi", "exudyn", "xarray")
#: 32 independent accumulators of the widest vectors: more than latency times width of any present multiply-add unit.
PEAK_SOURCE = """
#include <time.h>
#if WIDTH > 8
typedef double Vector __attribute__((vector_size(WIDTH)));
#define AT(v, j) v[j]
#else
typedef double Vector;
#define AT(v, j) v
#endif
double multiply_adds(long loops, double *seconds) {
  Vector x[CHAINS], a, b; double sum = 0;
  for (int i = 0; i < CHAINS; i++) for (int j = 0; j < (int)(WIDTH/8); j++) AT(x[i], j) = 1e-3*i + 1e-4*j;
  for (int j = 0; j < (int)(WIDTH/8); j++) { AT(a, j) = 0.999999; AT(b, j) = 1e-7; }
  struct timespec t0, t1;
  clock_gettime(CLOCK_MONOTONIC, &t0);
  for (long k = 0; k < loops; k++) {
    _Pragma("GCC unroll 64") for (int i = 0; i < CHAINS; i++) x[i] = x[i]*a + b;
  }
  clock_gettime(CLOCK_MONOTONIC, &t1);
  *seconds = (t1.tv_sec - t0.tv_sec) + 1e-9*(t1.tv_nsec - t0.tv_nsec);
  for (int i = 0; i < CHAINS; i++) for (int j = 0; j < (int)(WIDTH/8); j++) sum += AT(x[i], j);
  return sum;
}
"""
FLAGS = ("-O3", "-march=native", "-ffp-contract=fast", "-fPIC", "-shared", "-w")
SCALAR = ("-fno-tree-vectorize", "-fno-tree-slp-vectorize")
LOOPS = 2_000_000


@dataclass(frozen=True, kw_only=True)
class Machine:
    """A processor with its compiler and the versions of what is compared."""

    processor: str
    cores: int
    system: str
    python: str
    compiler: str
    calculix: str
    packages: dict[str, str]

    def lines(self) -> list[str]:
        """One sentence a line."""
        packages = ", ".join(f"{name} {number}" for name, number in self.packages.items())
        return [
            f"{self.processor}, {self.cores} cores; {self.system}",
            f"Python {self.python}; {packages}",
            f"C compiler: {self.compiler}; CalculiX: {self.calculix}",
        ]


_CORES = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set()


def one_core() -> None:
    """Pin this process and its children to one core, where the system can."""
    if _CORES:
        os.sched_setaffinity(0, {max(_CORES)})


def all_cores() -> None:
    """Give this process and its children back the cores that it started with."""
    if _CORES:
        os.sched_setaffinity(0, _CORES)


def machine() -> Machine:
    """The machine that this runs on."""
    command = compiler()
    return Machine(
        processor=_processor(),
        cores=os.cpu_count() or 1,
        system=f"{platform.system()} {platform.machine()}",
        python=platform.python_version(),
        compiler=_first_line([*command, "--version"]) if command else "none",
        calculix=_first_line(["ccx", "-v"]),
        packages={name: _version(name) for name in PACKAGES},
    )


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or platform.machine()
    name = re.search(r"model name\s*:\s*(.*)", text)
    kind = [re.search(rf"{key}\s*:\s*(\d+)", text) for key in ("cpu family", "model")]
    numbers = ", ".join(f"{key} {found[1]}" for key, found in zip(("family", "model"), kind, strict=True) if found)
    return f"{name[1].strip()} ({numbers})" if name else platform.machine()


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _first_line(command: list[str]) -> str:
    try:
        run = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return "not installed"
    return next((line.strip() for line in run.stdout.splitlines() if line.strip()), "unknown")


@cache
def peak() -> dict[int, float]:
    """Largest measured rate of one core [flop/s] with vectors of 1, 2, 4 and 8 doubles; {} without a compiler.

    Independent multiply-adds on registers, an addition and a multiplication each; 8 and 16 and 24 at a time, the best
    of five runs each: the flags allow everything that the processor has (``-march=native``).
    """
    command = compiler()
    if command is None:
        return {}
    rates: dict[int, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "peak.c"
        source.write_text(PEAK_SOURCE, encoding="utf-8")
        for width in (1, 2, 4, 8):
            rates[width] = max(_rate(command, source, width, chains) for chains in (8, 12, 24))
    return rates


def _rate(command: list[str], source: Path, width: int, chains: int) -> float:
    library = source.with_name(f"peak{width}-{chains}.so")
    flags = FLAGS if width > 1 else (*FLAGS, *SCALAR)
    line = [*command, *flags, f"-DWIDTH={8 * width}", f"-DCHAINS={chains}", "-o", str(library), str(source)]
    if subprocess.run(line, capture_output=True, check=False).returncode:
        return 0.0
    function = ctypes.CDLL(str(library)).multiply_adds
    function.restype = ctypes.c_double
    seconds, best = ctypes.c_double(), float("inf")
    for _ in range(5):
        function(ctypes.c_long(LOOPS), ctypes.byref(seconds))
        best = min(best, seconds.value)
    return 2 * width * chains * LOOPS / best
