"""Sensitivity of the tool to small errors of legs and joints, to first order, Eqs. (T16.8)-(T16.9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.analysis.results.causes import closure_coordinates
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.kinematics.mechanism import coordinates_of
from flexapod.kinematics.screws import screws
from flexapod.model import Robot
from flexapod.solve.statics.ideal_robot import is_hexapod, rigid_errors


@dataclass(frozen=True, kw_only=True)
class Sensitivity:
    """Displacement and rotation (world axes) of the tool at P poses for unit errors.

    ``coordinate`` (P, n, 8, 6): of what is held or driven, `COORDINATES`; ``base`` (P, n, 3, 6): shifts of the base
    joints along world x, y, z; ``platform`` (P, n, 3, 6): of the platform joints along platform x, y, z; ``q``
    (P, n, 8): the rigid legs there.
    """

    coordinate: Array
    base: Array
    platform: Array
    q: Array

    def part(self, which: slice) -> Sensitivity:
        """Sensitivity at some of the poses."""
        return Sensitivity(
            coordinate=self.coordinate[which], base=self.base[which], platform=self.platform[which], q=self.q[which]
        )


def sensitivity(at: kinematics.RigidPoses) -> Sensitivity:
    """First-order effect of errors at poses.

    Raises
    ------
    ComputationError
        A pose is singular.
    """
    legs, q, by = kinematics.rigid_limbs(at.robot), coordinates_of(at.legs), _by_coordinate(at)
    columns, takes = screws(legs, q).columns, closure_coordinates(legs)
    held = legs.given
    base = np.zeros((*q.shape[:2], 3, 6))
    kinds = np.column_stack([legs.pose_closure, takes, held])
    for kind in set(map(tuple, kinds.tolist())):
        alike = np.flatnonzero((kinds == kind).all(axis=1))
        i, rows = alike[0], 6 if kind[0] else 3
        # the drawn leg that reaches as far as the shifted one has other held coordinates: (T16.9)
        change = np.linalg.solve(columns[:, alike, :rows][..., takes[i]], np.eye(rows, 3))
        given = by[:, alike][:, :, takes[i] & held[i]]
        base[:, alike] = np.einsum("pikj,pikx->pijx", change[:, :, held[i, takes[i]]], given)
    platform = -np.einsum("pji,pnjx->pnix", at.poses.rotation, base)
    return Sensitivity(coordinate=by, base=base, platform=platform, q=q)


def _by_coordinate(at: kinematics.RigidPoses) -> Array:
    """Displacement of the tool by unit errors of held and driven coordinates, (P, n, 8, 6), Eq. (T16.8)."""
    robot, path = at.robot, at.poses
    if is_hexapod(robot):
        found = np.zeros((len(path), robot.count, len(COORDINATES), 6))
        try:
            inverse = np.linalg.inv(at.drive_jacobian(robot.tool))
        except np.linalg.LinAlgError:
            raise ComputationError(
                "a pose is singular: lengths do not determine it", next_step="See `flexapod check`."
            ) from None
        found[:, :, COORDINATES.index("l")] = inverse.swapaxes(1, 2)
        return found
    found = rigid_errors(at)
    R, arm = path.rotation[:, None, None], path.rotation @ (robot.tool - robot.com)
    turn = (R @ found[..., 3:, None])[..., 0]
    shift = found[..., :3] + np.cross(turn, arm[:, None, None])
    return np.concatenate([shift, turn], axis=-1)


def systematic(robot: Robot, at: Sensitivity) -> dict[str, Array]:
    """Displacement and rotation of the tool by part, as built and with heat, (n, 6) by leg, at the first pose."""
    found, still, start = {}, np.zeros_like(at.q[:1]), np.zeros(1)
    for part in kinematics.built_parts(robot):
        size = part.size(start).position[0, :, None]
        more = kinematics.added(part, start, kinematics.Law(at.q[:1], still, still)).position[0]
        found[part.name] = (
            np.einsum("nj,njx->nx", size * part.base, at.base[0])
            + np.einsum("nj,njx->nx", size * part.platform, at.platform[0])
            + np.einsum("nk,nkx->nx", more, at.coordinate[0])
        )
    return found
