"""Corrections that bring the loaded tool onto a path, as Chebyshev series of time, Eqs. (T22.1), (T22.3).

Functions that take long to compute are expanded between their knots.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebval, chebvander

from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.commissioning.feedforward.loaded_path import LoadedPath
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.units import DIMENSIONS
from flexapod.kinematics import Law
from flexapod.model import AxisMotion, CombinedMotion, ConstantWrench, CsvMotion, Study, WaypointMotion

NODES = 17  # of a piece, ends included: neighbours meet there
LAST = 3  # coefficients that say what is left out
FINEST = 1 / 64  # of the whole time: the shortest piece
_NODES = -np.cos(np.pi * np.arange(NODES) / (NODES - 1))
_TO_SERIES = np.linalg.inv(chebvander(_NODES, NODES - 1))


@dataclass(frozen=True, kw_only=True)
class CorrectionSeries:
    """Series of m functions: ``edges`` (n + 1,) [s], ``coefficients`` (n, NODES, m); ``tail``: last over largest."""

    edges: Array
    coefficients: Array
    tail: float

    def __call__(self, t: Array) -> Law:
        """Values at instants (T,) with two derivatives, (T, m); at rest outside the edges."""
        x = np.clip(t, self.edges[0], self.edges[-1])
        at = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.coefficients) - 1)
        found = np.zeros((3, len(t), self.coefficients.shape[2]))
        for k in np.unique(at):
            here, (first, last) = at == k, self.edges[k : k + 2]
            local, c = (2 * x[here] - first - last) / (last - first), self.coefficients[k]
            for order in range(3):
                found[order, here] = chebval(local, chebder(c, order)).T * (2 / (last - first)) ** order
        found[1:, (t < self.edges[0]) | (t > self.edges[-1])] = 0.0
        return Law(*found)


def chebyshev_series(
    compute: Callable[[Array], Array], knots: Array, enough: float, least: float = 0.0
) -> CorrectionSeries:
    """Series of a function between knots (n,) [s]; pieces are halved until the residual is `enough` of the largest.

    Parameters
    ----------
    compute : callable
        Of instants (T,): values (T, m) of one scale.
    least : float
        What counts as the largest where all is smaller: then it is rounding.
    """
    waiting, done = list(itertools.pairwise(knots)), []
    largest, shortest = least, FINEST * (knots[-1] - knots[0])
    while waiting:
        spans = np.array(waiting)
        times = spans[:, :1] + (spans[:, 1:] - spans[:, :1]) * (_NODES + 1) / 2
        times[:, -1] = spans[:, 1]
        values = compute(times.ravel()).reshape(len(spans), NODES, -1)
        largest = max(largest, float(np.abs(values).max(initial=0.0)))
        found = _TO_SERIES @ values
        last = np.abs(found[:, -LAST:]).max(axis=(1, 2), initial=0.0)
        rough = (last > enough * largest) & (spans[:, 1] - spans[:, 0] > shortest)
        done += [(*spans[k], found[k], last[k]) for k in np.flatnonzero(~rough)]
        middle = spans.mean(axis=1)
        waiting = [half for k in np.flatnonzero(rough) for half in ((spans[k, 0], middle[k]), (middle[k], spans[k, 1]))]
    done.sort(key=lambda piece: piece[0])
    tail = max(piece[3] for piece in done) / largest if largest else 0.0
    edges = np.array([done[0][0], *(piece[1] for piece in done)])
    return CorrectionSeries(edges=edges, coefficients=np.array([piece[2] for piece in done]), tail=float(tail))


TAIL = 1e-7  # of the largest correction: what its series leave out
JUMPING = ("trapezoid", "linear")  # profiles whose accelerations jump
LEAST = 1e-9  # m, rad: of corrections that are smaller rounding is a part


def static_series(path: LoadedPath, corrections: int, knots: Array) -> CorrectionSeries:
    """Series of the correction that is added to the coordinates of a path between knots [s]."""
    return chebyshev_series(lambda t: _correction(path, t, corrections), knots, TAIL, LEAST)


def is_permanent(study: Study) -> bool:
    """Test whether the correction stays constant once the motion is at its end."""
    robot, wrench = study.robot, study.load.wrench
    heat = robot.heat is not None and robot.heat.time is not None
    tables = any(getattr(leg.drive, "time", None) is not None for leg in robot.legs)
    return (wrench is None or isinstance(wrench, ConstantWrench)) and not heat and not tables


def correction_knots(study: Study, until: float) -> Array:
    """Instants between which corrections are smooth; tables are, four times over."""
    if isinstance(study.motion, CsvMotion):
        inner = [float(study.motion.time[-1])]
    else:
        inner = kinematics.path_knots(study.motion, until).tolist()
    least = DIMENSIONS["time"].least
    return np.array([0.0, *(t for t in inner if least < t < until - least), until])


def _correction(path: LoadedPath, t: Array, count: int) -> Array:
    """Correction of the coordinates (T, 6), Eq. (T22.1): each time the residual error of the loaded robot is added."""
    law = path.target_law(t)
    goal, added = path.tool_coordinates(path.rigid_poses(law, t)), np.zeros_like(law.position)
    by_command = path.command_gain(law, t)
    for _ in range(count):
        there = path.loaded_poses(Law(law.position + added, law.rate, law.acceleration), t)
        missing = (goal - path.tool_coordinates(there))[:, path.axes, None]
        added[:, path.axes] += np.linalg.solve(by_command, missing)[..., 0]
    return added


def check_correctable(study: Study, corrections: object, *, inertia: bool) -> None:
    """Refuse a study whose commands would have to jump, and what has no path.

    Raises
    ------
    InputError
    """
    if isinstance(corrections, bool) or not isinstance(corrections, int) or not 1 <= corrections <= 10:
        raise InputError("is not a number of corrections", key="corrections", value=corrections, allowed="1 to 10")
    heat = study.robot.heat
    if heat is not None and any(plate in heat.columns for plate in ("base", "platform")):
        raise InputError(
            "warms plates while the robot moves: where their joints then are equilibria do not follow",
            file=study.path,
            key="heat.file",
            value=heat.file,
            allowed="over time the temperatures of pistons, cylinders and screws",
            next_step="Leave it out (as_built=False), or give heat.base and heat.platform a number",
        )
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
    if inertia:
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


def check_workspace(study: Study) -> None:
    """Refuse commands that leave the workspace where the path that they are for does not.

    Raises
    ------
    InputError
    """
    try:
        check_path(study)
    except InputError as error:
        raise InputError(
            f"the commanded path that makes up for the deviation cannot be followed: {error.what}",
            file=error.file,
            key=error.key,
            value=error.value,
            allowed=error.allowed,
            next_step=error.next_step,
        ) from None
