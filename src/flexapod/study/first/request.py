"""What a first robot is asked for: a few quantities with units, as typed on the command line."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from flexapod.errors import InputError, closest
from flexapod.model import AXES, MATERIALS
from flexapod.units import DIMENSIONS, number_and_unit, to_si

OPTION = "--from"
EXAMPLE = "home=300 mm, payload=20 kg, stroke=60 mm"
CHOICES = {"material": tuple(MATERIALS), "motion": AXES}
_BETWEEN = re.compile(r";|,(?!\d)|\s+(?=[A-Za-z]+\s*=)")  # not the comma of 27,5 mm
_NUMBERS = {  # key: dimension, least, most [SI]
    "home": ("length", 0.01, 100.0),
    "payload": ("mass", 1e-3, 1e6),
    "stroke": ("length", 1e-6, 100.0),
    "base": ("length", 1e-3, 100.0),
    "platform": ("length", 1e-3, 100.0),
    "diameter": ("length", 1e-4, 10.0),
    "duration": ("time", 0.01, 1e4),
}


@dataclass(frozen=True, kw_only=True)
class Request:
    """What is given, SI; None is computed.

    `home`: height of the platform's joints above the base's; `payload`: mass with the platform; `stroke`: of a leg,
    from its shortest to its longest; `base`, `platform`: radii of the joints' circles; `diameter`: of the pistons;
    `duration`: of the motion; `texts`: what was typed, by key.
    """

    home: float
    payload: float
    stroke: float | None = None
    base: float | None = None
    platform: float | None = None
    diameter: float | None = None
    duration: float | None = None
    material: str = "steel"
    motion: str = "heave"
    texts: dict[str, str] = field(default_factory=dict)


def parse_request(text: str) -> Request:
    """A request from ``"home=300 mm, payload=20 kg, stroke=60 mm"``.

    Raises
    ------
    InputError
        An unknown key, one that is given twice or missing, a value without a unit or out of range.
    """
    given: dict[str, str] = {}
    for part in filter(None, (" ".join(piece.split()) for piece in _BETWEEN.split(text))):
        key, equals, value = (piece.strip() for piece in part.partition("="))
        key = key.lower()
        if key not in (*_NUMBERS, *CHOICES):
            names = ", ".join((*_NUMBERS, *CHOICES))
            hint = closest(key, (*_NUMBERS, *CHOICES)) or f'For example {OPTION} "{EXAMPLE}"'
            raise InputError("unknown key", key=OPTION, value=key, allowed=names, next_step=hint)
        if not equals or not value or key in given:
            what = "is given twice" if key in given else "has no value"
            raise InputError(what, key=f"{OPTION} {key}", next_step=f'For example {OPTION} "{EXAMPLE}"')
        given[key] = value
    for key in ("home", "payload"):
        if key not in given:
            raise InputError("is missing", key=f"{OPTION} {key}", next_step=f'For example {OPTION} "{EXAMPLE}"')
    values = {key: _number(key, value) for key, value in given.items() if key in _NUMBERS}
    return Request(**values, **{key: _choice(key, given[key]) for key in CHOICES if key in given}, texts=given)  # type: ignore[arg-type]


def _number(key: str, value: str) -> float:
    dimension, least, most = _NUMBERS[key]
    if (read := number_and_unit(value)) is not None and not read[1]:
        words = f'a {dimension} with its unit, such as "{DIMENSIONS[dimension].example}"'
        raise InputError("has no unit", key=f"{OPTION} {key}", value=value, allowed=words)
    number = to_si(value, dimension, key=f"{OPTION} {key}")
    if not least <= number <= most:
        unit = {"length": "m", "mass": "kg", "time": "s"}[dimension]
        words = f"{least:g} to {most:g} {unit}"
        raise InputError("is out of range", key=f"{OPTION} {key}", value=value, allowed=words)
    return number


def _choice(key: str, value: str) -> str:
    if value not in CHOICES[key]:
        hint = closest(value, CHOICES[key])
        words = ", ".join(CHOICES[key])
        raise InputError("is not known", key=f"{OPTION} {key}", value=value, allowed=words, next_step=hint)
    return value
