"""Inputs for the fields of a study: a number with its unit, a vector, a choice; each tells what is to be written."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from flexapod.app.view.document import Quantity, quantity
from flexapod.app.view.fields import Field
from flexapod.errors import InputError
from flexapod.units import DIMENSIONS, to_si

if TYPE_CHECKING:
    from viser import GuiApi, GuiEvent

__all__ = ["Changed", "Setter", "add_widget", "by_user", "signature"]

#: Called with a field's key, or the key of one component, and the value to write.
Changed = Callable[[str, object], None]
#: Shows another value, as written, without calling back.
Setter = Callable[[object], None]

DIGITS = 12
EMPTY = "an empty box leaves the value as it is"  # the browser tells nobody of it


def signature(field: Field) -> tuple[object, ...]:
    """What a field's input depends on besides the value: where it differs, another input is needed."""
    return field.key, field.kind, field.dimensions, field.choices, _units(field)


def add_widget(gui: GuiApi, field: Field, changed: Changed) -> Setter:
    """Add the input of a field that has a value."""
    if field.kind == "text":
        return _choice(gui, field, changed) if field.choices else _fixed(gui, field)
    if field.kind == "whole" and isinstance(field.value, int):
        return _whole(gui, field, changed)
    if field.kind == "number" and _units(field) is not None:
        return _number(gui, field, changed)
    if field.kind in ("vector", "rows") and _units(field) is not None:
        return _vectors(gui, field, changed)
    return _written(gui, field, changed)


def by_user(work: Callable[[], Any]) -> Callable[[GuiEvent[Any]], None]:
    """Work to do where a user, not this program, has set an input."""
    return lambda event: work() if event.client is not None else None


def _number(gui: GuiApi, field: Field, changed: Changed) -> Setter:
    first, dimension = quantity(field.value) or Quantity(0.0, ""), field.dimensions[0]
    unit = first.shown_unit(dimension)
    label = f"{field.name} [{unit}]" if unit else field.name
    handle = gui.add_number(label, first.number, step=_step(first.number), hint=_hint(field, first.unit, EMPTY))
    handle.precision = DIGITS
    handle.on_update(by_user(lambda: changed(field.key, Quantity(handle.value, first.unit).written())))

    def show(value: object) -> None:
        handle.value = (quantity(value) or first).number

    return show


def _whole(gui: GuiApi, field: Field, changed: Changed) -> Setter:
    handle = gui.add_number(field.name, int(str(field.value)), step=1, hint=_hint(field, "", EMPTY))
    handle.on_update(by_user(lambda: changed(field.key, handle.value)))

    def show(value: object) -> None:
        if isinstance(value, int):
            handle.value = value

    return show


def _choice(gui: GuiApi, field: Field, changed: Changed) -> Setter:
    options = tuple(field.choices or ())
    if field.value not in options:
        options = (*options, str(field.value))
    handle = gui.add_dropdown(field.name, options, initial_value=str(field.value))
    handle.on_update(by_user(lambda: changed(field.key, handle.value)))

    def show(value: object) -> None:
        if value in options:
            handle.value = str(value)

    return show


def _fixed(gui: GuiApi, field: Field) -> Setter:
    """A text that names a file of the person who started the server: shown, not changed."""
    gui.add_text(field.name, str(field.value), disabled=True)
    return lambda value: None


def _written(gui: GuiApi, field: Field, changed: Changed) -> Setter:
    """A value whose unit does not fit, as text: the unit can be changed too."""
    handle = gui.add_text(field.name, str(field.value), hint=_hint(field, ""))
    handle.on_update(by_user(lambda: changed(field.key, _as_written(handle.value))))

    def show(value: object) -> None:
        handle.value = str(value)

    return show


def _vectors(gui: GuiApi, field: Field, changed: Changed) -> Setter:
    """Inputs of three numbers each: one for a vector, two for a wrench, one a row for rows."""
    setters = []
    for label, key, start in _triples(field):
        dimension = field.dimensions[start]
        setters.append((start, key, _triple(gui, label, key, start, dimension, _at(field.value, key, start), changed)))

    def show(value: object) -> None:
        for start, key, setter in setters:
            setter(_at(value, key, start))

    return show


def _triples(field: Field) -> list[tuple[str, str, int]]:
    """Label, key of the list, and index of the first component, for each three numbers of a field."""
    if field.kind == "rows":
        count = len(field.value) if isinstance(field.value, list) else 0
        return [(f"{field.name} {i}", f"{field.key}[{i}]", 0) for i in range(1, count + 1)]
    if len(field.dimensions) == 3:
        return [(field.name, field.key, 0)]
    return [(f"{field.name} force", field.key, 0), (f"{field.name} moment", field.key, 3)]


def _at(value: object, key: str, start: int) -> list[object]:
    """Three written values of a list, or of the row that `key` ends with."""
    listed = value if isinstance(value, list) else []
    if listed and isinstance(listed[0], list):
        listed = listed[int(key.rpartition("[")[2].rstrip("]")) - 1]
    return listed[start : start + 3]


def _triple(
    gui: GuiApi, label: str, key: str, start: int, dimension: str, values: list[object], changed: Changed
) -> Setter:
    unit = next((q.unit for q in map(quantity, values) if q is not None and q.unit), "")
    shown = Quantity(0.0, unit).shown_unit(dimension)

    def numbers(written: object) -> tuple[float, float, float]:
        found = [quantity(v) or Quantity(0.0, "") for v in (written if isinstance(written, list) else [])]
        x, y, z = (q.in_unit(unit, dimension).number for q in found)
        return x, y, z

    last = numbers(values)
    title = f"{label} [{shown}]" if shown else label
    handle = gui.add_vector3(title, last, step=_step(max(map(abs, last))), hint=f"x, y, z; {EMPTY}")
    handle.precision = DIGITS

    def update() -> None:
        nonlocal last
        now = handle.value
        before, last = last, now
        for i, (number, old) in enumerate(zip(now, before, strict=True), start=start + 1):
            if number != old:
                changed(f"{key}[{i}]", Quantity(number, unit if number else "").written())

    def show(written: object) -> None:
        nonlocal last
        last = numbers(written)
        handle.value = last

    handle.on_update(by_user(update))
    return show


def _units(field: Field) -> tuple[str, ...] | None:
    """Units as written of a field's numbers; None where they are no numbers with units that fit."""
    if field.kind not in ("number", "vector", "rows"):
        return ()
    values = [field.value] if field.kind == "number" else field.value
    if field.kind == "rows" and isinstance(values, list):
        values = [item for row in values for item in (row if isinstance(row, list) else [None])]
    if not isinstance(values, list) or len(values) % len(field.dimensions):
        return None
    dimensions = field.dimensions * (len(values) // len(field.dimensions))
    found = []
    for value, dimension in zip(values, dimensions, strict=True):
        try:
            to_si(value, dimension)
        except InputError:
            return None
        written = quantity(value)
        found.append(written.unit if written else "")
    return tuple(found) if field.kind == "number" else ()


def _as_written(text: str) -> object:
    """What a typed text means in a file: a number without a unit, else the text."""
    found = quantity(text)
    return found.written() if found is not None and not found.unit else text


def _hint(field: Field, unit: str, more: str = "") -> str:
    dimension = field.dimensions[0] if field.dimensions else "number"
    parts = [field.key, "whole number" if field.kind == "whole" else DIMENSIONS[dimension].unit and dimension]
    if field.bounds.words:
        si = DIMENSIONS[dimension].unit
        limits = (field.bounds.least, field.bounds.most)
        in_si = any(limit for limit in limits) and si and unit != si
        parts.append(f"allowed: {field.bounds.words}{f' {si}' if in_si else ''}")
    return "; ".join(part for part in (*parts, more) if part)


def _step(value: float) -> float:
    """A step of the arrows: between a hundredth and a tenth of the value."""
    return 10.0 ** (math.floor(math.log10(abs(value))) - 1) if value else 0.1
