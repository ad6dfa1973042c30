"""Poses, axes, fixed coordinates and vectors of `flexapod map`, `modes` and `export` as they are typed."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from flexapod.analysis.results.arguments import coordinate, pose_from_text
from flexapod.common.errors import InputError, check_known
from flexapod.common.units import number_and_unit, quantity
from flexapod.design.maps.grid import Range
from flexapod.model import AXES

_AXIS = re.compile(
    r"^\s*(?P<name>[^=\s]+)\s*(?:[=\s]\s*(?P<low>.+?)\s*\.\.\s*(?P<high>[^:]+?)\s*)?(?::\s*(?P<count>\S+))?\s*$"
)
_UNIT = re.compile(r"[a-zA-Z°µ\"'].*$")
FORM = '"surge=-100mm..100mm", "roll=-20..20deg:41", or "heave" for as far as the robot reaches'


def parse_axes(options: dict[str, str | None], count: int | None, usual: Sequence[str]) -> dict[str, Range]:
    """Axes by name from texts (``"surge=-100mm..100mm:41"``) by option (``"--x"``); the `usual` ones without any.

    `count`: points of each axis that names none. InputError: an unknown coordinate, one that is given twice, ends that
    are not lengths or angles or in the wrong order, no points.
    """
    axes: dict[str, Range] = {}
    for option, text in options.items():
        if text is None:
            continue
        name, found = _axis(option, text)
        if name in axes:
            raise InputError("is given twice", key=option, value=text, next_step="Give each coordinate one axis")
        axes[name] = Range(low=found.low, high=found.high, count=count if found.count is None else found.count)
    return axes or {name: Range(count=count) for name in usual}


def _axis(option: str, text: str) -> tuple[str, Range]:
    match = _AXIS.match(text)
    name = match["name"].split(":")[0] if match else text.split("=")[0].strip()
    _check_name(option, name)
    if match is None or name != match["name"]:
        match = _AXIS.match(text.replace(":", " :", 1)) if match else None
    if match is None:
        raise InputError("is not an axis", key=option, value=text, allowed=FORM)
    count = _count(option, match["count"])
    if match["low"] is None:
        if "=" in text:
            raise InputError("is not an axis", key=option, value=text, allowed=FORM)
        return name, Range(count=count)
    low, high = match["low"], match["high"]
    if (unit := _UNIT.search(high)) and _is_number(low):
        low += unit[0]
    ends = [coordinate(name, end, f"{option} {name}") for end in (low, high)]
    if ends[0] > ends[1] or (ends[0] == ends[1] and count != 1):
        raise InputError("begins where it should end", key=option, value=text, allowed="the lower end first")
    return name, Range(low=ends[0], high=ends[1], count=count)


def _count(option: str, text: str | None) -> int | None:
    if text is None:
        return None
    if not text.isdecimal() or int(text) < 1:
        raise InputError("is not a number of points", key=option, value=text, allowed="1 or more")
    return int(text)


def parse_at(text: str | None, axes: Collection[str] = ()) -> dict[str, float]:
    """Fixed coordinates from ``"roll=20deg,heave=10mm"``.

    InputError: unknown coordinates, one given twice or one of the `axes`, something that is not a length or angle.
    """
    fixed: dict[str, float] = {}
    for part in (text or "").split(","):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not part.strip():
            continue
        _check_name("--at", name)
        if not equals or name in fixed:
            what = "is given twice" if name in fixed else "has no value"
            raise InputError(what, key="--at", value=part.strip(), next_step='Write --at "roll=20deg,heave=10mm"')
        if name in axes:
            raise InputError("varies in this map: it cannot be fixed, too", key="--at", value=part.strip())
        fixed[name] = coordinate(name, value, f"--at {name}")
    return fixed


def parse_pose(text: str | None) -> dict[str, float] | None:
    """A pose as of `pose_from_text`; None: home."""
    return None if text is None else pose_from_text(text, "--pose")


def parse_direction(text: str) -> str | list[float]:
    """``x``, ``y``, ``z``, or three numbers: ``1,0,1``."""
    if text in ("x", "y", "z"):
        return text
    return _numbers("--direction", text, 'x, y, z, or three numbers such as "1,0,1"')


def parse_acceleration(text: str | None) -> list[float] | None:
    """Three accelerations [m/s^2]: ``"0,0,5"``, or with units ``"0, 0, 0.5 m/s^2"``."""
    if text is None:
        return None
    parts = text.split(",")
    unit = _UNIT.search(parts[-1].strip())
    whole = [part.strip() + (unit[0] if unit and _is_number(part) else "") for part in parts]
    if len(whole) != 3:
        raise InputError("is not a vector", key="--acceleration", value=text, allowed='three numbers such as "0,0,5"')
    return [quantity(part, "acceleration", key="--acceleration") for part in whole]


def _numbers(option: str, text: str, allowed: str) -> list[float]:
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) != 3:
        raise InputError("is not a direction", key=option, value=text, allowed=allowed)
    return found


def _check_name(option: str, name: str) -> None:
    check_known(name, AXES, option, "is not a coordinate")


def _is_number(text: str) -> bool:
    """Test whether a text is a number without a unit."""
    read = number_and_unit(text)
    return read is not None and not read[1]
