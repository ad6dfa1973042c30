"""Variants of a study: its file with other values at some keys, read again, so that all that follows from them follows.

A sweep, the page, a sensitivity, an optimisation and `--set` of the command line come to their studies this way.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from itertools import combinations
from pathlib import Path
from typing import Any, TypeVar

from flexapod.common.errors import InputError, Malformed, check_kind
from flexapod.common.tables.field_help import Notes
from flexapod.common.tables.key_paths import Step, key_text, parse_key, similar_key
from flexapod.common.tables.named_files import NamedFiles
from flexapod.common.tables.section import Section
from flexapod.common.tables.table import to_plain_data
from flexapod.common.tables.toml import toml_text
from flexapod.model.file.files import read_study
from flexapod.model.file.key_paths import numbers_a_leg, overlap, put
from flexapod.model.file.plausible import size_remarks
from flexapod.model.file.study_text import tomlkit, with_each_leg
from flexapod.model.stored_tables import files_of
from flexapod.model.study.simulation import OWN_BASIS, STRAIGHT
from flexapod.model.study.study import ActuatorStudy, Study

S = TypeVar("S", bound=Study | ActuatorStudy)
Keys = Mapping[tuple[Step, ...], object]


def study_from_tables(
    data: Mapping[str, Any], files: Path | NamedFiles, *, text: str = "a variant of a study", file: str | None = None
) -> Study | ActuatorStudy:
    """The study of these tables; `text` and `file` become those that it was read from.

    Raises
    ------
    Malformed
        A key or a value is none of a study file.
    InputError
        The values are not allowed together, or not physical.
    """
    return read_study(Section(data, "", file, files), text)


def read_with_dimensions(
    data: Mapping[str, Any], files: Path | NamedFiles, dimensions: dict[str, str]
) -> Study | ActuatorStudy:
    """Read a study as `study_from_tables` does; `dimensions` receives that of every number, by key path."""
    notes = Notes()
    try:
        return read_study(Section(data, "", None, files, notes), "a variant of a study")
    finally:
        given = (field for field in notes.fields.values() if field.value is not None)
        dimensions.update(number for field in given for number in field.numbers)


def parse_values(values: object) -> dict[tuple[Step, ...], object]:
    """Values by the steps of their keys, as data of a study file.

    Raises
    ------
    InputError
        No values by key, a key that is none, a value that no file holds, or two keys of which one holds the other.
    """
    check_kind(values, Mapping, "values", 'values by key, {"leg.piston.diameter": "70 mm"}')
    found = {parse_key(key, what="key"): _plain(str(key), value) for key, value in dict(values).items()}  # type: ignore[call-overload]
    for one, other in combinations(found, 2):
        if overlap(one, other):
            raise InputError(
                f"and {key_text(other)} give the same value",
                key=key_text(one),
                allowed="keys of which none holds another",
                next_step="Give one of the two",
            )
    return found


def _plain(key: str, value: object) -> object:
    """A value as data: arrays and rows as lists, numbers of NumPy as numbers."""
    plain = _scalars(to_plain_data(value), key)
    if plain is None:
        raise InputError("has no value", key=key, next_step="Leave the key out: the study keeps its own value")
    return plain


def _scalars(value: Any, key: str) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _scalars(item, key) for name, item in value.items()}
    if isinstance(value, list):
        return [_scalars(item, key) for item in value]
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "item") and not getattr(value, "shape", ()):
        return value.item()
    if isinstance(value, bool | int | float | str) or value is None:
        return value
    raise InputError(
        "is no value of a study file", key=key, value=value, allowed="numbers, texts, lists and tables of them"
    )


def with_values(study: S, values: Mapping[str, object]) -> S:
    """The study with other values at some keys of its file; see `Study.with_values`."""
    keys = parse_values(values)
    files, data = files_of(study), tomllib.loads(study.source_text)
    for key, value in keys.items():
        put(data, key, value)
    text = text_with_values(study.source_text, keys, data)
    try:
        found: Any = study_from_tables(data, files, text=text, file=study.path)  # of the kind that the file is of
    except InputError as error:
        raise _explained(error, keys, tomllib.loads(study.source_text)) from None
    if study.holds_tables:
        found.hold_tables()
    remarks = size_remarks(data, study.path)
    return found.replace(notes=(*found.notes, *remarks), source_text=text) if remarks else found


def _explained(error: InputError, keys: Keys, data: Mapping[str, Any]) -> InputError:
    """The error of a variant: without the file, which does not hold the value, and with the key that was meant."""
    hint = error.next_step
    if isinstance(error, Malformed) and error.what == "unknown key" and error.key:
        asked = [key for key in keys if key_text(key).startswith(error.key.split("[")[0])]
        hint = next((found for key in asked if (found := similar_key(data, key))), hint)
    return type(error)(error.what, key=error.key, value=error.value, allowed=error.allowed, next_step=hint)


def text_with_values(text: str, keys: Keys, data: Mapping[str, Any]) -> str:
    """The text of a study file with other values at some keys; comments stay where the lines they belong to do.

    `data`: what it must say. Where it is written in a way that the values do not fit into, it is written anew.
    """
    tree: Any = tomlkit.parse(with_each_leg(text) if any(map(numbers_a_leg, keys)) else text)
    for key, value in keys.items():
        put(tree, key, value)
    found = tree.as_string()
    try:
        return found if tomllib.loads(found) == data else toml_text(data)
    except tomllib.TOMLDecodeError:
        return toml_text(data)


def override(
    study: S,
    *,
    fidelity: str | None = None,
    modes: int | None = None,
    axial_modes: int | None = None,
    basis: str | None = None,
    tolerance: float | None = None,
    step: float | None = None,
    duration: float | None = None,
    output_step: float | None = None,
    rho_inf: float | None = None,
    friction: str | None = None,
) -> S:
    """The study with settings of a Python call in place of those of the file; None keeps the file's.

    Raises
    ------
    InputError
        If a setting is not allowed, or has no effect together with the chosen fidelity.
    """
    given = {
        "fidelity": fidelity,
        "basis": basis,
        "modes": modes,
        "duration": duration,
        "tolerance": tolerance,
        "step": step,
        "output_step": output_step,
        "rho_inf": rho_inf,
        "friction": friction,
    }
    changes = {name: value for name, value in given.items() if value is not None}
    if not changes and axial_modes is None:
        return study  # the same, of which much is known already
    _refuse_unused(fidelity if isinstance(fidelity, str) else study.simulation.fidelity, changes, axial_modes)
    if "step" in changes and "tolerance" not in changes:
        changes["tolerance"] = None
    if "tolerance" in changes and "step" not in changes:
        changes["step"] = None
    simulation = study.simulation.replace(**changes)
    if axial_modes is None:
        return study.replace(simulation=simulation)
    if isinstance(study, ActuatorStudy):
        raise InputError(
            "is a setting of legs: a beam in its plane does not stretch",
            key="axial_modes",
            next_step="For a beam in space change actuator.axial_modes",
        )
    legs = tuple(leg.replace(axial_modes=axial_modes) for leg in study.robot.legs)
    return study.replace(simulation=simulation, robot=study.robot.replace(legs=legs))


def _refuse_unused(fidelity: str, changes: dict[str, object], axial_modes: int | None) -> None:
    given = [name for name in ("modes", "basis") if name in changes] + ["axial_modes"] * (axial_modes is not None)
    if fidelity in tuple(OWN_BASIS):
        given = [name for name in given if name == "basis"]
    if given and fidelity in (*STRAIGHT, *OWN_BASIS):
        raise InputError(
            f"has no effect with fidelity {fidelity!r}",
            key=given[0],
            value=changes.get(given[0], axial_modes),
            next_step=f"Leave {given[0]} out, or choose fidelity='assumed-modes'",
        )
