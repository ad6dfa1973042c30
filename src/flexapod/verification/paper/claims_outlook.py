"""Limits and future work that the paper names (sections 4.3 and 4.4), as entries of the claims table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from xarray import Dataset

from flexapod.analysis.results.attributes import robot_study
from flexapod.common.quantities import along_axes, number, text
from flexapod.verification.paper.claim import (
    DONE,
    HOLDS,
    USELESS,
    Claim,
    choose_verdict,
    deviation_words,
    largest_deviation,
)
from flexapod.verification.paper.outlook import (
    BLOW,
    BLOW_TIME,
    DRAWS,
    FLOOR,
    FRICTION,
    GAIN,
    MATERIAL,
    SAMPLE,
    SHAPER,
    TOLERANCES,
)
from flexapod.verification.paper.rows import outlook

MUCH, SOME = 0.2, 0.8  # of what was there before: what is left where a remedy helps, and where it helps a little


def _helps(before: float, after: float) -> str:
    """Verdict on a remedy by the size of an effect before and after it."""
    return choose_verdict(after < MUCH * before, after < SOME * before, best=DONE, worst=USELESS)


def _counts(*sizes: float) -> str:
    """Verdict on effects that were to be accounted for: computed, and there."""
    return choose_verdict(all(np.isfinite(x) and x > 0 for x in sizes), best=DONE, worst=USELESS)


def _per_cent(ratios: Sequence[float] | np.ndarray) -> str:
    return ", ".join(f"{number(100 * float(x), 2)} %" for x in ratios)


@outlook("Section 4.4, compensation", "Control that compensates elastic deformations is future work", "ahead")
def _compensation(ahead: Dataset) -> Claim:
    peak = ahead.miss_peak.values
    left = [float(np.linalg.norm(x, axis=1).max()) for x in ahead.miss.values]
    each = "; ".join(f"{name}: {along_axes(row)}" for name, row in zip(ahead.command.values[1:], peak[1:], strict=True))
    return Claim(
        ours=f"The payload beside its path, at most: {along_axes(peak[0])}. With commands ahead of time that make up "
        f"for {each}",
        verdict=_helps(left[0], left[-1]),
        reason="What is known beforehand can be in the commands, without a sensor, and in the same time: they make "
        f"the miss {number(left[0] / left[-1], 2)} times smaller. They know no friction, no floor, no tolerances.",
    )


@outlook("Section 4.4, vibration", "Active vibration control is future work", "shaped")
def _shaped(shaped: Dataset) -> Claim:
    payload, tips, longer = (shaped[name].values for name in ("payload_vibration", "tip_vibration", "longer"))
    each = "; ".join(
        f"{name}: {text(float(a), 'm', 2)}, {text(float(b), 'm', 2)}"
        for name, a, b in zip(shaped.command.values, payload, tips, strict=True)
    )
    return Claim(
        ours=f"Payload and tips after the roll, from peak to peak. {each[0].upper()}{each[1:]}",
        verdict=_helps(float(payload[0]), float(payload[-1])),
        reason=f"The roll is added up of delayed shares of itself ({SHAPER.upper()}), so that what they excite "
        f"cancels; it takes {text(float(longer[-1]), 's', 2)} more.",
    )


@outlook("Section 4.4, feedback", "Real-time feedback is future work", "feedback")
def _feedback(loops: Dataset) -> Claim:
    before, after = loops.damping_ratio.values
    peak = loops.compliance.max("frequency").values
    frequency = ", ".join(number(float(f), 3) for f in loops.mode_frequency.values[0])
    drive = robot_study(loops).robot.legs[0].drive
    stiffness = text(float(getattr(drive, "stiffness", np.nan)), "N/m")
    return Claim(
        ours=f"On drives of {stiffness}, as stiff as the pistons, each of which gives way to the integral of its own "
        f"force: damping of the modes at {frequency} Hz {_per_cent(after)} in place of {_per_cent(before)}, largest "
        f"compliance {number(1e6 * float(peak[1]))} in place of {number(1e6 * float(peak[0]))} µm/N",
        verdict=_helps(float(peak[0]), float(peak[1])),
        reason=f"A gain of {GAIN:g} 1/s, sampled every {text(SAMPLE, 's')} in the march, which is struck with "
        f"{BLOW:g} N for {text(BLOW_TIME, 's')}. Drives that hold their stroke, as the paper's, feel nothing: these "
        "are ours. By hand half of the gain over twice the circular frequency where half of the energy is in the "
        "drives, as in the first mode; others bend the legs as well.",
    )


@outlook(
    "Section 4.3, friction", "Not accounted for: joint friction, which can influence vibration and accuracy", "friction"
)
def _friction(rubbing: Dataset) -> Claim:
    ideal, rubs, ahead = rubbing.miss.values
    extra = np.abs(rubs - ideal).max(axis=0)
    own, kept, left = (along_axes(np.abs(x).max(axis=0)) for x in (ideal, rubs, ahead))
    lost = float(rubbing.lost[1] - rubbing.lost[0])
    mu, width = FRICTION["mu"], FRICTION["diameter"]
    return Claim(
        ours=f"Plain joints of {text(width, 'm')} with a coefficient of {mu:g}: {kept} in place of {own}, on the way "
        f"up to {along_axes(extra)} from there; {text(lost, 'J', 2)} are lost in the roll. With commands ahead for "
        f"weight and inertia {left} are left",
        verdict=_counts(*extra),
        reason="Joints that rub carry moments, which bend pistons and load legs, and keep some of that at rest. Size "
        "and coefficient are ours. Once weight and inertia are made up for, friction is what is left.",
    )


@outlook("Section 4.3, imperfections", "Not accounted for: material imperfections", "tolerances", "robot")
def _imperfections(spread: Dataset, robot: Dataset) -> Claim:
    by_kind = np.sqrt((spread.pose_sigma_by_tolerance**2).sum("leg"))
    own = np.sqrt((by_kind.sel({"tolerance": list(MATERIAL)}).values[:, :3] ** 2).sum(axis=0))
    whole, drawn = spread.pose_sigma.values[:3], np.sqrt(np.diag(spread.sample_covariance.values))[:3]
    joints, legs, bow, stiffness, density = _spreads()
    return Claim(
        ours=f"Pistons that scatter by {stiffness} in stiffness, {density} in density and {bow} in bow spread the "
        f"payload at home by {along_axes(own)} (standard deviations), with joints that lie within {joints} and legs "
        f"set to {legs} by {along_axes(whole)}; {DRAWS} machines that are drawn: {along_axes(drawn)}",
        verdict=_counts(*own, *whole),
        reason="All spreads are ours. What pistons are made of counts little; where joints lie counts "
        f"{number(float(np.linalg.norm(whole) / np.linalg.norm(largest_deviation(robot))), 2)} times as much as the "
        "elastic deviation, until a calibration takes it out.",
    )


def _spreads() -> tuple[str, ...]:
    """Spreads of joints, legs, bow, stiffness and density as text."""
    lengths = (text(TOLERANCES[name], "m", 2) for name in ("base_joints", "leg_offset", "bow"))
    return (*lengths, *(f"{100 * TOLERANCES[name]:g} %" for name in ("EA", "density")))


@outlook("Section 4.3, disturbances", "Not accounted for: external disturbances", "budget")
def _disturbances(budget: Dataset) -> Claim:
    floor = np.abs(budget.budget.sel(part="floor vibration", kind="random").values[:3])
    return Claim(
        ours=f"A floor as bad as {FLOOR} allows shakes the payload at home by {along_axes(floor)} (rms)",
        verdict=_counts(float(np.linalg.norm(floor))),
        reason="The pistons' damping leaves the payload's modes nearly undamped: that is what force feedback is for. "
        "The budget of all errors is drawn as error-budget.",
    )


@outlook(
    "Section 4.3",
    "A wider range of robotic architectures is future work; lateral vibration of the pistons matters",
    "tripod",
    "robot-radii",
    expected=HOLDS,
)
def _tripod(tripod: Dataset, robot: Dataset) -> Claim:
    shares, own = (_bent(data) for data in (tripod, robot))
    return Claim(
        ours=f"A 3-RPS of the same pistons, radii, payload and roll: {deviation_words(tripod)}; bending makes "
        f"{_shares(shares)} of it. The 6-UPS: {deviation_words(robot)}; {_shares(own)}",
        verdict=choose_verdict(shares.min() > 0.5 > own.max()),
        reason="Three hinges guide the platform sideways through the pistons, which give as cantilevers do: there the "
        "paper's claim is true. Ideal U and S joints keep it from a 6-UPS.",
    )


def _bent(data: Dataset) -> np.ndarray:
    """Share of bending in the largest deviation along each axis."""
    bending = np.abs(data.deviation_by_cause.sel(cause="bending").sum("leg").values).max(axis=0)
    return bending / largest_deviation(data)


def _shares(shares: np.ndarray) -> str:
    low, high = (number(100 * float(share), 2) for share in (shares.min(), shares.max()))
    return f"{low} %" if low == high else f"{low} to {high} %"
