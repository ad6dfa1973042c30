"""Forces and positions of the drives of a result; colours of legs, axes, energies and errors.

Drives push pistons, move carriages or turn cranks. Colours are the same in figures, on the page and in reports,
and load without matplotlib.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod.analysis.results.attributes import robot_of
from flexapod.common.errors import InputError

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

_OF_STROKES = ("actuator_force_rigid", "actuator_force", "leg_length_command", "leg_length")
_OF_ALL = ("drive_force_rigid", "drive_force", "drive_command", "drive_position")


@dataclass(frozen=True, kw_only=True)
class Drives:
    """Forces and places of the drives, (time, leg) of the legs that have one.

    `rigid`, `force`: of the rigid and the flexible robot; `word`, `unit` of these: "force" in N or "torque" in N m;
    `command`, `position`: where the drives stand on the rigid path and where they are, of strokes the length of the
    flexible leg; `place` of it in words, `place_unit` m or rad; `plain`: all legs are of the kind UPS.
    """

    rigid: DataArray
    force: DataArray
    command: DataArray
    position: DataArray
    word: str
    unit: str
    place: str
    place_unit: str
    plain: bool


def drives(data: Dataset) -> Drives:
    """The drives of a robot's result; InputError where the result has none."""
    legs = robot_of(data).legs if "leg" in data.coords else ()
    carried = any(leg.driven == "carriage" for leg in legs)
    names = _OF_ALL if carried else _OF_STROKES
    missing = [name for name in names if name not in data]
    if missing:
        allowed = f"a result with {', '.join(names)}"
        raise InputError(f"cannot be drawn: the result has no {missing[0]!r}", key="data", allowed=allowed)
    driven = np.array([bool(leg.driven) for leg in legs])
    rigid, force, command, position = (data[name].isel(leg=driven) for name in names)
    turns = force.attrs.get("units") == "N m"
    return Drives(
        rigid=rigid,
        force=force,
        command=command,
        position=position,
        word="torque" if turns else "force",
        unit="N m" if turns else "N",
        place="angle of the cranks" if turns else "place of the carriages" if carried else "length",
        place_unit="rad" if turns else "m",
        plain=all(leg.chain == "UPS" for leg in legs),
    )


#: Okabe & Ito's palette, in an order whose neighbours also differ in lightness.
LEG_COLORS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#A23B72")
RIGID = "#B8B8B8"
FLEXIBLE = "#0B3C5D"
AXIS_COLORS = {"x": "#7A5195", "y": "#0072B2", "z": "#D55E00"}
#: Words and colour of each energy and work by its variable.
ENERGIES = {
    "energy_kinetic": ("kinetic", "#0072B2"),
    "energy_potential": ("gravity", "#E69F00"),
    "energy_strain": ("strain and springs", "#009E73"),
    "energy_dissipated": ("lost in damping and friction", "#D55E00"),
    "work_drive": ("work of the drives", "#56B4E9"),
    "work_base": ("work on the base", "#8C6D31"),
    "work_control": ("work of the controller", "#1A1A1A"),
    "work_external": ("work of the load", "#A23B72"),
}
#: Words and colour of the kinds of errors in a budget, of systematic ones by what can be done about them.
ERRORS = {
    "calibratable": ("systematic: calibration takes it out", "#56B4E9"),
    "repeatable": ("systematic: by load, repeatable", "#0072B2"),
    "drifting": ("systematic: drifts with heat", "#D55E00"),
    "hysteretic": ("play and friction (bound)", "#CC79A7"),
    "random": ("random: tolerances, noise (3 sigma)", "#8C8C8C"),
    "dynamic": ("dynamic (peak)", "#009E73"),
}


def colors_of_legs(count: int) -> tuple[str, ...]:
    """A colour for each leg: those of `LEG_COLORS`, from the seventh leg on darker, from the thirteenth on paler."""
    parts = [tuple(int(color[i : i + 2], 16) for i in (1, 3, 5)) for color in LEG_COLORS]
    shades = ((1.0, 0.0), (0.55, 0.0), (0.5, 127.0))
    return tuple(
        "#" + "".join(f"{round(scale * part + white):02X}" for part in parts[i % len(parts)])
        for i in range(count)
        for scale, white in [shades[i // len(parts) % len(shades)]]
    )
