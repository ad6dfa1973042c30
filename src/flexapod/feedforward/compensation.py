"""A motion that brings the loaded tool onto the path of the drawing, Eqs. (T22.1)-(T22.5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from flexapod import kinematics
from flexapod.arrays import Array
from flexapod.errors import InputError
from flexapod.feedforward.loaded import LoadedPath, apart
from flexapod.feedforward.series import series_of
from flexapod.feedforward.table import Tabled, saved, tabled
from flexapod.kinematics import Law
from flexapod.model import AXES, AxisMotion, CombinedMotion, ConstantWrench, CsvMotion, Study, WaypointMotion
from flexapod.results.arguments import RobotLike, as_study
from flexapod.results.path import RigidPath
from flexapod.review.checks import check_path
from flexapod.runtime.threads import one_thread
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.modes import modes_of
from flexapod.units import DIMENSIONS
from flexapod.words import NOTHING, number, text

__all__ = ["Compensation", "compensate", "compensation"]

TAIL = 1e-7  # of the largest correction: what its series leave out
LEAST = 1e-9  # m, rad: of corrections that are smaller rounding is a part
LOOKS = 41  # instants at which the miss is measured
ROWS = 20  # of a table in a period of the first mode, where accelerations are made up for
MOST = 1000  # periods that are resolved so
FEWEST = 200  # and at least in the whole path
JUMPING = ("trapezoid", "linear")  # profiles whose accelerations jump


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
        """Benefit, cost and effect in words."""
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
            f"{own}. Deviations in results are those from the commands, which lie beside the wanted path"
        )

    def __repr__(self) -> str:
        return f"Compensation({self.sentence})"


@one_thread()
def compensate(
    study: RobotLike,
    order: Literal[0, 2] = 0,
    *,
    corrections: int = 2,
    as_built: bool = True,
    out: str | Path | None = None,
) -> Study:
    """A study whose motion brings the loaded tool onto the path of this study's motion.

    Corrections are of the pose: of all six coordinates, of a robot with fewer motions of those that are commanded.

    Parameters
    ----------
    study : Study or path
    order : 0 or 2
        0: what gravity, load and forces of drives do at rest at each pose. 2: and the inertia of the path's
        accelerations, as it bends a robot that follows them without vibrating.
    corrections : int
        How often the robot is looked at again where it then stands: one leaves 1e-4 of the miss, two 1e-8.
    as_built : bool
        Whether `geometry` and `heat` of the study are made up for, too.
    out : path, optional
        ``NAME.toml``, written with ``NAME.csv`` beside it.

    Returns
    -------
    Study
        Its motion is a table of poses; its `notes` say what it brings. Results of it give deviations from the commanded
        path: ``tool_position`` less the ``tool_position_rigid`` of the study before is the miss.

    Raises
    ------
    InputError
        The path or the commanded one leaves the workspace; a load or a profile that jumps; drives that are a force.
    ComputationError
        There is no equilibrium at an instant.
    """
    return compensation(study, order, corrections=corrections, as_built=as_built, out=out).study


def compensation(
    study: RobotLike,
    order: Literal[0, 2] = 0,
    *,
    corrections: int = 2,
    as_built: bool = True,
    out: str | Path | None = None,
) -> Compensation:
    """As `compensate`, with what it brings."""
    study = as_study(study)
    _refuse(study, order, corrections)
    check_path(study)
    robot = study.robot if as_built else study.robot.replace(geometry=None, heat=None)
    path = LoadedPath(study.replace(robot=robot), inertia=order == 2)
    until = study.motion.end_time - study.motion.hold if _lasts(study) else study.duration
    knots = _knots(study, until)
    series = series_of(lambda t: _correction(path, t, corrections), knots, TAIL, LEAST)

    def law(t: Array) -> Law:
        return Law(*(x + y for x, y in zip(path.wanted(t), series(t), strict=True)))

    periods = None if order == 0 else _periods(study, knots)
    rows = None if periods is None else np.linspace(0.0, until, max(FEWEST, int(ROWS * min(periods, MOST))) + 1)
    hold = study.motion.hold if _lasts(study) else 0.0
    length = kinematics.rigid_limbs(robot).L_c
    table = tabled(law, knots, study.motion, path.axes, length, hold=hold, rows=rows)
    found = _told(study, path, series.tail, table, periods)
    return _checked(found, out)


def _refuse(study: Study, order: object, corrections: object) -> None:
    if order not in (0, 2):
        raise InputError(
            "is not known", key="order", value=order, allowed='0, 2; "stable-inversion" of a single actuator'
        )
    if isinstance(corrections, bool) or not isinstance(corrections, int) or not 1 <= corrections <= 10:
        raise InputError("is not a number of corrections", key="corrections", value=corrections, allowed="1 to 10")
    if study.robot.platform_fixed:
        raise InputError(
            "has a platform that is fixed: there is no path that it could miss", key="robot.platform.fixed", value=True
        )
    if kinematics.robot_breaks(study.replace(motion=AxisMotion(type="heave", amplitude=0.0, duration=1.0))).jumps:
        raise InputError(
            "jumps while the robot moves, and a command that makes up for it would have to jump",
            file=study.path,
            key="load",
            allowed="loads that grow in some time: a table, a sine",
        )
    if order == 2:
        _refuse_inertia(study)


def _refuse_inertia(study: Study) -> None:
    motion = study.motion
    if isinstance(motion, AxisMotion | CombinedMotion | WaypointMotion) and motion.profile in JUMPING:
        raise InputError(
            "has accelerations that jump: a command that makes up for their inertia would have to jump",
            file=study.path,
            key="motion.profile",
            value=motion.profile,
            allowed="quintic, cycloidal, s-curve, smooth; order 0 takes any",
        )
    if study.robot.base_motion is not None:
        raise InputError(
            "moves the base, whose accelerations are not those of the path",
            file=study.path,
            key="robot.base_motion",
            allowed="a base at rest; order 0 takes any",
        )


def _lasts(study: Study) -> bool:
    """Whether the correction stays what it is once the motion is at its end."""
    robot, wrench = study.robot, study.load.wrench
    heat = robot.heat is not None and robot.heat.time is not None
    tables = any(getattr(leg.drive, "time", None) is not None for leg in robot.legs)
    return (wrench is None or isinstance(wrench, ConstantWrench)) and not heat and not tables


def _knots(study: Study, until: float) -> Array:
    """Instants between which corrections are smooth; tables are, four times over."""
    if isinstance(study.motion, CsvMotion):
        inner = [float(study.motion.time[-1])]
    else:
        inner = kinematics.path_knots(study.motion, until).tolist()
    least = DIMENSIONS["time"].least
    return np.array([0.0, *(t for t in inner if least < t < until - least), until])


def _correction(path: LoadedPath, t: Array, count: int) -> Array:
    """What to add to the coordinates (T, 6), Eq. (T22.1): each time what the loaded robot still misses."""
    law = path.wanted(t)
    goal, added = path.seen(path.rigid(law, t)), np.zeros_like(law.position)
    by_command = path.gain(law, t)
    for _ in range(count):
        there = path.loaded(Law(law.position + added, law.rate, law.acceleration), t)
        missing = (goal - path.seen(there))[:, path.axes, None]
        added[:, path.axes] += np.linalg.solve(by_command, missing)[..., 0]
    return added


def _periods(study: Study, knots: Array) -> float:
    """How many periods of the first mode at its start the path lasts."""
    start = kinematics.poses(study.robot, study.motion, np.zeros(1))
    still = kinematics.Poses.at_rest(start.position, start.rotation)
    modes = modes_of(locked_poses(study.robot, study.simulation, still, study.load))
    return float(modes.frequency[0, 0] * knots[-1])


def _told(study: Study, path: LoadedPath, tail: float, table: Tabled, periods: float | None) -> Compensation:
    """What the table brings, at instants between those at which it was made."""
    motion = table.motion
    robot, axes, t = path.study.robot, path.axes, np.linspace(0.0, motion.time[-1], LOOKS)
    law, commanded = path.wanted(t), kinematics.coordinates(motion, t)
    wanted = path.rigid(law, t)
    goal, found = path.seen(wanted), []
    for there in (law.position, commanded.position):
        loaded = path.loaded(Law(there, law.rate, law.acceleration), t)
        off = np.where(axes, goal - path.seen(loaded), 0.0)
        parts = *apart(robot, loaded, wanted), off[:, :3], off[:, 3:]
        found.append([float(np.linalg.norm(part, axis=1).max()) for part in parts])
    tool, turned, way, turn = zip(*found, strict=True)
    named = () if axes.all() else tuple(axis for axis, asked in zip(AXES, axes, strict=True) if asked)
    told = Compensation(
        study=study, periods=periods, named=named, tool=tool, turned=turned, commanded=(way, turn), tail=tail,
        table=table.acceleration,
    )  # fmt: skip
    return replace(told, study=study.replace(motion=motion, notes=(*study.notes, told.sentence)))


def _pair(values: Pair, unit: str) -> str:
    before, after = (f"less than 1 p{unit}" if x < NOTHING else text(x, unit) for x in values)
    return f"{after} in place of {before}"


def _checked(found: Compensation, out: str | Path | None) -> Compensation:
    """Refuse a command that leaves the workspace; write it where asked."""
    try:
        check_path(found.study, RigidPath(found.study))
    except InputError as error:
        raise InputError(
            f"the commanded path that makes up for the deviation cannot be followed: {error.what}",
            file=error.file,
            key=error.key,
            value=error.value,
            allowed=error.allowed,
            next_step=error.next_step,
        ) from None
    return found if out is None else replace(found, study=saved(found.study, out))
