"""Loops of drives that are unstable where a motion starts."""

from __future__ import annotations

import numpy as np

from flexapod import model, rigid
from flexapod.errors import FlexapodError
from flexapod.solve.modal_loops import unstable_words
from flexapod.solve.modes import robot_modes

__all__ = ["loop_remarks"]


def loop_remarks(study: model.Study) -> list[str]:
    """That they are, where the motion starts; nothing where they are not, or where there are no modes."""
    if not any(leg.screw is not None and leg.screw.loops for leg in study.robot.legs):
        return []
    start = rigid.poses(study.robot, study.motion, np.zeros(1))
    try:
        found = robot_modes(
            study.robot, study.simulation, rigid.Poses.at_rest(start.position, start.rotation), study.load
        )
    except FlexapodError:
        return []
    return unstable_words(found.growth)
