"""Play of joints and drives, at poses and along a motion: direction by forces, jumps, Eqs. (T16.13)-(T16.15)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexapod import model
from flexapod.analysis.checks.checks import check_geometry
from flexapod.analysis.pose_errors.sensitivity import Sensitivity, sensitivity
from flexapod.analysis.results.arguments import LoadLike, RobotLike, as_study
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.rigid_path import RigidPath, open_force_words
from flexapod.analysis.results.variables import dataset
from flexapod.common.arrays import Array
from flexapod.common.resources import one_thread
from flexapod.model import Robot

if TYPE_CHECKING:
    from xarray import Dataset

PLACES = ("base_joint", "drive", "platform_joint")


@dataclass(frozen=True, kw_only=True)
class Play:
    """Play at T instants; of each place and leg.

    ``force`` (T, 3, n): compression of the leg there [N], of a carriage's drive its force [N, N m]; ``effect``
    (T, 3, n, 6): what half the play does to the tool while the force presses.
    """

    force: Array
    effect: Array

    @property
    def error(self) -> Array:
        """Displacement and rotation of the tool, (T, 6), Eq. (T16.13); a force of nothing leaves the middle."""
        return np.einsum("tpn,tpnx->tx", np.sign(self.force), self.effect)

    @property
    def worst(self) -> Array:
        """Largest size of each component, whatever the signs, (T, 6), Eq. (T16.14)."""
        return np.abs(self.effect).sum(axis=(1, 2))


@dataclass(frozen=True, kw_only=True)
class Jumps:
    """Jumps where forces change their sign: instants [s], place, leg (numbers from 0), jump of the tool (j, 6)."""

    time: Array
    place: NDArray[np.intp]
    leg: NDArray[np.intp]
    size: Array


def half_play(robot: Robot) -> Array:
    """Half the free travel at each place of each leg, (3, n) [m], of a crank's drive [rad]; 0 inside a loop."""
    play = [[leg.base_joint.play or 0.0, leg.backlash, leg.platform_joint.play or 0.0] for leg in robot.legs]
    outside = [
        [leg.measured != "joint-to-joint", leg.measured == "rotor", leg.measured != "joint-to-joint"]
        for leg in robot.legs
    ]
    return 0.5 * (np.array(play) * outside).T


def play_along(path: RigidPath, at: Sensitivity | None = None) -> Play:
    """Play at the instants of a rigid path, pressed by the forces of the rigid robot."""
    robot, forces, axes = path.robot, path.forces, path.axes
    at = sensitivity(path) if at is None else at
    carried = np.array([leg.driven == "carriage" for leg in robot.legs])
    stroked = np.array([leg.driven == "stroke" for leg in robot.legs])
    end = np.sum(forces.joint_force * axes, axis=-1)
    inside = np.where(stroked, forces.drive_force, end)
    foot = inside if forces.base_force is None else np.sum(forces.base_force * axes, axis=-1)
    # pressed together, pins lie nearer to each other by half the play: the leg is as much shorter
    shorter = -np.einsum("tnj,tnjx->tnx", axes, at.base)
    behind = np.where(carried[:, None], -at.coordinate[:, :, 0], shorter)
    effect = np.stack([shorter, behind, shorter], axis=1) * half_play(robot)[..., None]
    force = np.stack([foot, np.where(carried, forces.drive_force, inside), end], axis=1)
    return Play(force=force, effect=effect)


def jumps(found: Play, t: Array) -> Jumps:
    """Find the sign changes of forces between instants (T,), and the jumps of the tool there, Eq. (T16.15)."""
    sign = np.sign(found.force)
    for k in range(1, len(sign)):  # what presses nowhere stays where it was
        sign[k] = np.where(sign[k] == 0, sign[k - 1], sign[k])
    k, place, leg = np.nonzero(sign[1:] * sign[:-1] < 0)
    before, after = found.force[k, place, leg], found.force[k + 1, place, leg]
    share = before / (before - after)
    between = (1 - share)[:, None] * found.effect[k, place, leg] + share[:, None] * found.effect[k + 1, place, leg]
    return Jumps(
        time=(1 - share) * t[k] + share * t[k + 1],
        place=place,
        leg=leg,
        size=(sign[k + 1, place, leg] - sign[k, place, leg])[:, None] * between,
    )


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
