"""The locked robot as `dynamic_stiffness` takes it, and what a number of shapes leaves out of its frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import spherical_jn

from flexapod.common.arrays import Array
from flexapod.model import Leg, Robot
from flexapod.verification import dynamic_stiffness


def legs_and_body(
    robot: Robot, pose: Sequence[float], shapes: int | None = None, compliance: float = 0.0
) -> tuple[list[dynamic_stiffness.UniformLeg], dynamic_stiffness.LockedPayload]:
    """Legs and payload at a pose (6,) from home [m, rad]; geometry written anew, not that of `flexapod.kinematics`.

    Carriages and platforms that are not where six legs UPS would have them: at home only.

    `shapes` and `compliance` [m/N] of the drives: see `dynamic_stiffness.UniformLeg`.
    """
    R = Rotation.from_euler("xyz", pose[3:]).as_matrix()
    at = np.array([0, 0, robot.home_height]) + pose[:3]
    places = zip(robot.legs, robot.home_bases, at + robot.platform_joints @ R.T, robot.home_vectors, strict=True)
    legs = [_leg(leg, base, tip, home, shapes, compliance) for leg, base, tip, home in places]
    load, free = robot.payload, np.eye(6)
    if robot.plane:
        normal = robot.normal != 0
        free = free[np.concatenate([~normal, normal])]
        legs = [_flat(leg, robot.normal) for leg in legs]
    else:
        legs = [replace(own, **_ends(leg)) for own, leg in zip(legs, robot.legs, strict=True)]
    return legs, dynamic_stiffness.LockedPayload(
        mass=load.mass, com=at + R @ load.com, inertia=R @ load.inertia @ R.T, free=free
    )


def _flat(leg: dynamic_stiffness.UniformLeg, normal: Array) -> dynamic_stiffness.UniformLeg:
    """The leg hinged at both ends about the normal of the plane, across which alone it bends."""
    return replace(leg, first_axis=normal, base_axes=normal[None], tip_axes=normal[None], planes=(1,))


def _ends(leg: Leg) -> dict[str, Array | float]:
    """Joints that are not universal at the base or not a ball at the platform."""
    none, found = np.zeros((0, 3)), {}
    if leg.letters.base in "RF":
        found["base_axes"] = none if leg.base_joint.axis is None else leg.base_joint.axis[None]
    if leg.letters.platform != "S":  # a round piston has twice the inertia that bending has
        rod = leg.piston
        inertia = rod.axial_inertia or 2 * rod.rhoA * rod.length * rod.EI / rod.EA
        found |= {"tip_axes": none, "GJ": rod.torsional_stiffness, "spin_inertia": inertia}
    return found


def _leg(
    leg: Leg, base: Array, tip: Array, home: Array, shapes: int | None, compliance: float
) -> dynamic_stiffness.UniformLeg:
    axis = np.cross([0.0, 0.0, 1.0], home) if leg.u_axis is None else leg.u_axis
    if not axis.any():  # an upright leg has no axis of its own across it
        axis = np.array([1.0, 0.0, 0.0])
    axis = axis - (axis @ home) / (home @ home) * home  # across the leg at home
    cylinder, rod = leg.cylinder, leg.piston
    return dynamic_stiffness.UniformLeg(
        base=base,
        tip=tip,
        first_axis=axis / np.linalg.norm(axis),
        EA=rod.EA,
        EI=rod.EI,
        rhoA=rod.rhoA,
        Lp=rod.length,
        mouth=cylinder.mouth,
        inertia=cylinder.inertia + cylinder.mass * cylinder.com**2,
        axial_inertia=cylinder.axial_inertia + (rod.axial_inertia if leg.letters.platform == "S" else 0.0),
        shapes=shapes,
        compliance=np.inf if leg.passive else compliance,
    )


def wave_number(legs: Sequence[dynamic_stiffness.UniformLeg], frequency: Array) -> Array:
    """Largest lambda = s (rhoA omega^2 / EI)^(1/4) of the legs at frequencies [Hz]."""
    slowest = max((leg.length - leg.mouth) * (leg.rhoA / leg.EI) ** 0.25 for leg in legs)
    return slowest * np.sqrt(2 * np.pi * np.asarray(frequency))


def missing_sines(legs: Sequence[dynamic_stiffness.UniformLeg], frequency: Array, axial: int) -> Array:
    """Relative error of frequencies [Hz] from the axial shapes left out, at most: half the rest of (T7.10)'s series.

    To first order the shift is the tip's strain energy that the rest adds over twice the whole, and the whole is at
    least the static one of the bars.
    """
    x = 2 * np.pi * np.asarray(frequency) * max(leg.Lp * np.sqrt(leg.rhoA / leg.EA) for leg in legs)
    squares = (np.pi * np.arange(axial, 2000)) ** 2
    return np.array([np.sum(y**4 / (squares * (squares - y**2))) for y in x])


def missing_twist(legs: Sequence[dynamic_stiffness.UniformLeg], frequency: Array) -> Array:
    """Relative error of frequencies [Hz] from one shape of twist, as `missing_sines` of a shaft in place of a bar."""
    slow = max((np.sqrt(leg.spin_inertia * leg.Lp / leg.GJ) for leg in legs if leg.GJ), default=0.0)
    squares = (np.pi * np.arange(1, 2000)) ** 2
    return np.array([np.sum(y**4 / (squares * (squares - y**2))) for y in 2 * np.pi * slow * np.asarray(frequency)])


def missing_polynomials(legs: Sequence[dynamic_stiffness.UniformLeg], frequency: Array, k: int) -> Array:
    """Relative error of frequencies [Hz] from k shapes a plane: what polynomials of degree < k lack of a sine.

    The curvature of `tip-load` has degree k; the free tip takes one. Legendre coefficient n of sin(lambda z + phase) is
    (2 n + 1) j_n(lambda / 2); the mean square of the sine is a half, and half the energy's error is the frequency's.
    """
    n = np.arange(k, 60)[:, None]
    return np.sum((2 * n + 1) * spherical_jn(n, wave_number(legs, frequency) / 2) ** 2, axis=0)
