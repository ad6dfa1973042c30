"""Tables of a study that its text names and does not hold: found in the model, by the key that names their file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from flexapod.common.tables.columns import columns_of
from flexapod.common.tables.named_files import NamedFiles, Stored
from flexapod.common.tables.table import Place, Table
from flexapod.model.leg.leg import Leg
from flexapod.model.study.robot import Robot
from flexapod.model.study.study import ActuatorStudy, Study


def stored_tables(study: Study | ActuatorStudy) -> dict[str, Stored]:
    """All tables of a study that stand in files, or were given in Python, by key: ``leg[3].drive.file``."""
    legs = study.robot.legs if isinstance(study, Study) else ()
    cranks = (i for i, leg in enumerate(legs, start=1) if leg.carriage is not None and leg.carriage.kind == "crank")
    return dict(_inside(study, Place(cranks=frozenset(cranks))))


def files_of(study: Study | ActuatorStudy) -> NamedFiles:
    """Files that the text of a study may name: tables that it has and that are in no file, and files in its folder."""
    tables = {key: table for key, table in stored_tables(study).items() if study.holds_tables or not table.name}
    return NamedFiles(Path(study.path).parent if study.path else Path(), stored=tables)


def _inside(table: Table, place: Place) -> Iterator[tuple[str, Stored]]:
    """The table of a file of this one, and those of the tables in it."""
    named = next((column.name for column in columns_of(type(table)).values() if column.file), None)
    if named is not None and (content := table.file_content(place)):
        yield f"{place.key}.{named}", Stored(getattr(table, named) or "", content)
    for name, value in vars(table).items():
        if isinstance(table, Robot) and name == "legs":
            yield from _legs(value, place)
        elif isinstance(table, Leg) and name == "elements":
            for element in value:
                yield from _inside(element, replace(place, key=f"{place.key}.{element.at}"))
        elif isinstance(value, Table):
            yield from _inside(value, replace(place, key=_key(table, name, place.key)))


def _legs(legs: tuple[Leg, ...], place: Place) -> Iterator[tuple[str, Stored]]:
    """The tables of all legs; those that are one object and have none are looked at once."""
    none: Leg | None = None
    for number, leg in enumerate(legs, start=1):
        if leg is not none:
            found = list(_inside(leg, replace(place, key=f"leg[{number}]", leg=number)))
            none = None if found else leg
            yield from found


def _key(table: Table, name: str, key: str) -> str:
    """Path of a table in a study file: what is of a robot as it is built stands beside it."""
    beside = isinstance(table, Robot) and name in ("payload", "geometry", "heat", "tolerances")
    return name if beside or not key else f"{key}.{name}"
