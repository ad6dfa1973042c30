"""Ball joints that carry moments as entries of the claims table: a hypothesis with its evidence and free parameters."""

from __future__ import annotations

import numpy as np
from xarray import Dataset

from flexapod.paper.claim import (
    HOLDS,
    PAPER_DEVIATION,
    REACHES,
    by_axis,
    judged,
    largest,
    peaks,
    size,
)
from flexapod.paper.claims_readings import SAYS
from flexapod.paper.rows import Said, row
from flexapod.paper.welded import SLOPE, travel_share
from flexapod.words import number, text

SAYS_MORE = f"{SAYS}, 6 %; a mode of a piston in Fig. 10"


def nearest(found: Dataset) -> Dataset:
    """The robot of one reading, by arm and roll, whose y and z are nearest to the printed ones."""
    y, z = (found.deviation.sel(axis=axis).values / limit - 1 for axis, limit in PAPER_DEVIATION.items())
    miss = np.nan_to_num(np.maximum(np.abs(y), np.abs(z)), nan=np.inf)
    j, k = np.unravel_index(miss.argmin(), miss.shape)
    share = float(travel_share(found)[j, k])
    return found.isel(arm=int(j), roll=int(k)).assign(share=share)


def _nearest_by_reading(found: Dataset, *, alone: bool) -> dict[str, Dataset]:
    """The same of all readings with six welded legs, or with one `alone`."""
    names = [str(name) for name in found.reading.values]
    return {name: nearest(found.sel(reading=name)) for name in names if name.endswith("-one") == alone}


def _words(name: str, row: Dataset) -> str:
    where = f"roll {float(row['roll']):.0f} deg, d = {1e3 * float(row.arm):.0f} mm"
    return f"{name}, {where}: {by_axis(row.deviation.values, 2)}, {100 * float(row.share):.2g} % of the travel in z"


@row("What would give it: joints", SAYS_MORE, "welded", expected=REACHES)
def _six(found: Dataset) -> Said:
    rows = _nearest_by_reading(found, alone=False)
    *_, best = rows.values()
    return Said(
        ours="Legs fixed to the platform, at rest. " + ". ".join(_words(n.capitalize(), r) for n, r in rows.items()),
        verdict=size(*(row.deviation.values for row in rows.values())),
        reason=f"A hypothesis, not a fit: tips {text(float(best.off_axis), 'm', 2)} off are visibly bent, "
        f"and bending counts at first order. It has free parameters (roll, d, half-angles, height), the 6 % are met "
        f"elsewhere than y and z, legs bear {text(float(best.leg_force), 'N', 2)} and "
        f"{text(float(best.stress), 'Pa', 2)}, which a linear elastic steel does and no real one. Slopes reach "
        f"{number(float(best.slope), 2)}, the theory is made for {SLOPE:g}: how far exact rods are off "
        "is in docs/when-bending-matters.md.",
    )


@row("What would give it: one joint", SAYS_MORE, "welded")
def _one(found: Dataset) -> Said:
    rows = _nearest_by_reading(found, alone=True)
    verdict = size(*(row.deviation.values for row in rows.values()))
    words = ". ".join(_words(name.removesuffix("-one").capitalize(), row) for name, row in rows.items())
    return Said(
        ours=f"Leg 1 alone fixed to the platform. {words}",
        verdict=verdict,
        reason="One leg that is held at the platform pushes it aside: y is larger than z but for large rolls and arms.",
    )


@row(
    "Section 4.3",
    "A wider range of robotic architectures is future work; lateral vibration of the pistons matters",
    "tripod",
    "robot-radii",
    expected=HOLDS,
)
def _tripod(tripod: Dataset, robot: Dataset) -> Said:
    shares, own = (_bent(data) for data in (tripod, robot))
    return Said(
        ours=f"A 3-RPS of the same pistons, radii, payload and roll: {peaks(tripod)}; bending makes "
        f"{_percent(shares)} of it. The 6-UPS: {peaks(robot)}; {_percent(own)}",
        verdict=judged(shares.min() > 0.5 > own.max()),
        reason="Three hinges guide the platform sideways through the pistons, which give as cantilevers do: there the "
        "paper's claim is true. Ideal U and S joints keep it from a 6-UPS.",
    )


def _bent(data: Dataset) -> np.ndarray:
    """Share of bending in the largest deviation along each axis."""
    bending = np.abs(data.deviation_by_cause.sel(cause="bending").sum("leg").values).max(axis=0)
    return bending / largest(data)


def _percent(shares: np.ndarray) -> str:
    low, high = (number(100 * float(share), 2) for share in (shares.min(), shares.max()))
    return f"{low} %" if low == high else f"{low} to {high} %"
