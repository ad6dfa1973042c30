"""Above the tabs: what the scene shows, and the ways back: to its first view, and to the motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from viser import Icon

from flexapod.app.view import words

if TYPE_CHECKING:
    import viser

    from flexapod.app.view.scene import Scene

__all__ = ["Picture"]


class Picture:
    """Words on the scene of one user, and two buttons.

    Parameters
    ----------
    gui : viser.GuiApi
    back, reset : callable
        What the buttons do.
    """

    def __init__(self, gui: viser.GuiApi, back: Callable[[], None], reset: Callable[[], None]) -> None:
        self._words = gui.add_html("")
        view = gui.add_button("Reset view", color="gray", icon=Icon.CAMERA, hint="See the whole from where it began")
        view.on_click(lambda _: reset())
        self._back = gui.add_button(
            "Back to the motion", color="gray", icon=Icon.ARROW_BACK_UP, visible=False, hint="Show the result over time"
        )
        self._back.on_click(lambda _: back())

    def tell(self, scene: Scene) -> None:
        """Say what a scene shows now."""
        html = words.block(f"Picture: {scene.picture_words()}.", "soft")
        if self._words.content != html:
            self._words.content = html
        elsewhere = bool(scene.drawn) and scene.data is not None
        if self._back.visible != elsewhere:
            self._back.visible = elsewhere
