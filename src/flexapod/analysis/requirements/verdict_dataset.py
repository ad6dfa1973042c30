"""Verdict on a study's requirement as a Dataset."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.requirements.judge import Judge
from flexapod.analysis.requirements.judgements import HOME, Judgement
from flexapod.analysis.results.arguments import read_subject
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.poses import coordinate_words, pose_coordinates
from flexapod.analysis.results.variables import Variable, dataset
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.model import AXES, Study

if TYPE_CHECKING:
    from xarray import Dataset

_ALONG = ("requirement",)
VERDICT_VARIABLES = {
    "wanted": Variable(_ALONG, "mixed", "bound that is asked, in the unit of each"),
    "found": Variable(_ALONG, "mixed", "worst value over the poses of the box, states and motion"),
    "margin": Variable(_ALONG, "mixed", "what is left of the bound, below 0 where it is missed"),
    "kept": Variable(_ALONG, "1", "whether the requirement is kept; not where it is not judged"),
    "judged": Variable(_ALONG, "1", "whether there are numbers enough to say so"),
    "sure": Variable(_ALONG, "1", "whether no other pose of the box can say otherwise"),
    "worst_pose": Variable((*_ALONG, "pose_axis"), "mixed", "surge to heave [m], roll to yaw [rad] of the worst case"),
    "home": Variable(_ALONG, "mixed", "value at home, of a robot with temperatures warm"),
}


@one_thread()
def verdict(study: Study | str | Path) -> Dataset:
    """Verdict on the [requirement] of a study: whether it is kept, by how much, and where it is missed most.

    Travel and rotation are one box; elastic values are those at home and at its corners, cold (all parts at
    `heat.reference`) and warm, with the least and the most payload; loads, stresses, life and settling those of the
    motion.

    Parameters
    ----------
    study : Study or path
        With a table [requirement].

    Returns
    -------
    xarray.Dataset
        Along `requirement`, the keys given: `wanted`, `found` (the worst), `margin`, what is left, below 0 where it
        is missed; `kept`, `judged`: not judged is not kept; `sure`: no other pose of the box can say otherwise, else
        the poses were looked at alone. Of the worst case `pose` of the box in words, `worst_pose` as other calls take
        it, `state`, `leg` (0: none), `part` with the largest share, where two cancel both; `home`: the value there;
        `why` in words where it is not judged; `unit`.

    Raises
    ------
    InputError
        A study without [requirement], or one that asks for motions which the robot does not have.

    Examples
    --------
    >>> study = fx.preset("machine-hexapod")
    >>> asked = fx.model.Requirement(travel="5 mm", first_frequency="20 Hz")
    >>> data = fx.verdict(study.replace(requirement=asked))
    >>> data.kept.to_series().to_dict()
    {'travel': True, 'first_frequency': True}
    """
    found = read_subject(study)
    if not isinstance(found, Study):
        raise InputError(
            "is not the study of a robot", key="study", value=type(found).__name__,
            allowed="a study with [requirement], or its file",
        )  # fmt: skip
    if found.requirement is None:
        raise InputError(
            "is missing: the study requires nothing that could be judged", key="requirement",
            next_step='Add a table [requirement], for example with travel = "15 mm" and '
            'pose_accuracy_calibrated = "10 um"; `flexapod keys requirement` lists its keys',
        )  # fmt: skip
    began = time.perf_counter()
    judge = Judge(found)
    data = verdict_dataset(judge, judge.findings())
    data.attrs["wall_time"] = time.perf_counter() - began
    return data


def verdict_dataset(judge: Judge, found: list[Judgement]) -> Dataset:
    """Judgements as a Dataset."""
    values = {
        name: np.array([getattr(one, name) for one in found]) for name in ("wanted", "found", "margin", "sure", "home")
    }
    values |= {name: np.array([getattr(one, f"is_{name}") for one in found]) for name in ("kept", "judged")}
    values["worst_pose"] = np.array([_as_pose(judge, one.pose) for one in found])
    words = {
        "pose": [one.place or _pose_words(one.pose) for one in found],
        **{name: [getattr(one, name) for one in found] for name in ("state", "part", "unit", "why", "home_state")},
    }
    poses = len(judge.trial_points)
    study = judge.study
    data = dataset(
        values,
        {"requirement": [one.name for one in found], "pose_axis": list(AXES)},
        {**attributes(study, list(study.warnings)), "poses": poses, "states": [s.words for s in judge.states]},
        VERDICT_VARIABLES,
    )
    coords = {name: ("requirement", np.array(texts, dtype=str)) for name, texts in words.items()}
    coords["leg"] = ("requirement", np.array([one.leg for one in found], dtype=int))
    return data.assign_coords(coords)


def _as_pose(judge: Judge, pose: Array | None) -> Array:
    """Surge to yaw of the platform frame, (6,); NaN without a pose."""
    if pose is None:
        return np.full(6, np.nan)
    return pose_coordinates(judge.study.robot, judge.poses(pose[None]))[0] + 0.0


def _pose_words(pose: Array | None) -> str:
    """Pose of the box in words."""
    if pose is None:
        return ""
    if np.array_equal(pose, HOME):
        return "home"
    return coordinate_words({axis: x for axis, x in zip(AXES, pose.tolist(), strict=True) if x})
