"""What the accuracy of a pose adds to an error budget: a row for each part."""

from __future__ import annotations

from typing import NamedTuple

from flexapod import rigid
from flexapod.model import Study
from flexapod.study.accuracy.play import PLACES, play_at
from flexapod.study.accuracy.sensitivity import sensitivity
from flexapod.study.accuracy.spread import spreading
from flexapod.study.accuracy.systematic import systematic
from flexapod.typing import Array

__all__ = ["Row", "rows"]


class Row(NamedTuple):
    """One part: its `kind` of error (systematic, hysteretic, random), of a systematic one its `nature`.

    `by_leg` (n, 6): displacement [m] and rotation [rad] of the tool, world axes; of a random one standard
    deviations, of a hysteretic one bounds. `how` it was computed, in words.
    """

    part: str
    kind: str
    nature: str
    by_leg: Array
    how: str


def rows(study: Study, pose: rigid.Poses) -> list[Row]:
    """Rows of geometry, heat, tolerances and play at one pose; of what the study does not name none."""
    at = sensitivity(study.robot, pose)
    found = [
        Row(name, "systematic", "drifting" if name.startswith("heat") else "calibratable", by_leg, "first order")
        for name, by_leg in systematic(study.robot, at).items()
    ]
    found += [
        Row(f"{one.name} tolerance", "random", "", one.sigma, "first order, errors independent of each other")
        for one in spreading(study.robot, at)
    ]
    effect = abs(play_at(study, pose, at).effect[0])
    how = "first order, whichever way the play is pressed"
    found += [
        Row(f"{place} play", "hysteretic", "", by_leg, how)
        for place, by_leg in zip(PLACES, effect, strict=True)
        if by_leg.any()
    ]
    return found
