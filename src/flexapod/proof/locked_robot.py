"""The locked robot as `dynamic_stiffness` takes it, and what a number of shapes leaves out of its frequencies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import spherical_jn

from flexapod.model import Leg, Robot
from flexapod.proof import dynamic_stiffness
from flexapod.typing import Array

__all__ = ["legs_and_body", "missing_polynomials", "missing_sines", "wave_number"]


def legs_and_body(
    robot: Robot, pose: Sequence[float], shapes: int | None = None, compliance: float = 0.0
) -> tuple[list[dynamic_stiffness.Leg], dynamic_stiffness.Body]:
    """Legs and payload at a pose (6,) from home [m, rad]; geometry written anew, not that of `flexapod.rigid`.

    `shapes` and `compliance` [m/N] of the drives: see `dynamic_stiffness.Leg`.
    """
    R = Rotation.from_euler("xyz", pose[3:]).as_matrix()
    at = np.array([0, 0, robot.home_height]) + pose[:3]
    places = zip(robot.legs, robot.base_joints, at + robot.platform_joints @ R.T, robot.home_vectors, strict=True)
    legs = [_leg(leg, base, tip, home, shapes, compliance) for leg, base, tip, home in places]
    load = robot.payload
    return legs, dynamic_stiffness.Body(mass=load.mass, com=at + R @ load.com, inertia=R @ load.inertia @ R.T)


def _leg(
    leg: Leg, base: Array, tip: Array, home: Array, shapes: int | None, compliance: float
) -> dynamic_stiffness.Leg:
    axis = np.cross([0.0, 0.0, 1.0], home) if leg.u_axis is None else leg.u_axis
    axis = axis - (axis @ home) / (home @ home) * home  # across the leg at home
    cylinder, rod = leg.cylinder, leg.piston
    return dynamic_stiffness.Leg(
        base=base,
        tip=tip,
        first_axis=axis / np.linalg.norm(axis),
        EA=rod.EA,
        EI=rod.EI,
        rhoA=rod.rhoA,
        Lp=rod.length,
        mouth=cylinder.mouth,
        inertia=cylinder.inertia + cylinder.mass * cylinder.com**2,
        axial_inertia=cylinder.axial_inertia + rod.axial_inertia,
        shapes=shapes,
        compliance=compliance,
    )


def wave_number(legs: Sequence[dynamic_stiffness.Leg], frequency: Array) -> Array:
    """Largest lambda = s (rhoA omega^2 / EI)^(1/4) of the legs at frequencies [Hz]."""
    slowest = max((leg.length - leg.mouth) * (leg.rhoA / leg.EI) ** 0.25 for leg in legs)
    return slowest * np.sqrt(2 * np.pi * np.asarray(frequency))


def missing_sines(legs: Sequence[dynamic_stiffness.Leg], frequency: Array, axial: int) -> Array:
    """Relative error of frequencies [Hz] from the axial shapes left out, at most: half the rest of (T7.10)'s series.

    To first order the shift is the tip's strain energy that the rest adds over twice the whole, and the whole is at
    least the static one of the bars.
    """
    x = 2 * np.pi * np.asarray(frequency) * max(leg.Lp * np.sqrt(leg.rhoA / leg.EA) for leg in legs)
    squares = (np.pi * np.arange(axial, 2000)) ** 2
    return np.array([np.sum(y**4 / (squares * (squares - y**2))) for y in x])


def missing_polynomials(legs: Sequence[dynamic_stiffness.Leg], frequency: Array, k: int) -> Array:
    """Relative error of frequencies [Hz] from k shapes a plane: what polynomials of degree < k lack of a sine.

    The curvature of `tip-load` has degree k; the free tip takes one. Legendre coefficient n of sin(lambda z + phase) is
    (2 n + 1) j_n(lambda / 2); the mean square of the sine is a half, and half the energy's error is the frequency's.
    """
    n = np.arange(k, 60)[:, None]
    return np.sum((2 * n + 1) * spherical_jn(n, wave_number(legs, frequency) / 2) ** 2, axis=0)
