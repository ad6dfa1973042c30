"""What is drawn over a map: the path of the study's motion in the coordinates of the grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod import rigid
from flexapod.errors import InputError
from flexapod.scene.robot import robot_study
from flexapod.study.poses import coordinates_of
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

POINTS = 400


def motion_path(data: Dataset) -> Array | None:
    """Surge ... yaw along the commanded motion, (T, 6) [m, rad]; None where it stays, or its tables are gone."""
    try:
        study = robot_study(data)
    except InputError:
        return None
    t = np.linspace(0.0, study.motion.end_time, POINTS)
    path = coordinates_of(study.robot, rigid.poses(study.robot, study.motion, t))
    return path if np.ptp(path, axis=0).max() > 1e-9 else None
