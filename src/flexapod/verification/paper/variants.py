"""Variants of the paper's robot: half-angles, a jump of the velocity, equilibria at rest, lighter pistons.

They show what the deviation depends on. Lighter pistons are hollow or thinner; the vibration of payload and
tips is computed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from xarray import Dataset

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import as_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.rigid_path import path_instants
from flexapod.analysis.results.time_history import Share
from flexapod.analysis.simulation import simulate
from flexapod.analysis.static import modes
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics.rotations import quaternion, rotation_vector
from flexapod.solve.statics.equilibrium import Equilibrium
from flexapod.solve.system import State, System
from flexapod.verification.paper.claim import axis_motion, largest_deviation, residual_vibration, roll_error
from flexapod.verification.paper.readings import robot_preset, with_legs
from flexapod.verification.paper.trials import TRIAL_STEP, extend_strokes, locked_equilibrium, system_of, table, trial

POSES = 11  # every tenth of the motion: sag and frequency change steadily along it, their extremes are at its ends
FINEST = 2.0**-8 / (POSES - 1)  # share of the motion to which the end of the equilibrium is found: 0.01 deg of 30 deg
NEXT = 0.01  # m; two equilibria further apart than this are not taken for neighbours, but tried again at half the step


@dataclass(frozen=True, kw_only=True)
class EquilibriumPath:
    """The resting robot along a motion.

    `sag` (3,) [m]: largest on the way; `frequency` [Hz]: lowest at `POSES` poses, as far as Newton's method finds the
    equilibrium from the rigid pose, NaN where the equilibrium ends (it falls to 0); `end`: turn [deg] at which the
    equilibrium that begins at home ends, because its stiffness vanishes; None if it lasts.
    """

    sag: Array
    frequency: float
    end: float | None


def singular_turn(study: model.Study) -> float | None:
    """Turn of the platform [deg] at which the rigid robot first passes through a singular pose; None: nowhere.

    There the determinant of the scaled Jacobian changes its sign, a fact of the joints' places and the path alone.
    """
    path = kinematics.poses(study.robot, study.motion, path_instants(study))
    changes = kinematics.singularity(study.robot, path).sign_changes
    if not len(changes):
        return None
    return float(np.rad2deg(np.linalg.norm(rotation_vector(quaternion(path.rotation[int(changes[0])])))))


def equilibrium_path(study: model.Study) -> EquilibriumPath:
    """Sag, frequency and end of the static equilibrium along the motion of a study.

    The equilibrium is followed from home, each from the one before, in steps that are halved where it is not found or
    lies elsewhere: beyond a singular pose there may be another one near the rigid pose, which the robot cannot reach.
    """
    target = axis_motion(study).target
    reached, sag = _followed(study)
    if reached < 1:
        return EquilibriumPath(sag=sag, frequency=np.nan, end=reached * float(np.rad2deg(np.abs(target[3:]).max())))
    frequency = np.nan
    for share in np.linspace(0.0, 1.0, POSES):
        try:
            frequency = np.fmin(frequency, float(modes(study, share * target).frequency[0]))
        except ComputationError:  # the equilibrium is too far from the rigid pose for Newton's method to start there
            break
    return EquilibriumPath(sag=sag, frequency=float(frequency), end=None)


def _followed(study: model.Study) -> tuple[float, Array]:
    """Share of the motion that the equilibrium of home lasts, and the largest sag (3,) [m] on the way."""
    system = system_of(study)
    found, off = _near(study, system, 0.0, None)
    if not found.found:
        return 0.0, np.full(3, np.nan)
    reached, step, sag = 0.0, 1.0 / (POSES - 1), np.abs(off)
    while reached < 1 and step >= FINEST:
        share = min(reached + step, 1.0)
        found, moved = _near(study, system, share, before := found.state)
        if found.found and np.abs(moved - off).max() <= NEXT:
            reached, off, sag = share, moved, np.fmax(sag, np.abs(moved))
        else:
            found, step = replace(found, state=before), step / 2
    return reached, sag


def _near(study: model.Study, system: System, share: float, state: State | None) -> tuple[Equilibrium, Array]:
    """Equilibrium at a share of the motion, sought from a state (None: the rigid pose); its sag (3,) [m]."""
    path = as_pose(study.robot, share * axis_motion(study).target)
    found = locked_equilibrium(study, system, path, state)
    return found, found.state.pose[:3] - path.point(study.robot.payload.com)[0][0]


HALF_ANGLES = (5.0, 10.0, 15.0, 20.0, 25.0, 27.0, 28.0, 29.0)  # deg
SWEEP_COLUMNS = {"deviation_peak": "m", "force_peak": "N", "load_share": "1", "lowest_frequency": "Hz", "sag": "m"}
JUMP_STEP = 3.125e-5  # s; an impact rings the legs at kilohertz: peaks within 4 % of those at a quarter of it
DURATIONS = (0.25, 0.5, 1.0, 2.0)  # s; from four times as fast as the preset to half as fast
SERVO_STIFFNESS = (3e5, 1e7)  # N/m; so soft that the payload sags by the size the paper prints; a usual ball screw


def with_half_angle(study: model.Study, angle: float) -> model.Study:
    """Study with other half-angles of its joint pairs, base and platform alike.

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
    return extend_strokes(study.replace(robot=robot.replace(base_joints=base, platform_joints=platform)))


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
    rows = []
    for i, angle in enumerate(angles):
        rows.append(_at_half_angle(with_half_angle(study, angle)))
        report((i + 1) / len(angles))
    along = ("half_angle", list(angles), {"units": "deg"})
    return table(rows, along, SWEEP_COLUMNS, attributes(study) | {"step": TRIAL_STEP})


def _at_half_angle(study: model.Study) -> dict[str, object]:
    rest, singular = equilibrium_path(study), singular_turn(study)
    lost = {"verdict": words} if (words := _lost(rest, singular)) else {}
    nothing = {"deviation_peak": np.full(3, np.nan), "force_peak": np.nan, "load_share": np.nan}
    tried = nothing if singular is not None else trial(study)  # no path to simulate where it is singular
    return {**tried, "sag": rest.sag, "lowest_frequency": rest.frequency, **lost}


def _lost(rest: EquilibriumPath, singular: float | None) -> str:
    """Reason why the robot cannot go its path at rest; empty if it can. Text before a colon labels figures."""
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
        `length_error` (leg) [m]: what the legs would have to be off for the paper's deviation.
    """
    whole = len(DURATIONS) + len(SERVO_STIFFNESS)
    durations, drives, sags = [], [], []
    for duration in DURATIONS:
        motion = axis_motion(study).replace(duration=duration)
        durations.append(largest_deviation(simulate(study, motion, step=TRIAL_STEP, duration=duration + 1.0)))
        report(len(durations) / whole)
    for stiffness in SERVO_STIFFNESS:
        data = simulate(_with_servo(study, stiffness), step=TRIAL_STEP)
        drives.append(largest_deviation(data))
        sags.append(np.abs(data.com_deviation.values[0]))
        report((len(durations) + len(drives)) / whole)
    metre = {"units": "m"}
    values = {
        "deviation_by_duration": (("duration", "axis"), np.array(durations), metre),
        "deviation_by_drive": (("drive_stiffness", "axis"), np.array(drives), metre),
        "sag_by_drive": (("drive_stiffness", "axis"), np.array(sags), metre),
        "length_error": ("leg", _needed_errors(study), metre),
    }
    coords = {
        "duration": ("duration", np.array(DURATIONS), {"units": "s"}),
        "drive_stiffness": ("drive_stiffness", np.array(SERVO_STIFFNESS), {"units": "N m-1"}),
        "axis": list("xyz"),
        "leg": np.arange(1, 7),
    }
    return Dataset(values, coords, attributes(study) | {"step": TRIAL_STEP})


def _with_servo(study: model.Study, stiffness: float) -> model.Study:
    """Drives with a spring, damped at about a tenth of critical for a sixth of the payload."""
    damping = 0.2 * float(np.sqrt(stiffness * study.robot.payload.mass / 6))
    drive = model.ServoDrive(stiffness=stiffness, damping=damping)
    legs = tuple(leg.replace(drive=drive) for leg in study.robot.legs)
    return study.replace(robot=study.robot.replace(legs=legs))


def _needed_errors(study: model.Study) -> Array:
    """Leg-length errors (n,) [m] that move the CoM by the paper's deviation."""
    robot, roll = study.robot, axis_motion(study).target[3]
    home = kinematics.home_pose(robot)
    off, there = (
        kinematics.leg_lengths(
            robot.base_joints,
            robot.platform_joints,
            home.position,
            kinematics.rotation_matrix(np.array([[x, 0.0, 0.0]]))[0],
        )[0]
        for x in (roll + roll_error(float(np.linalg.norm(robot.payload.com))), roll)
    )
    return off - there


#: Outer and inner diameter [mm]: the paper's, hollow ones of the same width, thinner ones.
PISTONS = ((27.0, 0.0), (27.0, 16.0), (27.0, 22.0), (27.0, 25.0), (20.0, 0.0), (15.0, 0.0), (10.0, 0.0))
COLUMNS = {
    "piston_mass": "kg",
    "payload_vibration": "m",
    "tip_vibration": "m",
    "lowest_frequency": "Hz",
    "deviation_peak": "m",
}


def with_section(study: model.Study, outer: float, inner: float) -> model.Study:
    """Study with round pistons of other diameters [m], of the same material and length."""
    section = {"diameter": outer, "inner_diameter": inner or None}
    return with_legs(study, lambda leg: leg.replace(piston=leg.piston.replace(**section)))


def light_pistons(report: Share) -> Dataset:
    """The roll of the paper's robot on lighter and lighter pistons.

    Returns
    -------
    xarray.Dataset
        Over `piston` (words), with its `outer` and `inner` diameters [mm]: `piston_mass` [kg]; `payload_vibration` and
        `tip_vibration` [m] from peak to peak after the roll, the largest along one direction; `lowest_frequency` [Hz]
        at home; `deviation_peak` (piston, axis) [m].
    """
    study, rows = robot_preset("paper-robot"), []
    for outer, inner in PISTONS:
        changed = with_section(study, 1e-3 * outer, 1e-3 * inner)
        data, piston = simulate(changed), changed.robot.legs[0].piston
        values = (
            piston.rhoA * piston.length,
            *(residual_vibration(data, name) for name in ("com_deviation", "tip_deflection")),
            float(modes(changed).frequency[0]),
            largest_deviation(data),
        )
        rows.append(dict(zip(COLUMNS, values, strict=True)))
        report(len(rows) / len(PISTONS))
    found = table(rows, ("piston", [piston_words(*pair) for pair in PISTONS], {}), COLUMNS, attributes(study))
    widths = zip(("outer", "inner"), np.transpose(PISTONS), strict=True)
    return found.assign_coords({name: ("piston", column) for name, column in widths})


def piston_words(outer: float, inner: float) -> str:
    """A piston by its diameters [mm]."""
    return f"{outer:g} mm, {inner:g} mm hollow" if inner else f"{outer:g} mm"
