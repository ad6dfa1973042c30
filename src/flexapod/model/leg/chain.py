"""Letters of a leg and of a robot: "UPS" is a chain of joints, "3-UPS+UP" a robot of four legs."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from typing import Literal

from flexapod.common.errors import InputError, check_kind

MOST_LEGS = 16
_CHAIN = re.compile(r"(?P<carriage>[PR]?)(?P<base>[RUSF])(?P<stroke>[PC]?)(?P<platform>[RUSF]?)")
_GROUP = re.compile(r"(?:([0-9]{1,3})-)?([A-Za-z]+)")
_KINDS: dict[str, Literal["", "slider", "crank"]] = {"": "", "P": "slider", "R": "crank"}
_LETTERS = (
    "from base to platform: P or R for a carriage, if there is one; R, U, S or F for the joint at the base; P or C for "
    "the stroke (none: a strut); R, U, S or F for the joint at the platform (none after a stroke: fixed to it). "
    "Examples: UPS, RPS, UCU, FPF, UP; with a carriage PUS, PRS, RUS, PUU, PRR"
)
_TYPES = '"COUNT-CHAIN", several joined by +: "6-UPS", "3-RPS", "3-UPS+UP", "6-PUS"'


@dataclass(frozen=True)
class Chain:
    """Meaning of the letters of a leg, from base to platform.

    `carriage`: what moves its foot, "" if that is fixed; `base`, `platform`: letters of its joints, R revolute,
    U universal, S spherical, F fixed or flexure, `platform` "" where the piston is part of the platform; `stroke`: P, C
    (the piston also turns about the axis), "" for a strut of fixed length.
    """

    carriage: Literal["", "slider", "crank"]
    base: str
    stroke: str
    platform: str

    @property
    def driven(self) -> Literal["", "stroke", "carriage"]:
        """Part that a drive moves: of the letters the first P or C, else the first R before the base joint."""
        if self.stroke and self.carriage != "slider":
            return "stroke"
        return "carriage" if self.carriage else ""

    @property
    def turning(self) -> bool:
        """Tell whether the drive turns something: angles and torques in place of lengths and forces."""
        return self.driven == "carriage" and self.carriage == "crank"


def chain_of(letters: str) -> Chain:
    """The chain of a leg's letters.

    Raises
    ------
    InputError
        They make no leg; without a key.
    """
    check_kind(letters, str, "letters", _LETTERS)
    return _chain(letters)


@cache
def _chain(letters: str) -> Chain:
    match = _CHAIN.fullmatch(letters)
    if match is None or not (match["stroke"] or match["platform"]):
        match = re.fullmatch(r"(?P<carriage>)(?P<base>R)(?P<stroke>)(?P<platform>[RUSF])", letters)
    if match is None:
        raise InputError("letters that make no leg", value=letters, allowed=_LETTERS)
    if match["carriage"] == "R" and match["stroke"]:
        raise InputError(
            "has a crank and a stroke",
            value=letters,
            allowed="one of the two",
            next_step=f"Write {letters[1:]} for the stroke, {letters.replace(match['stroke'], '')} for the crank",
        )
    return Chain(_KINDS[match["carriage"]], match["base"], match["stroke"], match["platform"])


def chains_of(kind: str) -> tuple[str, ...]:
    """Letters of every leg of a robot, ``("UPS", "UPS", "UPS", "UP")`` of "3-UPS+UP".

    Raises
    ------
    InputError
        The text is not of this form, the letters make no leg, or there are too many; without a key.
    """
    check_kind(kind, str, "kind", _TYPES)
    return _chains(kind)


@cache
def _chains(kind: str) -> tuple[str, ...]:
    found: list[str] = []
    for group in kind.split("+"):
        match = _GROUP.fullmatch(group.strip())
        if match is None:
            raise InputError("is not a type of robot", value=kind, allowed=_TYPES)
        letters, number = match[2], int(match[1] or 1)
        if letters != letters.upper():
            raise InputError("has small letters", value=kind, allowed=_TYPES, next_step=f"Write {kind.upper()!r}")
        try:
            chain_of(letters)
        except InputError as error:
            error.what = f"{letters}: {error.what}"
            raise InputError(error.what, value=kind, allowed=error.allowed, next_step=error.next_step) from None
        found += [letters] * number
    if not 1 <= len(found) <= MOST_LEGS:
        raise InputError(f"has {len(found)} legs", value=kind, allowed=f"1 to {MOST_LEGS}")
    return tuple(found)
