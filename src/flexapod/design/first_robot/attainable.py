"""Bounds that a first robot misses, and the best that larger robots and cooler parts reach."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexapod import model
from flexapod.analysis import verdict
from flexapod.common.errors import FlexapodError
from flexapod.design.first_robot.design import robot_at_home
from flexapod.design.first_robot.sizing import Request

if TYPE_CHECKING:
    from xarray import Dataset

LARGER = tuple(1.33**k for k in range(7))  # home heights over the first
WARMTH = (1.0, 0.2, 0.04)  # parts above the reference temperature, over what is written: screws 5, 1, 0.2 K
HEATED = ("base", "platform", "piston", "cylinder", "screw")
OF_BOX = ("travel", "rotation")


@dataclass(frozen=True, kw_only=True)
class Attained:
    """The best that variants of a first robot reach of a bound that it misses.

    `name`, `unit`; `wanted`, `found` by the robot itself, `best` of the variants [unit]; `kept`: the best keeps the
    bound; `home` [m] of that variant; `warmth`: of its parts above the reference temperature, over what is written, and
    `warmest`: so much the warmest is [K].
    """

    name: str
    unit: str
    wanted: float
    found: float
    best: float
    kept: bool
    home: float
    warmth: float
    warmest: float


def attainable(request: Request, written: str) -> tuple[Dataset | None, tuple[Attained, ...]]:
    """Verdict on the robot of a text, and for each bound that it misses the best of its variants.

    Variants are robots for the same box, up to 5.5 times as high, with temperatures as written and with all parts at a
    fifth and a 25th of that above the reference; as soon as each bound is kept by one of them no more are looked at.

    Parameters
    ----------
    request : Request
    written : str
        The study file that `first_robot` made of it.

    Returns
    -------
    data : Dataset or None
        As of `flexapod.verdict`; None without bounds besides travel and rotation.
    best : tuple of Attained
    """
    study: model.Study = model.loads(written)  # type: ignore[assignment]
    if study.requirement is None or not set(study.requirement.names) - {*OF_BOX}:
        return None, ()
    data = verdict(study)
    home = study.robot.home_height
    best = {
        name: Attained(
            name=name, unit=str(row.unit.item()), wanted=row.wanted.item(), found=row.found.item(),
            best=row.found.item(), kept=False, home=home, warmth=1.0,
            warmest=_warmest(study),
        )
        for name in data.requirement.values.tolist()
        if name not in OF_BOX and not (row := data.sel(requirement=name)).kept and row.judged
    }  # fmt: skip
    margins = {name: data.margin.sel(requirement=name).item() for name in best}
    for larger, warmth, warmest, other in _variants(request, study) if best else ():
        for name in best:
            row = other.sel(requirement=name)
            if row.judged and row.margin.item() > margins[name]:
                margins[name] = row.margin.item()
                best[name] = replace(
                    best[name], best=row.found.item(), kept=row.kept.item(), home=larger, warmth=warmth, warmest=warmest
                )
        if all(one.kept for one in best.values()):
            break
    return data, tuple(best.values())


def _variants(request: Request, study: model.Study) -> Iterator[tuple[float, float, float, Dataset]]:
    """Home heights [m], warmth, the warmest part [K], verdicts; the robot itself is left out."""
    for factor in LARGER:
        home = float(f"{factor * study.robot.home_height:.4g}")
        written = robot_at_home(request, home)
        if written is None:
            continue
        one: model.Study = model.loads(written)  # type: ignore[assignment]
        for warmth in WARMTH if _warmest(one) > 0 else WARMTH[:1]:
            if factor == LARGER[0] and warmth == WARMTH[0]:
                continue
            cooler = one if warmth == WARMTH[0] else one.with_values(_temperatures(one, warmth))
            try:
                yield home, warmth, _warmest(cooler), verdict(cooler)
            except FlexapodError:
                continue


def _temperatures(study: model.Study, warmth: float) -> dict[str, float]:
    """Temperatures of parts by key, a share of what is written above the reference; all legs alike [degC]."""
    heat = study.robot.heat
    if heat is None:
        return {}
    given = {name: float(np.max(at)) for name in HEATED if (at := getattr(heat, name)) is not None}
    return {f"heat.{name}": heat.reference + warmth * (at - heat.reference) for name, at in given.items()}


def _warmest(study: model.Study) -> float:
    """Warmest part above the reference temperature [K]; 0 without temperatures."""
    at = _temperatures(study, 1.0).values()
    return max(at) - study.robot.heat.reference if at and study.robot.heat is not None else 0.0
