"""Poses and architectures in which the legs do not hold the platform."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.rigid.jacobian import characteristic_length, length_jacobian, scaled
from flexapod.rigid.trajectory import rotation_matrix
from flexapod.typing import Array

HOME = np.array([0.0, 0.0, 0.9])
TURNS = (17.0, 60.0, 133.0)  # deg, of similar hexagons in their plane


def _smallest(base: Array, platform: Array, position: Array, rotation: Array) -> float:
    """Largest smallest singular value of the scaled Jacobian over poses."""
    jacobian = scaled(length_jacobian(base, platform, position, rotation), characteristic_length(platform))
    return float(np.linalg.svd(jacobian, compute_uv=False)[..., -1].max())


def _yawed(angle: float) -> float:
    """Smallest singular value of the standard layout, 0.9 m above its base, at a yaw in deg."""
    platform = model.platform_circle(0.3, np.deg2rad(10.0))
    return _smallest(base(10.0), platform, HOME, rotation_matrix(np.array([0, 0, np.deg2rad(angle)])))


def base(half_angle: float) -> Array:
    """Base joints on a circle of 0.5 m; half-angle in deg."""
    return model.base_circle(0.5, np.deg2rad(half_angle))


def _compute() -> list[Check]:
    random = np.random.default_rng(1991)
    position = random.uniform([-0.2, -0.2, 0.6], [0.2, 0.2, 1.1], (2000, 3))
    rotation = rotation_matrix(random.uniform(-0.5, 0.5, (2000, 3)))
    regular = model.platform_circle(0.3, np.deg2rad(30.0))
    turned = [rotation_matrix(np.array([0, 0, np.deg2rad(turn)])) for turn in TURNS]
    fourth = np.linalg.svd(scaled(length_jacobian(base(10.0), 0.6 * base(10.0), HOME, np.eye(3)), 0.3))[1][3]
    rows = (
        ("similar hexagons, 2000 poses", _smallest(base(10.0), 0.6 * base(10.0), position, rotation)),
        *(
            (
                f"similar hexagons, one turned by {turn:g} deg",
                _smallest(base(10.0), 0.6 * base(10.0) @ R.T, position, rotation),
            )
            for turn, R in zip(TURNS, turned, strict=True)
        ),
        ("similar hexagons at home, fourth singular value", float(fourth)),
        ("regular hexagons joined crosswise", _smallest(base(30.0), regular, position, rotation)),
        ("standard layout at a yaw of 90 deg", _yawed(90.0)),
        ("standard layout at a yaw of -90 deg", _yawed(-90.0)),
    )
    zeros = [Check(what=what, reference=0, ours=ours, tolerance=1e-15, absolute=True) for what, ours in rows]
    near = Check(what="ratio at yaws of 89 and 89.5 deg", reference=2, ours=_yawed(89) / _yawed(89.5), tolerance=2e-3)
    return [*zeros, near]


SINGULARITIES = Case(
    name="singularities",
    statement="Smallest singular value of the scaled Jacobian in known singularities",
    source="Ma & Angeles 1991 (architecture), Fichter 1986 (yaw)",
    argument="a few units in the last place of the largest singular value, about 2; a simple zero is linear to 1e-3 "
    "within a degree",
    compute=_compute,
)
