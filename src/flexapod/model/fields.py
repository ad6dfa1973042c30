"""The numbers and choices of a study file, as its readers ask for them: key, dimension, choices, bounds."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt

from flexapod.errors import InputError
from flexapod.model.base import Frozen
from flexapod.model.files import read_study
from flexapod.model.section import Section

__all__ = ["Bounds", "Field", "Notes", "listened", "read_fields"]

Kind = Literal["number", "vector", "rows", "whole", "text"]


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """Smallest and largest value that the model allows, in SI; None where there is none. `words` says them."""

    least: float | None = None
    most: float | None = None
    words: str = ""


@dataclass(frozen=True, kw_only=True)
class Field:
    """One value of a study file.

    `key`: path, ``leg.piston.diameter``; `kind`; `dimensions`: of a number, or of each component of a vector or of a
    row (see `flexapod.units`); `choices` of a text, None where any text is meant; `value` as written, None if absent;
    `default`: what the model takes where it is absent, SI, None where that is nothing or no number; `taken`: what the
    model has for an absent key, of any type.
    """

    key: str
    kind: Kind
    dimensions: tuple[str, ...] = ()
    choices: tuple[str, ...] | None = None
    value: object = None
    bounds: Bounds = Bounds()
    default: float | None = None
    taken: object = None

    @property
    def table(self) -> str:
        """Path of the table that holds it, ``leg.piston``."""
        return self.key.rpartition(".")[0]

    @property
    def name(self) -> str:
        """Its name in that table, ``diameter``."""
        return self.key.rpartition(".")[2]


def read_fields(text: str, path: str | Path | None) -> list[Field]:
    """Fields of a study text in the order of reading, absent optional ones included.

    A text that is refused gives the fields up to the refusal; one that is not TOML gives none.

    Parameters
    ----------
    text : str
        The study file.
    path : path or None
        Where it was read; tables it names are found relative to its folder.
    """
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return []
    notes, _ = listened(data, Path(path).parent if path else Path())
    return list(notes.fields.values())


@dataclass
class Notes:
    """What was asked while a study was read.

    `fields` by key; `allowed`: keys by path of their table; `given`: (class, field) of the model that were filled.
    """

    fields: dict[str, Field] = field(default_factory=dict)
    allowed: dict[str, set[str]] = field(default_factory=dict)
    given: set[tuple[str, str]] = field(default_factory=set)


def listened(data: Mapping[str, Any], folder: Path) -> tuple[Notes, InputError | None]:
    """What the readers ask of a study's tables, and why they refuse them, if they do."""
    reader = _Listener(data, folder)
    try:
        read_study(reader, "-")
    except InputError as error:
        return reader.notes, error
    return reader.notes, None


class _Listener(Section):
    """A reader that notes what is asked of it."""

    def __init__(
        self, data: object, folder: Path, path: str = "", file: str | None = None, notes: Notes | None = None
    ) -> None:
        self.notes = notes or Notes()
        super().__init__(data, path, file, folder)

    def child(self, data: object, name: str) -> Section:
        return _Listener(data, self.folder, self.key(name), self.file, self.notes)

    def only(self, *names: str) -> None:
        self.notes.allowed.setdefault(self.path, set()).update(names)
        super().only(*names)

    def number(self, name: str, dimension: str) -> float | None:
        self._note(name, "number", (dimension,))
        return super().number(name, dimension)

    def whole(self, name: str) -> int | None:
        self._note(name, "whole", ("number",))
        return super().whole(name)

    def text(self, name: str, allowed: tuple[str, ...] | None = None) -> str | None:
        self._note(name, "text", choices=allowed)
        return super().text(name, allowed)

    def vector(self, name: str, *dimensions: str) -> list[float] | None:
        self._note(name, "vector", dimensions)
        return super().vector(name, *dimensions)

    def rows(self, name: str, count: int, *dimensions: str) -> list[list[float]]:
        self._note(name, "rows", dimensions)
        return super().rows(name, count, *dimensions)

    def build(self, model: Callable[..., Any], **fields: object) -> Any:
        cls = model if isinstance(model, type) else getattr(model, "__self__", None)
        if not (isinstance(cls, type) and issubclass(cls, Frozen)):
            return super().build(model, **fields)
        self.notes.given |= {(cls.__name__, name) for name, value in fields.items() if value is not None}
        asked = self.notes.fields
        for name, info in cls.model_fields.items():
            if (known := asked.get(self.key(name))) is not None and known.kind in ("number", "whole"):
                bounds = _bounds([*info.metadata, info.annotation])
                default = info.default if isinstance(info.default, int | float) else None
                asked[known.key] = replace(known, bounds=bounds, default=default)
        built = super().build(model, **fields)
        for name in cls.model_fields:
            if (known := asked.get(self.key(name))) is not None and known.value is None:
                asked[known.key] = replace(known, taken=getattr(built, name, None))
        return built

    def _note(
        self, name: str, kind: Kind, dimensions: tuple[str, ...] = (), choices: tuple[str, ...] | None = None
    ) -> None:
        key = self.key(name)
        if key not in self.notes.fields:
            self.notes.fields[key] = Field(
                key=key, kind=kind, dimensions=dimensions, choices=choices, value=self.data.get(name)
            )


def _bounds(parts: list[object]) -> Bounds:
    """Bounds in an annotation and its metadata."""
    limits = [limit for part in parts for limit in _limits(part)]
    least: float | None = None
    most: float | None = None
    words: list[str] = []
    for limit in limits:
        if isinstance(limit, Gt | Ge):
            least = float(limit.gt if isinstance(limit, Gt) else limit.ge)  # type: ignore[arg-type]
            words.append(f"{'above' if isinstance(limit, Gt) else 'at least'} {least:g}")
        elif isinstance(limit, Lt | Le):
            most = float(limit.lt if isinstance(limit, Lt) else limit.le)  # type: ignore[arg-type]
            words.append(f"{'below' if isinstance(limit, Lt) else 'at most'} {most:g}")
    return Bounds(least=least, most=most, words=", ".join(words))


def _limits(part: object) -> list[object]:
    if isinstance(part, Gt | Ge | Lt | Le):
        return [part]
    if get_origin(part) is Annotated:
        base, *metadata = get_args(part)
        return [limit for inner in (base, *metadata) for limit in _limits(inner)]
    inner = getattr(part, "metadata", None)  # pydantic's FieldInfo inside Annotated
    found = [limit for item in inner for limit in _limits(item)] if isinstance(inner, list) else []
    return found + [limit for argument in get_args(part) for limit in _limits(argument)]
