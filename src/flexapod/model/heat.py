"""Temperatures of the parts of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import PlainSerializer, PlainValidator, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import FileKey, Key, Quantity, Series, array_of
from flexapod.common.tables.named_files import Content, columns_of_table
from flexapod.common.tables.table import Place, Table
from flexapod.model.leg.geometry import OfLegs, PerLeg, check_legs
from flexapod.model.motion import check_times

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

LEG_PARTS = ("piston", "cylinder", "screw")
HEAT_PARTS = ("base", "platform", *LEG_PARTS)
COLDEST = -273.15

_Rows = Annotated[Array, PlainValidator(array_of((None, None))), PlainSerializer(lambda rows: rows.tolist())]


class Expansion(Table):
    """Thermal expansion of parts [1/K] in place of that of their material, or of steel where none is known."""

    base: Annotated[float | None, Quantity("expansion", why="of the base", usual="11.8e-06")] = None
    platform: Annotated[float | None, Quantity("expansion", why="of the platform", usual="11.8e-06")] = None
    piston: Annotated[float | None, Quantity("expansion", why="of pistons and struts", usual="of leg.piston")] = None
    cylinder: Annotated[float | None, Quantity("expansion", why="of cylinders", usual="11.8e-06")] = None
    screw: Annotated[float | None, Quantity("expansion", why="of screws", usual="of leg.drive")] = None


class Gradient(OfLegs):
    """Temperature differences across parts [K]: of `piston` (or strut), for all legs or for each."""

    piston: Annotated[
        PerLeg | None,
        Quantity(
            "temperature difference",
            why="across pistons and struts; one number or one for each leg: for `flexapod.accuracy`",
            usual="none",
        ),
    ] = None


class Heat(OfLegs):
    """Temperatures [degC]: those at which lengths are as drawn, `reference`, and of parts, where they differ.

    `base`, `platform`: the plates between the joints; `piston` (or strut), `cylinder`, `screw`: for all legs or for
    each; `gradient`: across them. `time` [s] and `table` (T, columns) [degC]: temperatures over time from `file`,
    `columns` their names, a part or ``part leg``; they stand in place of the others.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "columns", "table")

    reference: Annotated[
        float, Quantity("temperature", least=COLDEST, why="temperature at which lengths are as drawn")
    ] = 20.0
    base: Annotated[
        float | None,
        Quantity(
            "temperature",
            least=COLDEST,
            why="temperature of the plate between the joints of the base",
            usual="reference",
        ),
    ] = None
    platform: Annotated[
        float | None,
        Quantity(
            "temperature",
            least=COLDEST,
            why="temperature of the plate between the joints of the platform",
            usual="reference",
        ),
    ] = None
    piston: Annotated[
        PerLeg | None,
        Quantity(
            "temperature", why="temperature of pistons and struts; one number or one for each leg", usual="reference"
        ),
    ] = None
    cylinder: Annotated[
        PerLeg | None,
        Quantity("temperature", why="temperature of cylinders; one number or one for each leg", usual="reference"),
    ] = None
    screw: Annotated[
        PerLeg | None,
        Quantity(
            "temperature", why="temperature of the screws of drives; one number or one for each leg", usual="reference"
        ),
    ] = None
    expansion: Annotated[Expansion | None, Key("table: thermal expansion of parts", usual="those of materials")] = None
    gradient: Annotated[Gradient | None, Key("table: temperature differences across parts", usual="none")] = None
    file: Annotated[str | None, FileKey("CSV with temperatures over time", usual="constant")] = None
    time: Annotated[Series | None, Quantity("time")] = None
    columns: tuple[str, ...] = ()
    table: Annotated[_Rows | None, Quantity("temperature")] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Tables in it, and the table over time."""
        expansion, gradient = section.section("expansion"), section.section("gradient")
        tables = {
            "expansion": expansion and expansion.read(Expansion),
            "gradient": gradient and gradient.read(Gradient),
        }
        return tables | (_over_time(section, section.leg[1]) if "file" in section else {})

    def file_content(self, place: Place) -> Content:
        """Temperatures over time."""
        if self.table is None:
            return {}
        return columns_of_table(dict.fromkeys(self.columns, "temperature"), self.time, self.table)

    @model_validator(mode="after")
    def _sensible(self) -> Heat:
        for name in (*LEG_PARTS, "table"):
            values = getattr(self, name)
            if values is not None and values.min(initial=0.0) < COLDEST:
                raise InputError(
                    "is below absolute zero", key=name, value=float(values.min()), allowed=f"at least {COLDEST:g} degC"
                )
        if self.time is not None:
            check_times(self.time, 0 if self.table is None else len(self.table))
        return self

    def check(self, count: int) -> None:
        """Refuse lists that do not fit a robot of `count` legs."""
        for name in LEG_PARTS:
            check_legs(getattr(self, name), f"heat.{name}", count)
        if self.gradient is not None:
            check_legs(self.gradient.piston, "heat.gradient.piston", count)

    def warms(self, part: str) -> bool:
        """Tell whether a part has a temperature of its own."""
        return getattr(self, part) is not None or any(name.partition(" ")[0] == part for name in self.columns)

    def temperatures(self, part: str, count: int) -> Array:
        """Temperatures of a part of `count` legs, at each instant of the table or at the only one, (T or 1, count)."""
        given = getattr(self, part)
        constant = np.broadcast_to(self.reference if given is None else given, count)
        if self.table is None:
            return constant[None].astype(float)
        found = np.tile(constant, (len(self.table), 1)).astype(float)
        for name, values in zip(self.columns, self.table.T, strict=True):
            what, _, leg = name.partition(" ")
            if what == part:
                found[:, slice(None) if not leg else int(leg) - 1] = values[:, None] if not leg else values
        return found


def _over_time(section: Section, count: int) -> dict[str, object]:
    names = [*HEAT_PARTS, *(f"{part} {leg}" for part in LEG_PARTS for leg in range(1, count + 1))]
    found = section.table(dict.fromkeys(names, "temperature"))
    time = found.pop("time")
    for name in found:
        part, _, leg = name.partition(" ")
        if leg and part in found:
            raise InputError(
                f"has the columns {part!r} and {name!r}",
                file=section.file,
                key=section.key("file"),
                value=section.data["file"],
                allowed="a part for all legs, or a column for each of its legs",
            )
        if part in section:
            raise section.error("is given together with its column in heat.file", part, allowed="one of the two")
    return {"time": time, "columns": tuple(found), "table": [list(row) for row in zip(*found.values(), strict=True)]}
