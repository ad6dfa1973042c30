"""A hydraulic cylinder whose valve is closed: two columns of oil that are springs, Eqs. (T23.1)-(T23.5)."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, PlainSerializer, PlainValidator, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.common.tables.base import Key, Quantity, one_or_each
from flexapod.common.tables.table import Table
from flexapod.model.leg.friction import Rubs


def _volumes(pair: Array) -> Array:
    if pair.min() < 0:
        raise InputError("is negative", key="dead_volume", value=pair.tolist(), allowed="one volume, or two; 0 or more")
    return pair


#: One volume for both sides, or two.
Pair = Annotated[
    Array, PlainValidator(one_or_each(2)), AfterValidator(_volumes), PlainSerializer(lambda pair: pair.tolist())
]


class HydraulicLimits(Table):
    """Limits of the supply: `pressure` [Pa] over that of the return, `flow` [m^3/s] into one cylinder."""

    pressure: Annotated[float | None, Quantity("stress", above=0, why="of the supply, over that of the return")] = None
    flow: Annotated[float | None, Quantity("flow", above=0, why="into one cylinder")] = None


class HydraulicDrive(Table):
    """A double-acting cylinder; the piston's inner end is its head, and the closed valve holds its place.

    `bore` of the cylinder and diameter of the `rod` [m]; `double_ended`: the rod leaves at both ends, and both areas
    are alike; `stroke` [m] of the head, from the cylinder's bottom at `bottom` [m] along the cylinder from the base
    joint (default: where the leg is as short as its `stroke` allows); `dead_volume` [m^3]: oil beyond the stroke on the
    side of the bottom and on that of the rod; `bulk_modulus` [Pa] of the oil with its air and hoses; `leakage`
    [m^3/(s Pa)] past the head. `friction` of its seals, along the stroke. `limits` are for the checks of a path alone.
    """

    holds: ClassVar[bool] = True
    pushes: ClassVar[bool] = False
    type: Annotated[Literal["hydraulic"], Key("kind of drive")] = "hydraulic"
    bore: Annotated[float, Quantity("length", above=0, why="of the hydraulic cylinder")]
    rod: Annotated[float, Quantity("length", above=0, why="diameter of its rod")]
    stroke: Annotated[float, Quantity("length", above=0, why="of its piston, from end to end")]
    bottom: Annotated[
        float | None,
        Quantity(
            "length",
            least=0,
            why="where it begins, along the cylinder from the base joint; default: with the leg at stroke.min",
        ),
    ] = None
    dead_volume: Annotated[
        Pair, Quantity("volume", why="oil beyond the stroke: one volume, or that at the bottom and that at the rod")
    ] = one_or_each(2)(0.0)
    bulk_modulus: Annotated[float, Quantity("stress", above=0, why="of the oil, with its air and hoses")]
    leakage: Annotated[float, Quantity("leakage", least=0, why="flow past the piston by pressure")] = 0.0
    double_ended: Annotated[bool, Key("whether the rod leaves at both ends")] = False
    friction: Rubs = None
    limits: Annotated[HydraulicLimits, Key("table: what the drive is made for")] = HydraulicLimits()

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
        """Areas on which oil pushes out and pulls in [m^2]."""
        ring = math.pi / 4 * (self.bore**2 - self.rod**2)
        return ring if self.double_ended else math.pi / 4 * self.bore**2, ring

    def volumes(self, out: Array) -> Array:
        """Oil on either side [m^3], shape (2, ...), of a head that is `out` [m] of its bottom, Eq. (T23.1)."""
        push, pull = self.areas
        return np.stack([self.dead_volume[0] + push * out, self.dead_volume[1] + pull * (self.stroke - out)])
