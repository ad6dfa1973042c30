"""Above the tabs: what the scene shows, and where that is not the motion, the way back to it."""

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
    """Words on the scene of one user, and a button.

    Parameters
    ----------
    gui : viser.GuiApi
    back : callable
        What the button does.
    """

    def __init__(self, gui: viser.GuiApi, back: Callable[[], None]) -> None:
        self._words = gui.add_html("")
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
