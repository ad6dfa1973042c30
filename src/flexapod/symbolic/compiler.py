"""C compilation of generated functions with a content-hash cache."""

import ctypes
import hashlib
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from flexapod.errors import ComputationError
from flexapod.typing import Array

#: -O1 runs straight-line code as fast as -O2 and compiles it in half the time.
FLAGS = ("-O1", "-fPIC", "-shared", "-std=gnu11", "-fno-math-errno", "-fno-trapping-math")


def cache_directory() -> Path:
    """Directory of compiled kernels: ``FLEXAPOD_CACHE``, else the user's cache."""
    if chosen := os.environ.get("FLEXAPOD_CACHE"):
        return Path(chosen)
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or str(Path.home() / ".cache")
    return Path(base) / "flexapod"


def compiler() -> list[str] | None:
    """Command of a C compiler: ``CC``, cc, gcc, clang, or the pip-installable ``ziglang``; None if there is none."""
    if os.environ.get("FLEXAPOD_COMPILER") == "none":
        return None
    for name in (os.environ.get("CC"), "cc", "gcc", "clang"):
        if name and shutil.which(name):
            return [name]
    if find_spec("ziglang"):
        return [sys.executable, "-m", "ziglang", "cc"]
    return None


class CompiledFunction:
    """One generated C function called on arrays."""

    def __init__(self, library: ctypes.CDLL, name: str, signature: dict[str, list]) -> None:
        self._function = getattr(library, name)
        self._sizes: list[int] = signature["inputs"]
        self._shapes: list[tuple[int, int]] = [tuple(s) for s in signature["outputs"]]

    def __call__(self, *arguments: Array) -> tuple[Array, ...]:
        """Outputs as 1-D arrays (columns) or 2-D arrays."""
        inputs = [np.ascontiguousarray(a, dtype=float).ravel() for a in arguments]
        if [a.size for a in inputs] != self._sizes:
            raise ValueError(f"expected input sizes {self._sizes}, got {[a.size for a in inputs]}")
        outputs = [np.zeros(shape, order="F") for shape in self._shapes]
        pointers = [(ctypes.c_void_p * max(len(x), 1))(*[a.ctypes.data for a in x]) for x in (inputs, outputs)]
        self._function(pointers[0], pointers[1], None, None, 0)
        return tuple(y[:, 0] if y.shape[1] == 1 else y for y in outputs)


def compiled_library(
    key: Sequence[object], functions: Callable[[], list], sources: Sequence[Path], command: list[str]
) -> tuple[ctypes.CDLL, dict[str, dict]]:
    """Load (compiling on first use) the generated functions together with hand-written C ``sources``.

    Parameters
    ----------
    key : sequence
        Everything the generated code depends on: bytes, numbers or text.
    functions : callable
        Builds the list of NamedFunction; called only when the cache has no library for ``key``.
    sources : sequence of Path
        C files appended after the generated code, in this order.
    command : list of str
        C compiler.

    Raises
    ------
    ComputationError
        The compiler failed; the message carries its words.
    """
    digest = hashlib.sha256()
    for part in [*key, sys.platform, platform.machine(), *FLAGS, *command, *(path.read_bytes() for path in sources)]:
        digest.update(part if isinstance(part, bytes) else repr(part).encode())
    target = cache_directory() / f"{digest.hexdigest()[:32]}.so"
    record = target.with_suffix(".json")
    if not (target.exists() and record.exists()):
        _build(functions(), sources, command, target, record)
    return ctypes.CDLL(str(target)), json.loads(record.read_text())


def _build(functions: list, sources: Sequence[Path], command: list[str], target: Path, record: Path) -> None:
    from casadi import CodeGenerator

    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        generator = CodeGenerator("generated.c", {"with_header": False})
        for function in functions:
            generator.add(function.build())
        generator.generate(folder + os.sep)
        unit = Path(folder) / "unit.c"
        texts = [(Path(folder) / "generated.c").read_text(), *(path.read_text() for path in sources)]
        unit.write_text("\n".join(texts))
        built = Path(folder) / "unit.so"
        done = subprocess.run(
            [*command, *FLAGS, "-o", str(built), str(unit), "-lm"], capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise ComputationError(
                f"the C compiler {' '.join(command)} failed: {done.stderr.strip()[-600:]}",
                next_step="Set CC to another compiler, or FLEXAPOD_COMPILER=none for the slow interpreted kernels.",
            )
        note = Path(folder) / "unit.json"
        note.write_text(json.dumps({f.name: f.signature() for f in functions}))
        note.replace(record)
        built.replace(target)
