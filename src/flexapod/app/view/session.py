"""One person's state: study, results, panels, scene. Nothing of it is shared with anybody else."""

from __future__ import annotations

import logging
import threading
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from viser import Icon

from flexapod import model
from flexapod.app.view import words
from flexapod.app.view.actuator_scene import ActuatorScene
from flexapod.app.view.document import Document
from flexapod.app.view.editing import Edit, read
from flexapod.app.view.files_panel import FilesPanel
from flexapod.app.view.header import Header
from flexapod.app.view.robot_scene import RobotScene
from flexapod.app.view.running import Run
from flexapod.app.view.study_panel import StudyPanel
from flexapod.errors import FlexapodError

if TYPE_CHECKING:
    from viser import ClientHandle
    from xarray import Dataset

__all__ = ["Session", "Source"]

QUIET = 0.15  # time without a change after which the study is simulated [s]
QUICK = 3.0  # a simulation that takes longer waits for the button [s]

_LOG = logging.getLogger("flexapod.view")


@dataclass(frozen=True, kw_only=True)
class Source:
    """What everybody begins with: a study file, its study, and results if there are any."""

    document: Document
    study: model.Study | model.ActuatorStudy
    data: Dataset | None = None


class Session:
    """What one client sees and does.

    Parameters
    ----------
    client : viser.ClientHandle
    source : Source
        What to begin with.

    Attributes
    ----------
    study : Study or ActuatorStudy
        The last valid one.
    data : xarray.Dataset or None
        Results of it.
    """

    def __init__(self, client: ClientHandle, source: Source) -> None:
        self.client = client
        self.study, self.data = source.study, source.data
        self._lock, self._closed = threading.RLock(), False
        self._run: Run | None = None
        self._timer: threading.Timer | None = None
        self._quick, self._valid = True, True
        self._panels: list[Any] = []
        self._source: Source | None = source
        self.header: Header | None = None

    def start(self) -> None:
        """Build the page."""
        if self._source is not None:
            self.open(self._source)
            self._source = None

    @property
    def busy(self) -> bool:
        """Whether a simulation is running."""
        return self._run is not None

    def open(self, source: Source) -> None:
        """Begin anew with another study."""
        with self._lock:
            if self._closed:
                return
            self._stop()
            self._drop_panels()
            self.study, self.data, self._valid, self._quick = source.study, source.data, True, True
            self._build(source.document)
            self._show_study()
            self.modes_panel.show_study(self.study)
            if self.data is None:
                self.simulate()
            else:
                self._show_data()

    def close(self) -> None:
        """Give everything back: the simulation ends, arrays and files go."""
        with self._lock:
            self._closed = True
            self._stop()
            self._drop_panels()
            self.data = None

    def simulate(self) -> None:
        """Compute the study as it stands; one that is running is cancelled."""
        with self._lock:
            if self._closed or not self._valid:
                return
            self._stop()
            self._run = Run(self.study, self._progress, self._ended)
            self._show_running(True)
            self._run.start()

    def cancel(self) -> None:
        """Stop the simulation; results that are there stay."""
        with self._lock:
            if self._run is not None:
                self._stop()
                self._say(words.block("Cancelled. The study is not simulated as it stands.", "warning"))

    def fault(self, error: BaseException) -> None:
        """Tell this person, and the log, what went wrong; the session goes on."""
        if isinstance(error, FlexapodError):
            html = words.error_html(error)
        else:
            _LOG.error("client %s: %s", self.client.client_id, "".join(traceback.format_exception(error)))
            html = words.fault_html(error)
        self._say(html)

    def _say(self, html: str) -> None:
        with self._lock:
            if not self._closed and self.header is not None:
                self.header.say(html)

    def _build(self, document: Document) -> None:
        from flexapod.app.view.modes_panel import ModesPanel
        from flexapod.app.view.time_panel import TimePanel

        gui = self.client.gui
        self.header = Header(self.client, _name(document), self.simulate, self.cancel)
        self.scene: Any = RobotScene(self.client) if isinstance(self.study, model.Study) else ActuatorScene(self.client)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Time", icon=Icon.CLOCK):
            self.time_panel = TimePanel(self.client, self.scene)
        with tabs.add_tab("Study", icon=Icon.ADJUSTMENTS):
            self.study_panel = StudyPanel(self.client, document, self._edited)
        with tabs.add_tab("Modes", icon=Icon.WAVE_SINE):
            self.modes_panel = ModesPanel(self.client, self.scene)
        with tabs.add_tab("Files", icon=Icon.FOLDER):
            self.files_panel = FilesPanel(
                self.client,
                lambda: self.study_panel.document,
                lambda: self.study,
                lambda: self.data,
                self._uploaded,
            )
        self._panels = [self.time_panel, self.modes_panel, self.files_panel, self.scene]

    def _drop_panels(self) -> None:
        for panel in self._panels:
            panel.close()
        if self._panels and not self._closed:
            self.client.gui.reset()
            self.client.scene.reset()
        self._panels = []

    def _edited(self, found: Edit) -> None:
        with self._lock:
            self._valid = found.study is not None
            if self.header is not None:
                self.header.ready(self._valid)
            if found.study is None:
                self._stop()
                self._say(words.block("The study is refused; the picture shows the last valid one.", "error"))
                return
            self._stop()
            self.study, self.data = found.study, None
            self._say(words.block("Changed: rigid preview.", "soft"))
            self._show_study()
            self._timer = threading.Timer(QUIET, self._settled)
            self._timer.daemon = True
            self._timer.start()

    def _settled(self) -> None:
        """Compute what takes longer than the preview, once nothing has changed for a while."""
        with self._lock:
            if self._closed or self._timer is not threading.current_thread():
                return
            self._timer = None
            self.modes_panel.show_study(self.study)
            if self._quick:
                self.simulate()
            else:
                self._say(words.block("Changed: press Simulate for the flexible result.", "soft"))

    def _uploaded(self, document: Document) -> None:
        found = read(document)
        if found.study is not None:
            self.open(Source(document=document, study=found.study))

    def _show_study(self) -> None:
        self.scene.show_study(self.study)
        self.time_panel.show_data(None)

    def _show_data(self) -> None:
        if self.data is not None:
            self._say(_answer(self.data))
            self.scene.show_data(self.data)
            self.time_panel.show_data(self.data)

    def _stop(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self._run is not None:
            self._run.cancel()
            self._run = None
            self._show_running(False)

    def _progress(self, run: Run, share: float) -> None:
        with self._lock:
            if run is self._run and not self._closed and self.header is not None:
                self.header.progress(share)

    def _show_running(self, on: bool) -> None:
        if not self._closed and self.header is not None:
            self.header.running(on)

    def _ended(self, run: Run, found: Dataset | BaseException) -> None:
        with self._lock:
            if run is not self._run or self._closed:
                return  # cancelled, or another one was started since
            self._run = None
            self._show_running(False)
            if isinstance(found, BaseException):
                self.fault(found)
                return
            self.data, self._quick = found, float(found.attrs["wall_time"]) < QUICK
            self._show_data()


def _name(document: Document) -> str:
    return Path(document.path).name if document.path else "study"


def _answer(data: Dataset) -> str:
    from flexapod.study.summary import summary

    html = words.block(summary(data).sentence, "good")
    if data.attrs["partial"]:
        reached = f"Stopped at t = {float(data.time[-1]):.6g} s: {data.attrs.get('failure', '')}"
        html += words.block(reached, "error")
    warnings = [line for line in str(data.attrs["warnings"]).splitlines() if line]
    return html + "".join(words.block(f"Warning: {line}", "warning") for line in warnings)
