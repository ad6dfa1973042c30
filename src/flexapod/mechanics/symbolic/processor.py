"""Processor at hand: its name and features, and the time loops that a wheel brings compiled for it."""

import hashlib
import os
import platform
import sys
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from flexapod.common.files import read_bytes

#: Where a wheel has them: `SYSTEM-MACHINE-TARGET-KEY-HASH.so`, or without the target. A checkout has none.
BUILT = Path(__file__).parent / "built"
#: What each level of x86-64 asks for beyond the one before, in the words of Linux.
LEVELS: dict[int, frozenset[str]] = {
    2: frozenset({"cx16", "lahf_lm", "popcnt", "pni", "ssse3", "sse4_1", "sse4_2"}),
    3: frozenset({"abm", "avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "movbe", "xsave"}),
    4: frozenset({"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}),
}
#: What Windows is asked for in their place: SSE 4.2, AVX2, AVX-512F.
WINDOWS = {2: 38, 3: 40, 4: 41}
LARGEST = 10_000_000  # of a file [byte]


@dataclass(frozen=True, kw_only=True)
class BuiltLoops:
    """File of compiled loops: ``key`` of text and flags, ``digest`` of the file, ``target`` of equations beside it."""

    path: Path
    target: str | None
    key: str
    digest: str


def built_loops() -> BuiltLoops | None:
    """Loops of the wheel for this processor; None where there are none, or ``CC`` says what is to compile."""
    return None if os.environ.get("CC") else _fitting(BUILT)


@cache
def _fitting(folder: Path) -> BuiltLoops | None:
    """Loops of the highest level that this processor has; None if no file is whole."""
    system = system_name(sys.platform, platform.machine())
    level = x86_level(_features()) if system.endswith(("x86_64", "amd64")) else 0
    for target in [x86_target(each) for each in range(level, 1, -1)] if level else [None]:
        for path in sorted(folder.glob(f"{file_stem(system, target)}-*-*.so")):
            key, digest = path.stem.split("-")[-2:]
            if digest == _digest(path):
                return BuiltLoops(path=path, target=target, key=key, digest=digest)
    return None


def system_name(system: str, machine: str) -> str:
    """Name of an operating system and a kind of machine, as files of loops have it."""
    return f"{system}-{machine.lower()}"


def file_stem(system: str, target: str | None) -> str:
    """Begin of the name of a file of loops."""
    return f"{system}-{target}" if target else system


def file_name(system: str, target: str | None, key: str, content: bytes) -> str:
    """Name of a file of loops with this content."""
    return f"{file_stem(system, target)}-{key}-{hashlib.sha256(content).hexdigest()[:16]}.so"


def x86_target(level: int) -> str:
    """Name that compilers have for a level."""
    return f"x86-64-v{level}"


def x86_level(features: Collection[str]) -> int:
    """Highest level of x86-64 all of whose features, and all of those below, are there; 1 if there is not even 2."""
    return max([1, *(level for level in LEVELS if all(LEVELS[k] <= set(features) for k in LEVELS if k <= level))])


@cache
def processor() -> str:
    """Name and features of this processor: a kernel made for it may not run on another that shares the cache."""
    told = _told()
    return "".join(told[key] for key in told if key in ("model name", "flags", "Features")) or platform.processor()


@cache
def _told() -> dict[str, str]:
    """Flags that Linux names of the first processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return {}
    pairs = (line.split(":", 1) for line in reversed(lines) if ":" in line)
    return {key.strip(): text for key, text in pairs}


def _features() -> frozenset[str]:
    """Features of an x86-64 processor that programs may use here, in the words of Linux."""
    if sys.platform == "win32":
        from ctypes import windll

        present = windll.kernel32.IsProcessorFeaturePresent
        return frozenset().union(*(LEVELS[level] for level, number in WINDOWS.items() if present(number)))
    return frozenset(_told().get("flags", "").split())


def _digest(path: Path) -> str | None:
    try:
        return hashlib.sha256(read_bytes(path, LARGEST)).hexdigest()[:16]
    except OSError:
        return None
