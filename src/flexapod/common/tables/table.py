"""A table of a study file: read by the fields of its class, kept as it was written, written back."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from flexapod.common.tables.base import FileKey, Frozen, same
from flexapod.common.tables.toml import SourceTable, merge_source

if TYPE_CHECKING:
    from flexapod.common.tables.named_files import Content
    from flexapod.common.tables.section import Section

_WRITTEN = "source_table"  # where an object keeps the table that it was read from
_HELD = "held"  # where a study keeps that its tables are all there is


@dataclass(frozen=True)
class Place:
    """Place of a table of a study: its `key`, the number of its `leg`; `cranks`: of which legs the drive turns."""

    key: str = ""
    leg: int = 1
    cranks: frozenset[int] = frozenset()

    def force(self, leg: int) -> str:
        """Effort of the drive of a leg: "force", or "torque" of a crank."""
        return "torque" if leg in self.cranks else "force"


ANYWHERE = Place()


class Table(Frozen):
    """Base of what a table of a study file fills: the class says what may stand there, the object what does.

    Fields are keys, ``Annotated[float | None, Quantity("length", above=0, why="of the screw")]``, `Key` of what is no
    number. What stands in a file in another way a class reads by `fields_from_section`, or whole by `from_table`, and
    writes by `si_values`.
    """

    #: Fields that are no keys of a study file: a table in a file of its own has them, or they follow from the others
    derived: ClassVar[tuple[str, ...]] = ()
    #: Keys that are no fields
    also: ClassVar[tuple[str, ...]] = ()
    #: Fields that a key stands for, where that is not the one of its name alone
    spells: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    #: Keys that say something else in another place: directions in words, vectors in a plane
    placed: ClassVar[tuple[str, ...]] = ()
    #: Keys that are left out where they say what holds without them
    silent: ClassVar[tuple[str, ...]] = ()
    #: Fields that are in no text
    untold: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def from_table(cls, section: "Section", among: tuple[str, ...] = ()) -> Self:
        """Object that a table describes; `among`: dimensions that count for numbers which may be of several."""
        return section.read(cls, among=cls.measuring(section, among))

    @classmethod
    def measuring(cls, section: "Section", among: tuple[str, ...]) -> tuple[str, ...]:
        """Dimensions that count in this table for numbers which may be of several."""
        return among

    @classmethod
    def fields_from_section(cls, section: "Section") -> Mapping[str, object]:
        """Fields that are not read key by key; asked once the keys are known to be right."""
        return {}

    def file_content(self, place: "Place") -> "Content":
        """Content that the file under its `FileKey` holds, or would hold; nothing where it has no such table."""
        return {}

    def si_values(self) -> dict[str, object]:
        """All that it has to say in a file, by key, in SI; what is None or follows from the rest is left out.

        A file whose table was given in Python is "": no text names a file that never was.
        """
        left_out = {*self.derived, *self._following(self._given)}
        infos = {name: info for name, info in type(self).model_fields.items() if name not in left_out}
        fields = {name: getattr(self, name) for name in infos}
        fields = {name: x for name, x in fields.items() if name not in self.silent or x != infos[name].default}
        if "file" in fields and fields["file"] is None and self.file_content(ANYWHERE):
            fields["file"] = ""
        return {name: value for name, value in fields.items() if value is not None}

    @property
    def source_table(self) -> SourceTable | None:
        """The table that it was read from, and what was changed since; None of an object made in Python."""
        return vars(self).get(_WRITTEN)

    def attach_source(self, written: SourceTable) -> Self:
        """Itself, with the table that says the same."""
        vars(self)[_WRITTEN] = written
        return self

    @property
    def holds_tables(self) -> bool:
        """Tell whether no file stands behind its tables any more: it comes from results, which held them."""
        return _HELD in vars(self)

    def hold_tables(self) -> Self:
        """Itself, whose tables are no more read from files."""
        vars(self)[_HELD] = True
        return self

    def is_unchanged(self, key: str) -> bool:
        """Tell whether what was written under a key still says what the object has."""
        return self.source_table is not None and self.source_table.changed.isdisjoint(self.spells.get(key, (key,)))

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed, validated again.

        Raises
        ------
        InputError
            If a field does not exist or the new value is not allowed.
        """
        return self._kept_in(super().replace(**self._unfiled(changes)))

    def _unfiled(self, changes: dict[str, Any]) -> dict[str, Any]:
        """Changes, and no file where the table is another one than that in the file."""
        changed = [name for name in self.derived if name in changes and not same(changes[name], getattr(self, name))]
        if not changed:
            return changes
        fields = type(self).model_fields.items()
        return {name: None for name, info in fields if any(isinstance(x, FileKey) for x in info.metadata)} | changes

    def _kept_in(self, changed: Self) -> Self:
        """A changed object with what still holds of the table of this one."""
        if self.holds_tables:
            changed.hold_tables()
        if self.source_table is None:
            return changed
        fields = (name for name in type(self).model_fields if name not in self.untold)
        names = {name for name in fields if not same(getattr(self, name), getattr(changed, name))}
        return changed.attach_source(SourceTable(self.source_table.data, self.source_table.changed | names))

    def data(self, fields: dict[str, object] | None = None) -> dict[str, object]:
        """Keys as they were written where that still holds, else in SI; `fields`: those in place of `si_values`."""
        fields = self.si_values() if fields is None else fields
        if self.source_table is None:
            return fields
        data, placed = self.source_table.data, self.placed
        said = {*data, *self.source_table.changed, *placed}
        usual = {name: info.default for name, info in type(self).model_fields.items() if name not in said}
        given = {name: value for name, value in fields.items() if not _is(value, usual.get(name))}
        vectors = [name for name in placed if isinstance(fields.get(name), np.ndarray)]  # say the same anywhere
        kept = (key for key in data if self.is_unchanged(key) and (key not in placed or key in vectors))
        return merge_source(given, data, {key: data[key] for key in kept})

    def __copy__(self) -> Self:
        copy = super().__copy__()
        vars(copy).pop(_WRITTEN, None)  # pydantic copies before it changes fields
        return copy

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__()} - _OF_TABLES)


# Names that readers and writers ask for, and that nobody who completes a name is looking for
_OF_TABLES = {name for name in vars(Table) if not name.startswith("_")} - {"replace"}


def to_plain_data(value: object) -> Any:
    """A value as data of a study file."""
    if isinstance(value, Table):
        if value.source_table is not None and not value.source_table.changed and not value.placed:
            return value.source_table.data
        value = value.data()
    if isinstance(value, Mapping):
        return {name: to_plain_data(item) for name, item in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [to_plain_data(item) for item in value] if isinstance(value, list | tuple) else value


def _is(value: object, usual: object) -> bool:
    if isinstance(value, np.ndarray):
        return isinstance(usual, np.ndarray | tuple) and np.array_equal(value, usual)
    return type(value) is type(usual) and isinstance(value, Frozen | float | int | str) and value == usual
