"""Corrections that bring the loaded tool onto a path, as Chebyshev series of time, Eqs. (T22.1), (T22.3).

They take long to compute and are expanded between their knots.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.checks import check_path
from flexapod.commissioning.feedforward.loaded_path import LoadedPath
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.piecewise_chebyshev import WITH_ENDS, Pieces
from flexapod.common.units import DIMENSIONS
from flexapod.kinematics import Law
from flexapod.model import AxisMotion, CombinedMotion, CsvMotion, Study, WaypointMotion

FINEST = 1 / 64  # of the whole time: the shortest piece
TAIL = 1e-7  # of the largest correction: what its series leave out
JUMPING = ("trapezoid", "linear")  # profiles whose accelerations jump
LEAST = 1e-9  # m, rad: of corrections that are smaller rounding is a part


def static_series(path: LoadedPath, corrections: int, knots: Array) -> tuple[Callable[[Array], Law], float]:
    """Correction that is added to the coordinates of a path between knots [s], and what its series leave out."""
    pieces = Pieces(
        lambda t: [_correction(path, t, corrections)],
        knots,
        WITH_ENDS,
        enough=TAIL,
        least=LEAST,
        shortest=FINEST * (knots[-1] - knots[0]),
    )
    return lambda t: Law(*pieces.with_derivatives(t)), pieces.make_all()


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
