"""Rigid hexapods: stiffness, all postures, singularities."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexapod import model
from flexapod.common.arrays import Array
from flexapod.kinematics.forward import all_postures
from flexapod.kinematics.inverse import leg_lengths
from flexapod.kinematics.jacobian import characteristic_length, dimensionless_jacobian, length_jacobian, stiffness
from flexapod.kinematics.trajectory import rotation_matrix
from flexapod.verification.case import Check, case, checks

EDGES_MM = (40, 100, 150, 250)  # over the square root of 3
ABOVE = 0.07  # m, above the centre of the cube of 100 mm
NAMES = ("along x", "along y", "along z", "about x [m^2]", "about y [m^2]", "about z [m^2]")
# 70 mm above the centre: row, column (x y z, about x y z), value
COUPLED = ((0, 4, -0.14), (4, 0, -0.14), (1, 3, 0.14), (3, 1, 0.14), (3, 3, 0.0248), (4, 4, 0.0248), (5, 5, 0.06))


def joints(edge: float) -> tuple[Array, Array]:
    """Ends of six edges of a cube that stands on a corner, its centre in the origin, (6, 3) each [m]."""
    corners = (np.ones((3, 3)) * -1 + 2 * np.eye(3)) * edge / 2
    z, x = np.ones(3) / np.sqrt(3), np.array([1, -1, 0]) / np.sqrt(2)
    axes = np.stack([x, np.cross(z, x), z])
    pairs = [(i, j) for i in range(3) for j in range(3) if i != j]
    lower = np.array([corners[i] for i, _ in pairs])
    upper = np.array([corners[i] + edge * np.eye(3)[j] for i, j in pairs])
    return lower @ axes.T, upper @ axes.T


def centre_stiffness(edge: float) -> Array:
    """Stiffness (6, 6) at the centre in units of that of a leg: diagonal."""
    return np.diag([2, 2, 2, edge**2 / 2, edge**2 / 2, 2 * edge**2])


def offset_stiffness() -> Array:
    """Stiffness (6, 6) at a point 70 mm above the centre of the cube of 100 mm times root 3."""
    table = np.diag([2.0, 2.0, 2.0, 0.0, 0.0, 0.0])
    for i, j, value in COUPLED:
        table[i, j] = value
    return table


@case(
    "Stiffness of a hexapod along edges of a cube, in units of that of a leg",
    source="Preumont et al. 2007: diag(2, 2, 2, L^2/2, L^2/2, 2 L^2), and its table 70 mm above the centre",
    argument="closed form on both sides: rounding",
)
def _cubic_hexapod() -> Iterator[Check]:
    for size in EDGES_MM:
        edge = np.sqrt(3) * size * 1e-3
        ours = stiffness(length_jacobian(*joints(edge), np.zeros(3), np.eye(3)), 1.0)
        names = [f"edge sqrt(3) {size} mm, {name}" for name in NAMES]
        yield from checks(names, np.diag(centre_stiffness(edge)), np.diag(ours), 1e-13)
        off = float(np.abs(ours - np.diag(np.diag(ours))).max())
        yield Check(f"edge sqrt(3) {size} mm, coupling", 0, off, 1e-14, absolute=True)
    ours = stiffness(length_jacobian(*joints(np.sqrt(3) * 0.1), np.zeros(3), np.eye(3), [0, 0, ABOVE]), 1.0)
    names = [f"70 mm above the centre, row {i + 1}, column {j + 1}" for i, j, _ in COUPLED]
    yield from checks(names, [v for *_, v in COUPLED], [ours[i, j] for i, j, _ in COUPLED], 1e-13)


BASE = np.array([
    [0.0, 0.0, 0.0], [1.107915, 0.0, 0.0], [0.549094, 0.756063, 0.0],
    [0.735077, -0.223935, 0.525991], [0.514188, -0.526063, -0.368418], [0.590473, 0.094733, -0.205018],
])  # fmt: skip
PLATFORM = np.array([
    [0.0, 0.0, 0.0], [0.542805, 0.0, 0.0], [0.956919, -0.528915, 0.0],
    [0.665885, -0.353482, 1.402538], [0.478359, 1.158742, 0.107672], [-0.137087, -0.235121, 0.353913],
])  # fmt: skip
LENGTHS = np.array([1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071])


@case(
    "All real postures of a platform that has as many as are possible",
    source="Dietmaier 1998; recomputed by Newton's method from 480000 starts",
    argument="counts are exact; lengths to rounding times the condition of the worst posture; the determinant is "
    "printed with two digits, the posture with six",
)
def _dietmaier() -> list[Check]:
    poses = all_postures(BASE, PLATFORM, LENGTHS).poses
    determinant = np.linalg.det(length_jacobian(BASE, PLATFORM, poses.position, poses.rotation))
    known = np.linalg.norm(poses.position - [0.955868, -0.046996, -0.290013], axis=1).min()
    gap = np.abs(leg_lengths(BASE, PLATFORM, poses.position, poses.rotation) - LENGTHS).max()
    near = float(np.abs(determinant).min())
    kinds = ("real postures", "with positive determinant", "with negative determinant")
    counts = len(poses), (determinant > 0).sum(), (determinant < 0).sum()
    return [
        *checks(kinds, [40, 20, 20], counts, 0.5, absolute=True),
        Check("leg lengths, largest gap", 0, float(gap), 1e-11, "m", absolute=True),
        Check("smallest determinant", 1.5e-5, near, 0.05),
        Check("known posture, distance", 0, float(known), 2e-6, absolute=True),
    ]


# Of the camera hexapod of the Rubin Observatory [m]: the mirror set stays, the base set moves about a pivot far below.
MIRROR = np.array([
    [0.47055, 0.51351], [-0.47055, 0.51351], [-0.67999, 0.15075], [-0.20944, -0.66426], [0.20944, -0.66426],
    [0.67999, 0.15075],
])  # fmt: skip
MOVED = np.array([
    [0.20944, 0.66426], [-0.20944, 0.66426], [-0.67999, -0.15075], [-0.47055, -0.51351], [0.47055, -0.51351],
    [0.67999, -0.15075],
])  # fmt: skip
PIVOT, TRANSLATION, TURN = (0, 0, -2.7584), (-0.0603, 0.1045, -0.0109), (-0.0355, -0.0205, -0.0004)
STRUTS = (0.15205, 0.07204, -0.04667, 0.13381, 0.02959, -0.07292)


@case(
    "Struts of the camera hexapod of the Rubin Observatory, moved by 0.12 m and turned about a distant pivot",
    source="github.com/lsst-ts/ts_mthexapod, simple_hexapod.py and its test: translation in m, successive angles about "
    "x, y, z in rad (R = Rx Ry Rz), changes of the struts",
    argument="half a unit of the last digit that is printed of a strut",
)
def _observatory_hexapod() -> list[Check]:
    mirror, moved = (np.column_stack([plane, np.full(6, z)]) for plane, z in ((MIRROR, -0.125), (MOVED, -0.555)))
    turns = np.diag(TURN)
    rotation = rotation_matrix(turns[0]) @ rotation_matrix(turns[1]) @ rotation_matrix(turns[2])
    lengths = leg_lengths(mirror, moved - PIVOT, np.add(PIVOT, TRANSLATION), rotation)
    names = [f"strut {i}" for i in range(1, 7)]
    return checks(names, STRUTS, lengths - np.linalg.norm(moved - mirror, axis=1), 5e-6, "m", absolute=True)


ABOVE_BASE = np.array([0.0, 0.0, 0.9])
TURNS = (17.0, 60.0, 133.0)  # deg, of similar hexagons in their plane


def _smallest(base: Array, platform: Array, position: Array, rotation: Array) -> float:
    """Largest smallest singular value of the scaled Jacobian over poses."""
    jacobian = dimensionless_jacobian(
        length_jacobian(base, platform, position, rotation), characteristic_length(platform)
    )
    return float(np.linalg.svd(jacobian, compute_uv=False)[..., -1].max())


def _yawed(angle: float) -> float:
    """Smallest singular value of the standard layout, 0.9 m above its base, at a yaw in deg."""
    platform = model.platform_circle(0.3, np.deg2rad(10.0))
    return _smallest(base(10.0), platform, ABOVE_BASE, rotation_matrix(np.array([0, 0, np.deg2rad(angle)])))


def base(half_angle: float) -> Array:
    """Base joints on a circle of 0.5 m; half-angle in deg."""
    return model.base_circle(0.5, np.deg2rad(half_angle))


@case(
    "Smallest singular value of the scaled Jacobian in known singularities",
    source="Ma & Angeles 1991 (architecture), Fichter 1986 (yaw)",
    argument="a few units in the last place of the largest singular value, about 2; a simple zero is linear to 1e-3 "
    "within a degree",
)
def _singularities() -> list[Check]:
    random = np.random.default_rng(1991)
    position = random.uniform([-0.2, -0.2, 0.6], [0.2, 0.2, 1.1], (2000, 3))
    rotation = rotation_matrix(random.uniform(-0.5, 0.5, (2000, 3)))
    regular = model.platform_circle(0.3, np.deg2rad(30.0))
    turned = [rotation_matrix(np.array([0, 0, np.deg2rad(turn)])) for turn in TURNS]
    below = base(10.0)
    fourth = np.linalg.svd(dimensionless_jacobian(length_jacobian(below, 0.6 * below, ABOVE_BASE, np.eye(3)), 0.3))[1][
        3
    ]
    similar = {
        f"similar hexagons, one turned by {turn:g} deg": _smallest(below, 0.6 * below @ R.T, position, rotation)
        for turn, R in zip(TURNS, turned, strict=True)
    }
    zeros = {
        "similar hexagons, 2000 poses": _smallest(below, 0.6 * below, position, rotation),
        **similar,
        "similar hexagons at home, fourth singular value": fourth,
        "regular hexagons joined crosswise": _smallest(base(30.0), regular, position, rotation),
        "standard layout at a yaw of 90 deg": _yawed(90.0),
        "standard layout at a yaw of -90 deg": _yawed(-90.0),
    }
    near = Check("ratio at yaws of 89 and 89.5 deg", 2, _yawed(89) / _yawed(89.5), 2e-3)
    return [*checks(list(zeros), np.zeros(len(zeros)), list(zeros.values()), 1e-15, absolute=True), near]
