"""What drives do in a result, leg by leg: they push pistons, move carriages or turn cranks."""

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
