"""What the deviation of the paper's robot depends on, as entries of the claims table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from flexapod.study.paper.claim import (
    BREAKS,
    ELASTIC_LENGTH,
    NOT,
    OPEN,
    PAPER_DEVIATION,
    REACHES,
    Claim,
    by_axis,
    peaks,
    roll_and_arm,
)
from flexapod.study.paper.study import PaperStudy
from flexapod.study.words import text

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["explanation_claims", "variant_claims"]

SAYS = "5 mm in Y and 10 mm in Z"


def variant_claims(result: PaperStudy) -> tuple[Claim, ...]:
    """The other reading of the circles, other times, half-angles up to the singularity, jumps of the velocity."""
    diameters, radii = result["half-angles"], result["half-angles-radii"]
    angles = diameters.half_angle.values.tolist()
    return (
        _radii(result["robot-radii"]),
        _duration(result["assumptions"]),
        *(_half_angle(diameters.sel(half_angle=a), radii.sel(half_angle=a), a) for a in angles),
        _jump(result["jump"], result["jump-radii"]),
        _jump_near(result["jump-27"]),
    )


def explanation_claims(result: PaperStudy) -> tuple[Claim, ...]:
    """What would give the paper's figures."""
    other = result["assumptions"]
    return (_roll_error(result["robot"]), _length_errors(other), _drives(other), _joints(other))


def _size(y: float, z: float) -> str:
    """Verdict on deviations: whether both are at least half of the paper's."""
    return REACHES if 2 * y >= PAPER_DEVIATION["y"] and 2 * z >= PAPER_DEVIATION["z"] else NOT


def _largest(data: Dataset) -> str:
    """Verdict on the largest deviations of a simulation."""
    return _size(*np.abs(data.com_deviation.values).max(axis=0)[1:])


def _radii(data: Dataset) -> Claim:
    return Claim(
        where="Circles as radii",
        says=f"{SAYS}; Table 3 calls 0.5 m and 0.3 m diameters",
        ours=peaks(data),
        verdict=_largest(data),
        reason="A wider robot is stiffer against the moment of the offset payload.",
    )


def _duration(data: Dataset) -> Claim:
    parts = [
        f"{float(duration):g} s: y {text(float(row[1]), 'm')}, z {text(float(row[2]), 'm')}"
        for duration, row in zip(data.duration, data.deviation_by_duration.values, strict=True)
    ]
    return Claim(
        where="Time of the roll",
        says=f"{SAYS}; no time is given",
        ours="; ".join(parts),
        verdict=_size(*data.deviation_by_duration.values[:, 1:].max(axis=0)),
        reason="Slower, only the sag is left; even four times as fast, inertia adds less than a tenth of a millimetre.",
    )


def _half_angle(own: Dataset, other: Dataset, angle: float) -> Claim:
    largest = [row.deviation_peak.values for row in (own, other)]
    good = [str(row.verdict.item()) == "" for row in (own, other)]
    reached = any(ok and _size(peak[1], peak[2]) == REACHES for ok, peak in zip(good, largest, strict=True))
    verdict = BREAKS if not any(good) else REACHES if reached else NOT
    return Claim(
        where=f"Half-angles {angle:g} deg",
        says=f"{SAYS}; no joint angles are given",
        ours=f"Diameters: {_words(own)}. Radii: {_words(other)}",
        verdict=verdict,
        reason=_reason(angle),
    )


def _words(row: Dataset) -> str:
    verdict, peak = str(row.verdict.item()), row.deviation_peak.values
    if np.isnan(peak).any():
        return verdict
    if verdict:
        return f"{verdict} ({by_axis(peak)}: beyond the theory)"
    return f"{by_axis(peak)}; forces to {text(float(row.force_peak), 'N')}"


def _reason(angle: float) -> str:
    if angle < 25:
        return "Far from the architecture singularity at 30 deg, where base and platform are similar hexagons."
    if angle < 28:
        return "Near the singularity the robot turns soft and leg forces grow; Fig. 8 would show it."
    return "Next to the singularity leg forces are ten and more times the payload's weight: no robot for use."


def _jump(diameters: Dataset, radii: Dataset) -> Claim:
    step = text(float(diameters.attrs["impact_energy"]), "J")
    return Claim(
        where="Start with a jump",
        says=f"{SAYS}; no law is given, it might start and stop at full rate",
        ours=f"Diameters: {peaks(diameters, 2)}. Radii: {peaks(radii, 2)}",
        verdict=REACHES if REACHES in (_largest(diameters), _largest(radii)) else NOT,
        reason=f"Constant rate from the first instant: an impact ({step} go into the legs), and another at the stop.",
    )


def _jump_near(data: Dataset) -> Claim:
    return Claim(
        where="Jump, half-angles 27 deg",
        says=SAYS,
        ours=f"Diameters: {peaks(data, 2)}",
        verdict=_largest(data),
        reason="The same jump in a robot that is nearly singular.",
    )


def _roll_error(robot: Dataset) -> Claim:
    roll, arm = roll_and_arm(robot)
    error = math.hypot(*PAPER_DEVIATION.values()) / arm
    y, z = (float(arm * f(roll) * error) for f in (np.sin, np.cos))
    return Claim(
        where="What would give it: roll",
        says=f"{SAYS}, 6 %",
        ours=f"A roll that is off by {np.rad2deg(error):.2f} deg: y {text(y, 'm')}, z {text(z, 'm')}",
        verdict=_size(y, z),
        reason=(
            f"{100 * error / roll:.2g} % of the roll. d = {1e3 * arm:.0f} mm and the roll are themselves backed out of "
            "the printed figures, as those of one such error: that it fits all three hints at where they come from."
        ),
    )


def _length_errors(data: Dataset) -> Claim:
    low, high = 1e3 * float(data.length_error.min()), 1e3 * float(data.length_error.max())
    return Claim(
        where="What would give it: legs",
        says=SAYS,
        ours=f"Legs that are off by {low:.1f} to {high:+.1f} mm",
        verdict=NOT,
        reason=(
            "To stretch by so much a piston needs hundreds of kilonewtons; to shorten by so much it must bend to a "
            f"half-wave {1e3 * _half_wave(1e-3 * max(-low, high)):.0f} mm high (shortening pi^2 w^2 / 4 L)."
        ),
    )


def _half_wave(shortening: float) -> float:
    """Height of a half-wave that shortens the paper's piston by `shortening` [m]."""
    return 2 * float(np.sqrt(shortening * ELASTIC_LENGTH)) / np.pi


def _drives(data: Dataset) -> Claim:
    soft, real = data.deviation_by_drive.values
    k = data.drive_stiffness.values
    return Claim(
        where="What would give it: drives",
        says=SAYS,
        ours=f"Drives of {text(k[0], 'N/m')}: y {text(float(soft[1]), 'm')}, z {text(float(soft[2]), 'm')}",
        verdict=_size(float(soft[1]), float(soft[2])),
        reason=(
            f"Most of it sag. Ball screws have {text(k[1], 'N/m')} and more: y {text(float(real[1]), 'm')}, "
            f"z {text(float(real[2]), 'm')}; and the paper's strokes are prescribed."
        ),
    )


def _joints(data: Dataset) -> Claim:
    turn = float(data.joint_turn.max())
    shortening = ELASTIC_LENGTH * turn**2 / 10  # pinned at the other end
    return Claim(
        where="What would give it: joints",
        says=f"{SAYS}; a visibly bent piston in Fig. 10",
        ours=f"Spherical joints that carry moments would shorten legs by up to {1e3 * shortening:.0f} mm (estimate)",
        verdict=OPEN,
        reason=(
            f"Legs turn by up to {np.rad2deg(turn):.0f} deg against the platform; a piston held at its end shortens by "
            "L theta^2 / 10, stressed far above yield, to which a linear elastic material does not object. "
            "The likeliest origin of the paper's figures, and not a property of ideal joints."
        ),
    )
