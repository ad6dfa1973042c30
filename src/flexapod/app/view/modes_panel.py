"""The tab "Modes": of a robot at a pose, chosen and animated; of a single actuator's beam at a length."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from flexapod import model
from flexapod.app.view.beam_modes import BeamModes
from flexapod.app.view.robot_modes import RobotModes
from flexapod.app.view.scene import Scene
from flexapod.app.view.threads import Threads

if TYPE_CHECKING:
    import viser

__all__ = ["ModesPanel"]


class ModesPanel:
    """Modes for one user; made inside the tab that holds them, with what `ListedModes` takes."""

    def __init__(self, client: viser.ClientHandle, scene: Scene, threads: Threads) -> None:
        self.client, self.scene, self._threads = client, scene, threads
        self._place = client.gui.add_folder(None)
        self._lock = threading.Lock()
        self._inside: RobotModes | BeamModes | None = None

    def show_study(self, study: model.Study | model.ActuatorStudy) -> None:
        """List the modes of another study; computed in the background."""
        kind = RobotModes if isinstance(study, model.Study) else BeamModes
        with self._lock:
            if not isinstance(self._inside, kind):
                self._leave()
                with self._place:
                    self._inside = kind(self.client, self.scene, self._threads)
            self._inside.show_study(study)  # type: ignore[arg-type]

    def pause(self) -> None:
        """Stop a mode that moves."""
        with self._lock:
            if self._inside is not None:
                self._inside.pause()

    def close(self) -> None:
        """Stop, and drop what was computed."""
        with self._lock:
            self._leave()

    def _leave(self) -> None:
        if self._inside is not None:
            self._inside.close()
            self._inside = None
