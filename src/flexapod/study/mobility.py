"""What a robot can do, as a Dataset: motions, motions left with its drives locked, drives that fight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod import rigid
from flexapod.study.arguments import PoseLike, RobotLike, as_pose, at_pose
from flexapod.study.attributes import attributes
from flexapod.study.names import dataset

if TYPE_CHECKING:
    from xarray import Dataset


def mobility(robot: RobotLike, pose: PoseLike = None) -> Dataset:
    """Motions of the rigid robot at one pose and next to it, by rank, Eqs. (T14.11)-(T14.15).

    Parameters
    ----------
    robot : Robot, Study or path
    pose : pose, optional
        As for `modes`; default home.

    Returns
    -------
    xarray.Dataset
        `mobility`, `locked` (with all drives locked), `redundant` conditions of joints, `self_stress` (forces that
        drives and joints can exert against each other), `freedoms` of all joints, `gruebler` (motions by counting),
        `motions` by name with their `motion_twist` (platform frame's origin, world axes), `mobility_nearby` and
        `locked_nearby` at two displaced poses; the attribute `words` says it in sentences.

    Raises
    ------
    InputError
        A pose that the legs do not reach.
    """
    study = at_pose(robot)
    legs = rigid.rigid_limbs(study.robot)
    at = None if pose is None else rigid.posture(study.robot, as_pose(study.robot, pose, check=False))
    found, near = rigid.mobility(legs, at), [rigid.mobility(legs, there) for there in rigid.displaced(legs, at)]
    lengths = np.array([legs.L_c] * 3 + [1.0] * 3)
    values = {
        "mobility": found.mobility,
        "locked": found.locked,
        "redundant": found.redundant,
        "self_stress": found.self_stress,
        "freedoms": found.freedoms,
        "gruebler": found.gruebler,
        "motions": np.array(rigid.motion_names(legs, found.platform, at), dtype=str),
        "motion_twist": found.platform.T * lengths,
        "mobility_nearby": [m.mobility for m in near],
        "locked_nearby": [m.locked for m in near],
    }
    attrs = attributes(study, study.warnings) | {"words": "\n".join(rigid.mobility_words(legs, at))}
    return dataset(values, attrs=attrs)
