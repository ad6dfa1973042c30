"""Stiffness of every part of every leg at a pose, as a Dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.checks.checks import pose_remarks
from flexapod.analysis.results.arguments import PoseLike, RigidPose, RobotLike, study_at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.elongations import is_guided
from flexapod.analysis.results.variables import dataset
from flexapod.common.resources import one_thread
from flexapod.solve.statics.lost_motion import lost_motion, places_with_friction
from flexapod.solve.statics.parts import guide_turning, mount_stiffness, part_stiffness

if TYPE_CHECKING:
    from xarray import Dataset


@one_thread()
def parts(robot: RobotLike, pose: PoseLike = None) -> Dataset:
    """Stiffness along its leg of every part of every leg at a pose, Eq. (T15.3).

    Parameters
    ----------
    robot : Robot, Study or path
    pose : pose, optional
        As for `modes`; default home.

    Returns
    -------
    xarray.Dataset
        `part_stiffness` (leg, part) [N/m]: of the piston's stretch, of joints, screw, twist, nut, bearing, of named
        springs, of a drive that has a spring, of mounts at the leg's joint against a force along that leg alone; inf
        where a leg does not have the part, or where its drive makes up for it: inside of what an encoder at the stroke,
        or from joint to joint, measures. `leg_stiffness` (leg): all but mounts in series. Of guided pistons
        `guide_stiffness` (leg, bushing) [N/m] across the leg and `guide_turning` (leg) [N m/rad], of bushings and the
        piston between them against a moment at the gland; inf of a clamped one. `lost_motion` (leg) [m], of
        robots whose drives have friction: half of what a leg lags by it to and fro.

    Raises
    ------
    InputError
        A pose out of reach, or with the nut outside the screw.

    Examples
    --------
    >>> data = fx.parts(fx.preset("machine-hexapod"))
    >>> float((1e-6 * data.leg_stiffness.sel(leg=1)).round(1))  # N/um
    54.0
    >>> str(data.part[int(data.part_stiffness.sel(leg=1).argmin("part"))].values)  # what is softest
    'base_joint'
    """
    study = study_at_pose(robot)
    at = RigidPose(study.robot, pose)
    remarks, length = pose_remarks(at), at.legs.length[0]
    found = part_stiffness(study.robot, length)
    softness = np.sum([1.0 / x for x in found.values()], axis=0)
    whole = np.divide(1.0, softness, out=np.full_like(softness, np.inf), where=softness > 0)
    found |= {name: x[0] for name, x in mount_stiffness(at).items()}
    values = {"part_stiffness": np.stack(list(found.values()), axis=1), "leg_stiffness": whole}
    if is_guided(study.robot):
        bushings = np.array(
            [[leg.guide.gland, leg.guide.head] if leg.guide else [np.inf] * 2 for leg in study.robot.legs]
        )
        values |= {"guide_stiffness": bushings, "guide_turning": guide_turning(study.robot, length)}
    if "drive" in places_with_friction(study.robot):
        values["lost_motion"] = lost_motion(study.robot, length)
    return dataset(values, {"part": list(found)}, attributes(study, [*study.warnings, *remarks]))
