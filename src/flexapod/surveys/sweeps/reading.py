"""From the tables of a study file with other values in them to a study, and the dimension of every number read."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flexapod.model import ActuatorStudy, Study
from flexapod.model.files import read_study
from flexapod.model.notes import Notes
from flexapod.model.section import Section
from flexapod.surveys.sweeps.keys import Step, key_text


def study_of(data: Mapping[str, Any], folder: Path) -> Study | ActuatorStudy:
    """The study of these tables.

    Raises
    ------
    Malformed
        A key or a value is none of a study file.
    InputError
        The values are not allowed together, or not physical.
    """
    return read_study(Section(data, "", None, folder), "a point of a sweep")


def read_with_dimensions(data: Mapping[str, Any], folder: Path, dimensions: dict[str, str]) -> Study | ActuatorStudy:
    """As `study_of`; `dimensions` receives the dimension of every number that is read, by key path."""
    notes = Notes()
    try:
        return read_study(Section(data, "", None, folder, notes), "a point of a sweep")
    finally:
        given = (field for field in notes.fields.values() if field.value is not None)
        dimensions.update(number for field in given for number in field.numbers)


def dimension_of(key: tuple[Step, ...], dimensions: Mapping[str, str]) -> str | None:
    """Dimension of a number, or of those of a list or of all legs; None of a choice or a whole number."""
    text = key_text(key)
    first_leg = "leg[1]" + text[3:] if text.startswith("leg.") else text
    for candidate in (text, first_leg):
        for inner in ("", "[1]", "[1][1]"):
            if candidate + inner in dimensions:
                return dimensions[candidate + inner]
    return None
