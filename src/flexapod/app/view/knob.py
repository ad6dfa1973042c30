"""One slider that turns any number of the study."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from flexapod.app.view import words
from flexapod.app.view.document import Quantity, quantity
from flexapod.app.view.fields import Field

if TYPE_CHECKING:
    from viser import ClientHandle, GuiDropdownHandle

    from flexapod.app.view.widgets import Changed

__all__ = ["Knob"]

FIRST = ("leg.piston.diameter", "payload.mass", "actuator.EI")
PARTS = 200  # steps of the slider
_NONE: tuple[str, ...] = ("",)


class Knob:
    """A choice of a number and a slider from zero to twice its value.

    Parameters
    ----------
    client : viser.ClientHandle
    changed : callable
        Called with key and value to write while the slider is dragged.
    """

    def __init__(self, client: ClientHandle, changed: Changed) -> None:
        self._changed, self._fields = changed, dict[str, Field]()
        with client.gui.add_folder("Turn a number"):
            self._choice: GuiDropdownHandle[str] = client.gui.add_dropdown(
                "number", _NONE, hint="The number that the slider changes"
            )
            self._slider = client.gui.add_slider("value", 0.0, 1.0, 0.01, 0.0, hint="Drag: the picture follows")
            self._words = client.gui.add_html("")  # the slider's own field cuts long numbers
        self._choice.on_update(lambda _: self._aim())
        self._slider.on_update(lambda event: self._turned() if event.client is not None else None)

    def show(self, fields: Sequence[Field], aim: bool) -> None:
        """Offer the numbers of `fields` that are not zero, and show the value of the chosen one if `aim`."""
        kept = self._choice.value
        numbers = {f.key: (f, q) for f in fields if f.kind == "number" and (q := quantity(f.value)) is not None}
        found = {key: field for key, (field, q) in numbers.items() if q.number or key == kept}
        if set(found) | {kept} != set(self._fields) | {kept}:
            self._choice.options = tuple(found)
        self._fields = found
        if kept not in found:
            self._choice.value = next((key for key in FIRST if key in found), next(iter(found), ""))
        elif aim and (now := quantity(found[kept].value)) is not None and now.number != self._slider.value:
            self._aim(moved=not self._slider.min <= now.number <= self._slider.max)
        self._tell()

    def _tell(self) -> None:
        """Write the chosen number out."""
        field = self._fields.get(self._choice.value)
        content = "" if field is None else words.block(f"{field.key} = {field.value}", "soft")
        if self._words.content != content:
            self._words.content = content

    def _aim(self, moved: bool = True) -> None:
        """Bring the slider to the chosen number; `moved`: with a range about it."""
        field = self._fields.get(self._choice.value)
        now = quantity(field.value) if field is not None else None
        if field is None or now is None:
            return
        unit = now.shown_unit(field.dimensions[0])
        self._slider.label = f"value [{unit}]" if unit else "value"
        if moved:
            reach = 2 * now.number or 1.0
            self._slider.min, self._slider.max = min(0.0, reach), max(0.0, reach)
            self._slider.step = abs(reach) / PARTS
            self._slider.precision = 12
        self._slider.value = now.number
        self._tell()

    def _turned(self) -> None:
        field = self._fields.get(self._choice.value)
        now = quantity(field.value) if field is not None else None
        if field is None or now is None:
            return
        self._changed(field.key, Quantity(self._slider.value, now.unit).written())
