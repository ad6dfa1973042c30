"""Entries of the claims table on what the deviation of the paper's robot depends on, ball joints included.

Ball joints that carry moments are a hypothesis with its evidence and free parameters.
"""

from __future__ import annotations

import numpy as np
from xarray import Dataset

from flexapod.analysis.results.attributes import robot_study
from flexapod.common.quantities import number, text
from flexapod.verification.paper.claim import (
    BREAKS,
    ELASTIC_LENGTH,
    MISSES,
    PAPER_DEVIATION,
    REACHES,
    Claim,
    axis_words,
    choose_verdict,
    deviation_words,
    is_similar,
    largest_deviation,
    roll_and_arm,
    roll_error,
    size_verdict,
    transverse_words,
)
from flexapod.verification.paper.claims_readings import SAYS
from flexapod.verification.paper.clamped_legs import SLOPE, travel_share
from flexapod.verification.paper.rows import variant

FAR = 25.0  # half-angles up to here are one row [deg]
NO_ANGLES = f"{SAYS}; no joint angles are given"


@variant("Time of the roll", f"{SAYS}; no time is given", "assumptions", "robot")
def _duration(data: Dataset, robot: Dataset) -> Claim:
    durations, rows = data.duration.values, data.deviation_by_duration.values
    parts = [f"{duration:g} s: {transverse_words(peak)}" for duration, peak in zip(durations, rows, strict=True)]
    sag = abs(float(robot.com_deviation.sel(axis="z")[0]))
    fast, slow = (text(float(rows[i, 2]) - sag, "m", 2) for i in (durations.argmin(), durations.argmax()))
    return Claim(
        ours="; ".join(parts),
        verdict=size_verdict(*rows),
        reason=f"At rest it sags by {text(sag, 'm')} in z; to that the motion adds {fast} in {durations.min():g} s and "
        f"{slow} in {durations.max():g} s.",
    )


@variant("Half-angles", NO_ANGLES, "half-angles", "half-angles-radii", expected=MISSES)
def _half_angles(diameters: Dataset, radii: Dataset) -> Claim:
    own, other = (data.isel(half_angle=data.half_angle.values <= FAR) for data in (diameters, radii))
    angles, rows = own.half_angle.values, own.deviation_peak.values
    forces = np.fmax(own.force_peak, other.force_peak).values / _weight(own)
    each = "; ".join(f"{angle:g} deg: {transverse_words(peak)}" for angle, peak in zip(angles, rows, strict=True))
    most = transverse_words(other.deviation_peak.max("half_angle").values)
    to = f" to {angles[-1]:g}" if len(angles) > 1 else ""
    return Claim(
        where=f"Half-angles {angles[0]:g}{to} deg",
        ours=f"Diameters: {each}. Radii: at most {most}",
        verdict=size_verdict(*rows, *other.deviation_peak.values),
        reason=f"Leg forces up to {number(forces[0], 2)} times the payload's weight at {angles[0]:g} deg, "
        f"{number(forces[-1], 2)} at {angles[-1]:g} deg: the nearer to the architecture singularity at 30 deg, "
        "where the joints form similar hexagons, the softer the robot.",
    )


def _weight(data: Dataset) -> float:
    robot = robot_study(data).robot
    return robot.payload.mass * float(np.linalg.norm(robot.gravity))


@variant("Half-angles", NO_ANGLES, "half-angles", "half-angles-radii")
def _beyond(diameters: Dataset, radii: Dataset) -> list[Claim]:
    angles = diameters.half_angle.values
    pairs = ((angle, *(data.sel(half_angle=angle) for data in (diameters, radii))) for angle in angles[angles > FAR])
    return [_half_angle(*pair) for pair in pairs]


def _half_angle(angle: float, own: Dataset, other: Dataset) -> Claim:
    sound = [data.deviation_peak.values for data in (own, other) if str(data.verdict.item()) == ""]
    force = float(np.fmax(own.force_peak, other.force_peak)) / _weight(own)
    order = " y exceeds z, in the paper z is twice y." if sound and all(y > z for _, y, z in sound) else ""
    return Claim(
        where=f"Half-angles {angle:g} deg",
        ours=f"Diameters: {_words(own)}. Radii: {_words(other)}",
        verdict=size_verdict(*sound) if sound else BREAKS,
        reason=_near(force) + order,
    )


def _words(data: Dataset) -> str:
    verdict, peak = str(data.verdict.item()), data.deviation_peak.values
    if np.isnan(peak).any():
        return verdict
    if verdict:
        return f"{verdict} ({axis_words(peak)}: beyond the theory)"
    return f"{axis_words(peak)}; forces to {text(float(data.force_peak), 'N')}"


def _near(force: float) -> str:
    """Nearness of a robot to the singularity as text, by its largest leg force over the payload's weight."""
    words = f"Leg forces up to {number(force, 2)} times the payload's weight"
    if force < 10:
        return f"{words}: near the singularity the robot turns soft; Fig. 8 would show such forces."
    return f"{words}: next to the singularity, where no robot can be used."


@variant(
    "Start with a jump", f"{SAYS}; no law is given, it might start and stop at full rate", "jump", "jump-radii", "robot"
)
def _jump(diameters: Dataset, radii: Dataset, smooth: Dataset) -> Claim:
    impact = text(float(diameters.attrs["impact_energy"]), "J")
    force, usual = (float(np.abs(data.actuator_force).max()) for data in (diameters, smooth))
    return Claim(
        ours=f"Diameters: {deviation_words(diameters, 2)}. Radii: {deviation_words(radii, 2)}",
        verdict=size_verdict(largest_deviation(diameters), largest_deviation(radii)),
        reason=f"The impact of the first instant puts {impact} into the legs; driven on, they ring with a strain "
        f"energy of up to {text(float(diameters.energy_strain.max()), 'J', 2)} and drive forces of up to "
        f"{text(force, 'N', 2)}, {number(force / usual, 2)} times those of the quintic: Fig. 8 would show them.",
    )


@variant("Jump, half-angles 27 deg", SAYS, "jump-27")
def _jump_near(data: Dataset) -> Claim:
    return Claim(
        ours=f"Diameters: {deviation_words(data, 2)}",
        verdict=size_verdict(largest_deviation(data)),
        reason="The same jump in a robot that is nearly singular.",
    )


@variant("What would give it: roll", f"{SAYS}, 6 %", "robot", expected=REACHES)
def _roll_error(robot: Dataset) -> Claim:
    roll, arm = roll_and_arm(robot)
    error = roll_error(arm)
    off = [0.0, *(float(arm * f(roll) * error) for f in (np.sin, np.cos))]
    return Claim(
        ours=f"A roll that is off by {np.rad2deg(error):.2f} deg: {transverse_words(off)}",
        verdict=size_verdict(off),
        reason=f"{100 * error / roll:.2g} % of the roll. It fits by construction and shows nothing: this error, d = "
        f"{1e3 * arm:.0f} mm and the roll are three unknowns, backed out of three printed figures.",
    )


@variant("What would give it: legs", SAYS, "assumptions", "robot")
def _length_errors(data: Dataset, robot: Dataset) -> Claim:
    low, high = float(data.length_error.min()), float(data.length_error.max())
    most = max(-low, high)
    needed = robot_study(robot).robot.legs[0].piston.EA / ELASTIC_LENGTH * most
    given, wave = float(np.abs(robot.actuator_force).max()), _half_wave(most)
    tips = float(np.abs(robot.tip_deflection).max())
    return Claim(
        ours=f"Legs that are off by {1e3 * low:.1f} to {1e3 * high:+.1f} mm",
        verdict=choose_verdict(is_similar(given, needed) or is_similar(tips, wave), best=REACHES, worst=MISSES),
        reason=f"To stretch by so much, {1e3 * ELASTIC_LENGTH:.0f} mm of piston need {text(needed, 'N')}, the drive "
        f"force is {text(given, 'N')}; to shorten by so much they must bend to a half-wave {1e3 * wave:.0f} mm high "
        f"(shortening pi^2 w^2 / 4 L), tips are {text(tips, 'm', 2)} off.",
    )


def _half_wave(shortening: float) -> float:
    """Height of a half-wave that shortens the paper's piston by `shortening` [m]."""
    return 2 * float(np.sqrt(shortening * ELASTIC_LENGTH)) / np.pi


@variant("What would give it: drives", SAYS, "assumptions")
def _drives(data: Dataset) -> Claim:
    peaks, (soft, real) = data.deviation_by_drive.values, data.drive_stiffness.values
    sag = float(data.sag_by_drive.values[0, 2])
    return Claim(
        ours=f"Drives of {text(soft, 'N/m')}: {transverse_words(peaks[0])}",
        verdict=size_verdict(peaks[0]),
        reason=f"{100 * sag / peaks[0, 2]:.0f} % of z is sag. Ball screws have {text(real, 'N/m')} and more: "
        f"{transverse_words(peaks[1])}; and the paper's strokes are prescribed.",
    )


#: Roll [deg], arm [m] and deviation along x, y, z [m] of the robots that come nearest with geometrically exact rods for
#: legs, by reading. Computed outside of this program: tests/verification/test_clamped_legs.py holds them.
EXACT = {
    "diameters": (11.0, 0.6, (2.802e-3, 6.298e-3, 9.114e-3)),
    "radii": (17.0, 0.373, (1.263e-3, 6.143e-3, 11.520e-3)),
    "diameters-one": (20.0, 0.6, (15.317e-3, 4.991e-3, 9.538e-3)),
    "radii-one": (27.0, 0.6, (2.405e-3, 3.759e-3, 7.849e-3)),
}
SAYS_MORE = f"{SAYS}, 6 %; a mode of a piston in Fig. 10"


def nearest_robot(found: Dataset) -> Dataset:
    """The robot of one reading, by arm and roll, whose y and z are nearest to the printed ones."""
    y, z = (found.deviation.sel(axis=axis).values / limit - 1 for axis, limit in PAPER_DEVIATION.items())
    miss = np.nan_to_num(np.maximum(np.abs(y), np.abs(z)), nan=np.inf)
    j, k = np.unravel_index(miss.argmin(), miss.shape)
    share = float(travel_share(found)[j, k])
    return found.isel(arm=int(j), roll=int(k)).assign(share=share)


def _nearest_by_reading(found: Dataset, *, alone: bool) -> dict[str, Dataset]:
    """Nearest robot of each reading with six clamped legs, or of each with one, `alone`."""
    names = [str(name) for name in found.reading.values]
    return {name: nearest_robot(found.sel(reading=name)) for name in names if name.endswith("-one") == alone}


def _clamped_words(name: str, row: Dataset) -> str:
    moved = axis_words(row.deviation.values, 2)
    return f"{name}, {_where(row)}: {moved}, {100 * float(row.share):.2g} % of the travel in z"


def _where(row: Dataset) -> str:
    return f"roll {float(row['roll']):.0f} deg, d = {1e3 * float(row.arm):.0f} mm"


def _trust(rows: dict[str, Dataset]) -> str:
    """Slopes of the nearest robots' legs, and error of the theory there against exact rods, as text."""
    slopes = " and ".join(number(float(row.slope), 2) for row in rows.values())
    off = "; ".join(f"{name.removesuffix('-one')} {_off(name, row)}" for name, row in rows.items())
    return (
        f"Slopes of the legs reach {slopes}, the theory is made for {SLOPE:g}. Against geometrically exact rods, which "
        f"{_also(rows)}: {off}."
    )


def _also(rows: dict[str, Dataset]) -> str:
    """Clause on whether exact rods are of the printed size as well."""
    exact = [found for name, row in rows.items() if (found := _exact(name, row)) is not None]
    return "are of that size as well" if exact and size_verdict(*exact) == REACHES else "are not of that size"


def _exact(name: str, row: Dataset) -> tuple[float, float, float] | None:
    """Deviation [m] of exact rods in place of this robot's legs; None where it was not computed."""
    roll, arm, deviation = EXACT[name]
    same = np.isclose(float(row["roll"]), roll) and np.isclose(float(row.arm), arm)
    return deviation if same else None


def _off(name: str, row: Dataset) -> str:
    exact = _exact(name, row)
    if exact is None:
        return "not compared"
    ways = []
    for axis, theirs in zip("xyz", exact, strict=True):
        ours = float(row.deviation.sel(axis=axis))
        word = "above" if ours > theirs else "below"
        ways.append(
            f"{axis} {text(ours, 'm')} is {number(100 * abs(ours / theirs - 1), 2)} % {word} {text(theirs, 'm')}"
        )
    return ", ".join(ways)


@variant("What would give it: joints", SAYS_MORE, "welded", expected=REACHES)
def _six(found: Dataset) -> Claim:
    rows = _nearest_by_reading(found, alone=False)
    *_, best = rows.values()
    return Claim(
        ours="Legs fixed to the platform, at rest. "
        + ". ".join(_clamped_words(n.capitalize(), r) for n, r in rows.items()),
        verdict=size_verdict(*(row.deviation.values for row in rows.values())),
        reason=f"A hypothesis, not a fit: tips {text(float(best.off_axis), 'm', 2)} off are visibly bent, "
        f"and bending counts at first order. It has free parameters (roll, d, half-angles, height), the 6 % are met "
        f"elsewhere than y and z, legs bear {text(float(best.leg_force), 'N', 2)} and "
        f"{text(float(best.stress), 'Pa', 2)}, which a linear elastic steel does and no real one. {_trust(rows)}",
    )


@variant("What would give it: one joint", SAYS_MORE, "welded")
def _one(found: Dataset) -> Claim:
    rows = _nearest_by_reading(found, alone=True)
    verdict = size_verdict(*(row.deviation.values for row in rows.values()))
    words = ". ".join(_clamped_words(name.removesuffix("-one").capitalize(), row) for name, row in rows.items())
    return Claim(
        ours=f"Leg 1 alone fixed to the platform. {words}",
        verdict=verdict,
        reason="One leg that is held at the platform pushes it aside: y is larger than z but for large rolls and arms. "
        f"{_trust(rows)}",
    )
