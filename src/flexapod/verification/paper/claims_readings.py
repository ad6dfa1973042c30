"""Readings of the paper's values as entries of the claims table: none is left out because it was thought unlikely."""

from __future__ import annotations

import numpy as np
from xarray import Dataset

from flexapod.analysis.results.attributes import robot_study
from flexapod.common.quantities import number, text
from flexapod.verification.paper.claim import (
    ELASTIC_LENGTH,
    MISSES,
    Claim,
    axis_words,
    deviation_words,
    largest_deviation,
    ratio_words,
    size_verdict,
)
from flexapod.verification.paper.rows import variant
from flexapod.verification.paper.variants import CUBE, MODULI, cube_edge, inertia_about_com

SAYS = "5 mm in Y and 10 mm in Z"
PRINTED = f"{1e3 * ELASTIC_LENGTH:.0f} mm"


def _peak(readings: Dataset, name: str) -> np.ndarray:
    return readings.deviation_peak.sel(reading=name).values


@variant("Section 2, assumption 3", f"The beam is inextensible; {SAYS}", "readings", expected=MISSES)
def _inextensible(readings: Dataset) -> Claim:
    peak, tip = _peak(readings, "inextensible"), float(readings.tip_peak.sel(reading="inextensible"))
    return Claim(
        ours=f"Pistons that bend and do not stretch: {axis_words(peak)}, with tips {text(tip, 'm', 2)} off",
        verdict=size_verdict(peak),
        reason="With the paper's own assumption no deviation is left, let alone millimetres: between ideal joints all "
        "that bending does to the payload is to shorten legs, by the square of the slope.",
    )


@variant("Table 3, elastic length", f"{SAYS}; elastic length of piston {PRINTED}", "robot", "readings", expected=MISSES)
def _elastic_length(robot: Dataset, readings: Dataset) -> Claim:
    piston = robot_study(robot).robot.legs[0].piston
    own, whole = largest_deviation(robot), _peak(readings, "elastic-length")
    less = 1 - whole / own
    stiffness = float(readings.stretch_stiffness.sel(reading="elastic-length"))
    return Claim(
        ours=f"{1e3 * piston.length:.0f} mm that stretch, {PRINTED} of them free at home: "
        f"{text(piston.EA / piston.length, 'N/m')}, {axis_words(own)}. A piston of {PRINTED} in all: "
        f"{text(stiffness, 'N/m')}, {axis_words(whole)}",
        verdict=size_verdict(own, whole),
        reason=f"The paper does not say whether {PRINTED} are the free part or the whole piston. The presets take the "
        "free part, which bends; what its cylinder guides, down to the drive, stretches too. The other reading "
        f"makes y {100 * less[1]:.0f} % and z {100 * less[2]:.0f} % smaller.",
    )


@variant(
    "Section 3.2, Table 2", f"{SAYS}; the pistons' elastic properties are those of Table 2", "readings", expected=MISSES
)
def _table_2(readings: Dataset) -> Claim:
    row = readings.sel(reading="table-2")
    peak, share = row.deviation_peak.values, 100 * float(row.load_share)
    return Claim(
        ours=f"Pistons with the EI, EA and mass of that beam: {axis_words(peak)}; tips "
        f"{text(float(row.tip_peak), 'm', 2)} off",
        verdict=size_verdict(peak),
        reason="Table 2 is the single actuator's aluminium beam; probably Table 3 is meant. Taken literally, pistons "
        f"bend more easily and stretch hardly more, and bear {share:.2g} % of their Euler load.",
    )


@variant("Elastic modulus", f"{SAYS}, a mode of a piston in Fig. 10; E = 200 GPa", "readings", expected=MISSES)
def _modulus(readings: Dataset) -> Claim:
    rows = {E: readings.sel(reading=f"modulus-{E:g}") for E in MODULI}
    sound = {E: row for E, row in rows.items() if not row.verdict.item()}
    last = sound[min(sound)] if sound else rows[min(rows)]
    return Claim(
        ours=". ".join(f"{E:g} GPa: {_modulus_words(row)}" for E, row in rows.items()),
        verdict=size_verdict(*(row.deviation_peak.values for row in sound.values())),
        reason="With one digit lost the stretch is ten times larger. Near the Euler load millimetres come with a "
        f"visibly bent piston (at {100 * float(last.load_share):.0f} % of it tips are "
        f"{text(float(last.tip_peak), 'm', 2)} off): a modulus {number(200 / min(sound, default=np.nan), 2)} times "
        "too small, and then x is off the most. Beyond, legs collapse and the deviation has any size.",
    )


def _modulus_words(row: Dataset) -> str:
    if row.verdict.item():
        return str(row.verdict.item())
    return f"{axis_words(row.deviation_peak.values)}, tips {text(float(row.tip_peak), 'm', 2)}"


@variant(
    "Circles as radii", f"{SAYS}; Table 3 calls 0.5 m and 0.3 m diameters", "robot", "robot-radii", expected=MISSES
)
def _radii(diameters: Dataset, radii: Dataset) -> Claim:
    (_, y0, z0), (_, y, z) = largest_deviation(diameters), largest_deviation(radii)
    return Claim(
        ours=deviation_words(radii),
        verdict=size_verdict(largest_deviation(radii)),
        reason="A wider robot is stiffer against the moment of the offset payload: "
        f"y {ratio_words(y, y0)}, z {ratio_words(z, z0)}.",
    )


@variant(
    "Centre of mass on top", f"{SAYS}; Eqs. 11-12 put it beside the platform", "robot", "readings", expected=MISSES
)
def _com_on_top(robot: Dataset, readings: Dataset) -> Claim:
    payload = robot_study(robot).robot.payload
    d, edge = float(np.linalg.norm(payload.com)), cube_edge(payload)
    low, high = _peak(readings, "com-on-top"), _peak(readings, CUBE)
    return Claim(
        ours=f"{1e3 * d:.0f} mm above the platform: {axis_words(low)}. {500 * edge:.0f} mm: {axis_words(high)}",
        verdict=size_verdict(low, high),
        reason=f"{payload.inertia.max():g} kg m^2 at {payload.mass:g} kg is a cube of {edge:.2f} m: standing on the "
        f"platform, it has its centre {500 * edge:.0f} mm up.",
    )


@variant("Inertia about the platform", SAYS, "robot", "readings", expected=MISSES)
def _about_platform(robot: Dataset, readings: Dataset) -> Claim:
    payload = robot_study(robot).robot.payload
    moments = np.linalg.eigvalsh(inertia_about_com(payload))
    body = "no body has these" if moments[2] > moments[0] + moments[1] or moments[0] <= 0 else "a body has these"
    peak = _peak(readings, "inertia-of-platform")
    return Claim(
        says=f"{SAYS}; {payload.inertia.max():g} kg m^2, about which point is not said",
        ours=f"About the platform's centre it would be {', '.join(f'{m:.3g}' for m in moments)} kg m^2 about the "
        f"centre of mass: {body}. With the largest lowered to the sum of the others: {axis_words(peak)}",
        verdict=size_verdict(peak),
        reason="Most of the deviation is sag, which does not depend on inertia.",
    )
