"""What the accuracy of a pose adds to an error budget: a row for each part."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.backlash import PLACES
from flexapod.analysis.pose_errors.error_sources import AtPose
from flexapod.analysis.pose_errors.sensitivity import Sensitivity
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.kinematics.robot import once
from flexapod.mechanics.elements.element import Contribution
from flexapod.mechanics.elements.registry import kinds_of
from flexapod.mechanics.elements.trial import asking
from flexapod.model import Robot, Study

__all__ = ["ErrorRow", "rows"]


class ErrorRow(NamedTuple):
    """One part: its `kind` of error (systematic, hysteretic, random, dynamic), and its `nature`.

    `nature`: of a systematic one calibratable, repeatable or drifting; empty of others. `stands`: of a random one, that
    it is the same at each approach of one machine.

    `by_leg` (n, 6): displacement [m] and rotation [rad] of the tool, world axes; of a random one standard
    deviations, of a hysteretic one bounds; (1, 6) of what acts on all legs at once. `how` it was computed, in words.
    """

    part: str
    kind: str
    nature: str
    by_leg: Array
    how: str
    stands: bool = False


def rows(study: Study, pose: kinematics.Poses, known: Sensitivity | None = None) -> list[ErrorRow]:
    """Rows of geometry, heat, bent legs, tolerances and play at one pose; of what the study does not name none.

    `known`: the sensitivity there, where it is.
    """
    at = AtPose(study, pose, known)
    found = [ErrorRow(name, "systematic", _nature(name), by_leg, "first order") for name, by_leg in at.parts.items()]
    found += [
        ErrorRow(f"{one.name} tolerance", "random", "", one.sigma, "first order, errors independent", stands=True)
        for one in at.spreading
    ]
    found += _of_elements(study, at)
    if at.is_loose:
        effect = np.abs(at.play.effect[0])
        how = "first order, whichever way the play is pressed"
        table = zip(PLACES, effect, strict=True)
        found += [ErrorRow(f"{place} play", "hysteretic", "", by_leg, how) for place, by_leg in table if by_leg.any()]
    return found


def _of_elements(study: Study, at: AtPose) -> list[ErrorRow]:
    """Rows of what elements make the strokes err by; alike ones of all legs are a row."""
    lengths, found = at.sensitivity.q[0, :, COORDINATES.index("l")], {}
    for i, error in _errors(study.robot):
        sizes = found.setdefault(error._replace(size=0.0), np.zeros(len(lengths)))
        size = error.size(lengths[i]) if callable(error.size) else error.size
        sizes[i] = np.hypot(sizes[i], size) if error.kind == "random" else sizes[i] + size
    moves = at.sensitivity.coordinate[0, :, COORDINATES.index("l")]
    by_leg = {error: sizes[:, None] * moves for error, sizes in found.items()}
    return [
        ErrorRow(error.name, error.kind, "", x if error.kind == "random" else np.abs(x), error.how, error.stands)
        for error, x in by_leg.items()
    ]


@once
def _errors(robot: Robot) -> list[tuple[int, Contribution]]:
    """The errors that elements of the legs make, each with the index of its leg."""
    found = []
    for i, leg in enumerate(robot.legs):
        for kind in kinds_of(robot.legs):
            with asking(kind, "errors"):
                found += [(i, error) for own in kind.all_of(leg) for error in own.errors(leg)]
    return found


def _nature(part: str) -> str:
    if part.startswith("heat"):
        return "drifting"
    return "repeatable" if part == "bent_legs" else "calibratable"
