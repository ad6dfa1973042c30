"""Numbers as text, with a slider or without: they take what study files take, read when the writer pauses or leaves.

viser's own number fields drop what they do not know while it is typed: 2e2 becomes 22, and 1,000 one.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from flexapod.app.browser import markup
from flexapod.app.browser.background import Debouncer, Threads
from flexapod.common.errors import InputError
from flexapod.common.units import number_and_unit, to_si

if TYPE_CHECKING:
    from viser import GuiApi, GuiEvent, GuiSliderHandle

LEFT = "\N{EM SPACE}"
"""What the page's script adds to the text of a field that is left (`assets/view.js`)."""
QUIET = 0.4  # time without another letter after which a text is read [s]
CROSSED = 2.0  # time after the server has written a text in which letters of a user may have met it on the way [s]


class TypedText:
    """A text field that shows `text` at first; `look` as `viser.GuiApi.add_text` takes it.

    `taken` is called with a text that is another than the one before, never an empty one, and whether the field was
    left; `left` after a field was left, with whether it was empty: it may `show` the value that holds.
    """

    def __init__(
        self,
        gui: GuiApi,
        threads: Threads,
        label: str,
        text: str,
        taken: Callable[[str, bool], None],
        left: Callable[[bool], None],
        **look: Any,
    ) -> None:
        self._read_last, self._taken, self._left = text, taken, left
        self._shown_at = 0.0
        self._handle = gui.add_text(label, text, **look)
        self._latest = Debouncer(threads, self._paused)
        self._handle.on_update(user_callback(self._heard))

    def show(self, text: str, label: str | None = None) -> None:
        """Show another text in place of whatever is written there."""
        self._read_last = text
        if label is not None and self._handle.label != label:
            self._handle.label = label
        if self._handle.value != text:
            self._handle.value, self._shown_at = text, time.monotonic()

    @property
    def disabled(self) -> bool:
        """True where nothing can be typed."""
        return self._handle.disabled

    @disabled.setter
    def disabled(self, disabled: bool) -> None:
        if self._handle.disabled != disabled:
            self._handle.disabled = disabled

    def remove(self) -> None:
        """Remove the field from the page."""
        self._latest.close()
        self._handle.remove()

    def _heard(self) -> None:
        if not self._handle.value.endswith(LEFT):
            self._latest.request(QUIET)
            return
        self._read()
        if self._handle.value.endswith(LEFT):  # nobody writes on
            self._left(not self._handle.value.strip())

    def _paused(self) -> None:
        if time.monotonic() - self._shown_at < CROSSED:
            resend_value(self._handle)
        self._read()

    def _read(self) -> None:
        text = self._handle.value.strip()
        if text and text != self._read_last:
            self._read_last = text
            self._taken(text, self._handle.value.endswith(LEFT))


def resend_value(handle: Any) -> None:
    """Send the value of an input to the browser once more: the one before may have crossed what the user did."""
    from viser import _messages

    message = _messages.GuiUpdateMessage(handle._impl.uuid, {"value": handle.value})
    handle._impl.gui_api._websock_interface.queue_message(message)


def user_callback(work: Callable[[], Any]) -> Callable[[GuiEvent[Any]], None]:
    """Work to do where a user, not this program, has set an input."""
    return lambda event: work() if event.client is not None else None


def entry_value(text: str, unit: str) -> object:
    """Value of a typed text in a study file; a number without a unit is in the one that is shown ("" for SI).

    A text that cannot be read is written as it is: the reader of study files says what is wrong with it.
    """
    read = number_and_unit(text)
    if read is None or read[1]:
        return text
    number = read[0]
    if unit:
        return f"{number} {unit}"
    return int(number) if number.lstrip("+-").isdecimal() else float(number)


def in_unit(text: str, unit: str, dimension: str, key: str) -> float:
    """A typed text as a number in the unit that is shown; InputError as of `flexapod.common.units.to_si`."""
    read = number_and_unit(text)
    if read is not None and not read[1]:
        return to_si(float(read[0]), "number", key=key)
    try:
        return to_si(text, dimension, key=key) / (to_si(f"1 {unit}", dimension) if unit else 1.0)
    except InputError as error:
        error.value = text
        raise


def plain(number: float) -> str:
    """A number in the fewest digits that give it back."""
    text = f"{number:.12g}"
    return text if float(text) == number else repr(number)


SETTLED = 0.3  # time without another movement after which the browser is told the value once more [s]


class NumberField:
    """Two inputs of one number; what is typed has the units of study files, and is refused beyond the ends.

    `unit` of the number, "" for one without, and its `dimension` (see `flexapod.common.units`); `ends` of the slider;
    `step` and `value` are whole where the number is; `moved` is called after a user has chosen another value.
    """

    def __init__(
        self,
        gui: GuiApi,
        threads: Threads,
        name: str,
        unit: str,
        ends: tuple[float, float],
        step: float,
        value: float,
        moved: Callable[[], None],
        *,
        dimension: str = "number",
        hint: str | None = None,
    ) -> None:
        self._name, self._unit, self._dimension, self._moved = name, unit, dimension, moved
        self._whole = isinstance(value, int)
        label = f"{name} [{unit}]" if unit else name
        self._text = TypedText(gui, threads, label, self._shown(value), self._typed, lambda _: self._show(), hint=hint)
        self._slider: GuiSliderHandle[float] = gui.add_slider("", *ends, step, value)
        self._words = gui.add_html("")
        self._latest = Debouncer(threads, lambda: resend_value(self._slider))
        self._slider.on_update(user_callback(self._dragged))

    @property
    def value(self) -> float:
        """The number."""
        return self._slider.value

    @value.setter
    def value(self, value: float) -> None:
        self._slider.value = value
        self._follow()

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest number."""
        return self._slider.min, self._slider.max

    @property
    def step(self) -> float:
        """Step of the slider."""
        return self._slider.step

    @property
    def disabled(self) -> bool:
        """True where the number cannot be changed."""
        return self._slider.disabled

    @disabled.setter
    def disabled(self, disabled: bool) -> None:
        self._slider.disabled = self._text.disabled = disabled

    def fit(self, low: float, high: float, step: float) -> None:
        """Take other ends and another step; the number stays if it is within them."""
        self._slider.min, self._slider.max, self._slider.step = low, high, step
        self._slider.precision = max(0, math.ceil(-math.log10(step)))
        self.value = min(max(self.value, low), high)

    def _follow(self) -> None:
        """Show another number as text; what was said of the text before is over."""
        self._show()
        self._say("")

    def _show(self) -> None:
        self._text.show(self._shown(self.value))

    def _say(self, html: str) -> None:
        if self._words.content != html:
            self._words.content = html

    def _shown(self, value: float) -> str:
        return f"{value:.12g}"

    def _dragged(self) -> None:
        self._follow()
        self._latest.request(SETTLED)
        self._moved()

    def _typed(self, text: str, left: bool) -> None:
        try:
            number = self._read(text)
        except InputError as error:
            self._say(markup.error_html(error))
            return
        self._say("")
        self._slider.value = number
        self._moved()

    def _read(self, text: str) -> float:
        number = in_unit(text, self._unit, self._dimension, self._name)
        low, high = self.ends
        if not low <= number <= high or (self._whole and number % 1):
            kind = "a whole number " if self._whole else ""
            raise InputError(
                "is beyond the slider" if not low <= number <= high else "is not a whole number",
                key=self._name,
                value=text,
                allowed=f"{kind}from {low:.6g} to {high:.6g} {self._unit}".rstrip(),
            )
        return int(number) if self._whole else number
