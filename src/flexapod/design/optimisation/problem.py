"""A design file: what may change, what is to be least, and what must be kept; checked before anything is computed."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from flexapod.analysis.scalar_outputs import OUTPUTS
from flexapod.common.arguments import integer
from flexapod.common.errors import InputError, check_kind, check_known
from flexapod.common.files import path_of
from flexapod.common.units import to_si
from flexapod.design.first_robot.catalogue import SCREWS, Screw
from flexapod.design.sensitivity import check_outputs
from flexapod.design.variants import Variants
from flexapod.model import ScrewDrive

DIMENSIONS = {
    "Hz": "frequency", "N m-1": "stiffness", "m": "length", "kg": "mass", "rad": "angle", "N": "force", "Pa": "stress",
}  # fmt: skip
TABLES = ("variables", "objective", "constraints", "front")
MOST_ROWS = 200  # of all lists together


class Limit(NamedTuple):
    """A constraint: an output, the value that it has to keep [SI], and its sense: 1 at least, -1 at most."""

    output: str
    value: float
    sense: int

    def margin(self, found: float) -> float:
        """Rest of the limit over its size; below 0 where it is not kept."""
        return self.sense * (found - self.value) / (abs(self.value) or 1.0)


@dataclass(frozen=True, kw_only=True)
class DesignVariable:
    """A number that changes between bounds [SI]; what is tied to it changes in proportion."""

    key: str
    low: float
    high: float
    start: float
    ties: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Choice:
    """Rows of which one is taken: its name, and its values by key."""

    name: str
    rows: tuple[tuple[str, dict[str, object]], ...]


@dataclass(frozen=True, kw_only=True)
class Front:
    """Targets of a second output, from the least that can be had to what the best objective has."""

    output: str
    count: int


@dataclass(frozen=True, kw_only=True)
class DesignProblem:
    """Problem of an optimisation; `sense` is 1 for the least of the objective and -1 for the most."""

    variables: tuple[DesignVariable, ...]
    choices: tuple[Choice, ...]
    objective: str
    sense: int
    limits: tuple[Limit, ...]
    front: Front | None

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all outputs that are asked for, each once."""
        second = [self.front.output] if self.front else []
        return tuple(dict.fromkeys([self.objective, *(limit.output for limit in self.limits), *second]))


def read_problem(design: Mapping[str, Any] | str | Path, variants: Variants) -> DesignProblem:
    """Read a design from its file or as tables.

    Raises
    ------
    InputError
        A key, a name, a unit or bounds that are none; bounds without the start; nothing to change.
    """
    if isinstance(design, str | Path):
        try:
            data: Mapping[str, Any] = tomllib.loads(path_of(design, "design").read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise InputError(f"cannot be read: {error}", file=design) from None
    else:
        check_kind(design, Mapping, "design", "a design file, or its tables")
        data = design
    for name in data:
        check_known(name, TABLES, "design")
    entries = data.get("variables")
    if not isinstance(entries, list) or not entries:
        raise InputError("has nothing that may change", key="variables", next_step="Write [[variables]]")
    variables, choices = [], []
    for k, entry in enumerate(entries, start=1):
        place = f"variables[{k}]"
        check_kind(entry, Mapping, place, "a table")
        if "catalogue" in entry or "values" in entry:
            choices.append(_choice(entry, place, variants))
        else:
            variables.append(_variable(entry, place, variants))
    count = 1
    for choice in choices:
        count *= len(choice.rows)
    if count > MOST_ROWS:
        raise InputError(
            "are too many lists together", key="variables", value=count, allowed=f"{MOST_ROWS} combinations"
        )
    objective, sense = _objective(data.get("objective"))
    return DesignProblem(
        variables=tuple(variables), choices=tuple(choices), objective=objective, sense=sense,
        limits=tuple(_limits(data.get("constraints", {}))), front=_front(data.get("front")),
    )  # fmt: skip


def _known(entry: Mapping[str, Any], names: tuple[str, ...], place: str) -> None:
    for name in entry:
        check_known(name, names, place)


def _variable(entry: Mapping[str, Any], place: str, variants: Variants) -> DesignVariable:
    _known(entry, ("key", "low", "high", "ties"), place)
    for name in ("key", "low", "high"):
        if name not in entry:
            raise InputError(
                "is missing", key=f"{place}.{name}", allowed="key, low and high; or values, or a catalogue"
            )
    key = str(entry["key"])
    start, dimension = _number(key, variants)
    ties = tuple(map(str, entry.get("ties", ())))
    for tied in ties:
        _number(tied, variants)
    low, high = (to_si(entry[name], dimension, key=f"{place}.{name}") for name in ("low", "high"))
    if not low < high:
        raise InputError("is not a range", key=place, value=[entry["low"], entry["high"]], allowed="low below high")
    if not low <= start <= high:
        raise InputError(
            "is outside of its bounds", key=key, value=start, allowed=f"{low:g} to {high:g}",
            next_step="Widen the bounds, or start inside with --set",
        )  # fmt: skip
    return DesignVariable(key=key, low=low, high=high, start=start, ties=ties)


def _number(key: str, variants: Variants) -> tuple[float, str]:
    """Value and dimension of a key whose numbers are all equal."""
    found = variants.numbers(key)
    values = {number.value for number in found}
    if len(values) != 1:
        what = "is 0" if not found else "has several values"
        raise InputError(f"{what}: it cannot vary in proportion", key=key, next_step="Name one number: leg[1]...")
    return found[0].value, found[0].dimension


def _choice(entry: Mapping[str, Any], place: str, variants: Variants) -> Choice:
    if "catalogue" in entry:
        _known(entry, ("catalogue",), place)
        check_known(entry["catalogue"], ("screws",), f"{place}.catalogue")
        share = _preload_share(variants)
        rows = [(f"screw {screw.name}", _screw(screw, share)) for screw in SCREWS]
        for key in rows[0][1]:
            variants.numbers(key)
        return Choice(name="screws", rows=tuple(rows))
    _known(entry, ("key", "values"), place)
    values, key = entry["values"], str(entry.get("key", ""))
    if not key or not isinstance(values, list) or not values:
        raise InputError(
            "is no list of values of a key", key=place, allowed='key = "leg.piston.material", values = [...]'
        )
    return Choice(name=key, rows=tuple((f"{key} = {value}", {key: value}) for value in values))


def _preload_share(variants: Variants) -> float | None:
    """Preload of the study's nuts over their dynamic load, which other screws then have too; None without one."""
    nuts = [leg.drive.nut for leg in variants.study.robot.legs if isinstance(leg.drive, ScrewDrive)]
    nut = nuts[0] if nuts else None
    return nut.preload / nut.dynamic_load if nut is not None and nut.preload and nut.dynamic_load else None


def _screw(screw: Screw, share: float | None) -> dict[str, object]:
    """Values of a screw by key, with bearing, nut and the nut's preload."""
    preload: dict[str, object] = {} if share is None else {"leg.drive.nut.preload": share * screw.dynamic_load}
    return preload | {
        "leg.drive.lead": screw.lead,
        "leg.drive.root_diameter": screw.root,
        "leg.drive.bearing.stiffness": screw.bearing,
        "leg.drive.nut.rigidity": screw.rigidity,
        "leg.drive.nut.dynamic_load": screw.dynamic_load,
    }


def _objective(table: Any) -> tuple[str, int]:
    if not isinstance(table, Mapping) or len(table) != 1:
        raise InputError("is missing", key="objective", allowed='minimise = "OUTPUT" or maximise = "OUTPUT"')
    ((verb, name),) = table.items()
    check_known(verb, ("minimise", "maximise"), "objective")
    check_outputs([str(name)])
    return str(name), 1 if verb == "minimise" else -1


def _limits(table: Any) -> list[Limit]:
    """Constraints by outputs; those of a study's requirement will be added here."""
    check_kind(table, Mapping, "constraints", 'first_frequency = { least = "25 Hz" }')
    found = []
    for name, bounds in table.items():
        key = f"constraints.{name}"
        if name == "requirement":
            raise InputError("needs a study with [requirement]", key=key, next_step="Give the limits one by one")
        check_outputs([name])
        check_kind(bounds, Mapping, key, 'least = "25 Hz" or most = "10 um"')
        _known(bounds, ("least", "most"), key)
        dimension = DIMENSIONS.get(OUTPUTS[name].units, "number")
        found += [
            Limit(name, to_si(bounds[verb], dimension, key=f"{key}.{verb}"), sense)
            for verb, sense in (("least", 1), ("most", -1))
            if verb in bounds
        ]
    return found


def _front(table: Any) -> Front | None:
    if table is None:
        return None
    check_kind(table, Mapping, "front", 'output = "static_deviation_size", count = 15')
    _known(table, ("output", "count"), "front")
    check_outputs([str(table.get("output", ""))])
    return Front(output=str(table["output"]), count=integer(table.get("count", 15), "front.count", 2, 100))
