"""The machine as it was built: joints out of place, legs too long, leads that are not what they are called."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import PlainSerializer, PlainValidator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import Joints, Quantity, one_or_each
from flexapod.common.tables.table import Table

#: A number for all legs, (1,), or one for each, (n,).
PerLeg = Annotated[Array, PlainValidator(one_or_each(None)), PlainSerializer(lambda array: array.tolist())]


class OfLegs(Table):
    """Base of tables with numbers for all legs or for each."""

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file: what is the same for all legs as one number."""
        si_values = super().si_values()
        return {key: x.item() if isinstance(x, np.ndarray) and x.shape == (1,) else x for key, x in si_values.items()}


class Geometry(OfLegs):
    """Differences from the drawing, the same at all times; what is left out is as drawn.

    `base_joints` (n, 3) [m] in world axes, `platform_joints` (n, 3) [m] in platform axes: real less drawn place of
    the joints, of a leg with a carriage of its rail or its shaft; `leg_offset` [m]: real less commanded length at
    home, of a leg without a stroke its length; `lead`: real over called travel, less 1, from home on, of a stroke or a
    slider. The last two for all legs or for each.
    """

    base_joints: Annotated[
        Joints | None,
        Quantity(
            "length",
            why="real less drawn place of the joints on the base, of a carriage of its rail or shaft, world "
            "axes, leg by leg",
            usual="as drawn",
        ),
    ] = None
    platform_joints: Annotated[
        Joints | None,
        Quantity(
            "length",
            why="real less drawn place of the joints on the platform, platform axes, leg by leg",
            usual="as drawn",
        ),
    ] = None
    leg_offset: Annotated[
        PerLeg | None,
        Quantity(
            "length",
            why="real less commanded length of a leg at home, of a strut its length; one number or one for each leg",
            usual="as drawn",
        ),
    ] = None
    lead: Annotated[
        PerLeg | None,
        Quantity(
            "number",
            why="real over called travel of a stroke or slider, less 1, from home on; one number or one for each leg",
            usual="as drawn",
        ),
    ] = None

    def check(self, count: int, normal: Array | None) -> None:
        """Refuse what does not fit a robot of `count` legs, and what leaves the plane of this normal."""
        for name in ("base_joints", "platform_joints"):
            joints = getattr(self, name)
            if joints is None:
                continue
            if len(joints) != count:
                raise InputError(
                    f"has {len(joints)} rows",
                    key=f"geometry.{name}",
                    allowed=f"{count} rows of three numbers, one for each leg",
                )
            if normal is not None and np.abs(joints @ normal).max() > 0:
                raise InputError(
                    "leaves the plane of the robot",
                    key=f"geometry.{name}",
                    value=joints.tolist(),
                    allowed="errors in the plane: what is across it nothing can follow",
                )
        for name in ("leg_offset", "lead"):
            check_legs(getattr(self, name), f"geometry.{name}", count)


def check_legs(values: Array | None, key: str, count: int) -> None:
    """Refuse a list that has not a number for each of `count` legs."""
    if values is not None and len(values) not in (1, count):
        raise InputError(
            f"has {len(values)} numbers",
            key=key,
            value=values.tolist(),
            allowed=f"one number, or one for each of {count} legs",
        )
