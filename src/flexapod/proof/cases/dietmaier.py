"""All postures of a platform with forty of them."""

from __future__ import annotations

import numpy as np

from flexapod.proof.case import Case, Check
from flexapod.rigid.forward import all_postures
from flexapod.rigid.jacobian import length_jacobian
from flexapod.rigid.kinematics import leg_lengths

BASE = np.array([
    [0.0, 0.0, 0.0], [1.107915, 0.0, 0.0], [0.549094, 0.756063, 0.0],
    [0.735077, -0.223935, 0.525991], [0.514188, -0.526063, -0.368418], [0.590473, 0.094733, -0.205018],
])  # fmt: skip
PLATFORM = np.array([
    [0.0, 0.0, 0.0], [0.542805, 0.0, 0.0], [0.956919, -0.528915, 0.0],
    [0.665885, -0.353482, 1.402538], [0.478359, 1.158742, 0.107672], [-0.137087, -0.235121, 0.353913],
])  # fmt: skip
LENGTHS = np.array([1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071])


def _compute() -> list[Check]:
    poses = all_postures(BASE, PLATFORM, LENGTHS).poses
    determinant = np.linalg.det(length_jacobian(BASE, PLATFORM, poses.position, poses.rotation))
    known = np.linalg.norm(poses.position - [0.955868, -0.046996, -0.290013], axis=1).min()

    gap = np.abs(leg_lengths(BASE, PLATFORM, poses.position, poses.rotation) - LENGTHS).max()
    near = float(np.abs(determinant).min())

    def count(what: str, reference: int, ours: int) -> Check:
        return Check(what=what, reference=reference, ours=ours, tolerance=0.5, absolute=True)

    return [
        count("real postures", 40, len(poses)),
        count("with positive determinant", 20, int((determinant > 0).sum())),
        count("with negative determinant", 20, int((determinant < 0).sum())),
        Check(what="leg lengths, largest gap", reference=0, ours=float(gap), tolerance=1e-11, unit="m", absolute=True),
        Check(what="smallest determinant", reference=1.5e-5, ours=near, tolerance=0.05),
        Check(what="known posture, distance", reference=0, ours=float(known), tolerance=2e-6, absolute=True),
    ]


DIETMAIER = Case(
    name="dietmaier",
    statement="All real postures of a platform that has as many as are possible",
    source="Dietmaier 1998; recomputed by Newton's method from 480000 starts",
    argument="counts are exact; lengths to rounding times the condition of the worst posture; the determinant is "
    "printed with two digits, the posture with six",
    compute=_compute,
)
