"""The study as a form: every number of the file with its unit, validated at each change; the rigid preview."""

from __future__ import annotations

import threading
import tomllib
from collections.abc import Callable, Collection
from typing import Any

from viser import ClientHandle, Icon

from flexapod.app.browser import markup
from flexapod.app.browser.background import Threads
from flexapod.app.browser.document import Document, Edit, edit_choice, edit_values, first_value, read
from flexapod.app.browser.number_slider import NumberSlider
from flexapod.app.browser.preview import preview_html
from flexapod.app.browser.structure import StructureEdit, split_long_lists, structure_edits, without_rows
from flexapod.app.browser.widgets import Setter, add_widget, signature
from flexapod.common.errors import InputError
from flexapod.model.file.fields import NotedField, read_fields

OPEN = ("[motion]",)
_NOTHING = "add a value ..."


class StudyPanel:
    """The tab "Study" of one client; `on_edit` is called with each `Edit`, valid or refused."""

    document: Document

    def __init__(
        self, client: ClientHandle, document: Document, threads: Threads, on_edit: Callable[[Edit], None]
    ) -> None:
        self._gui, self._original, self._threads, self._on_edit = client.gui, document, threads, on_edit
        self.document = self._valid = document  # as it is, and as it was when it was valid last
        self._lock, self._waiting, self._busy = threading.Lock(), dict[str, tuple[object, str]](), False
        self._before: list[Document] = []
        self._taking = threading.RLock()  # each click comes in a thread of its own: one change after the other
        self._fields: dict[str, NotedField] = {}
        self._long: dict[str, int] = {}
        self._setters: dict[str, Setter] = {}
        self._folders: dict[str, Any] = {}
        self._signatures: dict[str, object] = {}
        self._beside: dict[str, Any] = {}
        self._words = self._gui.add_html("")
        self._knob = NumberSlider(client, threads, self._turned, self._changed, self._left)
        undo = self._gui.add_button("Undo", color="gray", icon=Icon.ARROW_BACK_UP, hint="Take back the last change")
        reset = self._gui.add_button("Back to the file", color="gray", icon=Icon.FILE, hint="Take back all changes")
        undo.on_click(lambda _: self._undo())
        reset.on_click(lambda _: self._replace(self._original))
        self._tab = self._gui.add_folder(None)
        self._more = self._gui.add_folder(None)
        self._absent: list[tuple[str, Any]] = []
        self._show(read(document))

    def _typed(self, key: str, value: object, on: bool) -> None:
        """Take a value from its input, which shows it already and is left alone while somebody types `on`."""
        self._changed(key, value, "typed" if on else "left")

    def _turned(self, key: str, value: object) -> None:
        """Take a value from the slider, which is left alone."""
        self._changed(key, value, "turned")

    def _left(self, key: str, empty: bool) -> None:
        """Show in an input that was left what the document has; an empty one gets the last valid value back."""
        with self._taking:
            name = key if key in self._fields else key.rpartition("[")[0]
            if empty and (good := self._valid.value(key)) is not None and good != self.document.value(key):
                self._changed(key, good, "left")
            if name in self._fields and name in self._setters:
                self._setters[name](self._fields[name].value)

    def _changed(self, key: str, value: object, how: str = "") -> None:
        """Take a changed value; while one is being read, only the newest of each key waits."""
        with self._lock:
            self._waiting[key] = (value, how)
            if self._busy:
                return
            self._busy = True
        while (changes := self._next()) is not None:
            try:
                self._apply(changes)
            except BaseException:
                with self._lock:
                    self._busy = False
                raise

    def _next(self) -> dict[str, tuple[object, str]] | None:
        """Waiting changes that differ from the document; None, and the panel is not busy any more, without any."""
        with self._lock:
            changes = {key: change for key, change in self._waiting.items() if not self._same(key, change[0])}
            self._waiting.clear()
            self._busy = bool(changes)
            return changes or None

    def _same(self, key: str, value: object) -> bool:
        """Test whether a field has `value` in the document already: it was read, not changed by the user."""
        field = self._fields.get(key)
        return field is not None and type(field.value) is type(value) and field.value == value

    def _apply(self, changes: dict[str, tuple[object, str]]) -> None:
        with self._taking:
            there = self._fields  # a row or a leg may have gone meanwhile
            changes = {key: c for key, c in changes.items() if key in there or key.rpartition("[")[0] in there}
            before = self.document
            choices = [key for key in changes if key in self._fields and self._fields[key].choices]
            found = edit_values(before, {key: value for key, (value, _) in changes.items() if key not in choices})
            for key in choices:
                found = edit_choice(found.document, self._fields[key], str(changes[key][0]))
            if found.document != before:
                self._before = [*self._before[-99:], before]
                typed = {
                    key if key in self._fields else key.rpartition("[")[0]
                    for key, (_, how) in changes.items()
                    if how == "typed"
                }
                self._take(found, typed, turned=all(how == "turned" for _, how in changes.values()))

    def _apply_offer(self, offer: StructureEdit) -> None:
        with self._taking:
            self._replace(offer.apply(self.document))

    def _undo(self) -> None:
        with self._taking:
            if self._before:
                self._take(read(self._before.pop()))

    def _replace(self, document: Document) -> None:
        with self._taking:
            if document != self.document:
                self._before = [*self._before[-99:], self.document]
                self._take(read(document))

    def _take(self, found: Edit, typed: Collection[str] = (), turned: bool = False) -> None:
        self._show(found, typed, turned)
        self._on_edit(found)

    def _show(self, found: Edit, typed: Collection[str] = (), turned: bool = False) -> None:
        """Show a document; inputs of the keys in `typed`, and the slider where it was turned, are left alone.

        Somebody may be typing on, or dragging on, there.
        """
        self.document = found.document
        if found.error is None:
            self._valid = found.document
        fields, long = split_long_lists(self._readable(found))
        if found.error is not None:  # reading stopped, before the rows perhaps
            there = found.document.present_keys(self._long)
            long = {key: count for key, count in self._long.items() if key in there} | long
        self._long = long
        before, self._fields = self._fields, {field.key: field for field in fields}
        present = [field for field in fields if field.value is not None]
        self._fit_folders(fields, long)
        for field in present:
            if field.key not in typed and field.key in before and before[field.key].value != field.value:
                self._setters[field.key](field.value)
        if found.error is None:
            self._knob.show(present, aim=not turned)
        self._words.content = self._said(found)
        self._point_at(found.error)

    def _readable(self, found: Edit) -> list[NotedField]:
        """Fields of the document in its order; where reading stopped, those known before stay as they were."""
        said = found.document
        fields = {field.key: field for field in read_fields(said.text, said.path, said.files)}
        if found.error is not None:
            there = found.document.present_keys(key for key, f in self._fields.items() if f.value is not None)
            known = {key: f for key, f in self._fields.items() if f.value is None or key in there}
            fields = known | fields
        order = list(tomllib.loads(found.document.text))
        return sorted(fields.values(), key=lambda f: _place(order, f.key))

    def _said(self, found: Edit) -> str:
        removed = [f"{key} is taken out: the choice does not use it" for key in found.removed]
        html = markup.lines_html(removed, "warning") if removed else ""
        if found.error is not None:
            return html + markup.error_html(found.error)
        if found.study is None:
            return html
        remarks = "".join(markup.block(remark, "warning") for remark in found.study.warnings)
        return html + preview_html(found.study) + remarks

    def _fit_folders(self, fields: list[NotedField], long: dict[str, int]) -> None:
        """A folder for each table of the file; one is made anew where its inputs are others than before.

        `long`: rows of the lists that are too long to show.
        """
        tables: dict[str, list[NotedField]] = {}
        for field in fields:
            if field.value is not None or field.kind != "text" or field.choices:
                tables.setdefault(_top(field.key), []).append(field)
        for name in [name for name in self._folders if name not in tables]:
            self._folders.pop(name).remove()
            del self._signatures[name]
            self._beside = {t: h for t, h in self._beside.items() if _top(t) != name}
        found = without_rows(structure_edits(self.document), long)
        for place, (name, listed) in enumerate(tables.items()):
            here = [offer for offer in found if offer.place == name]
            remarks = [_counted(key, count) for key, count in long.items() if _top(key) == name]
            now = [[(signature(f), f.value is None) for f in listed], [offer.label for offer in here], remarks]
            if self._signatures.get(name) != now:
                self._make_folder(name, listed, here, remarks, place)
                self._signatures[name] = now
        self._offer_tables([offer for offer in found if not offer.place])

    def _offer_tables(self, found: list[StructureEdit]) -> None:
        """Below the folders: a button for each table that the file leaves out."""
        if [label for label, _ in self._absent] == [offer.label for offer in found]:
            return
        for _, handle in self._absent:
            handle.remove()
        with self._more:
            self._absent = [(offer.label, self._button(offer)) for offer in found]

    def _buttons(self, found: list[StructureEdit], inside: str) -> None:
        for offer in found:
            if offer.inside == inside:
                self._button(offer)

    def _button(self, offer: StructureEdit) -> Any:
        icon = Icon.MINUS if offer.label.startswith("Take out") else Icon.PLUS
        handle = self._gui.add_button(offer.label, color="gray", icon=icon, hint=offer.hint)
        handle.on_click(lambda _: self._apply_offer(offer))
        return handle

    def _point_at(self, error: InputError | None) -> None:
        """Say what is wrong beside the inputs of its table too: those may be far below."""
        key = "" if error is None else error.key or ""
        near = max((t for t in self._beside if key.startswith(f"{t}.") or key.startswith(f"{t}[")), key=len, default="")
        for table, handle in self._beside.items():
            content = markup.error_html(error) if error is not None and table == near else ""
            if handle.content != content:
                handle.content = content

    def _make_folder(
        self, name: str, fields: list[NotedField], found: list[StructureEdit], remarks: list[str], place: int
    ) -> None:
        known = name in self._folders
        if known:
            self._folders.pop(name).remove()
        with self._tab:
            folder = self._gui.add_folder(name, expand_by_default=known or name in OPEN, order=float(place))
        self._folders[name] = folder
        self._beside = {t: h for t, h in self._beside.items() if _top(t) != name}
        with folder:
            self._fill(fields, found)
            for remark in remarks:
                self._gui.add_html(markup.block(remark, "soft"))

    def _fill(self, fields: list[NotedField], found: list[StructureEdit]) -> None:
        inner: dict[str, list[NotedField]] = {}
        present, absent = _split_absent(fields)
        for field in present:
            inner.setdefault(_inside(field), []).append(field)
        for name, listed in inner.items():
            if not name:
                self._add(listed)
                continue
            with self._gui.add_folder(name):
                self._add(listed)
                self._buttons(found, name)
        self._buttons(found, "")
        if absent:
            self._offer(absent)

    def _add(self, fields: list[NotedField]) -> None:
        """The inputs of one table, and a place for words."""
        for field in fields:
            self._setters[field.key] = add_widget(self._gui, self._threads, field, self._typed, self._left)
        self._beside[fields[0].table] = self._gui.add_html("")

    def _offer(self, absent: list[NotedField]) -> None:
        names = {field.key: field for field in absent}
        handle = self._gui.add_dropdown("more", (_NOTHING, *names), initial_value=_NOTHING)

        def add(_: object) -> None:
            if handle.value != _NOTHING:
                self._changed(handle.value, first_value(names[handle.value]))

        handle.on_update(add)


def _split_absent(fields: list[NotedField]) -> tuple[list[NotedField], list[NotedField]]:
    """Fields that the file gives, and those that it leaves out."""
    return [f for f in fields if f.value is not None], [f for f in fields if f.value is None]


def _counted(key: str, count: int) -> str:
    """Text in place of the rows of a long list."""
    return f"{count} {key.rpartition('.')[2]}, not changed here: change them in the file"


def _top(key: str) -> str:
    """Name of the folder: the table's heading in the file, ``[leg]`` or ``[[leg]] 2``."""
    head = key.split(".")[0]
    name, bracket, index = head.partition("[")
    return f"[[{name}]] {index.rstrip(']')}" if bracket else f"[{name}]"


def _inside(field: NotedField) -> str:
    """Path of the inner table within its top one."""
    return field.table.partition(".")[2]


def _place(order: list[str], key: str) -> int:
    name = key.split(".")[0].split("[")[0]
    return order.index(name) if name in order else len(order)
