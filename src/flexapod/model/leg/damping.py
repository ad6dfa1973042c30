"""Damping of a piston or beam: a ratio for all modes, a part in proportion to stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field, PlainSerializer, PlainValidator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import Quantity
from flexapod.common.tables.table import Table

Ratio = Annotated[float, Field(strict=True, ge=0, lt=1)]


class Damping(Table):
    """Damping of a piston or beam, Eqs. (T5.1)-(T5.6).

    `ratio` of every mode of the bare body; `stiffness` [s]: the damping matrix has this time times the stiffness matrix
    added, so that a mode of angular frequency omega has the ratio ``ratio + stiffness * omega / 2``.
    """

    ratio: Ratio = 0.0
    stiffness: Annotated[float, Quantity("time", least=0, why="time by which its stiffness is multiplied")] = 0.0

    def __bool__(self) -> bool:
        """Tell whether anything is damped, as of a plain number."""
        return bool(self.ratio or self.stiffness)


def damping_parts(damping: float | Damping) -> tuple[float, float]:
    """Damping ratio, and time of the part in proportion to stiffness [s]; a plain number is the ratio."""
    return (damping.ratio, damping.stiffness) if isinstance(damping, Damping) else (damping, 0.0)


def _checked(value: object) -> float | Damping:
    if isinstance(value, Damping):
        return value
    if isinstance(value, Mapping):
        try:
            return Damping(**value)
        except InputError as error:
            raise error.with_location(prefix="damping") from None
    try:
        return Damping(ratio=value).ratio  # type: ignore[arg-type]
    except InputError as error:
        raise InputError(error.what, key="damping", value=error.value, allowed=error.allowed) from None


def _plain(value: float | Damping) -> object:
    return {"ratio": value.ratio, "stiffness": value.stiffness} if isinstance(value, Damping) else value


BodyDamping = Annotated[Ratio | Damping, PlainValidator(_checked), PlainSerializer(_plain)]
