"""Lighter pistons in the paper's robot, hollow ones and thinner ones: what its payload and their tips vibrate by."""

from __future__ import annotations

import numpy as np
from xarray import Dataset

from flexapod import model
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.time_history import Share
from flexapod.analysis.simulation import simulate
from flexapod.analysis.static import modes
from flexapod.verification.paper.claim import after_motion, largest
from flexapod.verification.paper.readings import robot_preset, with_legs
from flexapod.verification.paper.trials import table

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
    """The same robot with round pistons of other diameters [m], of the same material and length."""
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
            *(after_motion(data, name) for name in ("com_deviation", "tip_deflection")),
            float(modes(changed).frequency[0]),
            largest(data),
        )
        rows.append(dict(zip(COLUMNS, values, strict=True)))
        report(len(rows) / len(PISTONS))
    found = table(rows, ("piston", [words(*pair) for pair in PISTONS], {}), COLUMNS, attributes(study))
    widths = zip(("outer", "inner"), np.transpose(PISTONS), strict=True)
    return found.assign_coords({name: ("piston", column) for name, column in widths})


def words(outer: float, inner: float) -> str:
    """A piston by its diameters [mm]."""
    return f"{outer:g} mm, {inner:g} mm hollow" if inner else f"{outer:g} mm"
