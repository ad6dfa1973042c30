"""Named functions of dense arrays, and Lagrange's equations by differentiation, Eqs. (T3.1)-(T3.3).

Named functions are the only thing that leaves the symbolic layer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi
import numpy as np
from casadi import SX

from flexapod.common.arrays import Array
from flexapod.mechanics.symbolic.vocabulary import gradient, jacobian, time_derivative


@dataclass(frozen=True)
class NamedFunction:
    """A function by name with (name, expression) inputs and outputs.

    ``alone``: it is called from C for one body, too, not only for a vector of bodies.
    """

    name: str
    inputs: Sequence[tuple[str, SX]]
    outputs: Sequence[tuple[str, SX]]
    alone: bool = False

    def build(self) -> casadi.Function:
        """CasADi function with dense outputs that does every operation once."""
        return self._function(casadi.cse(self._dense()))

    def as_written(self) -> casadi.Function:
        """The same to the bit, operations as often as they are written: a fifth more, made in a twentieth of it."""
        return self._function(self._dense())

    def _dense(self) -> list[SX]:
        return [casadi.densify(y) for _, y in self.outputs]

    def _function(self, outputs: list[SX]) -> casadi.Function:
        inputs = [x for _, x in self.inputs]
        return casadi.Function(self.name, inputs, outputs, [n for n, _ in self.inputs], [n for n, _ in self.outputs])

    def signature(self) -> dict[str, object]:
        """Sizes of inputs and shapes of outputs, for callers that do not know casadi."""
        return {
            "inputs": [int(x.numel()) for _, x in self.inputs],
            "outputs": [[int(y.shape[0]), int(y.shape[1])] for _, y in self.outputs],
        }


class Interpreted:
    """A function evaluated by casadi's virtual machine: slow, but there at once."""

    def __init__(self, function: NamedFunction) -> None:
        self._function = function.as_written()

    def __call__(self, *arguments: Array) -> tuple[Array, ...]:
        """Outputs as 1-D arrays (columns) or 2-D arrays."""
        result = self._function.call([casadi.DM(np.asarray(a, dtype=float).ravel()) for a in arguments])
        return tuple(np.asarray(y).ravel() if y.shape[1] == 1 else np.asarray(y) for y in result)


_KINDS = {
    casadi.OP_ADD: "additions",
    casadi.OP_SUB: "additions",
    casadi.OP_TWICE: "additions",
    casadi.OP_MUL: "multiplications",
    casadi.OP_SQ: "multiplications",
    casadi.OP_DIV: "divisions",
    casadi.OP_INV: "divisions",
    casadi.OP_SQRT: "roots",
    casadi.OP_EXP: "exponentials",
    casadi.OP_SIN: "circular",
    casadi.OP_COS: "circular",
}
_MOVES = {casadi.OP_CONST, casadi.OP_INPUT, casadi.OP_OUTPUT, casadi.OP_NEG, casadi.OP_ASSIGN}


def operations(function: casadi.Function) -> dict[str, int]:
    """Floating-point operations of one call by kind.

    Additions, multiplications, divisions, roots, exponentials, circular.

    Raises
    ------
    ValueError
        An operation of no such kind.
    """
    found: dict[str, int] = {}
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        if operation in _MOVES:
            continue
        if operation not in _KINDS:
            raise ValueError(f"an operation that is not counted: {operation}")
        found[_KINDS[operation]] = found.get(_KINDS[operation], 0) + 1
    return found


@dataclass(frozen=True, kw_only=True)
class Lagrangian:
    """Energies of a body in coordinates q and rates v."""

    q: SX
    v: SX
    kinetic: SX
    potential: SX
    dissipation: SX


def inverse_dynamics(e: Lagrangian, v_dot: SX) -> SX:
    """Residual M v_dot + h of the free body, without forces, Eq. (T3.2)."""
    p = gradient(e.kinetic, e.v)  # (T3.1)  p = dT/dv
    return (
        time_derivative(p, (e.q, e.v), (e.v, v_dot))  # (T3.2)  dp/dt
        - gradient(e.kinetic - e.potential, e.q)  #                - dL/dq
        + gradient(e.dissipation, e.v)  #                          + dR/dv
    )


def mass_matrix(e: Lagrangian) -> SX:
    """M = d2T/dv2, Eq. (T3.3)."""
    return jacobian(gradient(e.kinetic, e.v), e.v)
