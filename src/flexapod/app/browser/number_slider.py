"""One slider, with a text field above it, that turns any number of the study."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence

from viser import ClientHandle, GuiDropdownHandle, GuiSliderHandle

from flexapod.app.browser import markup
from flexapod.app.browser.background import Threads
from flexapod.app.browser.document import TypedQuantity, quantity
from flexapod.app.browser.text_fields import TypedText, entry_value, plain, user_callback
from flexapod.model.file.fields import NotedField

FIRST = ("leg.piston.diameter", "payload.mass", "actuator.EI")
PARTS = 200  # steps of the slider
DIGITS = 12  # of a number that is turned
_NONE: tuple[str, ...] = ("",)


class NumberSlider:
    """A choice of a number and a slider from zero to twice its value.

    `turned`, `entered` are called with key and value to write while the slider is dragged, and where a number is typed;
    `left` as `widgets.Left`.
    """

    def __init__(
        self,
        client: ClientHandle,
        threads: Threads,
        turned: Callable[[str, object], None],
        entered: Callable[[str, object], None],
        left: Callable[[str, bool], None],
    ) -> None:
        self._gui, self._slid, self._fields = client.gui, turned, dict[str, NotedField]()
        self._entered, self._field_left, self._typing = entered, left, False
        self._lock = threading.RLock()  # numbers are chosen in one thread and turned in another
        self._slider: GuiSliderHandle[float] | None = None
        self._folder = client.gui.add_folder("Turn a number")
        with self._folder:
            self._choice: GuiDropdownHandle[str] = client.gui.add_dropdown(
                "number", _NONE, hint="The number that the slider changes", order=0
            )
            self._text = TypedText(client.gui, threads, "value", "", self._typed, self._left, order=1)
            self._words = client.gui.add_html("", order=3)
        self._choice.on_update(lambda _: self._chosen())

    def show(self, fields: Sequence[NotedField], aim: bool) -> None:
        """Offer the numbers of `fields` that are not zero, and show the value of the chosen one if `aim`."""
        with self._lock:
            kept = self._choice.value
            numbers = {f.key: (f, q) for f in fields if f.kind == "number" and (q := quantity(f.value)) is not None}
            found = {key: field for key, (field, q) in numbers.items() if q.number or key == kept}
            if set(found) | {kept} != set(self._fields) | {kept}:
                self._choice.options = tuple(found)
            self._fields = found
            if kept not in found:
                self._choice.value = next((key for key in FIRST if key in found), next(iter(found), ""))
            elif aim:
                self._aim(found[kept])
            self._tell()

    def _tell(self) -> None:
        """Write the chosen number out."""
        field = self._fields.get(self._choice.value)
        if not self._typing:
            self._show_text()
        content = "" if field is None else markup.block(f"{field.key} = {field.value}", "soft")
        if self._words.content != content:
            self._words.content = content

    def _chosen(self) -> None:
        with self._lock:
            field, self._typing = self._fields.get(self._choice.value), False
            if field is not None:
                self._make(field)
                self._tell()

    def _aim(self, field: NotedField) -> None:
        """Bring the slider to its number, which was changed elsewhere."""
        now, slider = quantity(field.value), self._slider
        if now is None or (slider is not None and now.number == slider.value):
            return
        if slider is not None and slider.min <= now.number <= slider.max:
            slider.value = now.number
        else:
            self._make(field)

    def _make(self, field: NotedField) -> None:
        """A slider of this number's own: what is still coming from the one before is not taken for this number."""
        now = quantity(field.value)
        if now is None:
            return
        if self._slider is not None:
            self._slider.remove()
        reach = 2 * now.number or 1.0
        low, high = min(0.0, reach), max(0.0, reach)
        with self._folder:
            slider = self._gui.add_slider(
                "",
                low,
                high,
                abs(reach) / PARTS,
                now.number,
                marks=((low, f"{low:.6g}"), (high, f"{high:.6g}")),
                hint="Drag: the picture follows",
                order=2,
            )
        slider.precision = min(100, max(0, DIGITS - math.floor(math.log10(abs(reach)))))
        slider.on_update(user_callback(lambda: self._turned(field.key, slider.value)))
        self._slider = slider

    def _turned(self, key: str, number: float) -> None:
        field, self._typing = self._fields.get(key), False
        now = quantity(field.value) if field is not None else None
        if now is not None:
            self._slid(key, TypedQuantity(float(f"{number:.{DIGITS}g}"), now.unit).toml_value())

    def _typed(self, text: str, left: bool) -> None:
        field = self._fields.get(self._choice.value)
        now = quantity(field.value) if field is not None else None
        self._typing = not left
        if field is not None:
            self._entered(field.key, entry_value(text, now.unit if now is not None else ""))

    def _left(self, empty: bool) -> None:
        self._typing = False
        self._field_left(self._choice.value, empty)
        self._show_text()

    def _show_text(self) -> None:
        field = self._fields.get(self._choice.value)
        now = quantity(field.value) if field is not None else None
        if field is not None and now is not None:
            self._text.show(plain(now.number), _label(field, now))


def _label(field: NotedField, now: TypedQuantity) -> str:
    unit = now.shown_unit(field.dimensions[0])
    return f"value [{unit}]" if unit else "value"
