"""Play along a motion as a Dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis.checks.checks import check_geometry
from flexapod.analysis.pose_errors.backlash import PLACES, half_play, jumps, play_along
from flexapod.analysis.results.arguments import LoadLike, RobotLike, as_study
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.rigid_path import RigidPath, open_force_words
from flexapod.analysis.results.variables import dataset
from flexapod.common.resources import one_thread

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["play"]


@one_thread()
def play(robot: RobotLike, motion: model.Motion | None = None, *, load: LoadLike = None) -> Dataset:
    """Play along a motion: how forces press it, what that does to the tool, where it jumps.

    Forces are those of the rigid robot: gravity, load and inertia.

    Parameters
    ----------
    robot : Robot, Study or path
        With `play` of joints, `backlash` of drives.
    motion : Motion, optional
        In place of the study's.
    load : Load, wrench or array_like (6,), optional
        At the tool, in place of the study's.

    Returns
    -------
    xarray.Dataset
        `pressing_force` (time, place, leg), positive where it presses the leg together; `play_error`, `play_worst`
        (time, component) of the tool; of each change of sign where there is play `jump_time`, `jump_place`, `jump_leg`,
        `jump_size` (jump, component). `sign_changes` (place, leg) counts them whether there is play or not.

    Raises
    ------
    InputError
        As `inverse_dynamics`.

    Examples
    --------
    >>> data = fx.play(fx.preset("machine-hexapod"))
    >>> int(data.sign_changes.sum())  # no joint is pulled and pushed by turns
    0
    """
    study = as_study(robot, motion, load)
    path = RigidPath(study)
    remarks = check_geometry(study, path)
    found = play_along(path)
    jump = jumps(found, path.time)
    changes = np.zeros(found.force.shape[1:], dtype=int)
    np.add.at(changes, (jump.place, jump.leg), 1)
    loose = half_play(study.robot)[jump.place, jump.leg] > 0
    values = {
        "pressing_force": found.force,
        "play_error": found.error,
        "play_worst": found.worst,
        "sign_changes": changes,
        "jump_time": jump.time[loose],
        "jump_place": np.array(PLACES)[jump.place[loose]],
        "jump_leg": jump.leg[loose] + 1,
        "jump_size": jump.size[loose],
    }
    labels = {"time": path.time, "place": list(PLACES)}
    return dataset(values, labels, attributes(study, [*study.warnings, *remarks, *open_force_words(path.forces)]))
