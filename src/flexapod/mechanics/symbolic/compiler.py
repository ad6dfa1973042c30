"""C compilation of generated functions with a content-hash cache."""

import ctypes
import hashlib
import json
import logging
import math
import os
import platform
import shlex
import shutil
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.files import temporary_folder
from flexapod.common.processes import run_programs
from flexapod.mechanics.symbolic.cache import (
    intact_libraries,
    known_text,
    open_cache,
    remember_text,
    store_library,
    warn_unused,
)
from flexapod.mechanics.symbolic.processor import built_loops, processor

#: C text that every generated function needs before it.
PRELUDE = Path(__file__).parent / "lanes.h"

#: Without contraction of products and sums numbers do not depend on the processor.
COMMON = ("-fPIC", "-std=gnu11", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off")
#: -O1 runs straight-line code as fast as -O2 and compiles it in half the time; what is written by hand has loops.
FLAGS, LOOPS = ("-O1",), ("-O3",)
#: gcc leaves out what finds nothing to do in straight-line code, a quarter of its time. Operations stay in the order in
#: which they are written: put together to expressions they need more values at a time than there are registers, and
#: take a tenth longer. No number depends on it.
STRAIGHT = """#if defined(__OPTIMIZE__) && defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("Og", "no-tree-ter")
#endif"""
#: Equations are compiled in so many units side by side, each of so many characters or more.
UNITS, WORTH_IT = 2, 60_000
#: What a function takes a compiler grows with this power of its length, to share functions out to units.
GROWTH = 1.5
#: Vectors as wide as the processor has them; left out where the compiler does not know it, or `CC` names a target.
NATIVE = "-march=native"
LONGEST = 300.0  # seconds that a compiler may take: usual are 2 to 20
SILENT = 2.0  # seconds after which it is told that there is a compiler at work
#: Sizes of inputs, and shapes of outputs, of a function.
Signature = dict[str, list[Any]]
_log = logging.getLogger("flexapod")
#: Function of every library that returns sizes of inputs and shapes of outputs, as JSON.
SIGNATURES = "flexapod_signatures"
#: That of how many bodies stand side by side in its vectors.
LANES = "flexapod_lanes"


def compiler() -> list[str] | None:
    """Command of a C compiler: ``CC``, cc, gcc, clang, or the pip-installable ``ziglang``; None if there is none."""
    if os.environ.get("FLEXAPOD_COMPILER") == "none":
        return None
    chosen = _words(os.environ.get("CC", ""))
    found = next((line for line in (chosen, ["cc"], ["gcc"], ["clang"]) if line and shutil.which(line[0])), None)
    if found is None and find_spec("ziglang"):
        found = [sys.executable, "-m", "ziglang", "cc"]
    if chosen and found is not chosen:
        _say_passed_over(shlex.join(chosen), shlex.join(found or []))
    return found


def _words(line: str) -> list[str]:
    """Program and arguments; a name that has spaces and is a program is one word."""
    try:
        return [line] if shutil.which(line) else shlex.split(line)
    except ValueError:  # a quotation mark that is not closed
        return [line]


@cache
def _say_passed_over(chosen: str, found: str) -> None:
    _log.warning("CC = %s is passed over: there is no such program. Used instead: %s", chosen, found or "none")


def address(array: Array) -> int:
    """Address of an array; by its buffer where possible, in a tenth of the time of `ndarray.ctypes`."""
    return ctypes.addressof(_BUFFER.from_buffer(array.data)) if array.flags.carray else array.ctypes.data


_BUFFER = ctypes.c_char * 0


class CompiledFunction:
    """One generated C function called on arrays."""

    def __init__(self, library: ctypes.CDLL, name: str, signature: Signature) -> None:
        self._function = getattr(library, name)
        self._sizes: list[int] = signature["inputs"]
        self._shapes: list[tuple[int, int]] = [tuple(s) for s in signature["outputs"]]

    def __call__(self, *arguments: Array) -> tuple[Array, ...]:
        """Outputs as 1-D arrays (columns) or 2-D arrays."""
        inputs = [np.ascontiguousarray(a, dtype=float).ravel() for a in arguments]
        if [a.size for a in inputs] != self._sizes:
            raise ValueError(f"expected input sizes {self._sizes}, got {[a.size for a in inputs]}")
        outputs = [np.zeros(shape, order="F") for shape in self._shapes]
        pointers = [(ctypes.c_void_p * max(len(x), 1))(*map(address, x)) for x in (inputs, outputs)]
        rows = (ctypes.c_long * len(inputs))(*[1] * len(inputs))
        self._function(ctypes.c_long(1), pointers[0], rows, pointers[1])
        return tuple(y[:, 0] if y.shape[1] == 1 else y for y in outputs)

    def each(self, count: int, rows: Sequence[Array], shapes: Sequence[tuple[int, ...]]) -> list[Array]:
        """Outputs of ``count`` bodies, (count, *shape), as C writes them: column by column.

        Parameters
        ----------
        count : int
        rows : sequence of ndarray, shape (any, size)
            Arguments; with fewer rows than bodies they repeat.
        shapes : sequence of tuple
            Of each output of one body.

        Raises
        ------
        ValueError
            Sizes are not those of the function: C would read and write beyond them.
        """
        given = [x.shape[1] if len(x) or not count else 0 for x in rows], [math.prod(shape) for shape in shapes]
        known = self._sizes, [rows * columns for rows, columns in self._shapes]
        if given != known:
            raise ValueError(f"expected sizes of inputs and outputs {known}, got {given}")
        out = [np.zeros((count, *shape[::-1])) for shape in shapes]
        pointers = [(ctypes.c_void_p * max(len(x), 1))(*map(address, x)) for x in (rows, out)]
        self._function(ctypes.c_long(count), pointers[0], (ctypes.c_long * len(rows))(*map(len, rows)), pointers[1])
        return out


def compiled_library(
    key: Sequence[object], functions: Callable[[], list], command: list[str], callers: str = ""
) -> tuple[ctypes.CDLL, dict[str, Signature]]:
    """Load (compiling on first use) generated functions, and their signatures.

    Parameters
    ----------
    key : sequence
        Everything the generated code may depend on: bytes, numbers or text. What it is for a key is remembered.
    functions : callable
        Builds the list of NamedFunction; called only where it is not known what the code is, or is not compiled.
    command : list of str
        C compiler.
    callers : str
        C text that calls them.

    Raises
    ------
    ComputationError
        The compiler failed (the message carries its words), or its library cannot be loaded.
    """
    cache, source = open_cache(), _hash([*key, callers, version("casadi")])
    if cache and (text := known_text(cache, source)):
        if found := _first(intact_libraries(cache, _name([text], FLAGS, command))):
            return found
    with _announced(), temporary_folder() as folder:
        units = _generated(functions(), callers)
        text = _hash(units)
        found = _library(_name([text], FLAGS, command), units, FLAGS, command, cache, folder)
    if cache:
        remember_text(cache, source, text)
    return found


def written_library(
    sources: Sequence[Path], command: list[str], *, flags: Sequence[str] = LOOPS, bodies: int | None = None
) -> ctypes.CDLL:
    """Load hand-written C `sources`, in this order: from the wheel, or compiled on first use.

    Parameters
    ----------
    sources : sequence of Path
    command : list of str
        C compiler.
    flags : sequence of str
        Of the compiler; the wheel has the loops with theirs.
    bodies : int, optional
        How many stand side by side in the vectors of the equations; what the wheel has for others is not taken.

    Raises
    ------
    ComputationError
        As `compiled_library` does.
    """
    unit, key = written_text(sources)
    if (built := built_loops()) and built.key == key and (found := _first([built.path])):
        if bodies in (None, lanes(found[0])):
            return found[0]
    cache, name = open_cache(), _name([unit], flags, command)
    if cache and (found := _first(intact_libraries(cache, name))):
        return found[0]
    with _announced(), temporary_folder() as folder:
        return _library(name, [unit], flags, command, cache, folder)[0]


def written_text(sources: Sequence[Path]) -> tuple[str, str]:
    """One C text of hand-written `sources`, and the key that a wheel has its library under: of text and flags."""
    unit = "\n".join([PRELUDE.read_text(), *(path.read_text() for path in sources), _signatures({})])
    return unit, _hash([unit, *COMMON, *LOOPS])[:16]


def shared_object(texts: Mapping[str, str], sources: Sequence[str], flags: Sequence[str]) -> bytes:
    """The contents of a shared library for any machine of this kind, made of `sources` among C `texts` by name.

    Raises
    ------
    ComputationError
        There is no compiler, or it failed.
    """
    command = compiler()
    if command is None:
        raise ComputationError("there is no C compiler", next_step="Install gcc or clang, or `pip install ziglang`.")
    with _announced(), temporary_folder() as folder:
        for name, text in texts.items():
            (folder / name).write_text(text)
        program = os.path.abspath(shutil.which(command[0]) or command[0])
        line = [program, *command[1:], "-fPIC", "-shared", "-s", *flags, "-o", "made", *sources, "-lm"]
        if fault := _fault([line], command, folder):
            raise _failed(command, fault)
        return (folder / "made").read_bytes()


def lanes(library: ctypes.CDLL) -> int:
    """Bodies side by side in the vectors of a library: libraries that call each other have as many."""
    return int(getattr(library, LANES)())


def _generated(functions: list, callers: str) -> list[str]:
    """C text of functions in units that take a compiler about as long: as many as it pays to compile side by side."""
    from flexapod.mechanics.symbolic.c_source import c_source

    units: list[list[str]] = [[_signatures({f.name: f.signature() for f in functions})]]
    texts = sorted(map(c_source, functions), key=len, reverse=True)
    units += [[] for _ in range(min(UNITS, sum(map(len, texts)) // WORTH_IT + 1) - 1) if not callers]
    for text in texts:
        min(units, key=lambda unit: sum(len(x) ** GROWTH for x in unit)).append(text)
    units[0].append(callers)
    return ["\n".join([PRELUDE.read_text(), STRAIGHT, *unit]) for unit in units]


def _signatures(known: dict[str, dict[str, object]]) -> str:
    words = json.dumps(json.dumps(known))
    return f"const char* {SIGNATURES}(void) {{ return {words}; }}\nlong {LANES}(void) {{ return LANES; }}"


def _library(
    name: str, units: list[str], flags: Sequence[str], command: list[str], cache: Path | None, folder: Path
) -> tuple[ctypes.CDLL, dict[str, Signature]]:
    """Library `name` of these units, from the cache or made in `folder`."""
    if cache and (found := _first(intact_libraries(cache, name))):
        return found  # other equations have the same text
    built = _build(units, flags, command, folder)
    if cache and (found := _first(intact_libraries(cache, name))):
        return found  # another process was faster
    if cache and (stored := store_library(cache, name, built)):
        try:
            return _load(stored)
        except OSError as error:
            if stored.exists():  # else another process has just made room
                warn_unused(cache, f"libraries cannot be loaded from there ({error})")
    try:
        return _load(built)  # it stays in memory when the folder is removed
    except OSError as error:
        raise ComputationError(
            f"the compiled equations cannot be loaded: {error}",
            next_step="Set FLEXAPOD_CACHE to a folder from which programs may be run, CC to another compiler, "
            "or FLEXAPOD_COMPILER=none for the slow interpreted kernels.",
        ) from None


@contextmanager
def _announced() -> Iterator[None]:
    """Log a message if the block takes longer than a moment."""
    words = "Compiling the equations of motion: once for each number of shapes, some seconds"
    timer = threading.Timer(SILENT, _log.info, [words])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _name(key: Sequence[object], flags: Sequence[str], command: list[str]) -> str:
    """Hash of everything that the library depends on, 32 hexadecimal digits."""
    program = Path(shutil.which(command[0]) or command[0]).resolve()
    if not program.exists():
        raise _failed(command, "there is no such program")
    made_by = [str(program), program.stat().st_size, program.stat().st_mtime_ns, *command[1:]]
    made_by += [version("ziglang")] if "ziglang" in command else []
    made_by += [built.path.name] if (built := built_loops()) else []  # target of equations, and hash of the loops
    machine = [sys.platform, platform.machine(), sys.maxsize, processor()]
    return _hash([*key, *COMMON, *flags, *made_by, *machine])


def _hash(parts: Sequence[object]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        text = part if isinstance(part, bytes) else repr(part).encode()
        digest.update(b"%d:" % len(text) + text)  # the length keeps neighbours apart
    return digest.hexdigest()[:32]


def _load(path: Path) -> tuple[ctypes.CDLL, dict[str, Signature]]:
    """Library and signatures; OSError if it is none of ours, or not for this machine."""
    library = ctypes.CDLL(str(path))
    try:
        signatures = getattr(library, SIGNATURES)
    except AttributeError as error:
        raise OSError(str(error)) from None
    signatures.restype = ctypes.c_char_p
    return library, json.loads(signatures())


def _first(paths: Sequence[Path]) -> tuple[ctypes.CDLL, dict[str, Signature]] | None:
    """The first library that loads here: a home may be shared by machines with different C libraries."""
    for path in paths:
        try:
            return _load(path)
        except OSError:
            continue
    return None


def _build(units: list[str], flags: Sequence[str], command: list[str], folder: Path) -> Path:
    """Library of these C texts, compiled side by side in `folder`."""
    program = shutil.which(command[0]) or command[0]
    # Relative names and a folder of its own: some linkers write paths into what they make, which would no longer
    # be the same from one process to the next.
    line = [os.path.abspath(program), *command[1:], *COMMON]
    names = [f"unit{k}" for k in range(len(units))]
    target = _targets(command)
    fault = ""
    try:
        for name, unit in zip(names, units, strict=True):
            (folder / f"{name}.c").write_text(unit)
        for targets in [*([word] for word in target), []]:
            each = [[*line, *flags, "-c", "-o", f"{name}.o", f"{name}.c", *targets] for name in names]
            if not (fault := _fault(each, command, folder)):
                link = [*line, "-shared", "-o", "kernel.so", *(f"{name}.o" for name in names), "-lm"]
                fault = _fault([link], command, folder)
                break
    except OSError as error:
        raise _failed(command, f"{error.filename or folder}: {error.strerror}") from None
    if not fault and not (folder / "kernel.so").is_file():
        fault = "it said nothing; its exit status is 0, and made no library"
    if fault:
        raise _failed(command, fault)
    return folder / "kernel.so"


def _targets(command: Sequence[str]) -> list[str]:
    """Words for the processor to compile for, the next one where a compiler does not know the one before."""
    if any(word.startswith(("-march=", "-mcpu=")) for word in command):
        return []
    target = built.target if (built := built_loops()) else None
    named = target.replace("-", "_") if target and "ziglang" in command else target
    return [*([f"-march={named}"] if named else []), NATIVE]


def _fault(lines: list[list[str]], command: list[str], folder: Path) -> str:
    """Error of the first of these compiler calls, run side by side, that fails; empty if none does."""
    own = {"TMPDIR": str(folder)}  # of its files, too, nothing stays if it is killed
    for said, status in run_programs(lines, folder, LONGEST, own):
        if status is None:
            raise _failed(command, f"it did not end within {LONGEST:g} s and was stopped")
        if status:
            return said.strip()[-600:] or f"it said nothing; its exit status is {status}"
    return ""


def _failed(command: list[str], words: str) -> ComputationError:
    return ComputationError(
        f"the C compiler {shlex.join(command)} failed: {words}",
        next_step="Set CC to another compiler, TMPDIR to another folder for its files, "
        "or FLEXAPOD_COMPILER=none for the slow interpreted kernels.",
    )
