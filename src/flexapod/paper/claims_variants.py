"""What the deviation of the paper's robot depends on, as entries of the claims table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod.paper.claim import (
    BREAKS,
    ELASTIC_LENGTH,
    NOT,
    REACHES,
    Claim,
    by_axis,
    judged,
    largest,
    near,
    peaks,
    roll_and_arm,
    roll_error,
    size,
)
from flexapod.paper.claims_readings import SAYS
from flexapod.paper.claims_welded import tripod_claim, welded_claims
from flexapod.paper.study import PaperStudy
from flexapod.scene.robot import robot_study
from flexapod.words import number, text

if TYPE_CHECKING:
    from xarray import Dataset

FAR = 25.0  # half-angles up to here are one row [deg]


def variant_claims(result: PaperStudy) -> tuple[Claim, ...]:
    """Other times, half-angles up to the singularity, jumps of the velocity."""
    diameters, radii = result["half-angles"], result["half-angles-radii"]
    angles = diameters.half_angle.values
    beyond = angles[angles > FAR].tolist()
    return (
        _duration(result["assumptions"], result["robot"]),
        _half_angles(*(data.sel(half_angle=angles[angles <= FAR]) for data in (diameters, radii))),
        *(_half_angle(diameters.sel(half_angle=a), radii.sel(half_angle=a), a) for a in beyond),
        _jump(result["jump"], result["jump-radii"], result["robot"]),
        _jump_near(result["jump-27"]),
    )


def explanation_claims(result: PaperStudy) -> tuple[Claim, ...]:
    """What would give the paper's figures."""
    robot, other = result["robot"], result["assumptions"]
    return (
        _roll_error(robot),
        _length_errors(other, robot),
        _drives(other),
        *welded_claims(result["welded"]),
        tripod_claim(result["tripod"], result["robot-radii"]),
    )


def _duration(data: Dataset, robot: Dataset) -> Claim:
    durations, rows = data.duration.values, data.deviation_by_duration.values
    parts = [
        f"{duration:g} s: y {text(float(row[1]), 'm')}, z {text(float(row[2]), 'm')}"
        for duration, row in zip(durations, rows, strict=True)
    ]
    sag = abs(float(robot.com_deviation.sel(axis="z")[0]))
    fast, slow = (text(float(rows[i, 2]) - sag, "m", 2) for i in (durations.argmin(), durations.argmax()))
    return Claim(
        where="Time of the roll",
        says=f"{SAYS}; no time is given",
        ours="; ".join(parts),
        verdict=size(*rows),
        reason=f"At rest it sags by {text(sag, 'm')} in z; to that the motion adds {fast} in {durations.min():g} s and "
        f"{slow} in {durations.max():g} s.",
    )


def _half_angles(own: Dataset, other: Dataset) -> Claim:
    angles, rows = own.half_angle.values, own.deviation_peak.values
    forces = np.fmax(own.force_peak, other.force_peak).values / _weight(own)
    each = "; ".join(
        f"{angle:g} deg: y {text(float(y), 'm')}, z {text(float(z), 'm')}"
        for angle, (_, y, z) in zip(angles, rows, strict=True)
    )
    _, y, z = other.deviation_peak.max("half_angle").values
    to = f" to {angles[-1]:g}" if len(angles) > 1 else ""
    return Claim(
        where=f"Half-angles {angles[0]:g}{to} deg",
        says=f"{SAYS}; no joint angles are given",
        ours=f"Diameters: {each}. Radii: at most y {text(float(y), 'm')}, z {text(float(z), 'm')}",
        verdict=size(*rows, *other.deviation_peak.values),
        expected=NOT,
        reason=f"Leg forces up to {number(forces[0], 2)} times the payload's weight at {angles[0]:g} deg, "
        f"{number(forces[-1], 2)} at {angles[-1]:g} deg: the nearer to the architecture singularity at 30 deg, "
        "where the joints form similar hexagons, the softer the robot.",
    )


def _weight(data: Dataset) -> float:
    robot = robot_study(data).robot
    return robot.payload.mass * float(np.linalg.norm(robot.gravity))


def _half_angle(own: Dataset, other: Dataset, angle: float) -> Claim:
    sound = [row.deviation_peak.values for row in (own, other) if str(row.verdict.item()) == ""]
    force = float(np.fmax(own.force_peak, other.force_peak)) / _weight(own)
    order = " y exceeds z, in the paper z is twice y." if sound and all(y > z for _, y, z in sound) else ""
    return Claim(
        where=f"Half-angles {angle:g} deg",
        says=f"{SAYS}; no joint angles are given",
        ours=f"Diameters: {_words(own)}. Radii: {_words(other)}",
        verdict=size(*sound) if sound else BREAKS,
        reason=_near(force) + order,
    )


def _words(row: Dataset) -> str:
    verdict, peak = str(row.verdict.item()), row.deviation_peak.values
    if np.isnan(peak).any():
        return verdict
    if verdict:
        return f"{verdict} ({by_axis(peak)}: beyond the theory)"
    return f"{by_axis(peak)}; forces to {text(float(row.force_peak), 'N')}"


def _near(force: float) -> str:
    """How near the singularity a robot is, by its largest leg force over the payload's weight."""
    words = f"Leg forces up to {number(force, 2)} times the payload's weight"
    if force < 10:
        return f"{words}: near the singularity the robot turns soft; Fig. 8 would show such forces."
    return f"{words}: next to the singularity, where no robot can be used."


def _jump(diameters: Dataset, radii: Dataset, smooth: Dataset) -> Claim:
    impact = text(float(diameters.attrs["impact_energy"]), "J")
    force, usual = (float(np.abs(data.actuator_force).max()) for data in (diameters, smooth))
    return Claim(
        where="Start with a jump",
        says=f"{SAYS}; no law is given, it might start and stop at full rate",
        ours=f"Diameters: {peaks(diameters, 2)}. Radii: {peaks(radii, 2)}",
        verdict=size(largest(diameters), largest(radii)),
        reason=f"The impact of the first instant puts {impact} into the legs; driven on, they ring with a strain "
        f"energy of up to {text(float(diameters.energy_strain.max()), 'J', 2)} and drive forces of up to "
        f"{text(force, 'N', 2)}, {number(force / usual, 2)} times those of the quintic: Fig. 8 would show them.",
    )


def _jump_near(data: Dataset) -> Claim:
    return Claim(
        where="Jump, half-angles 27 deg",
        says=SAYS,
        ours=f"Diameters: {peaks(data, 2)}",
        verdict=size(largest(data)),
        reason="The same jump in a robot that is nearly singular.",
    )


def _roll_error(robot: Dataset) -> Claim:
    roll, arm = roll_and_arm(robot)
    error = roll_error(arm)
    y, z = (float(arm * f(roll) * error) for f in (np.sin, np.cos))
    return Claim(
        where="What would give it: roll",
        says=f"{SAYS}, 6 %",
        ours=f"A roll that is off by {np.rad2deg(error):.2f} deg: y {text(y, 'm')}, z {text(z, 'm')}",
        verdict=size([0.0, y, z]),
        expected=REACHES,
        reason=f"{100 * error / roll:.2g} % of the roll. It fits by construction and shows nothing: this error, d = "
        f"{1e3 * arm:.0f} mm and the roll are three unknowns, backed out of three printed figures.",
    )


def _length_errors(data: Dataset, robot: Dataset) -> Claim:
    low, high = float(data.length_error.min()), float(data.length_error.max())
    most = max(-low, high)
    needed = robot_study(robot).robot.legs[0].piston.EA / ELASTIC_LENGTH * most
    given, wave = float(np.abs(robot.actuator_force).max()), _half_wave(most)
    tips = float(np.abs(robot.tip_deflection).max())
    return Claim(
        where="What would give it: legs",
        says=SAYS,
        ours=f"Legs that are off by {1e3 * low:.1f} to {1e3 * high:+.1f} mm",
        verdict=judged(near(given, needed) or near(tips, wave), best=REACHES),
        reason=f"To stretch by so much, {1e3 * ELASTIC_LENGTH:.0f} mm of piston need {text(needed, 'N')}, the drive "
        f"force is {text(given, 'N')}; to shorten by so much they must bend to a half-wave {1e3 * wave:.0f} mm high "
        f"(shortening pi^2 w^2 / 4 L), tips are {text(tips, 'm', 2)} off.",
    )


def _half_wave(shortening: float) -> float:
    """Height of a half-wave that shortens the paper's piston by `shortening` [m]."""
    return 2 * float(np.sqrt(shortening * ELASTIC_LENGTH)) / np.pi


def _drives(data: Dataset) -> Claim:
    (_, y, z), (_, real_y, real_z) = data.deviation_by_drive.values
    soft, real = data.drive_stiffness.values
    sag = float(data.sag_by_drive.values[0, 2])
    return Claim(
        where="What would give it: drives",
        says=SAYS,
        ours=f"Drives of {text(soft, 'N/m')}: y {text(float(y), 'm')}, z {text(float(z), 'm')}",
        verdict=size(data.deviation_by_drive.values[0]),
        reason=f"{100 * sag / z:.0f} % of z is sag. Ball screws have {text(real, 'N/m')} and more: y "
        f"{text(float(real_y), 'm')}, z {text(float(real_z), 'm')}; and the paper's strokes are prescribed.",
    )
