"""Modes in the background: the newest study's are listed, one of them is drawn and animated."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from flexapod.app.view import words
from flexapod.app.view.latest import Latest
from flexapod.app.view.mode_show import ModeShow
from flexapod.app.view.scene import Scene
from flexapod.app.view.threads import Threads
from flexapod.errors import FlexapodError

if TYPE_CHECKING:
    import viser

__all__ = ["Listed", "ListedModes"]

QUIET = 0.3  # after a change of the study, before its modes are computed [s]
Study = TypeVar("Study")


class Listed(NamedTuple):
    """Modes: what the scene draws, their names in the choice, their table as HTML.

    `where` they are taken, in words; `length` [m] that amplitudes are a share of.
    """

    modes: Any
    names: list[str]
    table: str
    where: str = ""
    length: float = 0.0


class ListedModes(ABC, Generic[Study]):
    """Controls of modes for one user.

    Parameters
    ----------
    client : viser.ClientHandle
    scene : Scene
        It draws the modes.
    threads : Threads
        Of the session.
    """

    size: str
    """What amplitudes are a share of."""

    def __init__(self, client: viser.ClientHandle, scene: Scene, threads: Threads) -> None:
        self.client, self.scene = client, scene
        self._study: Study | None = None
        self._modes: Any = None
        self._where = ""
        self._latest = Latest(threads, self._compute)
        self._words = client.gui.add_html("")
        self._show = ModeShow(client.gui, scene, threads, self._draw, self.size)
        self._add_controls(client.gui, threads)
        self._table = client.gui.add_html("")

    @abstractmethod
    def _add_controls(self, gui: viser.GuiApi, threads: Threads) -> None:
        """Inputs of what the modes depend on besides the study."""

    @abstractmethod
    def _fit(self, study: Study) -> None:
        """Bring those inputs to another study."""

    @abstractmethod
    def _listed(self, study: Study) -> Listed:
        """The modes of a study with these inputs."""

    @abstractmethod
    def _preview(self, study: Study) -> None:
        """Draw the undeformed mechanism with these inputs."""

    def show_study(self, study: Study) -> None:
        """List the modes of another study; computed in the background."""
        self._show.pause()
        with self._show.lock:
            self._study, self._modes = study, None
        self._fit(study)
        self._latest.request(QUIET)

    def pause(self) -> None:
        """Stand still."""
        self._show.pause()

    def close(self) -> None:
        """Stop, and drop what was computed."""
        self._show.close()
        self._latest.close()
        with self._show.lock:
            self._study = self._modes = None

    def _moved(self, quiet: float = 0.0) -> None:
        """Draw the undeformed mechanism at once; its modes follow."""
        study = self._study
        if study is not None:
            if not self._show.playing:
                self.scene.driver = None
                self._preview(study)
            self._latest.request(quiet)

    def _draw(self, place: int, amplitude: float, phase: float) -> None:
        if self._modes is not None:
            self.scene.show_mode(self._modes, place + 1, amplitude, phase, self._where)

    def _compute(self) -> None:
        """The modes, or in words why there are none."""
        study = self._study
        if study is None:
            return
        found, said = Listed(None, [], ""), ""
        try:
            found = self._listed(study)
        except FlexapodError as error:
            said = words.error_html(error)
        finally:  # a fault, too, leaves no modes of the study before
            with self._show.lock:
                if study is self._study:
                    self._modes, self._where = found.modes, found.where
                    self._words.content, self._table.content = said, found.table
                    self._show.offer(found.names, found.length)
