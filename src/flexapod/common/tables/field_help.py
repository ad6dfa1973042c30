"""Notes on what is asked while a study is read: keys, dimensions, choices, bounds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from flexapod.common.tables.columns import NO_BOUNDS, Bounds, Column, Kind, columns_of
from flexapod.common.tables.table import Table


@dataclass(frozen=True, kw_only=True)
class NotedField:
    """One value of a study file.

    `key`: path, ``leg.piston.diameter``; `kind`; `dimensions`: of a number, or of each component of a vector or of a
    row (see `flexapod.common.units`); `choices` of a text, None where any text is meant; `value` as written, None if
    absent; `default`: what the model takes where it is absent, SI, None where that is nothing or no number; `taken`:
    what the model has for an absent key, of any type.
    """

    key: str
    kind: Kind
    dimensions: tuple[str, ...] = ()
    choices: tuple[str, ...] | None = None
    value: object = None
    bounds: Bounds = NO_BOUNDS
    default: float | None = None
    taken: object = None

    @property
    def table(self) -> str:
        """Path of the table that holds it, ``leg.piston``."""
        return self.key.rpartition(".")[0]

    @property
    def name(self) -> str:
        """Name in that table, ``diameter``."""
        return self.key.rpartition(".")[2]

    @property
    def numbers(self) -> Iterator[tuple[str, str]]:
        """Key path and dimension of every number in it, ``payload.com[2]``."""
        if self.kind == "number":
            yield self.key, self.dimensions[0]
        rows = len(self.value) if self.kind == "rows" and isinstance(self.value, list) else 0
        for path in [self.key] * (self.kind == "vector") + [f"{self.key}[{row}]" for row in range(1, rows + 1)]:
            yield from ((f"{path}[{i}]", dimension) for i, dimension in enumerate(self.dimensions, start=1))


@dataclass
class Notes:
    """`fields` by key; `allowed`: keys by path of their table; `given`: fields of the model that were filled.

    `columns`: of the classes that a table fills, by its path; `named`: tables whose keys are names.
    """

    fields: dict[str, NotedField] = field(default_factory=dict)
    allowed: dict[str, set[str]] = field(default_factory=dict)
    given: set[tuple[str, str]] = field(default_factory=set)
    columns: dict[str, dict[str, Column]] = field(default_factory=dict)
    named: set[str] = field(default_factory=set)

    def allow(self, table: str, names: tuple[str, ...]) -> None:
        """A table may have these keys."""
        self.allowed.setdefault(table, set()).update(names)

    def ask(
        self, key: str, kind: Kind, dimensions: tuple[str, ...], choices: tuple[str, ...] | None, value: object
    ) -> None:
        """A value is read."""
        if key not in self.fields:
            self.fields[key] = NotedField(key=key, kind=kind, dimensions=dimensions, choices=choices, value=value)

    def fill(self, table: str, model: Callable[..., Any], values: Mapping[str, object]) -> None:
        """An object of the model is made of the values of a table."""
        cls = model if isinstance(model, type) else getattr(model, "__self__", None)
        if not (isinstance(cls, type) and issubclass(cls, Table)):
            return
        self.given |= {(cls.__name__, name) for name in values}
        self.columns.setdefault(table, {}).update(columns_of(cls))
        for name, column in columns_of(cls).items():
            known = self.fields.get(_path(table, name))
            if known is not None and known.kind in ("number", "whole"):
                self.fields[known.key] = replace(known, bounds=column.bounds, default=column.default)

    def record_defaults(self, table: str, built: Table) -> None:
        """The object was made: what it has for keys that are absent."""
        for name in type(built).model_fields:
            known = self.fields.get(_path(table, name))
            if known is not None and known.value is None:
                self.fields[known.key] = replace(known, taken=getattr(built, name, None))


def _path(table: str, name: str) -> str:
    return f"{table}.{name}" if table else name
