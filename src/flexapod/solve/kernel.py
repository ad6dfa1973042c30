"""The compiled (or interpreted) functions of one set of shapes, and the parameters they read."""

import ctypes
import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache, lru_cache
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.lazy_imports import LazyModule
from flexapod.mechanics import elements, leg, symbolic
from flexapod.mechanics.elements.element import source_of
from flexapod.mechanics.leg.layout import Shapes, leg_parameters
from flexapod.mechanics.symbolic.compiler import CompiledFunction, compiled_library, compiler

if TYPE_CHECKING:
    from flexapod.mechanics.leg import kernel_functions, sliding
    from flexapod.mechanics.symbolic import c_source
    from flexapod.mechanics.symbolic import functions as symbolic_functions
    from flexapod.mechanics.symbolic.functions import NamedFunction
else:
    kernel_functions = LazyModule("flexapod.mechanics.leg.kernel_functions")
    sliding = LazyModule("flexapod.mechanics.leg.sliding")
    c_source = LazyModule("flexapod.mechanics.symbolic.c_source")
    symbolic_functions = LazyModule("flexapod.mechanics.symbolic.functions")

Function = Callable[..., tuple[Array, ...]]
#: Functions that the time loops call, in the order of ``native/system.h``.
FOR_LOOPS = (
    *(f"leg_{name}" for name in ("residual", "matrices", "energies", "closing", "friction", "friction_matrix")),
    *("leg_sliding", "leg_loop", "joint_residual", "joint_matrices", "joint_closing"),
    *("payload_residual", "payload_matrices", "payload_energies"),
)
_log = logging.getLogger("flexapod")


@dataclass(frozen=True, kw_only=True)
class Kernel:
    """Functions of a leg with given shapes and of the payload; all take and return float arrays.

    ``leg_closing``, ``joint_closing``: for steps within a tolerance. ``leg_friction``,
    ``leg_friction_matrix``, ``leg_sliding``: of legs with friction. ``leg_loop``: of those with loops not symmetric.
    ``library``: functions as compiled, ``equations`` what time loops know of them; None where no C compiler was found
    and casadi interprets them. ``compiler``: command of the one that made it, which time loops need as well.
    """

    shapes: Shapes
    leg_residual: Function
    leg_matrices: Function
    leg_energies: Function
    joint_residual: Function
    joint_matrices: Function
    payload_residual: Function
    payload_matrices: Function
    payload_energies: Function
    library: ctypes.CDLL | None
    equations: "Equations | None" = None
    compiler: tuple[str, ...] = ()
    leg_closing: Function | None = None
    joint_closing: Function | None = None
    leg_friction: Function | None = None
    leg_friction_matrix: Function | None = None
    leg_sliding: Function | None = None
    leg_loop: Function | None = None


NAMES = tuple(
    field.name for field in fields(Kernel) if field.name not in ("shapes", "library", "equations", "compiler")
)


@lru_cache(maxsize=32)  # solid pistons and tip bodies of many sizes have shapes of their own
def kernel(shapes: Shapes) -> Kernel:
    """Kernel of legs with the given shapes and joints, see `shapes`."""
    if command := compiler():
        return loaded_kernel(shapes, command, fingerprint(shapes), lambda: _functions(shapes))
    _warn_interpreted()
    return interpreted_kernel(shapes)


@cache
def _warn_interpreted() -> None:
    """Say once, whatever the number of kernels, that they are slow."""
    _log.warning(
        "No C compiler was found: the equations are interpreted, some 700 times slower. "
        "Install gcc or clang, or `pip install ziglang`."
    )


def interpreted_kernel(shapes: Shapes) -> Kernel:
    """Kernel evaluated by casadi, without a C compiler."""
    functions: dict[str, Any] = {f.name: symbolic_functions.Interpreted(f) for f in _functions(shapes)}
    return Kernel(shapes=shapes, library=None, **functions)


class Equations(ctypes.Structure):
    """Description of a kind of robot for the compiled time loops, as in ``native/system.h``."""

    _fields_ = [
        *[(name, ctypes.c_long) for name in ("n", "rows", "leg_p", "joint", "command", "common", "plate", "posed")],
        *[(name, ctypes.c_long) for name in ("floor", "bristles", "loop")],
        *[(name, ctypes.POINTER(ctypes.c_long)) for name in ("order", "place")],
        *[(name, ctypes.c_void_p) for name in FOR_LOOPS],
    ]


def loaded_kernel(
    shapes: Shapes,
    command: list[str],
    key: Sequence[object],
    functions: "Callable[[], list[NamedFunction]]",
    leg_p: int = 0,
    joint: int = 3,
) -> Kernel:
    """Kernel of functions that `compiled_library` makes; ``leg_p``, ``joint``: how many numbers legs, joints read."""
    library, signatures = compiled_library(key, functions, command)
    n, pivots, leg_p = shapes.size, shapes.pivots, leg_p or sum(size for _, size in leg_parameters(shapes))
    order = [
        *pivots,
        *(i for i in range(n) if i not in (*pivots, *shapes.shared_coordinates)),
        *shapes.shared_coordinates,
    ]  # as in system.h
    values = {"n": n, "rows": shapes.rows, "leg_p": leg_p, "joint": joint, "command": shapes.commands}
    values |= {"common": len(shapes.shared_coordinates), "plate": shapes.plate, "posed": int(shapes.reads_pose)}
    values |= {"bristles": shapes.bristles, "floor": shapes.index("g") if shapes.has("g") else n}
    lists = {"order": order, "place": sorted(range(n), key=order.__getitem__)}
    kinds = {name: "double" if name.startswith("payload") else "lanes" for name in FOR_LOOPS if name in signatures}
    equations = Equations(
        **values,
        loop=shapes.index("j") if shapes.has("j") else n,
        **{name: (ctypes.c_long * n)(*x) for name, x in lists.items()},
        **{name: ctypes.cast(getattr(library, f"{name}_{kind}"), ctypes.c_void_p) for name, kind in kinds.items()},
    )
    compiled = {name: CompiledFunction(library, name, signatures[name]) for name in NAMES if name in signatures}
    return Kernel(shapes=shapes, library=library, equations=equations, compiler=tuple(command), **compiled)


def generated_text(shapes: Shapes) -> dict[str, str]:
    """C text of each function of the equations, by name."""
    return {function.name: c_source.c_source(function) for function in _functions(shapes)}


def text_of_one_unit(shapes: Shapes) -> str:
    """C text of all functions that time loops call, for one unit with these."""
    return "\n".join(c_source.unit_source(function) for function in _functions(shapes) if function.name in FOR_LOOPS)


def _functions(shapes: Shapes) -> "list[NamedFunction]":
    return [
        *kernel_functions.leg_functions(shapes),
        *sliding.friction_functions(shapes),
        *kernel_functions.joint_functions(),
        *kernel_functions.payload_functions(shapes),
    ]


def fingerprint(shapes: Shapes) -> list[object]:
    """Everything the generated code depends on: the text of the equations and the numbers of the bases."""
    texts = [
        path.read_bytes()
        for package in (elements, leg, symbolic)
        for path in sorted(Path(str(package.__file__)).parent.glob("*.py"))
    ]
    numbers = [getattr(basis, field.name) for basis in shapes.beam.bases for field in fields(basis)]
    arrays = [np.ascontiguousarray(x).tobytes() for x in numbers if isinstance(x, np.ndarray)]
    sources = {source_of(one.kind) for one in shapes.elements}
    texts += [path.read_bytes() for path in sorted(path for path in sources if path is not None)]
    return [*texts, *arrays, shapes.layout, shapes.beam.made_of, shapes.chain, [str(one) for one in shapes.elements]]


def evaluate(
    kernel: Kernel, name: str, count: int, inputs: Sequence[Array], shapes: Sequence[tuple[int, ...]]
) -> list[Array]:
    """A kernel function for ``count`` items at once.

    Parameters
    ----------
    kernel : Kernel
    name : str
        One of `NAMES`.
    count : int
    inputs : sequence of ndarray
        Their last axis is one argument of one item; with fewer arguments than items they repeat.
    shapes : sequence of tuple
        Of each output of one item.

    Returns
    -------
    list of ndarray, each shape (count, *shape)

    Raises
    ------
    ValueError
        Sizes are not those of the function.
    """
    rows = [np.ascontiguousarray(x, dtype=float).reshape(prod(x.shape[:-1]), x.shape[-1]) for x in inputs]
    if kernel.library is None:
        return _one_by_one(kernel, name, count, rows, shapes)
    out = getattr(kernel, name).each(count, rows, shapes)  # the kernels write column by column
    return [x.swapaxes(1, 2) if x.ndim == 3 else x for x in out]


def _one_by_one(
    kernel: Kernel, name: str, count: int, rows: list[Array], shapes: Sequence[tuple[int, ...]]
) -> list[Array]:
    function = getattr(kernel, name)
    found = [function(*(x[i % len(x)] for x in rows)) for i in range(count)]
    return [
        np.array([values[k] for values in found], dtype=float).reshape(count, *shape) for k, shape in enumerate(shapes)
    ]
