"""Values at key paths of a study file, read and put there; short forms are spelled out on the way."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from flexapod.common.errors import InputError
from flexapod.common.tables.key_paths import Step, copy_data, key_text, similar_key
from flexapod.common.units import to_si
from flexapod.model.leg.circle import Circle
from flexapod.model.leg.material import MATERIALS

_SHORT = [
    {"joints", "radius"},
    {"joints", "half_angle"},
    {"joints", "angles"},
    {"material", "E"},
    {"material", "density"},
]
_ENDS = ("base", "platform")


def overlap(one: tuple[Step, ...], other: tuple[Step, ...]) -> bool:
    """Tell whether one key holds or replaces the other: joints replace their circle, E and density the material."""
    for a, b in zip(_of_leg(one), _of_leg(other), strict=False):
        if {a, b} in _SHORT:
            return True
        if a != b and 0 not in (a, b):
            return False
    return True


def _of_leg(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    """The key with number 0 for all legs, where it gives none."""
    every = steps[0] == "leg" and len(steps) > 1 and isinstance(steps[1], str)
    return ("leg", 0, *steps[1:]) if every else steps


def put(data: dict[str, Any], steps: tuple[Step, ...], value: object) -> None:
    """Set a value in the tables of a study file; a key without the number of a leg means all legs.

    What the file gives in short is spelled out where the path needs it: one [leg] becomes one for each leg, circles
    become joints, a material becomes E and density, a damping ratio the table that holds it.

    Raises
    ------
    InputError
        The path leads through something that has no such key or item.
    """
    _put(data, steps, 0, value)


def _put(holder: Any, steps: tuple[Step, ...], at: int, value: object) -> None:
    step, last = steps[at], at == len(steps) - 1
    if isinstance(step, int):
        if not isinstance(holder, list) or not 1 <= step <= len(holder):
            raise _no_item(steps, at, holder)
        if last:
            holder[step - 1] = copy_data(value)
        else:
            _put(holder[step - 1], steps, at + 1, value)
        return
    if isinstance(holder, list) and at == 1 and steps[0] == "leg":
        for leg in holder:
            _put(leg, steps, at, value)
        return
    if not isinstance(holder, dict):
        raise InputError("is not a table", key=key_text(steps[:at]), value=holder)
    _spell_out(holder, steps, at)
    if last:
        holder[step] = copy_data(value)
    else:
        _put(holder.setdefault(step, {}), steps, at + 1, value)


def _no_item(steps: tuple[Step, ...], at: int, holder: object) -> InputError:
    allowed = f"1 to {len(holder)}" if isinstance(holder, list) else "a list, whose items are counted from 1"
    return InputError("has no such item", key=key_text(steps[: at + 1]), allowed=allowed)


def _spell_out(table: dict[str, Any], steps: tuple[Step, ...], at: int) -> None:
    """Replace a short form in `table` by the long one that the path goes into."""
    step, before = steps[at], steps[at - 1] if at else ""
    if at == 0 and numbers_a_leg(steps):
        if (legs := each_leg(table)) is not table.get("leg"):
            table["leg"] = legs
    elif before == "robot" and step in _ENDS and steps[at + 1 : at + 2] == ("joints",):
        _place(table.get(str(step)), str(step), table.get("plane"))
    elif step == "damping" and len(steps) == at + 2 and (at == 1 or isinstance(before, int)):
        if not isinstance(table.get("damping", {}), dict):
            table["damping"] = {"ratio": table["damping"]}
    elif step in ("E", "density") and table.get("material") in MATERIALS:
        material = MATERIALS[table.pop("material")]
        table.update({"E": material.E, "density": material.density})
        others = {name: getattr(material, name) for name in ("yield_stress", "poisson", "expansion")}
        for name, value in others.items():
            if value is not None:
                table.setdefault(name, value)


def _place(circle: Any, end: str, plane: str | None) -> None:
    """Replace a circle by its joints."""
    if not isinstance(circle, dict) or "radius" not in circle or not {"half_angle", "angles"} & circle.keys():
        return
    given: dict[str, Any] = {"radius": to_si(circle.pop("radius"), "length", key=f"robot.{end}.radius")}
    if "half_angle" in circle:
        given["half_angle"] = to_si(circle.pop("half_angle"), "angle", key=f"robot.{end}.half_angle")
    else:
        angles = enumerate(circle.pop("angles"), start=1)
        given["angles"] = [to_si(angle, "angle", key=f"robot.{end}.angles[{i}]") for i, angle in angles]
    circle["joints"] = Circle(**given).joints(end, plane).tolist()


def numbers_a_leg(steps: tuple[Step, ...]) -> bool:
    """Tell whether a key is one of a single leg, by its number."""
    return steps[0] == "leg" and len(steps) > 1 and isinstance(steps[1], int)


def leg_count(data: Mapping[str, Any]) -> int:
    """Number of legs that the tables of a study file name: "6-UPS" six, "3-UPS+UP" four."""
    groups = re.findall(r"(?:^|\+)\s*(\d*)", str(data.get("robot", {}).get("type", "6-UPS")))
    return sum(int(number or 1) for number in groups)


def each_leg(data: Mapping[str, Any]) -> Any:
    """The table of every leg by itself; what is none as it is."""
    legs = data.get("leg")
    if isinstance(legs, dict):
        legs = [{**legs, "count": leg_count(data)}]
    if not isinstance(legs, list):
        return legs
    counts = [leg.get("count") if isinstance(leg, dict) else None for leg in legs]
    if not any(isinstance(count, int) for count in counts):
        return legs
    found = []
    for leg, count in zip(legs, counts, strict=True):
        plain = {name: value for name, value in leg.items() if name != "count"} if isinstance(leg, dict) else leg
        found += [copy_data(plain) for _ in range(count if isinstance(count, int) else 1)]
    return found


def value_at(data: dict[str, Any], steps: tuple[Step, ...]) -> object:
    """Value at a path, short forms spelled out in `data`.

    Raises
    ------
    InputError
        Nothing stands there.
    """
    found: Any = data
    for at, step in enumerate(steps):
        if isinstance(found, dict) and isinstance(step, str):
            _spell_out(found, steps, at)
            if step in found:
                found = found[step]
                continue
        if isinstance(found, list) and isinstance(step, int) and 1 <= step <= len(found):
            found = found[step - 1]
            continue
        similar = similar_key(data, steps)
        raise InputError(
            "has no value in the study file that could vary about it",
            key=key_text(steps),
            next_step=f"{similar} Otherwise add it to the study file" if similar else "Add it to the study file",
        )
    return found
