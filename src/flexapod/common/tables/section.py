"""One table of a study file, read by the fields of the class that it fills."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, quote_text
from flexapod.common.tables.axes import NO_PLACE, WORDS, axis_of
from flexapod.common.tables.columns import Column, columns_of
from flexapod.common.tables.csv_tables import read_table
from flexapod.common.tables.named_files import Content, UnreadableFile
from flexapod.common.tables.systems import read_system
from flexapod.common.tables.table import Table
from flexapod.common.tables.values import Values

M = TypeVar("M", bound=Table)
_KINDS = ("type", "law")  # keys that say which of several tables it is


class Section(Values):
    """A table of a study file; what `Values` has, and whole objects of the model."""

    def read(
        self,
        model: type[M],
        *,
        among: tuple[str, ...] = (),
        also: tuple[str, ...] = (),
        then: Callable[[Section], Mapping[str, object]] | None = None,
    ) -> M:
        """The model's object that this table describes, key by key (`schema.columns`).

        Parameters
        ----------
        model : type
            The class.
        among : tuple of str
            Dimensions that count for numbers which may be of several.
        also : tuple of str
            Further keys, that the caller reads.
        then : callable, optional
            Gives the fields that are not read key by key; asked once the keys are known to be right.
        """
        columns = [column for name, column in columns_of(model).items() if name not in model.derived]
        self.check_keys(*(column.name for column in columns), *model.also, *also)
        several = {column.name: self._value(column, among) for column in columns if column.kind in ("each", "rows")}
        others = several | {**model.fields_from_section(self), **({} if then is None else then(self))}
        columns.sort(key=lambda column: column.kind != "words")  # these first, the others in the order of the class
        values = {column.name: self._value(column, among) for column in columns if column.name not in others}
        return self.build(model, **values, **others).attach_source(self.source_table)

    def _value(self, column: Column, among: tuple[str, ...]) -> object:
        name = column.name
        if column.kind == "number":
            return self.number(name, next((kind for kind in among if kind in column.dimensions), column.dimensions[0]))
        if column.kind == "vector" and column.size:
            return self.vector(name, *np.repeat(column.dimensions, column.size // len(column.dimensions)).tolist())
        if column.kind == "vector":  # of any length
            given = self.data.get(name)
            return self.vector(name, *column.dimensions * (len(given) if isinstance(given, list) else 1))
        if column.kind == "each":
            many = isinstance(self.data.get(name), list)
            count = (column.size or self.leg[1]) if many else 1
            return (self.vector if many else self.number)(name, *column.dimensions * count)
        if column.kind == "rows":
            return self.rows(name, *(column.dimensions * column.size,) * self.leg[1]) if name in self else None
        if column.kind == "words":
            return self.words(name, column.choices or ())
        if column.kind == "text":
            found = self.text(name, column.choices)
            return None if column.file and not found else found  # a table that was given in Python has no file
        if column.kind == "whole":
            return self.integer(name)
        if column.kind == "flag":
            return self.flag(name)
        if column.kind != "table":
            return None
        if column.dimensions and not isinstance(self.data.get(name), Mapping):
            return self.number(name, column.dimensions[0])
        inner = self.section(name)
        return inner and inner.one_of(column.models, among=among)

    def one_of(
        self,
        models: tuple[type[M], ...],
        *,
        among: tuple[str, ...] = (),
        default: type[M] | None = None,
        readers: Mapping[type, Callable[[Section], Any]] | None = None,
    ) -> M:
        """An object of one of several classes, the one that `type` or `law` names, or the default one.

        `readers`: of classes that are not read key by key.
        """
        model = models[0]
        if len(models) > 1:
            key = next(name for name in _KINDS if name in columns_of(model))
            if default is None:
                self.require_keys(key)
            kinds = {kind: one for one in models for kind in columns_of(one)[key].choices or ()}
            model = kinds.get(str(self.text(key, tuple(kinds))), default or model)
        reader = (readers or {}).get(model)
        return model.from_table(self, among) if reader is None else reader(self)

    def direction(self, name: str, place: Array, normal: Array) -> Array | None:
        """A vector, or a word for one as seen from a joint (`schema.axes`); None if absent."""
        if not isinstance(self.data.get(name), str):
            given = self.vector(name, "number", "number", "number")
            return None if given is None else np.array(given)
        found = axis_of(str(self.text(name, WORDS)), place, normal)
        if found is None:
            raise self.error(NO_PLACE, name, allowed="a vector, or vertical")
        return found

    def table(
        self,
        columns: Mapping[str, str],
        *,
        needed: bool = False,
        jumps: bool = False,
        name: str = "file",
        along: str = "time",
    ) -> dict[str, Array]:
        """Columns of the CSV file under `file` or another name (`schema.csv_tables`)."""
        found = self._stored(name)
        if found is not None:
            return self._columns(name, found, {along: along, **columns})
        try:
            return read_table(self.place(name), columns, needed=needed, jumps=jumps, along=along)
        except UnreadableFile as error:
            raise self.file_error(name, error) from None

    def linear_system(self, name: str = "file") -> dict[str, Any]:
        """The linear system in the file under `file` or another name (`schema.systems`)."""
        found = self._stored(name)
        if found is not None:
            return {part: value for part, (_, value) in found.items()}
        try:
            return read_system(self.place(name))
        except UnreadableFile as error:
            raise self.file_error(name, error) from None

    def place(self, name: str) -> Path:
        """Place of the file that a key names: the only way from a text of a study to a file.

        Raises
        ------
        InputError
            It is missing, or no file that this study may name.
        """
        self.require_keys(name)
        try:
            return self.files.place(str(self.text(name)))
        except UnreadableFile as error:
            raise self.file_error(name, error) from None

    def file_error(self, name: str, error: InputError) -> InputError:
        """Error of the file that a key names, told of the key."""
        return self.error(error.what, name, allowed=error.allowed, next_step=error.next_step)

    def _stored(self, name: str) -> Content | None:
        """Content that stands for the file that a key names, if any does."""
        self.require_keys(name)
        path = self.key(name)
        if path.startswith("leg."):  # of a table for all legs that of each
            path = f"leg[{self.leg[0]}]{path[3:]}"
        return self.files.content(path, str(self.text(name)))

    def _columns(self, name: str, content: Content, dimensions: Mapping[str, str]) -> dict[str, Array]:
        """Columns of a table that stands for a file; refused where the key asks for others."""
        for column, (dimension, _) in content.items():
            if dimensions.get(column) != dimension:
                raise self.error(
                    f"stands for a table with the column {quote_text(column)}, {dimension}",
                    name,
                    allowed=", ".join(f"{column} ({dimension})" for column, dimension in dimensions.items()),
                    next_step="Write a table with these columns into a file, and name that",
                )
        return {column: values for column, (_, values) in content.items()}
