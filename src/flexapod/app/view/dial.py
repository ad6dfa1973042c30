"""A number as a text field and a slider below it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from flexapod.app.view import words
from flexapod.app.view.latest import Latest
from flexapod.app.view.threads import Threads
from flexapod.app.view.typed import TypedText, by_user, in_unit, say_again
from flexapod.errors import InputError

if TYPE_CHECKING:
    from viser import GuiApi, GuiSliderHandle

__all__ = ["Dial"]

SETTLED = 0.3  # time without another movement after which the browser is told the value once more [s]


class Dial:
    """Two inputs of one number; what is typed has the units of study files, and is refused beyond the ends.

    Parameters
    ----------
    gui : viser.GuiApi
    threads : Threads
        Of the session.
    name, unit : str
        The unit of the number, "" for one without.
    ends : tuple of float
        Of the slider.
    step, value : float
        All whole, where the number is whole.
    moved : callable
        Called after a user has chosen another value.
    dimension : str, optional
        Of typed units (see `flexapod.units`).
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
        self._latest = Latest(threads, lambda: say_again(self._slider))
        self._slider.on_update(by_user(self._dragged))

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
        """Of the slider."""
        return self._slider.step

    @property
    def disabled(self) -> bool:
        """Whether it can be changed."""
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
            self._say(words.error_html(error))
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
