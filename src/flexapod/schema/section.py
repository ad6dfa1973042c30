"""One table of a study file, read by the fields of the class that it fills."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np

from flexapod.arrays import Array
from flexapod.schema.axes import NO_PLACE, WORDS, axis_of
from flexapod.schema.columns import Column, columns_of
from flexapod.schema.csv_tables import Unreadable, read_table
from flexapod.schema.systems import read_system
from flexapod.schema.table import Table
from flexapod.schema.values import Values

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
        self.only(*(column.name for column in columns), *model.also, *also)
        others = {**model.resolved(self), **({} if then is None else then(self))}
        values = {column.name: self._value(column, among) for column in columns if column.name not in others}
        return self.build(model, **values, **others).keep(self.written)

    def _value(self, column: Column, among: tuple[str, ...]) -> object:
        name = column.name
        if column.kind == "number":
            return self.number(name, next((kind for kind in among if kind in column.dimensions), column.dimensions[0]))
        if column.kind == "vector" and column.size:
            return self.vector(name, *np.repeat(column.dimensions, column.size // len(column.dimensions)).tolist())
        if column.kind == "vector":  # of any length
            given = self.data.get(name)
            return self.vector(name, *column.dimensions * (len(given) if isinstance(given, list) else 1))
        if column.kind == "text":
            return self.text(name, column.choices)
        if column.kind == "whole":
            return self.whole(name)
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
                self.need(key)
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
        self.need(name)
        try:
            return read_table(self.folder / str(self.text(name)), columns, needed=needed, jumps=jumps, along=along)
        except Unreadable as error:
            raise self.error(error.what, name, next_step=error.next_step) from None

    def linear_system(self, name: str = "file") -> dict[str, Any]:
        """The linear system in the file under `file` or another name (`schema.systems`)."""
        self.need(name)
        try:
            return read_system(self.folder / str(self.text(name)))
        except Unreadable as error:
            raise self.error(error.what, name, next_step=error.next_step) from None
