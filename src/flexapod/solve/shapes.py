"""Coordinates of a study: its shapes, by name or reduced from the solid piston, and the places of a beam's."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import ABSENT, COORDINATES, FREE, HELD, Limbs
from flexapod.mechanics import shapes as bases
from flexapod.mechanics.elements.element import Physics
from flexapod.mechanics.elements.registry import elements_of
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.tip_body import PlanarTipBody, TipBody
from flexapod.mechanics.elements.torsion import Torsion
from flexapod.mechanics.leg.layout import Shapes, columns
from flexapod.mechanics.leg.leg_beam import LegBeam
from flexapod.mechanics.leg.leg_chain import LegChain
from flexapod.mechanics.shapes.lateral import LateralBasis
from flexapod.model import Actuator, Rectangle, Robot, Simulation, Tube

SOLID = "solid"
#: Coordinates of an actuator in space by the motions that drive them.
SPACE_NAMES = {"extension": "l", "rotation": "alpha", "elevation": "beta"}


def robot_shapes(robot: Robot, simulation: Simulation, legs: Limbs) -> Shapes:
    """Coordinates of the legs of a robot: those that any of them has."""
    spin, gamma3 = (legs.state[:, COORDINATES.index(name)] for name in ("spin", "gamma3"))
    pose = bool(legs.pose_closure.any())
    lateral = leg_shapes(robot, simulation)
    shear = simulation.lateral_shapes > 0 and any(leg.piston.shear for leg in robot.legs)
    beam = LegBeam(
        a=bases.lateral_basis("clamped-free", 0) if robot.plane else lateral,  # across the plane nothing bends
        b=lateral,
        axial=bases.axial_basis(simulation.axial_shapes(robot.legs[0].axial_modes)),
        guide=_inner(simulation.lateral_shapes, robot),
        cylinder=_cylinder(simulation.lateral_shapes, robot),
        sections=max(len(leg.piston.sections) for leg in robot.legs) or int(shear),
        strips=any(section.width != section.thickness for leg in robot.legs for section in leg.piston.sections),
        tapers=any(section.tapered for leg in robot.legs for section in leg.piston.sections),
        shear=shear,
    )
    chain = LegChain(
        carriage=legs.carriage,
        spin=bool((spin != ABSENT).any()),
        closure="pose" if pose else "point",
        pivot_spin=bool(((spin == FREE) & (gamma3 == HELD)).any()),
    )
    torsion = (Slot(Torsion),) * (pose and simulation.lateral_shapes > 0)
    return Shapes(beam=beam, chain=chain, elements=torsion + elements_of(robot, simulation))


def _bends(robot: Robot) -> bool:
    return any(leg.cylinder.section is not None for leg in robot.legs)


def _inner(count: int, robot: Robot) -> LateralBasis | None:
    """Shapes of pistons between their bushings, a short piece: half as many as outside, at most four.

    Of an odd number half of the next where a cylinder bends: one alone costs more than the kink at the head gains.
    """
    if all(leg.guide is None for leg in robot.legs):
        return None
    return bases.lateral_basis("tip-load", min(max((count + _bends(robot)) // 2, 1), 4, count))


def _cylinder(count: int, robot: Robot) -> LateralBasis | None:
    """Shapes of cylinders that bend, the static ones under forces and moments at the mouth among them."""
    if not count or not _bends(robot):
        return None
    return bases.lateral_basis("tip-load", min((count + 1) // 2 + 1, 5), moment=True)


def space_shapes(lateral: LateralBasis, axial_modes: int, *elements: type[Physics], **joints: Any) -> Shapes:
    """Shapes of a leg that bends equally in both planes; ``joints`` as in `LegChain`, by default of a leg UPS."""
    beam = LegBeam(a=lateral, b=lateral, axial=bases.axial_basis(axial_modes))
    return Shapes(beam=beam, chain=LegChain(**joints), elements=tuple(map(Slot, elements)))


def planar_shapes(lateral: LateralBasis) -> Shapes:
    """Shapes of the single actuator in its plane."""
    none = bases.lateral_basis("clamped-free", 0)
    beam, chain = LegBeam(a=lateral, b=none, axial=bases.axial_basis(0)), LegChain(planar=True, closure="none")
    return Shapes(beam=beam, chain=chain, elements=(Slot(PlanarTipBody),))


def actuator_shapes(actuator: Actuator, simulation: Simulation, rate: float = 0.0) -> Shapes:
    """Shapes of a single actuator: in its plane, or in space with stretch and twist where they have a stiffness.

    ``rate``: see `beam_shapes`.
    """
    lateral = beam_shapes(actuator, simulation, rate)
    if not actuator.space:
        return planar_shapes(lateral)
    axial = simulation.axial_shapes(actuator.axial_modes) if actuator.EA is not None else 0
    torsion = (Torsion,) * (actuator.GJ is not None and simulation.lateral_shapes > 0)
    return space_shapes(lateral, axial, *torsion, TipBody, closure="none")


def leg_shapes(robot: Robot, simulation: Simulation) -> LateralBasis:
    """Shapes of the legs of a robot, the same in both planes of all; solid pistons are equal (`model.Study`).

    Where a platform joint takes a moment, static answers to one are among them, Eq. (T1.18).
    """
    name, count = simulation.lateral_basis, simulation.lateral_shapes
    moment = bool(kinematics.robot_limbs(robot).pose_closure.any())
    if name != SOLID:
        return bases.lateral_basis(name, count, moment=moment)
    piston = robot.legs[0].piston
    home = kinematics.inverse_kinematics(robot, kinematics.home_pose(robot)).length[0]
    free = float(np.mean(home - [leg.cylinder.mouth for leg in robot.legs]))
    return _solid(Tube(diameter=piston.diameter, inner_diameter=piston.inner_diameter), free, count, moment)  # type: ignore[arg-type]


def beam_shapes(actuator: Actuator, simulation: Simulation, rate: float = 0.0) -> LateralBasis:
    """Shapes of the single actuator; ``tip-load`` ones in steady rotation know the ``rate`` [rad/s], Eq. (T1.16)."""
    name, count = simulation.lateral_basis, simulation.lateral_shapes
    if name != SOLID:
        return bases.lateral_basis(name, count, *_ratios(actuator, name, rate))
    return _solid(actuator.section, actuator.free_length, count)  # type: ignore[arg-type]


def _ratios(actuator: Actuator, basis: str, rate: float) -> tuple[float, ...]:
    """Dimensionless numbers of the shapes: arguments of `lateral_basis` after the count.

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
    return (0.0, float(inertia > 0 or actuator.space)) if basis == "tip-load" else ()


@lru_cache(maxsize=16)
def _solid(section: Tube | Rectangle, length: float, count: int, moment: bool = False) -> LateralBasis:
    """Lateral basis of a solid leg without lateral contraction: no study file gives Poisson's ratio."""
    from flexapod.solve.fem.reduction import solid_leg_shapes  # scikit-fem loads on use

    return solid_leg_shapes(section, length, count, moment=moment)


def places(shapes: Shapes) -> dict[str, int]:
    """Positions of the coordinates that motions and loads drive, in the order of the ports, by name of the motion."""
    names = {"extension": "l", "rotation": "beta"} if shapes.chain.planar else SPACE_NAMES
    return {motion: shapes.index(name) for motion, name in names.items()}


def home(actuator: Actuator) -> dict[str, float]:
    """Coordinates of an actuator at t = 0 [rad, m], by the names of `places`; the extension from the pivot."""
    begin = {"extension": actuator.hub_radius + actuator.free_length, "rotation": actuator.angle}
    return begin | ({"elevation": actuator.elevation} if actuator.space else {})


def lateral_signs(shapes: Shapes, along: float, up: float) -> list[tuple[str, float]]:
    """Amplitudes by name, and their parts of a deflection ``along`` the rotation and ``up`` the elevation, (T9.9)."""
    return [("a", along)] if shapes.chain.planar else [("b", -along), ("a", up)]


def amplitudes(shapes: Shapes, q: Array, name: str) -> Array:
    """Columns of q (T, n) of the amplitudes called ``name``."""
    return q[:, columns(shapes.layout, name)]
