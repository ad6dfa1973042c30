"""Base of all model classes: frozen, SI floats with limits, read-only arrays, errors in the user's words."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Mapping
from html import escape
from threading import RLock
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    PlainSerializer,
    PlainValidator,
    SerializationInfo,
    ValidationError,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError, check_known, suggest_word
from flexapod.common.quantities import number
from flexapod.common.units import DIMENSIONS, number_and_unit, quantities, to_si

#: A loss factor; metals have 1e-4 to 0.01, joints 0.01 to 0.1, layers made for damping up to about 1.
Loss = Annotated[float, Field(strict=True, ge=0, le=2, allow_inf_nan=False)]

SAME = 1e-9  # relative, by which what was given may miss what follows from others; rounding leaves less

_HASH = "hash"  # where an object keeps its hash; no field can have this name, which would hide the built-in

_building = RLock()  # classes need those of their fields

_LIMIT_WORDS = {
    "greater_than": ("gt", "above"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "below"),
    "less_than_equal": ("le", "at most"),
}


class Key:
    """Words for a key of a table, for the reference: `why` says what it is.

    `usual`: what holds where it is left out, in words, where its default does not say it. `short`: "number" or "text"
    where one may stand for the value.

    Examples
    --------
    >>> fx.Key("of the seal", usual="none").why
    'of the seal'
    """

    def __init__(self, why: str = "", *, usual: str = "", short: str = "") -> None:
        self.why: str = why
        self.usual: str = usual
        self.short: str = short


class FileKey(Key):
    """A key that names a file, or holds "" where the table was given in Python.

    What the file holds stands in other fields of the class, its `derived` ones; `Table.file_content` gives it back.
    """


class Quantity(Key):
    """Quantity that the number or the array of a field measures: its size lies in the range of that dimension.

    ``Annotated[float | None, Quantity("length", above=0, why="of the screw")]``; of several dimensions, where another
    field decides which, the widest range counts. The lower end concerns numbers that cannot be 0: what may be 0 may be
    next to it as well. `above`, `least`, `most`, `below`: limits of a number.

    Examples
    --------
    >>> stiffness = fx.Quantity("stiffness", above=0, why="of the spring")
    >>> stiffness.dimensions, stiffness.limits
    (('stiffness',), {'gt': 0.0})
    """

    def __init__(
        self,
        *dimensions: str,
        above: float | None = None,
        least: float | None = None,
        most: float | None = None,
        below: float | None = None,
        why: str = "",
        usual: str = "",
        short: str = "",
    ) -> None:
        super().__init__(why, usual=usual, short=short)
        for name in dimensions or (None,):
            check_known(name, DIMENSIONS, "Quantity", "is nothing that a Quantity can measure")
        self.dimensions = dimensions
        limits = {"gt": above, "ge": least, "le": most, "lt": below}
        self.limits: dict[str, float] = {
            name: to_si(limit, "number", key="limits") for name, limit in limits.items() if limit is not None
        }
        self.smallest: float = min(DIMENSIONS[name].least for name in dimensions) if above == 0 else 0.0
        self.largest: float = max(DIMENSIONS[name].most for name in dimensions)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        schema = self._limited(handler(source))
        one = len(self.dimensions) == 1
        return core_schema.no_info_before_validator_function(self._in_si, schema) if one else schema

    def _in_si(self, value: Any) -> Any:
        """Texts as SI numbers, where one dimension alone is meant; what is no number at all is left to the field."""
        if isinstance(value, str) and number_and_unit(value) is None:
            return value
        try:
            return quantities(value, self.dimensions[0])
        except InputError as error:
            raise PydanticCustomError("unit", "{what}", {"what": error.what, "allowed": error.allowed}) from None

    def _limited(self, schema: Any) -> CoreSchema:
        if schema["type"] == "nullable":
            return schema | {"schema": self._limited(schema["schema"])}
        if schema["type"] == "float":
            schema = schema | {"strict": True, "allow_inf_nan": False, **self.limits}
        unit = DIMENSIONS[self.dimensions[0]].unit if len(self.dimensions) == 1 else ""
        most = f"{self.largest:g} {unit}".rstrip()
        allowed = f"{self.smallest:g} to {most}" if self.smallest else f"at most {most} in size"

        def within(value: Any) -> Any:
            if isinstance(value, str):  # a word where no number stands
                return value
            size = np.abs(value).max(initial=0.0) if isinstance(value, np.ndarray) else abs(value)
            if not self.smallest <= size <= self.largest:
                raise PydanticCustomError("size", "is out of range", {"allowed": allowed})
            return value

        return core_schema.no_info_after_validator_function(within, schema)


def array_of(shape: tuple[int | None, ...]) -> Callable[[object], Array]:
    """A converter to a finite, read-only float array of `shape` (None: any length)."""
    words = " x ".join("n" if n is None else str(n) for n in shape)

    def convert(value: object) -> Array:
        try:
            array = floats(value)
        except ValueError:
            raise ValueError(f"must be {words} numbers") from None
        if array.ndim != len(shape) or any(n not in (None, m) for n, m in zip(shape, array.shape, strict=True)):
            raise ValueError(f"must be {words} numbers, got {' x '.join(map(str, array.shape)) or 'a single one'}")
        if not np.all(np.isfinite(array)):
            raise ValueError("must be finite numbers (no nan, no inf)")
        array.flags.writeable = False
        return array

    convert.shape = shape  # type: ignore[attr-defined]
    return convert


def one_or_each(count: int | None) -> Callable[[object], Array]:
    """A converter to an array of one number for all, or of `count` numbers (None: one, or one for each leg)."""
    several = array_of((count,))

    def convert(value: object) -> Array:
        return several([value] * (count or 1) if isinstance(value, int | float) else value)

    convert.each = count or 0  # type: ignore[attr-defined]
    return convert


#: Context of `model_dump_json` in which a hash stands for a long table: of a thousand points each writes it.
SHORT = {"tables": "hashes"}


def _as_list(array: Array, info: SerializationInfo) -> list[Any] | str:
    if info.context == SHORT and array.size > 100:
        return f"{array.shape} {hashlib.sha256(array.tobytes()).hexdigest()}"
    return array.tolist()


Vec3 = Annotated[Array, PlainValidator(array_of((3,))), PlainSerializer(_as_list)]
Vec6 = Annotated[Array, PlainValidator(array_of((6,))), PlainSerializer(_as_list)]
Matrix3 = Annotated[Array, PlainValidator(array_of((3, 3))), PlainSerializer(_as_list)]
Matrix6 = Annotated[Array, PlainValidator(array_of((6, 6))), PlainSerializer(_as_list)]
Joints = Annotated[Array, PlainValidator(array_of((None, 3))), PlainSerializer(_as_list)]
Series = Annotated[Array, PlainValidator(array_of((None,))), PlainSerializer(_as_list)]
Series6 = Annotated[Array, PlainValidator(array_of((None, 6))), PlainSerializer(_as_list)]


class Frozen(BaseModel):
    """Base of the model: immutable, SI, unknown fields refused, `InputError` on bad values."""

    model_config: ClassVar[ConfigDict] = ConfigDict(
        frozen=True, extra="forbid", arbitrary_types_allowed=True, hide_input_in_errors=True, defer_build=True
    )  # what checks a class is built with its first object: most studies have few of the tables

    #: From what the fields of `_following` follow, in words
    _source: ClassVar[str] = "the others"

    def __init__(self, **fields: Any) -> None:
        if not self.__pydantic_complete__:
            with _building:  # of several threads one builds
                type(self).model_rebuild()
        follow = type(self)._following(fields)
        for name, value in follow.items():
            if (given := fields.get(name)) is not None and not nearly_same(given, value):
                raise InputError(
                    f"is not what follows from {self._source}",
                    key=name,
                    value=_largest(given),
                    allowed="none" if value is None else f"{_brief(value)}, or left out",
                    next_step=f"Give {name}, or that from which it follows",
                )
        try:
            super().__init__(**{**fields, **follow})
        except ValidationError as error:
            raise _input_error(error, type(self)) from None
        self.model_fields_set.difference_update(follow)

    @classmethod
    def _following(cls, fields: Mapping[str, Any]) -> Mapping[str, Any]:
        """Values of the fields that follow from those given, for an object that is to be made of these.

        They are computed with each object, and neither handed on to a copy nor written. Asked before anything is
        checked: what misses a part of that from which it follows, follows from nothing.
        """
        return {}

    @classmethod
    def _of(cls, value: object) -> Self | None:
        """An object of this class, of its fields where a mapping has them; None of anything else."""
        if isinstance(value, Mapping):
            return cls(**value)
        return value if isinstance(value, cls) else None

    @property
    def _given(self) -> dict[str, Any]:
        """The fields that were given, by name: without those that follow, and without those left to their defaults."""
        return {name: getattr(self, name) for name in type(self).model_fields if name in self.model_fields_set}

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed, validated again; what follows from others follows from the new ones.

        What followed from fields of which one is taken away (None) stays as it was.

        Raises
        ------
        InputError
            If a field does not exist, the new value is not allowed, or it contradicts others.
        """
        before, fields = self._given, {**self._given, **changes}
        followed = type(self)._following(before)
        if followed:
            now = type(self)._following(fields)
            fields |= {name: getattr(self, name) for name in followed if name not in changes and name not in now}
        return type(self)(**fields)

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        return self  # nothing in it can change

    def __copy__(self) -> Self:
        copy = super().__copy__()
        vars(copy).pop(_HASH, None)  # pydantic copies before it changes fields
        return copy

    def __setstate__(self, state: dict[Any, Any]) -> None:
        super().__setstate__(state)
        vars(self).pop(_HASH, None)  # hashes of texts differ from process to process
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def _content(self) -> tuple[object, ...]:
        return tuple(_comparable(getattr(self, name)) for name in type(self).model_fields)

    def _shown(self) -> Mapping[str, str]:
        """Names and words that `repr` and notebooks show; all fields that are given where a class chooses none."""
        fields = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: _brief(value) for name, value in fields.items() if value is not None}

    def __repr__(self) -> str:
        return f"{type(self).__name__}({'; '.join(f'{name}: {words}' for name, words in self._shown().items())})"

    def __str__(self) -> str:
        return repr(self)

    def _repr_html_(self) -> str:
        cell = '<td style="text-align: left">'
        rows = (
            f"<tr>{cell}{escape(name)}</td>{cell}{escape(words)}</td></tr>" for name, words in self._shown().items()
        )
        return f"<b>{type(self).__name__}</b><table>{''.join(rows)}</table>"

    def __dir__(self) -> list[str]:
        return sorted({*object.__dir__(self)} - _OF_PYDANTIC)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        return isinstance(other, Frozen) and type(self) is type(other) and self._content() == other._content()

    def __hash__(self) -> int:
        kept = vars(self)
        if _HASH not in kept:  # computed once: what is derived from a robot is looked up by it
            kept[_HASH] = hash((type(self).__name__, self._content()))
        return kept[_HASH]


# Names that work, and that nobody who completes a name is looking for
_OF_PYDANTIC = {name for name in dir(BaseModel) if not name.startswith("__")} | {"model_config", _HASH}


def _brief(value: object) -> str:
    if isinstance(value, float):
        return number(value, 6)
    if isinstance(value, np.ndarray):
        return str(value.tolist()) if value.size <= 9 else f"{' x '.join(map(str, value.shape))} numbers"
    return str(value)


def same(one: object, other: object) -> bool:
    """Tell whether two values of a field are the same."""
    return one is other or _comparable(one) == _comparable(other)


def nearly_same(one: Any, other: Any) -> bool:
    """Tell whether two values are the same but for rounding."""
    if isinstance(one, bool) or not isinstance(one, int | float | np.ndarray | list | tuple):
        return same(one, other)
    try:
        first, second = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    except (TypeError, ValueError, OverflowError):
        return same(one, other)
    return first.shape == second.shape and bool(
        np.all(np.abs(first - second) <= SAME * np.abs(second).max(initial=0.0))
    )


def _comparable(value: object) -> object:
    if isinstance(value, np.ndarray):
        return (value.shape, (value + 0.0).tobytes())  # -0.0 is 0.0
    if isinstance(value, dict):
        return tuple(sorted(value.items()))
    return value


def _largest(value: Any) -> Any:
    """Number of the largest size in a table or a vector, else the value."""
    if not isinstance(value, list | tuple | np.ndarray) or any(isinstance(x, str) for x in value):
        return value
    flat = np.asarray(value, dtype=float).ravel()
    return float(flat[np.abs(flat).argmax()])


def _input_error(error: ValidationError, model: type[Frozen]) -> InputError:
    first = error.errors(include_url=False)[0]
    key = ".".join(str(part) for part in first["loc"]) or None
    kind, context = first["type"], first.get("ctx", {})
    value = first.get("input")
    if kind == "extra_forbidden":
        names = [*model.model_fields, *model.model_computed_fields]
        return InputError(
            "unknown key", key=key, allowed=", ".join(names), next_step=suggest_word(str(first["loc"][-1]), names)
        )
    if kind == "missing":
        return InputError("is missing", key=key, next_step=f"Add {key}")
    if kind in _LIMIT_WORDS:
        name, words = _LIMIT_WORDS[kind]
        return InputError("is out of range", key=key, value=value, allowed=f"{words} {context[name]:g}")
    if kind == "literal_error":
        names = re.findall(r"'([^']*)'", str(context["expected"]))
        hint = suggest_word(value, names) if isinstance(value, str) else None
        allowed = ", ".join(names) or str(context["expected"])
        return InputError("is not known", key=key, value=value, allowed=allowed, next_step=hint)
    if kind in ("size", "unit"):
        return InputError(first["msg"], key=key, value=_largest(value), allowed=context["allowed"])
    message = first["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    return InputError(message, key=key, value=value)
