"""Legs that are not straight: bending and shortening under thrust, (T16.16)-(T16.19)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.estimates import buckling_loads, pinned_root
from flexapod.analysis.pose_errors.backlash import Play
from flexapod.analysis.pose_errors.sensitivity import Sensitivity
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.ranking import EQUALS, first_largest
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.model import Leg, Robot

L = COORDINATES.index("l")


@dataclass(frozen=True, kw_only=True)
class BentLegs:
    """Legs under thrust, (n,).

    `deflection` [m]: largest distance of the bent axis from the line of the joints; `shorter` [m]: than without thrust;
    `share`: thrust over Euler load.
    """

    deflection: Array
    shorter: Array
    share: Array

    def effect(self, axes: Array, at: Sensitivity) -> Array:
        """Displacement and rotation of the tool by leg, (n, 6)."""
        return -np.einsum("n,nj,njx->nx", self.shorter, axes, at.base[0])


def thrust(found: Play) -> Array:
    """Mean thrust along the pistons at the first instant, (n,) [N]."""
    return 0.5 * (found.force[0, 1] + found.force[0, 2])


def bent_legs(robot: Robot, at: Sensitivity, push: Array) -> BentLegs | None:
    """Legs with a bow or eccentric joints under the thrusts `push` (n,) [N]; None where all are straight.

    Raises
    ------
    ComputationError
        A thrust reaches the Euler load.
    """
    if not has_bent_legs(robot):
        return None
    at_rest = _loaded_legs(robot, at, push)
    beside = at_rest.start + (0.5 - 2 / np.pi) * _eccentricities(robot)
    shorter = 0.5 * at_rest.slopes * ((at_rest.start * at_rest.grown) ** 2 - at_rest.cold**2)  # (T16.18)
    return BentLegs(deflection=beside + at_rest.start * (at_rest.grown - 1), shorter=shorter, share=at_rest.share)


class _LoadedLegs(NamedTuple):
    """Legs under thrust, (n,): amplitudes without it, cold and as they are; share, growth, and slopes of the shape."""

    cold: Array
    start: Array
    share: Array
    grown: Array
    slopes: Array


def _loaded_legs(robot: Robot, at: Sensitivity, push: Array) -> _LoadedLegs:
    cold = crookedness(robot)
    free = at.q[0, :, L] - np.array([leg.cylinder.mouth for leg in robot.legs])
    euler = buckling_loads(robot, at.q[:1, :, L])[0]
    share = push / euler
    if share.max() >= 1:
        leg = first_largest(share, EQUALS)
        raise ComputationError(
            f"leg {leg + 1} is pushed with {push[leg]:.4g} N, beyond its Euler load of {euler[leg]:.4g} N",
            next_step="A thicker or shorter piston bears more",
        )
    slopes = np.array([_slopes(leg, s) for leg, s in zip(robot.legs, free, strict=True)])
    slopes *= [leg.measured != "joint-to-joint" for leg in robot.legs]  # what shortens a leg is seen there
    return _LoadedLegs(cold, cold + _by_heat(robot, free), share, 1 / (1 - share), slopes)  # (T16.17)


def bow_sensitivity(robot: Robot, at: Sensitivity, push: Array) -> tuple[Array, Array]:
    """Elongation of legs under thrust by a further bow x, c1 x + c2 x^2: c1 [1], c2 [1/m], (n,), Eq. (T16.21)."""
    x = _loaded_legs(robot, at, push)
    return -x.slopes * (x.grown**2 * x.start - x.cold), -0.5 * x.slopes * (x.grown**2 - 1)


def bending_sensitivity(robot: Robot, at: Sensitivity, push: Array) -> Array:
    """Elongation of crooked legs under thrust per relative increase of EI, (n,) [m], Eq. (T16.22)."""
    x = _loaded_legs(robot, at, push)
    return x.slopes * x.start**2 * x.grown**3 * x.share


def has_bent_legs(robot: Robot) -> bool:
    """Test whether any leg is not straight."""
    return bool(crookedness(robot).any() or _curvatures(robot).any())


def crookedness(robot: Robot) -> Array:
    """Amplitudes of the legs' axes off the lines of their joints without thrust, (n,) [m], Eq. (T16.16)."""
    return np.array([leg.piston.bow or 0.0 for leg in robot.legs]) + 2 / np.pi * _eccentricities(robot)


def _eccentricities(robot: Robot) -> Array:
    """Sum of the eccentricities of both joints of each leg, (n,) [m]."""
    ends = ((leg.base_joint.eccentricity, leg.platform_joint.eccentricity) for leg in robot.legs)
    return np.array([(base or 0.0) + (platform or 0.0) for base, platform in ends])


def _curvatures(robot: Robot) -> Array:
    """Curvatures of pistons with a temperature difference across them, (n,) [1/m]."""
    gradient = None if robot.heat is None else robot.heat.gradient
    if robot.heat is None or gradient is None or gradient.piston is None:
        return np.zeros(robot.count)
    width = np.array([leg.piston.width for leg in robot.legs])
    return kinematics.expansion(robot, robot.heat, "piston") * gradient.piston / width


def _by_heat(robot: Robot, free: Array) -> Array:
    """Largest distance of pistons of constant curvature from the line of the joints, (n,) [m], Eq. (T16.20)."""
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    at = free**2 / (2 * (free + mouth))  # from the mouth
    return 0.5 * np.abs(_curvatures(robot)) * at * (at + 2 * mouth)


def _slopes(leg: Leg, free: float) -> float:
    """Int phi'^2 dx of the shape in which a leg of uniform section buckles, its largest value 1 [1/m]."""
    m = leg.cylinder.mouth
    k = pinned_root(np.array(m / free)) / free
    rigid = np.sin(k * free) ** 2 / m if m > 0 else 0.0
    return float(rigid + k**2 * (free / 2 + np.sin(2 * k * free) / (4 * k)))


def axial_sensitivity(robot: Robot, push: Array) -> Array:
    """Elongation of the pistons under thrust per relative increase of EA, (n,) [m], Eq. (T16.19)."""
    return push * np.array([leg.piston.length / leg.piston.EA for leg in robot.legs])
