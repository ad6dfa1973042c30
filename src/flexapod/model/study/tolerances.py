"""Tolerances of parts about the drawing: standard deviations, boxes, accuracy classes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import BeforeValidator, model_validator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Quantity
from flexapod.common.tables.table import Table

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

#: Accuracy classes of screws: largest error of the travel over the travel. THK, Ball screw, point of selection:
#: 0.018, 0.05 and 0.21 mm in 300 mm.
CLASSES = {"C5": 0.018 / 300, "C7": 0.05 / 300, "C10": 0.21 / 300}
_RATIOS = ("lead", "EA", "EI", "density")


class LengthSpread(Table):
    """Spread of a length: its standard deviation `sigma` [m], or up to `box` [m] on either side of the drawing."""

    sigma: Annotated[float | None, Quantity("length", least=0, why="standard deviation", usual="given by box")] = None
    box: Annotated[
        float | None, Quantity("length", least=0, why="largest error on either side", usual="given by sigma")
    ] = None

    @model_validator(mode="after")
    def _either(self) -> LengthSpread:
        return _either(self)


class RatioSpread(Table):
    """A ratio: standard deviation `sigma`, or up to `box` on either side; of EA, EI and density relative to them."""

    sigma: Annotated[
        float | None, Quantity("number", least=0, most=1, why="standard deviation", usual="given by box")
    ] = None
    box: Annotated[
        float | None, Quantity("number", least=0, most=1, why="largest error on either side", usual="given by sigma")
    ] = None

    @model_validator(mode="after")
    def _either(self) -> RatioSpread:
        return _either(self)


Spread = LengthSpread | RatioSpread
S = TypeVar("S", LengthSpread, RatioSpread)


def _either(spread: S) -> S:
    if (spread.sigma is None) == (spread.box is None):
        raise InputError(
            "is missing" if spread.sigma is None else "is given together with box",
            key="sigma",
            allowed="a standard deviation, sigma, or { box = .. }",
        )
    return spread


def _spread(value: Any) -> Any:
    """A number is a standard deviation."""
    return {"sigma": value} if isinstance(value, int | float) and not isinstance(value, bool) else value


class Tolerances(Table):
    """Independent errors of single parts, those of joints along each axis; what is left out has none.

    `base_joints`, `platform_joints`, `leg_offset` and `lead` as of `Geometry`; `EA`, `EI` and `density` of pistons and
    struts, relative; `bow` of them, on either side of that which is given.
    """

    base_joints: Annotated[
        LengthSpread | None,
        BeforeValidator(_spread),
        Key("of the joints on the base, along each axis; a number, or a table with `sigma` or `box`", usual="exact"),
    ] = None
    platform_joints: Annotated[
        LengthSpread | None,
        BeforeValidator(_spread),
        Key("of the joints on the platform, along each axis; as base_joints", usual="exact"),
    ] = None
    leg_offset: Annotated[
        LengthSpread | None, BeforeValidator(_spread), Key("of the lengths of the legs; as base_joints", usual="exact")
    ] = None
    lead: Annotated[
        RatioSpread | None,
        BeforeValidator(_spread),
        Key("of the travels, as a ratio; as base_joints, or an accuracy class of screws: C5, C7, C10", usual="exact"),
    ] = None
    EA: Annotated[
        RatioSpread | None,
        BeforeValidator(_spread),
        Key("of the axial stiffness of pistons and struts, relative; as lead, without classes", usual="exact"),
    ] = None
    EI: Annotated[
        RatioSpread | None,
        BeforeValidator(_spread),
        Key("of their bending stiffness, relative: counts for legs that are not straight; as EA", usual="exact"),
    ] = None
    density: Annotated[
        RatioSpread | None,
        BeforeValidator(_spread),
        Key("of their density, relative: their weight; as EA", usual="exact"),
    ] = None
    bow: Annotated[
        LengthSpread | None,
        BeforeValidator(_spread),
        Key("of their bow, on either side of `piston.bow`; as base_joints", usual="exact"),
    ] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Spreads by a number or a table, the lead by its class as well."""
        lengths = {
            name: _read_spread(section, name, LengthSpread, "length")
            for name in ("base_joints", "platform_joints", "leg_offset", "bow")
        }
        named = _class(section)
        ratios = {name: _read_spread(section, name, RatioSpread, "number") for name in _RATIOS if name not in named}
        return lengths | ratios | named


def _class(section: Section) -> dict[str, object]:
    """The lead by an accuracy class."""
    grade = section.data.get("lead")
    if not (isinstance(grade, str) and grade[:1].isalpha()):
        return {}
    return {"lead": RatioSpread(box=CLASSES[str(section.text("lead", tuple(CLASSES)))])}


def _read_spread(section: Section, name: str, model: type[LengthSpread] | type[RatioSpread], dimension: str) -> object:
    """A standard deviation, or a table with `sigma` or `box`."""
    if isinstance(section.data.get(name), Mapping):
        return section.child(section.data[name], name).read(model)
    number = section.number(name, dimension)
    try:
        return None if number is None else model(sigma=number)
    except InputError as error:
        raise section.error(error.what, name, allowed=error.allowed) from None
