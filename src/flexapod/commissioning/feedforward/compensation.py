"""Compensation of elastic robots: motions that keep the loaded tool on its nominal path, Eqs. (T22.1)-(T22.5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, get_args, overload

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.results.arguments import FileLike, RobotLike, as_study, read_subject
from flexapod.commissioning.feedforward.actuator_inversion import tip_inversion
from flexapod.commissioning.feedforward.command_table import (
    CommandTable,
    axis_names,
    check_out,
    save_study,
    tabulate_law,
)
from flexapod.commissioning.feedforward.correction_series import (
    check_correctable,
    check_workspace,
    correction_knots,
    static_series,
)
from flexapod.commissioning.feedforward.loaded_path import LoadedPath, is_permanent, tool_miss
from flexapod.commissioning.feedforward.stable_inversion import elastic_compensation
from flexapod.common.arguments import flag
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import NOTHING, number, text
from flexapod.common.resources import one_thread
from flexapod.kinematics import Law
from flexapod.model import ActuatorStudy, Study
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.modes import modes_of

LOOKS = 41  # instants at which the miss is measured
ROWS = 20  # of a table in a period of the first mode, where accelerations are made up for
MOST = 1000  # periods that are resolved so
FEWEST = 200  # and at least in the whole path


Pair = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Compensation:
    """A compensated study and what it brings.

    Before and after, as equilibria tell at instants of the path: ``tool`` [m] and ``turned`` [rad], how far the loaded
    tool misses its wanted place and attitude at most; ``commanded`` [m], [rad], how far the coordinates that are
    ``named`` (of the pivot) miss theirs; ``named`` is empty where all six are. ``tail``: last coefficients of the
    corrections' series over the largest; ``table``: by how much accelerations of the table are off in the mean, over
    the largest. ``periods`` of the first mode that the path lasts, where its inertia is made up for.
    """

    study: Study
    periods: float | None
    named: tuple[str, ...]
    tool: Pair
    turned: Pair
    commanded: tuple[Pair, Pair]
    tail: float
    table: float

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect as text."""
        what, own = "weight and load", "its inertia and its own vibration are left"
        if self.periods is not None:
            what = "weight, load and the inertia of its path"
            own = f"its own vibration is left, of a path that lasts {number(self.periods, 3)} periods of the first mode"
        miss = f"the tool misses the wanted path by {_pair(self.tool, 'm')}"
        if self.named:
            ways = (_pair(x, unit) for x, unit in zip(self.commanded, ("m", "rad"), strict=True) if x[0] > 0)
            follow = f"what follows is not commanded: the tool is {_pair(self.tool, 'm')} beside the wanted path"
            miss = f"{', '.join(self.named)} miss the wanted path by {' and '.join(ways) or 'nothing'}; {follow}"
        return (
            f"commands make up for what {what} do to the elastic robot, in the same time: {miss}, as equilibria tell; "
            f"{own}. Series leave out {number(self.tail, 1)} of the largest correction. Deviations in results are "
            "those from the commands, which lie beside the wanted path"
        )

    def __repr__(self) -> str:
        return f"Compensation({self.sentence})"


def compensation(
    study: RobotLike,
    order: Literal[0, 2] = 0,
    *,
    corrections: int = 2,
    as_built: bool = True,
    out: str | Path | None = None,
) -> Compensation:
    """Compensate the motion of a study, as `compensate` does, and return it with its effect."""
    study = as_study(study)
    known = study if as_built else study.replace(robot=study.robot.replace(geometry=None, heat=None))
    check_correctable(known, corrections, inertia=order == 2)
    check_path(study)
    path = LoadedPath(known, inertia=order == 2)
    until = study.motion.end_time - study.motion.hold if is_permanent(study) else study.duration
    knots = correction_knots(study, until)
    series, tail = static_series(path, corrections, knots)

    def law(t: Array) -> Law:
        return Law(*(x + y for x, y in zip(path.target_law(t), series(t), strict=True)))

    periods = None if order == 0 else _periods(study, knots)
    rows = None if periods is None else np.linspace(0.0, until, max(FEWEST, int(ROWS * min(periods, MOST))) + 1)
    hold = study.motion.hold if is_permanent(study) else 0.0
    length = kinematics.rigid_limbs(study.robot).L_c
    table = tabulate_law(law, knots, study.motion, path.axes, length, hold=hold, rows=rows)
    found = _compensation_result(study, path, tail, table, periods)
    check_workspace(found.study)
    return found if out is None else replace(found, study=save_study(found.study, out))


def _periods(study: Study, knots: Array) -> float:
    """Number of periods of the first mode, at its start, that the path lasts."""
    start = kinematics.poses(study.robot, study.motion, np.zeros(1))
    still = kinematics.Poses.at_rest(start.position, start.rotation)
    modes = modes_of(locked_poses(study.robot, study.simulation, still, study.load))
    return float(modes.frequency[0, 0] * knots[-1])


def _compensation_result(
    study: Study, path: LoadedPath, tail: float, table: CommandTable, periods: float | None
) -> Compensation:
    """Result with the effect of the table at instants between those at which it was made."""
    motion = table.motion
    robot, axes, t = path.study.robot, path.axes, np.linspace(0.0, motion.time[-1], LOOKS)
    law, commanded = path.target_law(t), kinematics.coordinates(motion, t)
    wanted = path.rigid_poses(law, t)
    goal, found = path.tool_coordinates(wanted), []
    for there in (law.position, commanded.position):
        loaded = path.loaded_poses(Law(there, law.rate, law.acceleration), t)
        off = np.where(axes, goal - path.tool_coordinates(loaded), 0.0)
        parts = *tool_miss(robot, loaded, wanted), off[:, :3], off[:, 3:]
        found.append([float(np.linalg.norm(part, axis=1).max()) for part in parts])
    tool, turned, way, turn = zip(*found, strict=True)
    told = Compensation(
        study=study, periods=periods, named=axis_names(axes) or (), tool=tool, turned=turned, commanded=(way, turn),
        tail=tail, table=table.acceleration,
    )  # fmt: skip
    return replace(told, study=study.replace(motion=motion, notes=(*study.notes, told.sentence)))


def _pair(values: Pair, unit: str) -> str:
    before, after = (f"less than 1 p{unit}" if x < NOTHING else text(x, unit) for x in values)
    return f"{after} in place of {before}"


Order = Literal[0, 2, "stable-inversion"]


@overload
def compensate(
    study: ActuatorStudy,
    order: Order = ...,
    *,
    corrections: int = ...,
    as_built: bool = ...,
    drives: Literal["given", "force"] = ...,
    out: FileLike | None = ...,
) -> ActuatorStudy: ...
@overload
def compensate(
    study: RobotLike,
    order: Order = ...,
    *,
    corrections: int = ...,
    as_built: bool = ...,
    drives: Literal["given", "force"] = ...,
    out: FileLike | None = ...,
) -> Study: ...
@one_thread()
def compensate(
    study: RobotLike | ActuatorStudy,
    order: Order = 0,
    *,
    corrections: int = 2,
    as_built: bool = True,
    drives: Literal["given", "force"] = "given",
    out: FileLike | None = None,
) -> Study | ActuatorStudy:
    """A study whose motion brings the loaded tool onto the path of this study's motion.

    Corrections are of the pose: of all six coordinates, of a robot with fewer motions of those that are commanded.

    Parameters
    ----------
    study : Study, ActuatorStudy or path
    order : 0, 2 or "stable-inversion"
        0: what gravity, load and forces of drives do at rest at each pose. 2: and the inertia of the path's
        accelerations, as it bends a robot that follows them without vibrating. "stable-inversion": and the motion of
        its modes, by commands that begin before the path and end after it; of a single actuator so that its tip does
        what that of a rigid beam would.
    corrections : int
        How often the robot is looked at again where it then stands: one leaves 1e-4 of the miss, two 1e-8.
    as_built : bool
        Whether `geometry` and `heat` of the study are made up for, too.
    drives : {"given", "force"}
        Of a single actuator: the motion of its hub, or the torque on it.
    out : path, optional
        ``NAME.toml``, written with ``NAME.csv`` beside it.

    Returns
    -------
    Study or ActuatorStudy
        Its motion is a table of poses; its `notes` say what it brings. Results of it give deviations from the commanded
        path: ``tool_position`` less the ``tool_position_rigid`` of the study before is the miss.

    Raises
    ------
    InputError
        The path or the commanded one leaves the workspace; a load or a profile that jumps; drives that are a force.
    ComputationError
        There is no equilibrium at an instant.

    Examples
    --------
    >>> ahead = fx.compensate(fx.preset("machine-hexapod"))
    >>> ahead.motion.type
    'csv'
    >>> print(ahead.notes[0])
    commands make up for what weight and load do ...: the tool misses the wanted path by ... in place of 20.4 µm, ...
    """
    subject = read_subject(study)
    if not isinstance(order, str | int) or isinstance(order, bool) or order not in get_args(Order):
        raise InputError("is not known", key="order", value=order, allowed='0, 2, "stable-inversion"')
    if not isinstance(subject, Study | ActuatorStudy):
        subject = as_study(subject)
    if out is not None:
        check_out(subject, out)
    flag(as_built, "as_built")
    if isinstance(subject, ActuatorStudy):
        _refuse_of_robots(order, corrections, as_built)
        return tip_inversion(subject, drives, out).study
    if not isinstance(drives, str) or drives != "given":
        raise InputError("is for single actuators", key="drives", value=drives, allowed='"given" of robots')
    settings = {"corrections": corrections, "as_built": as_built, "out": out}
    if order == "stable-inversion":
        return elastic_compensation(subject, **settings).study
    return compensation(subject, order, **settings).study


def _refuse_of_robots(order: Order, corrections: int, as_built: bool) -> None:
    """Refuse what a single actuator has none of."""
    for key, value, usual in (("corrections", corrections, 2), ("as_built", as_built, True)):
        if value != usual:
            raise InputError("is for robots", key=key, value=value, allowed=f"{usual}, of a single actuator")
    if order != "stable-inversion":
        raise InputError("is not known of a single actuator", key="order", value=order, allowed='"stable-inversion"')
