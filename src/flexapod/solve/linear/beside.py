"""Functions of a leg that the linear model alone asks for, made when it does, Eqs. (T20.3), (T20.9), (T20.26)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.elements.element import Physics
from flexapod.mechanics.elements.motor_loop import MotorLoop
from flexapod.mechanics.leg.layout import Shapes
from flexapod.mechanics.symbolic.compiler import CompiledFunction, compiled_library, compiler
from flexapod.solve.kernel import Function, fingerprint
from flexapod.solve.system import System

__all__ = ["carried", "lines", "pushes"]


def pushes(system: System, q: Array) -> tuple[Array, Array] | None:
    """D and K (P, legs, n, n) of what pushes without an energy at coordinates (P, legs, n); None of robots without."""
    shapes, legs = system.kernel.shapes, q.reshape(-1, system.n)
    if shapes.holds(MotorLoop):
        D, K, *_ = _each(system.kernel.leg_loop, legs, system, [(system.n, system.n)] * 2 + [(1,), (system.n,)])
    elif any(_pushes(slot.kind) for slot in shapes.elements):
        D, K = _each(_function(shapes, "leg_pushes"), legs, system, [(system.n, system.n)] * 2)
    else:
        return None
    return D.reshape(*q.shape, system.n), K.reshape(*q.shape, system.n)


def carried(system: System, q: Array) -> Array:
    """Masses (P, legs, 6, n) between coordinates (P, legs, n) and a base that is moved; a system that has one."""
    found = _each(_function(system.kernel.shapes, "leg_carried"), q.reshape(-1, system.n), system, [(6, system.n)])[0]
    return found.reshape(*q.shape[:-1], 6, system.n)


def lines(system: System, q: Array) -> tuple[Array, Array]:
    """Lines (P, legs, 3) from base joints to tips at coordinates (P, legs, n), and derivatives by these (..., 3, n)."""
    function, n = _function(system.kernel.shapes, "leg_line"), system.n
    line, J = _each(function, q.reshape(-1, n), system, [(3,), (3, n)])
    return line.reshape(*q.shape[:-1], 3), J.reshape(*q.shape[:-1], 3, n)


def _pushes(kind: type[Physics]) -> bool:
    own = (kind.pushes.__func__, kind.asked.__func__)  # type: ignore[attr-defined]
    return own != (Physics.pushes.__func__, Physics.asked.__func__)  # type: ignore[attr-defined]


def _each(function: Function | None, q: Array, system: System, shapes: Sequence[tuple[int, ...]]) -> list[Array]:
    p = np.tile(system.leg_p, (len(q) // system.legs, 1))
    if isinstance(function, CompiledFunction):
        return [x.swapaxes(1, 2) if x.ndim == 3 else x for x in function.each(len(q), [q, p], shapes)]
    found = [function(*row) for row in zip(q, p, strict=True)]  # type: ignore[misc]
    return [np.array([one[k] for one in found]).reshape(len(q), *shape) for k, shape in enumerate(shapes)]


@lru_cache(maxsize=32)
def _function(shapes: Shapes, name: str) -> Function:
    """One of `assembly`, compiled where there is a compiler."""
    from flexapod.mechanics.leg import kernel_functions

    if command := compiler():
        library, signatures = compiled_library(
            [name, *fingerprint(shapes)], lambda: [getattr(kernel_functions, name)(shapes)], command
        )
        return CompiledFunction(library, name, signatures[name])
    from flexapod.mechanics.symbolic.functions import Interpreted

    return Interpreted(getattr(kernel_functions, name)(shapes))
