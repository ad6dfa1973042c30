"""Variants of a study whose numbers are multiples of its own, for inner loops: read from tables, each once."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import cached_property
from typing import Any, NamedTuple

from flexapod.common.errors import InputError
from flexapod.common.tables.key_paths import Step, copy_data, key_text, leaves, parse_key
from flexapod.design.sweeps.reading import dimension_of, number
from flexapod.model import ActuatorStudy, Study
from flexapod.model.file.key_paths import each_leg, put, value_at
from flexapod.model.file.variants import read_with_dimensions, study_from_tables
from flexapod.model.stored_tables import files_of

REFERENCE = 20.0  # degC, of a file that names none


class KeyNumber(NamedTuple):
    """A number of a study file: where it stands, its value [SI], its dimension, and what its multiples count from."""

    steps: tuple[Step, ...]
    value: float
    dimension: str
    origin: float = 0.0

    def times(self, factor: float) -> float:
        """The value whose distance from the origin is a multiple."""
        return self.origin + factor * (self.value - self.origin)


class Variants:
    """Variants of a robot's study by the keys of its file."""

    def __init__(self, study: Study) -> None:
        self.study: Study = study
        self._files = files_of(study)
        self.data: dict[str, Any] = tomllib.loads(study.source_text)

    @cached_property
    def _read(self) -> dict[str, str]:
        found: dict[str, str] = {}
        read_with_dimensions(copy_data(self.data), self._files, found)
        return found

    def study_with(self, values: Mapping[tuple[Step, ...], object]) -> Study:
        """The study with these values at its keys.

        Raises
        ------
        InputError
            A value is not allowed, or none of a study file.
        """
        data = copy_data(self.data)
        for steps, value in values.items():
            put(data, steps, value)
        found = study_from_tables(data, self._files)
        if isinstance(found, ActuatorStudy):
            raise InputError("is the study of a single actuator", key="study", allowed="the study of a robot")
        return found

    def numbers(self, key: str) -> list[KeyNumber]:
        """The numbers that a key stands for: of every leg that has it, and of a list every one that is not 0.

        Raises
        ------
        InputError
            Nothing stands there, or no number: a count, a choice, a name.
        """
        steps = parse_key(key, what="keys")
        found = []
        places = self._places(steps)
        for place in places:
            data, known = copy_data(self.data), {}
            try:
                given = value_at(data, place)
            except InputError:
                if len(places) > 1 and place is not places[-1]:
                    continue  # another leg has it
                if found:
                    return found
                raise
            read_with_dimensions(copy_data(data), self._files, known)
            for leaf, value in leaves(given, place):
                dimension = dimension_of(leaf, known)
                if dimension is None or isinstance(value, dict):
                    raise InputError(
                        "is a count or a choice, and has no per cent", key=key, value=value,
                        allowed="keys of numbers with or without a unit",
                        next_step="Compare its values one by one: flexapod sweep",
                    )  # fmt: skip
                si = number(value, leaf, known)
                if si != self._origin(leaf, dimension):
                    found.append(KeyNumber(leaf, si, dimension, self._origin(leaf, dimension)))
        return found

    def _places(self, steps: tuple[Step, ...]) -> list[tuple[Step, ...]]:
        """A key of all legs as one of each, where the file has several tables."""
        legs = self.data.get("leg")
        if steps[0] != "leg" or len(steps) == 1 or isinstance(steps[1], int) or not isinstance(legs, list):
            return [steps]
        return [("leg", i, *steps[1:]) for i in range(1, len(each_leg(self.data)) + 1)]

    def _origin(self, steps: tuple[Step, ...], dimension: str) -> float:
        """The reference of temperatures, whose distances from it are what matters; else 0."""
        if dimension != "temperature":
            return 0.0
        return number(self.data.get("heat", {}).get("reference", REFERENCE), ("heat", "reference"), self._read)

    def written_keys(self, tables: tuple[str, ...]) -> list[str]:
        """Keys of all numbers other than 0 that the file gives in some tables, with a dimension, each once."""
        found: dict[str, None] = {}
        for table in tables:
            content = self.data.get(table)
            for part in content if isinstance(content, list) else [content]:
                for steps, value in _entries(part, (table,)):
                    if (dimension := dimension_of(steps, self._read)) is None:
                        continue
                    try:
                        si = number(value, steps, self._read)
                    except InputError:
                        continue  # a class or a material in place of a number
                    if si != self._origin(steps, dimension):
                        found[key_text(steps)] = None
        return list(found)


def _entries(table: object, steps: tuple[Step, ...]) -> list[tuple[tuple[Step, ...], object]]:
    if isinstance(table, dict):
        return [entry for name, value in table.items() for entry in _entries(value, (*steps, str(name)))]
    if isinstance(table, list):
        return [entry for k, value in enumerate(table, start=1) for entry in _entries(value, (*steps, k))]
    return [(steps, table)]
