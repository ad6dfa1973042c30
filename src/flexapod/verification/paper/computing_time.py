"""Floating-point operations of the inverse dynamics of a rigid leg, by Newton and Euler and by Lagrange.

Both from angles, length, their rates and accelerations, with the same parameters. What comes after is the same for
both: six balances of the payload, and six equations for the forces along the legs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from xarray import Dataset

from flexapod import model
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.time_history import Share
from flexapod.common.arrays import Array
from flexapod.kinematics import dynamics
from flexapod.kinematics.inverse import JointTurn
from flexapod.kinematics.rotations import rotate_vector
from flexapod.mechanics import shapes as bases
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, Shapes
from flexapod.mechanics.leg.leg import leg
from flexapod.mechanics.leg.leg_beam import LegBeam
from flexapod.mechanics.leg.leg_chain import LegChain
from flexapod.mechanics.symbolic.functions import NamedFunction, inverse_dynamics, operations
from flexapod.mechanics.symbolic.vocabulary import symbol, symbols

FORMULATIONS = ("Newton-Euler", "Lagrange")


class CountedNumber:
    """A number that counts in `tally` what is computed with it; NumPy's arithmetic of object arrays asks it."""

    def __init__(self, value: float, tally: list[int]) -> None:
        self.value: float = value
        self.tally: list[int] = tally

    def _done(self, value: float) -> CountedNumber:
        self.tally[0] += 1
        return CountedNumber(value, self.tally)

    def __add__(self, other: CountedNumber | float) -> CountedNumber:
        return self._done(self.value + _plain(other))

    def __radd__(self, other: CountedNumber | float) -> CountedNumber:
        return self + other

    def __sub__(self, other: CountedNumber | float) -> CountedNumber:
        return self._done(self.value - _plain(other))

    def __mul__(self, other: CountedNumber | float) -> CountedNumber:
        return self._done(self.value * _plain(other))

    def __rmul__(self, other: CountedNumber | float) -> CountedNumber:
        return self * other

    def __truediv__(self, other: CountedNumber | float) -> CountedNumber:
        return self._done(self.value / _plain(other))

    def __pow__(self, power: int) -> CountedNumber:
        return self._done(self.value**power)

    def __neg__(self) -> CountedNumber:
        return CountedNumber(-self.value, self.tally)

    def cos(self) -> CountedNumber:
        """Cosine, for NumPy."""
        return self._done(float(np.cos(self.value)))

    def sin(self) -> CountedNumber:
        """Sine, for NumPy."""
        return self._done(float(np.sin(self.value)))


def _plain(number: CountedNumber | float) -> float:
    return number.value if isinstance(number, CountedNumber) else number


def inverse_dynamics_cost(_: Share) -> Dataset:
    """Operations of one rigid leg's inverse dynamics; they are the same for every robot of this kind.

    Returns
    -------
    xarray.Dataset
        `operations` (formulation): additions, multiplications, divisions, sines and cosines, one each.
    """
    tally = [0]
    _newton_euler_leg(lambda *shape: _numbers(shape, tally))
    lagrange = sum(operations(lagrange_leg().build()).values())
    values = ("formulation", [tally[0], lagrange], {"units": "1"})
    return Dataset({"operations": values}, {"formulation": list(FORMULATIONS)}, attributes(model.preset("paper-robot")))


def _newton_euler_leg(numbers: Callable[..., Array]) -> tuple[Array, ...]:
    """Forces across and along one leg in one pose from given numbers, by Eqs. (T2.26)-(T2.34)."""
    names = ("length", "rate", "accel", "alpha_dot", "beta_dot", "alpha_ddot", "beta_ddot")
    bodies = dynamics.LegBodies(**{name: numbers(1, 1) for name in dynamics.LegBodies.__dataclass_fields__})
    turn = JointTurn.from_angles(numbers(1, 1), numbers(1, 1))
    legs = dynamics.LegArrays(turn=turn, **{name: numbers(1, 1) for name in names})
    home, gravity, along = numbers(3, 3, 1, 1), numbers(3), numbers(1, 1)
    leg_gravity = turn.into_leg(rotate_vector(home, gravity))
    motion = dynamics.leg_motion(bodies, legs)
    across, _ = dynamics.transverse_forces(bodies, legs, motion, leg_gravity)
    return (*across[:2], dynamics.axial_drive_force(bodies, motion, leg_gravity, along))


def _numbers(shape: tuple[int, ...], tally: list[int]) -> Array:
    found = np.empty(shape, dtype=object)
    for index in np.ndindex(*shape):
        found[index] = CountedNumber(1.0, tally)
    return found


def lagrange_leg() -> NamedFunction:
    """Leg by Lagrange's equations, differentiated symbolically, Eqs. (T3.1)-(T3.2): M v_dot + h of 3 rows."""
    none = bases.lateral_basis("clamped-free", 0)
    shapes = Shapes(beam=LegBeam(a=none, b=none, axial=bases.axial_basis(0)), chain=LegChain())
    p_vector, p = symbols(LEG_PARAMETERS, "p")
    q, qs = symbols(shapes.layout, "q")
    v, vs = symbols(shapes.layout, "v")
    v_dot = symbol("v_dot", shapes.size)
    r = inverse_dynamics(leg(shapes, p, q, v, qs, vs).lagrangian, v_dot)
    return NamedFunction("lagrange_leg", [("q", q), ("v", v), ("v_dot", v_dot), ("p", p_vector)], [("r", r)])
