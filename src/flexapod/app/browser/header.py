"""Above the tabs: the answer or what is wrong, Simulate, progress, what the scene shows."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import viser
from viser import ClientHandle, Icon

from flexapod.app.browser import markup

if TYPE_CHECKING:
    from flexapod.app.browser.scene import PageScene


class Header:
    """The top of the panel of one client: the `name` of the study, words, two buttons and what they do.

    `said`: the words that are shown (HTML).
    """

    said: str

    def __init__(
        self, client: ClientHandle, name: str, simulate: Callable[[], None], cancel: Callable[[], None]
    ) -> None:
        gui = client.gui
        gui.add_html(markup.title(name))
        self.said, self._answer, self._runs, self._ready = "", "", False, True
        self._words, self._fault = gui.add_html(""), gui.add_html("")
        self._simulate = gui.add_button("Simulate", icon=Icon.PLAYER_PLAY, hint="Compute the study as it stands now")
        self._progress = gui.add_progress_bar(0.0)
        self._cancel = gui.add_button("Cancel", icon=Icon.X, disabled=True, color="red", hint="Stop the simulation")
        self._simulate.on_click(lambda _: simulate())
        self._cancel.on_click(lambda _: cancel())

    def answer(self, html: str) -> None:
        """Show an answer (HTML of `markup`) in place of the words before."""
        self._answer = html
        self.say(html)

    def say(self, html: str) -> None:
        """Show words in place of those before; the last answer keeps its room: what is below stays under the mouse."""
        self.said = html
        self._words.content = html if html == self._answer else markup.in_room_of(self._answer, html)

    def fault(self, html: str) -> None:
        """Show a fault below the words until the next change or simulation that is asked for; "" for none."""
        if self._fault.content != html:
            self._fault.content = html

    def running(self, on: bool) -> None:
        """Whether a simulation runs, from its beginning: Cancel or Simulate can be pressed."""
        self._progress.value, self._runs = 0.0, on
        self._update()

    def progress(self, share: float) -> None:
        """Show how much is done (0 to 1)."""
        self._progress.value = 100.0 * min(max(share, 0.0), 1.0)

    def ready(self, on: bool) -> None:
        """Whether there is a study that can be simulated."""
        self._ready = on
        self._update()

    def _update(self) -> None:
        """Nothing comes and goes: what is below stays under the mouse."""
        self._simulate.disabled, self._cancel.disabled = self._runs or not self._ready, not self._runs


class Picture:
    """Words on the scene of one user, and two buttons with what they do."""

    def __init__(self, gui: viser.GuiApi, back: Callable[[], None], reset: Callable[[], None]) -> None:
        self._words = gui.add_html("")
        view = gui.add_button("Reset view", color="gray", icon=Icon.CAMERA, hint="See the whole from where it began")
        view.on_click(lambda _: reset())
        self._back = gui.add_button(
            "Back to the motion", color="gray", icon=Icon.ARROW_BACK_UP, visible=False, hint="Show the result over time"
        )
        self._back.on_click(lambda _: back())

    def tell(self, scene: PageScene) -> None:
        """Say what a scene shows now."""
        html = markup.block(f"Picture: {scene.picture_words()}.", "soft")
        if self._words.content != html:
            self._words.content = html
        elsewhere = bool(scene.drawn) and scene.data is not None
        if self._back.visible != elsewhere:
            self._back.visible = elsewhere
