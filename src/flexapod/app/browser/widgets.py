"""Inputs for the fields of a study: a number, a vector, a choice; each tells what is to be written."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from viser import GuiApi

from flexapod.app.browser.document import TypedQuantity, quantity
from flexapod.app.browser.text_fields import TypedText, entry_value, plain, user_callback
from flexapod.common.errors import InputError
from flexapod.common.units import DIMENSIONS, to_si
from flexapod.model.file.fields import NotedField

if TYPE_CHECKING:
    from flexapod.app.browser.background import Threads

#: Called with a field's key, or the key of one component, the value to write, and whether it is still being typed.
Changed = Callable[[str, object, bool], None]
#: Called with the key of a field, or of one component, whose input was left, and whether it was empty.
Left = Callable[[str, bool], None]
#: Shows another value, as written, without calling back.
Setter = Callable[[object], None]

_AXES = {2: "12", 3: "xyz"}  # two: in the plane of a planar robot
LETTERS = ("type", "chain")  # texts that say which joints a robot or a leg has
EMPTY = "a number, or one with a unit; an emptied field gets its value back"


def signature(field: NotedField) -> tuple[object, ...]:
    """Properties on which a field's input depends besides the value: where they differ, another input is needed."""
    return field.key, field.kind, field.dimensions, field.choices, _rows(field)


def add_widget(gui: GuiApi, threads: Threads, field: NotedField, changed: Changed, left: Left) -> Setter:
    """Add the input of a field that has a value."""
    if field.kind == "text":
        if field.choices:
            return _choice(gui, field, changed)
        return (_written if field.name in LETTERS else _fixed)(gui, threads, field, changed, left)
    if field.kind in ("number", "whole"):
        return _number(gui, threads, field, changed, left)
    if field.kind == "flag":
        return _flag(gui, field, changed)
    if field.kind == "words":
        return _fixed(gui, threads, field, changed, left)
    if _rows(field):
        return _vectors(gui, threads, field, changed, left)
    return _written(gui, threads, field, changed, left)


def _number(gui: GuiApi, threads: Threads, field: NotedField, changed: Changed, left: Left) -> Setter:
    dimension = field.dimensions[0]
    first, unit = _shown(field.value, "", dimension)

    def accept(text: str, done: bool) -> None:
        changed(field.key, entry_value(text, unit), not done)

    def title() -> str:
        return _label(field.name, unit, dimension)

    hint = _hint(field, unit)
    box = TypedText(gui, threads, title(), first, accept, lambda empty: left(field.key, empty), hint=hint)

    def show(value: object) -> None:
        nonlocal unit
        text, unit = _shown(value, unit, dimension)
        box.show(text, title())

    return show


def _shown(value: object, unit: str, dimension: str) -> tuple[str, str]:
    """The text of a number without its unit, and that unit; of what is not one, all of it, and the `unit` before."""
    found = _readable(value, dimension)
    return (str(value), unit) if found is None else (plain(found.number), found.unit)


def _readable(value: object, dimension: str) -> TypedQuantity | None:
    """A value as the readers of study files take it; None where they do not."""
    try:
        to_si(value, dimension)
    except InputError:
        return None
    return quantity(value)


def _label(name: str, unit: str, dimension: str) -> str:
    shown = TypedQuantity(0.0, unit).shown_unit(dimension)
    return f"{name} [{shown}]" if shown else name


def _choice(gui: GuiApi, field: NotedField, changed: Changed) -> Setter:
    options = tuple(field.choices or ())
    if field.value not in options:
        options = (*options, str(field.value))
    handle = gui.add_dropdown(field.name, options, initial_value=str(field.value))
    handle.on_update(user_callback(lambda: changed(field.key, handle.value, True)))

    def show(value: object) -> None:
        if value in options:
            handle.value = str(value)

    return show


def _flag(gui: GuiApi, field: NotedField, changed: Changed) -> Setter:
    handle = gui.add_checkbox(field.name, field.value is True)
    handle.on_update(user_callback(lambda: changed(field.key, handle.value, True)))

    def show(value: object) -> None:
        handle.value = value is True

    return show


def _fixed(gui: GuiApi, _threads: Threads, field: NotedField, _changed: Changed, _left: Left) -> Setter:
    """A text that names a file of the person who started the server, or a list of texts: shown, not changed."""
    gui.add_text(field.name, str(field.value), disabled=True)
    return lambda value: None


def _written(gui: GuiApi, threads: Threads, field: NotedField, changed: Changed, left: Left) -> Setter:
    """Letters of a mechanism, or a list that is none of the numbers that are asked for, as text."""

    def accept(text: str, done: bool) -> None:
        changed(field.key, text, not done)

    hint = _hint(field, "")
    box = TypedText(gui, threads, field.name, str(field.value), accept, lambda empty: left(field.key, empty), hint=hint)
    return lambda value: box.show(str(value))


def _vectors(gui: GuiApi, threads: Threads, field: NotedField, changed: Changed, left: Left) -> Setter:
    """Inputs for a vector, one a row for rows, two for a wrench; of angles one for each leg."""
    setters = [(part, _components(gui, threads, field, part, changed, left)) for part in _parts(field)]

    def show(value: object) -> None:
        for part, setter in setters:
            setter(_at(value, part))

    return show


class _Part(NamedTuple):
    """Some numbers of a field: label, key of the list, index of the first, and what each is called."""

    label: str
    key: str
    start: int
    names: Sequence[str]


def _parts(field: NotedField) -> list[_Part]:
    count = len(field.dimensions)
    if field.kind == "rows":
        rows = len(field.value) if isinstance(field.value, list) else 0
        return [_Part(f"{field.name} {i}", f"{field.key}[{i}]", 0, _AXES[count]) for i in range(1, rows + 1)]
    if len(set(field.dimensions)) > 1 and count == 6:
        return [_Part(f"{field.name} {word}", field.key, i, "xyz") for word, i in (("force", 0), ("moment", 3))]
    numbered = count not in _AXES or field.name == "angles"
    return [_Part(field.name, field.key, 0, [str(i) for i in range(1, count + 1)] if numbered else _AXES[count])]


def _at(value: object, part: _Part) -> list[object]:
    """The written values of a part of a list, or of the row that its key ends with."""
    listed = value if isinstance(value, list) else []
    if listed and isinstance(listed[0], list):
        listed = listed[int(part.key.rpartition("[")[2].rstrip("]")) - 1]
    return listed[part.start : part.start + len(part.names)]


def _components(gui: GuiApi, threads: Threads, field: NotedField, part: _Part, changed: Changed, left: Left) -> Setter:
    """Numbers in one unit, that of the first which has one."""
    label, key, start, names = part
    dimension, unit = field.dimensions[start], ""

    def numbers(values: list[object]) -> list[str]:
        nonlocal unit
        found = [_readable(value, dimension) for value in values]
        unit = next((q.unit for q in found if q is not None and q.unit), "")
        shown = [None if q is None else q.in_unit(unit, dimension) for q in found]
        return [str(v) if q is None else plain(q.number) for v, q in zip(values, shown, strict=True)]

    def accept(i: int) -> Callable[[str, bool], None]:
        def take(text: str, done: bool) -> None:
            value = entry_value(text, unit)
            changed(f"{key}[{start + i + 1}]", 0 if value == entry_value("0", unit) else value, not done)

        return take

    def leave(i: int) -> Callable[[bool], None]:
        return lambda empty: left(f"{key}[{start + i + 1}]", empty)

    def titles() -> list[str]:
        return [_label(f"{label} {axis}", unit, dimension) for axis in names]

    texts = numbers(_at(field.value, part))
    boxes = [
        TypedText(gui, threads, title, text, accept(i), leave(i), hint=_hint(field, unit))
        for i, (title, text) in enumerate(zip(titles(), texts, strict=True))
    ]

    def show(value: object) -> None:
        shown = numbers(value if isinstance(value, list) else [0.0] * len(boxes))
        for box, text, title in zip(boxes, shown, titles(), strict=True):
            box.show(text, title)

    return show


def _rows(field: NotedField) -> int:
    """Number of lists of numbers in a field; 0 where they are not as long as they are asked for."""
    if field.kind not in ("vector", "rows") or not isinstance(field.value, list):
        return 0
    rows = field.value if field.kind == "rows" else [field.value]
    return len(rows) * all(isinstance(row, list) and len(row) == len(field.dimensions) for row in rows)


def _hint(field: NotedField, unit: str) -> str:
    dimension = field.dimensions[0] if field.dimensions else "number"
    parts = [field.key, "whole number" if field.kind == "whole" else DIMENSIONS[dimension].unit and dimension]
    if field.bounds.words:
        si = DIMENSIONS[dimension].unit
        limits = (field.bounds.least, field.bounds.most)
        in_si = any(limit for limit in limits) and si and unit != si
        parts.append(f"allowed: {field.bounds.words}{f' {si}' if in_si else ''}")
    return "; ".join(part for part in (*parts, EMPTY) if part)
