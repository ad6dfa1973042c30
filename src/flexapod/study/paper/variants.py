"""What the deviation of the paper's robot depends on: half-angles, a jump of the velocity, other assumptions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model, rigid
from flexapod.errors import ComputationError, InputError
from flexapod.study.attributes import attributes
from flexapod.study.checks import path_instants
from flexapod.study.estimates import buckling_load
from flexapod.study.paper.claim import axis_motion, roll_error
from flexapod.study.paper.statics import Rest, at_rest, singular_turn
from flexapod.study.record import Share
from flexapod.study.simulation import simulate
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = [
    "DURATIONS",
    "HALF_ANGLES",
    "JUMP_STEP",
    "SERVO_STIFFNESS",
    "assumptions",
    "half_angle_sweep",
    "jump_motion",
    "with_half_angle",
]

HALF_ANGLES = (5.0, 10.0, 15.0, 20.0, 25.0, 27.0, 28.0, 29.0)  # deg
SWEEP_STEP = 5e-4  # s; peaks change by less than 1 % from 1 ms to 0.25 ms
JUMP_STEP = 3.125e-5  # s; an impact rings the legs at kilohertz: peaks within 4 % of those at a quarter of it
DURATIONS = (0.25, 0.5, 1.0, 2.0)  # s; from four times as fast as the preset to half as fast
SERVO_STIFFNESS = (3e5, 1e7)  # N/m; so soft that the payload sags by the size the paper prints; a usual ball screw


def with_half_angle(study: model.Study, angle: float) -> model.Study:
    """The same robot with other half-angles of its joint pairs, base and platform alike.

    Strokes are opened, and the mouths of the cylinders moved just so far that no piston leaves its cylinder.

    Parameters
    ----------
    study : Study
        A robot whose joints lie on circles.
    angle : float
        Half-angle [deg]; at 30 deg both circles are regular hexagons.
    """
    robot, half = study.robot, np.deg2rad(angle)
    base = model.base_circle(float(np.linalg.norm(robot.base_joints[0])), half)
    platform = model.platform_circle(float(np.linalg.norm(robot.platform_joints[0])), half)
    moved = robot.replace(base_joints=base, platform_joints=platform)
    path = rigid.poses(moved, study.motion, path_instants(study))
    longest = float(rigid.leg_lengths(base, platform, path.position, path.rotation).max())
    legs = tuple(_opened(leg, longest) for leg in robot.legs)
    return study.replace(robot=moved.replace(legs=legs))


def _opened(leg: model.Leg, longest: float) -> model.Leg:
    mouth = max(leg.cylinder.mouth, longest - leg.piston.length)
    stroke = model.Stroke(min=mouth, max=mouth + leg.piston.length)
    return leg.replace(stroke=stroke, cylinder=leg.cylinder.replace(mouth=mouth))


def jump_motion(study: model.Study) -> model.Motion:
    """The study's motion at constant rate: its velocity jumps at the start and at the end."""
    return axis_motion(study).replace(profile="linear")


def half_angle_sweep(study: model.Study, angles: Sequence[float], report: Share) -> Dataset:
    """Deviation, drive force, frequency and equilibrium of the path for several half-angles.

    Returns
    -------
    xarray.Dataset
        Over `half_angle` [deg]: `deviation_peak` (half_angle, axis) [m], `force_peak` [N], `load_share` (largest axial
        load over the Euler load), `lowest_frequency` on the path [Hz], NaN if its equilibrium ends, `sag` (half_angle,
        axis) [m]: largest static deviation on the path, as far as there is an equilibrium; `verdict`: empty, or in
        words why there is no deviation to trust.
    """
    import xarray as xr

    rows = []
    for i, angle in enumerate(angles):
        rows.append(_at_half_angle(with_half_angle(study, angle)))
        report((i + 1) / len(angles))
    deviation, sag = (np.array([row[name] for row in rows]) for name in ("deviation_peak", "sag"))
    scalars = {"force_peak": "N", "load_share": "1", "lowest_frequency": "Hz"}
    data = {
        "deviation_peak": (("half_angle", "axis"), deviation, {"units": "m"}),
        "sag": (("half_angle", "axis"), sag, {"units": "m"}),
        **{name: ("half_angle", np.array([row[name] for row in rows]), {"units": u}) for name, u in scalars.items()},
        "verdict": ("half_angle", [row["verdict"] for row in rows]),
    }
    coords = {"half_angle": ("half_angle", np.array(angles), {"units": "deg"}), "axis": list("xyz")}
    return xr.Dataset(data, coords, attributes(study) | {"step": SWEEP_STEP})


def _at_half_angle(study: model.Study) -> dict[str, object]:
    nothing = np.full(3, np.nan)
    rest, singular = at_rest(study), singular_turn(study)
    row: dict[str, object] = {"deviation_peak": nothing, "force_peak": np.nan, "load_share": np.nan}
    row |= {"sag": rest.sag, "lowest_frequency": rest.frequency, "verdict": _lost(rest, singular)}
    if singular is not None:  # no path to simulate
        return row
    try:
        data = simulate(study, step=SWEEP_STEP)
    except (InputError, ComputationError) as error:
        return row | {"verdict": row["verdict"] or error.what.split(":")[0]}
    free = data.leg_length.values - np.array([leg.cylinder.mouth for leg in study.robot.legs])
    share = max(float((data.actuator_force.values[:, i] / buckling_load(leg, free[:, i])).max())
                for i, leg in enumerate(study.robot.legs))  # fmt: skip
    if not row["verdict"] and data.attrs["partial"]:
        row["verdict"] = str(data.attrs["failure"])
    if not row["verdict"] and share >= 1:
        row["verdict"] = f"collapse: a leg bears {100 * share:.0f} % of its Euler load"
    return row | {
        "deviation_peak": _peaks(data),
        "force_peak": float(np.abs(data.actuator_force).max()),
        "load_share": share,
    }


def _lost(rest: Rest, singular: float | None) -> str:
    """Why the robot cannot go its path at rest, in words; empty if it can. What is before a colon labels figures."""
    if singular is None:
        return "" if rest.end is None else f"no equilibrium: the one at home ends at {rest.end:.1f} deg of roll"
    words = f"singular path: the rigid robot passes through a singular pose at {singular:.1f} deg of roll"
    if rest.end is None:
        return words
    return f"{words}, and beyond {rest.end:.1f} deg no equilibrium continues the one at home"


def assumptions(study: model.Study, report: Share) -> Dataset:
    """Largest deviation of the robot under other durations of the motion and with yielding drives.

    Returns
    -------
    xarray.Dataset
        `deviation_by_duration` (duration, axis), `deviation_by_drive` (drive_stiffness, axis) [m]; `sag_by_drive`: the
        part of the latter that is there at rest, before the motion;
        `length_error` (leg) [m]: what the legs would have to be off for the paper's deviation;
        `joint_turn` (leg) [rad]: what the spherical joints turn on the path.
    """
    import xarray as xr

    whole = len(DURATIONS) + len(SERVO_STIFFNESS)
    durations, drives, sags = [], [], []
    for duration in DURATIONS:
        motion = axis_motion(study).replace(duration=duration)
        durations.append(_peaks(simulate(study, motion, step=SWEEP_STEP, duration=duration + 1.0)))
        report(len(durations) / whole)
    for stiffness in SERVO_STIFFNESS:
        data = simulate(_with_servo(study, stiffness), step=SWEEP_STEP)
        drives.append(_peaks(data))
        sags.append(np.abs(data.com_deviation.values[0]))
        report((len(durations) + len(drives)) / whole)
    length_error, turn = _needed_errors(study)
    metre = {"units": "m"}
    values = {
        "deviation_by_duration": (("duration", "axis"), np.array(durations), metre),
        "deviation_by_drive": (("drive_stiffness", "axis"), np.array(drives), metre),
        "sag_by_drive": (("drive_stiffness", "axis"), np.array(sags), metre),
        "length_error": ("leg", length_error, metre),
        "joint_turn": ("leg", turn, {"units": "rad"}),
    }
    coords = {
        "duration": ("duration", np.array(DURATIONS), {"units": "s"}),
        "drive_stiffness": ("drive_stiffness", np.array(SERVO_STIFFNESS), {"units": "N m-1"}),
        "axis": list("xyz"),
        "leg": np.arange(1, 7),
    }
    return xr.Dataset(values, coords, attributes(study) | {"step": SWEEP_STEP})


def _peaks(data: Dataset) -> Array:
    return np.abs(data.com_deviation.values).max(axis=0)


def _with_servo(study: model.Study, stiffness: float) -> model.Study:
    """Drives with a spring, damped at about a tenth of critical for a sixth of the payload."""
    damping = 0.2 * float(np.sqrt(stiffness * study.robot.payload.mass / 6))
    drive = model.ServoDrive(stiffness=stiffness, damping=damping)
    legs = tuple(leg.replace(drive=drive) for leg in study.robot.legs)
    return study.replace(robot=study.robot.replace(legs=legs))


def _needed_errors(study: model.Study) -> tuple[Array, Array]:
    """Leg-length errors (6,) [m] that move the CoM by the paper's deviation; turn (6,) [rad] of the joints above."""
    robot, target = study.robot, axis_motion(study).target
    roll, error = target[3], roll_error(float(np.linalg.norm(robot.payload.com)))
    home = rigid.home_pose(robot)
    turned = [rigid.rotation_matrix(np.array([[x, 0.0, 0.0]])) for x in (roll, roll + error)]
    lengths = [rigid.leg_lengths(robot.base_joints, robot.platform_joints, home.position, R)[0] for R in turned]
    axes = []
    for R in (np.eye(3), turned[0][0]):
        vectors = robot.platform_joints @ R.T + home.position[0] - robot.base_joints
        axes.append(vectors / np.linalg.norm(vectors, axis=1)[:, None] @ R)  # in platform axes
    return lengths[1] - lengths[0], np.arccos(np.clip((axes[0] * axes[1]).sum(axis=1), -1.0, 1.0))
