"""Ball joints that carry moments as entries of the claims table: a hypothesis with its evidence and free parameters."""

from __future__ import annotations

import numpy as np
from xarray import Dataset

from flexapod.common.quantities import number, text
from flexapod.verification.paper.claim import (
    PAPER_DEVIATION,
    REACHES,
    by_axis,
    size,
)
from flexapod.verification.paper.claims_readings import SAYS
from flexapod.verification.paper.clamped_legs import SLOPE, travel_share
from flexapod.verification.paper.rows import Said, variant

#: Roll [deg], arm [m] and deviation along x, y, z [m] of the robots that come nearest with geometrically exact rods for
#: legs, by reading. Computed outside of this program: tests/consistency/test_welded_robot.py holds them.
EXACT = {
    "diameters": (11.0, 0.6, (2.802e-3, 6.298e-3, 9.114e-3)),
    "radii": (17.0, 0.373, (1.263e-3, 6.143e-3, 11.520e-3)),
    "diameters-one": (20.0, 0.6, (15.317e-3, 4.991e-3, 9.538e-3)),
    "radii-one": (27.0, 0.6, (2.405e-3, 3.759e-3, 7.849e-3)),
}
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
    return (
        f"{name}, {_where(row)}: {by_axis(row.deviation.values, 2)}, {100 * float(row.share):.2g} % of the travel in z"
    )


def _where(row: Dataset) -> str:
    return f"roll {float(row['roll']):.0f} deg, d = {1e3 * float(row.arm):.0f} mm"


def _trust(rows: dict[str, Dataset]) -> str:
    """How steep the legs of the nearest robots are, and how far the theory is there from geometrically exact rods."""
    slopes = " and ".join(number(float(row.slope), 2) for row in rows.values())
    off = "; ".join(f"{name.removesuffix('-one')} {_off(name, row)}" for name, row in rows.items())
    return (
        f"Slopes of the legs reach {slopes}, the theory is made for {SLOPE:g}. Against geometrically exact rods, which "
        f"{_also(rows)}: {off}."
    )


def _also(rows: dict[str, Dataset]) -> str:
    """Whether exact rods are of the printed size as well."""
    exact = [found for name, row in rows.items() if (found := _exact(name, row)) is not None]
    return "are of that size as well" if exact and size(*exact) == REACHES else "are not of that size"


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
def _six(found: Dataset) -> Said:
    rows = _nearest_by_reading(found, alone=False)
    *_, best = rows.values()
    return Said(
        ours="Legs fixed to the platform, at rest. " + ". ".join(_words(n.capitalize(), r) for n, r in rows.items()),
        verdict=size(*(row.deviation.values for row in rows.values())),
        reason=f"A hypothesis, not a fit: tips {text(float(best.off_axis), 'm', 2)} off are visibly bent, "
        f"and bending counts at first order. It has free parameters (roll, d, half-angles, height), the 6 % are met "
        f"elsewhere than y and z, legs bear {text(float(best.leg_force), 'N', 2)} and "
        f"{text(float(best.stress), 'Pa', 2)}, which a linear elastic steel does and no real one. {_trust(rows)}",
    )


@variant("What would give it: one joint", SAYS_MORE, "welded")
def _one(found: Dataset) -> Said:
    rows = _nearest_by_reading(found, alone=True)
    verdict = size(*(row.deviation.values for row in rows.values()))
    words = ". ".join(_words(name.removesuffix("-one").capitalize(), row) for name, row in rows.items())
    return Said(
        ours=f"Leg 1 alone fixed to the platform. {words}",
        verdict=verdict,
        reason="One leg that is held at the platform pushes it aside: y is larger than z but for large rolls and arms. "
        f"{_trust(rows)}",
    )
