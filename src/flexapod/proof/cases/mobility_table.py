"""Mobility of mechanisms that people build."""

from __future__ import annotations

from functools import partial

from flexapod.proof.case import Case, Check, checks
from flexapod.proof.parallel_robots import LOWER, eight_legs, hexapod, planar, sliders, tricept, tripod
from flexapod.study.mobility import mobility

COUNTS = ("freedoms", "gruebler", "mobility", "redundant", "locked", "self_stress")
TABLE = {  # the counts above
    "6-UPS": (hexapod, (36, 6, 6, 0, 0, 0)),
    "6-UPS on similar hexagons": (partial(hexapod, lower=LOWER, upper=LOWER), (36, 6, 6, 0, 3, 3)),
    "6-SPS": (partial(hexapod, "SPS"), (42, 12, 12, 0, 6, 0)),
    "6-UCU": (partial(hexapod, "UCU"), (36, 6, 6, 0, 0, 0)),
    "6-PUS": (sliders, (36, 6, 6, 0, 0, 0)),
    "8-UPS": (eight_legs, (48, 6, 6, 0, 0, 2)),
    "3-RPS": (tripod, (15, 3, 3, 0, 0, 0)),
    "3-PRS": (partial(sliders, "PRS", 0.5), (15, 3, 3, 0, 0, 0)),
    "3-UPU, axes along the circle": (partial(tripod, "UPU"), (15, 3, 3, 0, 0, 0)),
    "3-PUU": (partial(sliders, "PUU", 0.4), (15, 3, 3, 0, 0, 0)),
    "3-UPS+UP": (tricept, (21, 3, 3, 0, 0, 0)),
    "3-PRR in a plane": (planar, (18, 3, 3, 0, 0, 0)),
}


def _compute() -> list[Check]:
    found: list[Check] = []
    for name, (make, counts) in TABLE.items():
        ours = mobility(make())
        values = [float(ours[key]) for key in COUNTS]
        found += checks([f"{name}, {key}" for key in COUNTS], counts, values, 0.5, absolute=True)
    return found


MOBILITY_TABLE = Case(
    name="mobility-table",
    statement="Joint freedoms, Gruebler's number, motions, redundant conditions, motions with locked drives and "
    "self-stress of twelve mechanisms",
    source="textbooks (Merlet 2006, Tsai 1999); singular on similar hexagons: Merlet; six idle turns of legs between "
    "balls",
    argument="whole numbers",
    compute=_compute,
)
