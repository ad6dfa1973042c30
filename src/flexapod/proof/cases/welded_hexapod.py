"""Stiffness of hexapods whose joints carry moments."""

from __future__ import annotations

from functools import partial

import numpy as np

from flexapod.model import Robot
from flexapod.model.joint import Joint
from flexapod.proof.case import Case, Check
from flexapod.proof.parallel_robots import CYLINDER, PISTON, hexapod
from flexapod.proof.unlike import without_gravity
from flexapod.rigid import rigid_limbs
from flexapod.study.static import stiffness
from flexapod.typing import Array

WELD = (Joint(), np.zeros((6, 6)))
SPRINGS = (Joint(bending=150.0, torsion=200.0), np.diag([0, 0, 0, 1 / 150, 1 / 150, 1 / 200]))


def _lever(arm: Array) -> Array:
    """What shift and turn do a way `arm` further on."""
    A = np.eye(6)
    A[:3, 3:] = np.cross(np.eye(3), arm).T
    return A


def _series(vector: Array, axes: Array, end: Array) -> Array:
    """Compliance (6, 6) of a leg at its tip, world axes: cantilever, bar and shaft, then a flexure at either end."""
    s = np.linalg.norm(vector) - CYLINDER.mouth
    shear, both, turn = s**3 / (3 * PISTON.EI), s**2 / (2 * PISTON.EI), s / PISTON.EI
    C = np.diag([shear, shear, PISTON.length / PISTON.EA, turn, turn, PISTON.length / PISTON.torsional_stiffness])
    C[0, 4] = C[4, 0] = both
    C[1, 3] = C[3, 1] = -both
    six, far = np.kron(np.eye(2), axes), _lever(vector)
    return six @ (C + end) @ six.T + far @ six @ end @ six.T @ far.T


def _exact(robot: Robot, end: Array) -> Array:
    total, tool = np.zeros((6, 6)), robot.home_position + robot.payload.tool
    for vector, tip, axes in zip(robot.home_vectors, robot.home_tips, rigid_limbs(robot).frames, strict=True):
        at = _lever(tip - tool)
        total += at.T @ np.linalg.solve(_series(vector, axes, end), at)
    return total


def _compute(joint: Joint, end: Array) -> list[Check]:
    robot = without_gravity(hexapod("FPF", joint=joint))
    ours, exact = stiffness(robot, modes=2, axial_modes=1).stiffness.values, _exact(robot, end)
    scale = np.sqrt(np.diag(exact))
    gap = np.abs(ours - exact) / np.outer(scale, scale)
    names = ("along x", "along y", "along z", "about x", "about y", "about z")
    values = zip(names, np.diag(exact), np.diag(ours), strict=True)
    found = [Check(what=n, reference=float(a), ours=float(b), tolerance=1e-8, unit="N/m, N m") for n, a, b in values]
    return [*found, Check(what="all 36", reference=0, ours=float(gap.max()), tolerance=1e-8, absolute=True)]


def _case(name: str, kind: str, joint: Joint, end: Array) -> Case:
    return Case(
        name=name,
        statement=f"Stiffness of a hexapod at its tool, legs {kind}",
        source="in each leg compliances in series, s^3 / 3 EI, s^2 / 2 EI, s / EI, L / EA, L / GJ and those of its "
        "joints a lever away; over the legs stiffnesses in sum",
        argument="the shapes contain the static answers: rounding times the ratio of bars to springs, 1e6",
        compute=partial(_compute, joint, end),
    )


WELDED_HEXAPOD = _case("welded-hexapod", "welded at both ends", *WELD)
FLEXURE_HEXAPOD = _case("flexure-hexapod", "on flexures at both ends", *SPRINGS)
