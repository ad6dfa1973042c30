"""A design file: what may change, what is to be least, and what must be kept; checked before anything is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from flexapod.analysis.scalar_outputs import OUTPUTS
from flexapod.common.arguments import integer
from flexapod.common.errors import InputError, Malformed, check_kind, check_known
from flexapod.common.files import LARGEST_TEXT, path_of, read_text
from flexapod.common.tables.key_paths import key_text, parse_key
from flexapod.common.tables.toml import parse_toml
from flexapod.common.units import to_si
from flexapod.design.first_robot.catalogue import SCREWS, Screw
from flexapod.design.sensitivity import check_outputs
from flexapod.design.variants import Variants
from flexapod.model import ScrewDrive
from flexapod.model.file.key_paths import overlap

DIMENSIONS = {
    "Hz": "frequency", "N m-1": "stiffness", "m": "length", "kg": "mass", "rad": "angle", "N": "force", "Pa": "stress",
}  # fmt: skip
TABLES = ("variables", "objective", "constraints", "front")
FARTHEST = 1000.0  # times the value of the study, that a bound may be: the search goes in parts of the range
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
    if not isinstance(design, str | Path):
        check_kind(design, Mapping, "design", "a design file, or its tables")
        return _problem(design, variants)
    file = path_of(design, "design")
    try:
        text = read_text(file, LARGEST_TEXT)
    except OSError as error:
        words = f"cannot be read: {error.strerror}"
        raise InputError(words, file=file, next_step="See docs/optimise.md for an example") from None
    try:
        return _problem(parse_toml(text, str(file)), variants)
    except InputError as error:
        raise error.with_location(file=file) from None


def _problem(data: Mapping[str, Any], variants: Variants) -> DesignProblem:
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
    _refuse_twice([v.key for v in variables], [key for v in variables for key in v.ties], choices)
    objective, sense = _objective(data.get("objective"))
    return DesignProblem(
        variables=tuple(variables), choices=tuple(choices), objective=objective, sense=sense,
        limits=tuple(_limits(data.get("constraints", {}))), front=_front(data.get("front"), objective),
    )  # fmt: skip


def _refuse_twice(keys: list[str], ties: list[str], choices: list[Choice]) -> None:
    """Refuse a value that two entries give: variables, their ties, lists."""
    every = [*keys, *ties, *(key for choice in choices for key in choice.rows[0][1])]
    for k, key in enumerate(every):
        steps = parse_key(key, what="variables")
        if twice := [other for other in every[:k] if overlap(parse_key(other, what="variables"), steps)]:
            raise InputError(
                f"and {twice[0]} give the same value", key=key, allowed="one entry for each key",
                next_step="Leave one of them out",
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
    given = entry.get("ties", [])
    if not isinstance(given, list | tuple) or not all(isinstance(tied, str) for tied in given):
        raise InputError("is no list of keys", key=f"{place}.ties", value=given, allowed='["leg.piston.length", ...]')
    ties = tuple(given)
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
    if max(abs(low), abs(high)) > FARTHEST * abs(start):
        raise InputError(
            "is too far from the value of the study", key=place, value=[entry["low"], entry["high"]],
            allowed=f"at most {FARTHEST:g} times {start:g}",
        )  # fmt: skip
    for name, end in (("low", low), ("high", high)):
        _refuse_value({key: end}, variants, key=f"{place}.{name}", value=entry[name])
    return DesignVariable(key=key, low=low, high=high, start=start, ties=ties)


def _refuse_value(values: Mapping[str, object], variants: Variants, *, key: str, value: object) -> None:
    """Refuse what no study file may hold; what is wrong only beside other values may be right with those."""
    try:
        variants.study_with({parse_key(name, what=key): given for name, given in values.items()})
    except InputError as error:
        if isinstance(error, Malformed) or error.what == "is out of range":
            raise InputError(error.what, key=key, value=value, allowed=error.allowed) from None


def _number(key: str, variants: Variants) -> tuple[float, str]:
    """Value and dimension of a key whose numbers are all equal."""
    found = variants.numbers(key)
    values = {number.value for number in found}
    if len(values) != 1:
        what = "is 0" if not found else "has several values"
        raise InputError(f"{what}: it cannot vary in proportion", key=key, next_step="Name one number: leg[1]...")
    if isinstance(found[0].steps[-1], int) and not key.endswith("]"):
        raise InputError("is a list of numbers", key=key, next_step=f"Name one of them: {key_text(found[0].steps)}")
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
    for k, value in enumerate(values, start=1):
        _refuse_value({key: value}, variants, key=f"{place}.values[{k}]", value=value)
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
        if not bounds:
            raise InputError("limits nothing", key=key, allowed='least = "25 Hz" or most = "10 um"')
        dimension = DIMENSIONS.get(OUTPUTS[name].units, "number")
        found += [
            Limit(name, to_si(bounds[verb], dimension, key=f"{key}.{verb}"), sense)
            for verb, sense in (("least", 1), ("most", -1))
            if verb in bounds
        ]
        if len(bounds) == 2 and found[-2].value > found[-1].value:
            raise InputError("is not a range", key=key, value=dict(bounds), allowed="least below most")
    return found


def _front(table: Any, objective: str) -> Front | None:
    if table is None:
        return None
    check_kind(table, Mapping, "front", 'output = "static_deviation_size", count = 15')
    _known(table, ("output", "count"), "front")
    check_outputs([str(table.get("output", ""))])
    if table["output"] == objective:
        raise InputError("is the objective itself", key="front.output", value=objective, allowed="another output")
    return Front(output=str(table["output"]), count=integer(table.get("count", 15), "front.count", 2, 100))
