"""Keys that a table of a study file may hold, from the fields of the model's class that it fills."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic.fields import FieldInfo

from flexapod.common.tables.base import FileKey, Key, Quantity
from flexapod.common.tables.table import Table

Kind = Literal["number", "vector", "each", "rows", "matrix", "whole", "text", "words", "flag", "table", "other"]


_LIMITS = {"gt": "above", "ge": "at least", "le": "at most", "lt": "below"}


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """Smallest and largest value that the model allows, in SI; None where there is none. `words` says them."""

    least: float | None = None
    most: float | None = None
    words: str = ""


NO_BOUNDS = Bounds()


@dataclass(frozen=True, kw_only=True)
class Column:
    """One key of a table.

    `kind` of its value, "each" of a number for all or one for each; `dimensions` that a number may have, another key
    deciding which; `size`: numbers of a vector, or of a row of each leg;
    `choices` of a text; `models`: classes of a table, of which the text under `type` or `law` names one; a number may
    stand in place of a table where both are possible; `default` where it is a number; `why`, `usual`: its words and
    those of its default, where it has some; `short`: "number" or "text" that may stand for it; `file`: its text is the
    name of a file.
    """

    name: str
    kind: Kind
    dimensions: tuple[str, ...] = ()
    size: int = 0
    choices: tuple[str, ...] | None = None
    models: tuple[type[Table], ...] = ()
    bounds: Bounds = NO_BOUNDS
    default: float | None = None
    why: str = ""
    usual: str = ""
    short: str = ""
    file: bool = False


@cache
def columns_of(model: type[Table]) -> dict[str, Column]:
    """The keys of a table that fills a class, in their order."""
    return {name: _column(name, info) for name, info in model.model_fields.items()}


def _column(name: str, info: FieldInfo) -> Column:
    parts = list(_flat([info.annotation, *info.metadata]))
    kinds = [part for part in parts if isinstance(part, type)]
    quantity = next((part for part in parts if isinstance(part, Quantity)), None)
    dimensions = ("number",) if quantity is None else quantity.dimensions
    keys = [part for part in parts if isinstance(part, Key)]
    said = {
        word: next((getattr(key, word) for key in keys if getattr(key, word)), "") for word in ("why", "usual", "short")
    }
    found: dict[str, Any] = {"name": name, "bounds": _bounds(parts), **said}
    found["file"] = any(isinstance(key, FileKey) for key in keys)
    if isinstance(info.default, int | float) and not isinstance(info.default, bool):
        found["default"] = info.default
    models = tuple(kind for kind in kinds if issubclass(kind, Table))
    shape = next((part.shape for part in parts if hasattr(part, "shape") and not isinstance(part, type)), None)
    each = next((part.each for part in parts if hasattr(part, "each") and not isinstance(part, type)), None)
    choices = [part for part in parts if isinstance(part, str)]
    if models:
        return Column(kind="table", models=models, dimensions=("number",) * (float in kinds), **found)
    if choices:
        return Column(kind="words" if tuple in kinds else "text", choices=tuple(choices), **found)
    if each is not None:
        return Column(kind="each", dimensions=dimensions, size=each, **found)
    if shape is not None:
        kind = "vector" if len(shape) == 1 else "matrix" if shape[0] else "rows"
        return Column(kind=kind, dimensions=dimensions, size=shape[-1] or 0, **found)  # type: ignore[arg-type]
    for kind, word in ((bool, "flag"), (int, "whole"), (float, "number"), (str, "text")):
        if kind in kinds:
            return Column(kind=word, dimensions=dimensions if kind is float else (), **found)  # type: ignore[arg-type]
    return Column(kind="other", **found)


def _flat(parts: list[Any]) -> Any:
    """Types, choices and limits of an annotation and its metadata, of whatever is nested in them."""
    for part in parts:
        origin = get_origin(part)
        if origin is Literal:
            yield from (choice if isinstance(choice, str) else type(choice) for choice in get_args(part))
        elif origin in (Annotated, Union, UnionType):
            yield from _flat(list(get_args(part)))
        elif origin is tuple and get_origin(get_args(part)[0]) is Literal:
            yield from (tuple, *_flat([get_args(part)[0]]))
        elif isinstance(part, FieldInfo):
            yield from _flat([part.annotation, *part.metadata] if part.annotation else part.metadata)
        elif hasattr(part, "func"):  # a validator by a function
            yield part.func
        elif part is not NoneType:
            yield np.ndarray if origin is np.ndarray else part


def _bounds(parts: list[Any]) -> Bounds:
    limits = {name: limit for part in parts if isinstance(part, Quantity) for name, limit in part.limits.items()}
    kinds = {Gt: "gt", Ge: "ge", Le: "le", Lt: "lt"}
    limits |= {kinds[type(part)]: float(getattr(part, kinds[type(part)])) for part in parts if type(part) in kinds}
    words = [f"{_LIMITS[name]} {limit:g}" for name, limit in limits.items()]
    least, most = limits.get("gt", limits.get("ge")), limits.get("lt", limits.get("le"))
    return Bounds(least=least, most=most, words=", ".join(words))
