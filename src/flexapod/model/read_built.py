"""From the tables [geometry], [heat], [tolerances] of a study file to the model."""

from __future__ import annotations

from collections.abc import Mapping

from flexapod.errors import InputError
from flexapod.model.geometry import Geometry
from flexapod.model.heat import HEAT_PARTS, LEG_PARTS, Expansion, Gradient, Heat
from flexapod.model.tolerances import CLASSES, LengthSpread, RatioSpread, Tolerances
from flexapod.schema.section import Section

__all__ = ["read_built"]

_LENGTHS = ("length",) * 3
_RATIOS = ("lead", "EA", "EI", "density")


def read_built(top: Section, count: int) -> dict[str, object]:
    """What a study file says of a robot with `count` legs as it is built and warm; None where it says nothing."""
    geometry, heat, tolerances = (top.section(name) for name in ("geometry", "heat", "tolerances"))
    return {
        "geometry": geometry and geometry.read(Geometry, then=lambda s: _geometry(s, count)),
        "heat": heat and _heat(heat, count),
        "tolerances": tolerances and tolerances.read(Tolerances, then=_tolerances),
    }


def _geometry(section: Section, count: int) -> dict[str, object]:
    joints = {
        name: section.rows(name, *(_LENGTHS,) * count) if name in section else None
        for name in ("base_joints", "platform_joints")
    }
    numbers = {"leg_offset": "length", "lead": "number"}
    return joints | {name: _per_leg(section, name, dimension, count) for name, dimension in numbers.items()}


def _per_leg(section: Section, name: str, dimension: str, count: int) -> object:
    """A number, or one for each leg."""
    if not isinstance(section.data.get(name), list):
        return section.number(name, dimension)
    return section.vector(name, *(dimension,) * count)


def _heat(section: Section, count: int) -> Heat:
    def parts(section: Section) -> dict[str, object]:
        expansion, gradient = section.section("expansion"), section.section("gradient")
        return {
            **{name: _per_leg(section, name, "temperature", count) for name in LEG_PARTS},
            "expansion": expansion and expansion.read(Expansion),
            "gradient": gradient and gradient.read(Gradient, then=lambda s: _gradient(s, count)),
            **(_table(section, count) if "file" in section else {}),
        }

    return section.read(Heat, then=parts)


def _gradient(section: Section, count: int) -> dict[str, object]:
    return {"piston": _per_leg(section, "piston", "temperature difference", count)}


def _table(section: Section, count: int) -> dict[str, object]:
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


def _tolerances(section: Section) -> dict[str, object]:
    lengths = {
        name: _spread(section, name, LengthSpread, "length")
        for name in ("base_joints", "platform_joints", "leg_offset", "bow")
    }
    named = _class(section)
    ratios = {name: _spread(section, name, RatioSpread, "number") for name in _RATIOS if name not in named}
    return lengths | ratios | named


def _class(section: Section) -> dict[str, object]:
    """The lead by an accuracy class."""
    grade = section.data.get("lead")
    if not (isinstance(grade, str) and grade[:1].isalpha()):
        return {}
    return {"lead": RatioSpread(box=CLASSES[str(section.text("lead", tuple(CLASSES)))])}


def _spread(section: Section, name: str, model: type[LengthSpread] | type[RatioSpread], dimension: str) -> object:
    """A standard deviation, or a table with `sigma` or `box`."""
    if isinstance(section.data.get(name), Mapping):
        return section.child(section.data[name], name).read(model)
    number = section.number(name, dimension)
    try:
        return None if number is None else model(sigma=number)
    except InputError as error:
        raise section.error(error.what, name, allowed=error.allowed) from None
