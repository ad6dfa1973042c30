"""A hydraulic cylinder whose valve is closed: two columns of oil that are springs, Eqs. (T23.1)-(T23.5)."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import PlainSerializer, PlainValidator, model_validator

from flexapod.errors import InputError
from flexapod.model.friction import StrokeFriction
from flexapod.schema.base import Frozen, Measure, NonNegative, Positive, array_of
from flexapod.typing import Array
from flexapod.words import text

__all__ = ["HydraulicDrive", "HydraulicLimits"]


def _pair(value: object) -> Array:
    """One volume for both sides, or two."""
    found = array_of((2,))([value, value] if isinstance(value, int | float) else value)
    if found.min() < 0:
        raise InputError(
            "is negative", key="dead_volume", value=found.tolist(), allowed="one volume, or two; 0 or more"
        )
    return found


Pair = Annotated[Array, PlainValidator(_pair), PlainSerializer(lambda pair: pair.tolist())]


class HydraulicLimits(Frozen):
    """What the supply gives: `pressure` [Pa] over that of the return, `flow` [m^3/s] into one cylinder."""

    pressure: Annotated[Positive, Measure("stress")] | None = None
    flow: Annotated[Positive, Measure("flow")] | None = None


class HydraulicDrive(Frozen):
    """A double-acting cylinder; the piston's inner end is its head, and the closed valve holds its place.

    `bore` of the cylinder and diameter of the `rod` [m]; `double_ended`: the rod leaves at both ends, and both areas
    are alike; `stroke` [m] of the head, from the cylinder's bottom at `bottom` [m] along the cylinder from the base
    joint (default: where the leg is as short as its `stroke` allows); `dead_volume` [m^3]: oil beyond the stroke on the
    side of the bottom and on that of the rod; `bulk_modulus` [Pa] of the oil with its air and hoses; `leakage`
    [m^3/(s Pa)] past the head. `friction` of its seals, along the stroke. `limits` are for the checks of a path alone.
    """

    holds: ClassVar[bool] = True
    pushes: ClassVar[bool] = False
    type: Literal["hydraulic"] = "hydraulic"
    bore: Annotated[Positive, Measure("length")]
    rod: Annotated[Positive, Measure("length")]
    stroke: Annotated[Positive, Measure("length")]
    bottom: Annotated[NonNegative, Measure("length")] | None = None
    dead_volume: Annotated[Pair, Measure("volume")] = array_of((2,))([0.0, 0.0])
    bulk_modulus: Annotated[Positive, Measure("stress")]
    leakage: Annotated[NonNegative, Measure("leakage")] = 0.0
    double_ended: bool = False
    friction: StrokeFriction | None = None
    limits: HydraulicLimits = HydraulicLimits()

    @model_validator(mode="after")
    def _rod_in_bore(self) -> HydraulicDrive:
        if self.rod >= self.bore:
            raise InputError(
                "does not fit into the bore",
                key="rod",
                value=self.rod,
                allowed=f"below bore = {text(self.bore, 'm')}",
            )
        return self

    @property
    def areas(self) -> tuple[float, float]:
        """On which oil pushes out and pulls in [m^2]."""
        ring = math.pi / 4 * (self.bore**2 - self.rod**2)
        return ring if self.double_ended else math.pi / 4 * self.bore**2, ring

    def volumes(self, out: Array) -> Array:
        """Oil on either side [m^3], shape (2, ...), of a head that is `out` [m] of its bottom, Eq. (T23.1)."""
        push, pull = self.areas
        return np.stack([self.dead_volume[0] + push * out, self.dead_volume[1] + pull * (self.stroke - out)])
