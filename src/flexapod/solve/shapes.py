"""The lateral shapes of a study: a basis by name, or reduced from the solid piston."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from flexapod import bases, rigid
from flexapod.bases.lateral import LateralBasis
from flexapod.errors import InputError
from flexapod.model import Actuator, Rectangle, Robot, Simulation, Tube

__all__ = ["beam_shapes", "leg_shapes"]

SOLID = "solid"
POISSON = 0.3  # of metals; no study file gives it, and a beam does not know it


def leg_shapes(robot: Robot, simulation: Simulation) -> LateralBasis:
    """Shapes of the legs of a robot, the same in both planes of all six.

    Raises
    ------
    InputError
        Solid legs without a diameter, or of different pistons: one basis serves all legs.
    """
    name, count = simulation.lateral_basis, simulation.lateral_shapes
    if name != SOLID:
        return bases.lateral_basis(name, count)
    sections = {(leg.piston.diameter, leg.piston.inner_diameter) for leg in robot.legs}
    diameter, inner = min(sections, key=str)
    if len(sections) > 1 or diameter is None:
        raise InputError(
            "takes legs whose pistons are alike and given by their diameter: one solid piston is reduced for all",
            key="simulation.fidelity",
            value=simulation.fidelity,
            allowed="rigid, lumped, finite-segment, assumed-modes, beam-fem for other legs",
        )
    home = rigid.inverse_kinematics(robot, rigid.home_pose(robot)).length[0]
    free = float(np.mean(home - [leg.cylinder.mouth for leg in robot.legs]))
    return _solid(Tube(diameter=diameter, inner_diameter=inner), free, count)  # type: ignore[arg-type]


def beam_shapes(actuator: Actuator, simulation: Simulation, rate: float = 0.0) -> LateralBasis:
    """Shapes of the single actuator; ``tip-load`` ones in steady rotation know the ``rate`` [rad/s], Eq. (T1.16).

    Raises
    ------
    InputError
        A solid beam without a section.
    """
    name, count = simulation.lateral_basis, simulation.lateral_shapes
    if name != SOLID:
        return bases.lateral_basis(name, count, *_ratios(actuator, name, rate))
    if actuator.section is None:
        raise InputError(
            "needs the section of the beam",
            key="simulation.fidelity",
            value=simulation.fidelity,
            next_step="Give actuator.section and material in place of EI and rhoA",
        )
    return _solid(actuator.section, actuator.free_length, count)  # type: ignore[arg-type]


def _ratios(actuator: Actuator, basis: str, rate: float) -> tuple[float, ...]:
    """What the shapes depend on, dimensionless: arguments of `bases.lateral_basis` after the count.

    ``tip-mass`` shapes know mass and inertia of the tip body. ``tip-load`` shapes know whether it takes a moment and,
    in steady rotation, speed, hub radius and the mass that pulls at the tip. The others know nothing.
    """
    length = actuator.free_length
    mass = actuator.tip_mass / (actuator.rhoA * length)
    inertia = actuator.tip_inertia / (actuator.rhoA * length**3)
    if basis == "tip-mass":
        return mass, inertia
    if basis == "tip-load" and rate:
        speed = abs(rate) * float(np.sqrt(actuator.rhoA * length**4 / actuator.EI))
        return mass, inertia, speed, actuator.hub_radius / length
    return (0.0, float(inertia > 0)) if basis == "tip-load" else ()


@lru_cache(maxsize=16)
def _solid(section: Tube | Rectangle, length: float, count: int) -> LateralBasis:
    from flexapod.fem.leg_shapes import solid_leg_shapes  # scikit-fem loads on use

    return solid_leg_shapes(section, length, count, poisson=POISSON)
