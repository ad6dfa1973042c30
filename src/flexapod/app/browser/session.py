"""Session of one client: study, results, panels, scene, none of it shared with other clients.

Values that a browser sends for its inputs are checked before viser takes them.
"""

from __future__ import annotations

import threading
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

from viser import (
    ClientHandle,
    GuiButtonHandle,
    GuiCheckboxHandle,
    GuiDropdownHandle,
    GuiSliderHandle,
    GuiTextHandle,
)

from flexapod import model
from flexapod.app.browser import markup
from flexapod.app.browser.actuator_scene import ActuatorScene
from flexapod.app.browser.background import LOG, Debouncer, Threads
from flexapod.app.browser.document import Document, Edit, read
from flexapod.app.browser.files_panel import FilesPanel
from flexapod.app.browser.header import Header, SceneCaption, StudySource
from flexapod.app.browser.markup import run_script
from flexapod.app.browser.preview import coarse, is_preview_fast, preview_words
from flexapod.app.browser.robot_scene import RobotScene
from flexapod.app.browser.running import CorePool, ResultMemory, Run
from flexapod.app.browser.study_panel import StudyPanel
from flexapod.app.browser.uploads import UploadFolder, refuse_length
from flexapod.common.errors import FlexapodError
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text.parts import warning_lines

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis.results import summary
    from flexapod.app.browser import budget_panel, modes_panel, time_panel
else:
    summary = LazyModule("flexapod.analysis.results.summary")
    budget_panel = LazyModule("flexapod.app.browser.budget_panel")
    modes_panel = LazyModule("flexapod.app.browser.modes_panel")
    time_panel = LazyModule("flexapod.app.browser.time_panel")

LONGEST = 2_000
"""Longest text that is taken from a field [characters]."""


def limit_inputs(client: ClientHandle) -> None:
    """Take from a client only what its inputs can have: other values have no effect but a line in the log."""
    from viser import _messages

    connection: Any = client._websock_connection
    gui: Any = client.gui

    async def update(client_id: Any, message: Any) -> None:
        handle = gui._gui_input_handle_from_uuid.get(message.uuid)
        if handle is None:  # it may have gone meanwhile
            return
        problem = _problem(handle, message.updates["value"]) if [*message.updates] == ["value"] else "it sets no value"
        if problem:
            LOG.warning("client %s: a message had no effect: %s", client_id, problem)
            return
        if isinstance(handle, GuiSliderHandle):  # its ends may have changed while the value was on its way
            message.updates["value"] = min(max(message.updates["value"], handle.min), handle.max)
        await gui._handle_gui_updates(client_id, message)

    connection.unregister_handler(_messages.GuiUpdateMessage)
    connection.register_handler(_messages.GuiUpdateMessage, update)


def _problem(handle: Any, value: object) -> str:
    """Reason why an input cannot have a value; "" where it can."""
    if isinstance(handle, GuiSliderHandle):
        right = isinstance(value, int | float) and not isinstance(value, bool)
        return "" if right else "a slider takes a number"
    if isinstance(handle, GuiCheckboxHandle | GuiButtonHandle):
        return "" if isinstance(value, bool) else "a box or a button takes true or false"
    if isinstance(handle, GuiDropdownHandle):
        return "" if value in handle.options else "it is none of the options"
    if isinstance(handle, GuiTextHandle):
        right = isinstance(value, str) and len(value) <= LONGEST
        return "" if right else f"a field takes a text of at most {LONGEST} characters"
    return "this is nothing that a page sets"


DROPPED = (
    "This result was dropped: others have computed since, and results of all visitors together have a limit. "
    "Press Simulate to have it again."
)
QUIET = 0.15  # time without a change after which the study is simulated [s]


class Session:
    """State and actions of one client, from `source` on.

    Simulations of all sessions share the `cores` of the server, their results the room that `results` has.

    `study`: the last valid one; `data`: results of it, or None.
    """

    client: ClientHandle

    def __init__(self, client: ClientHandle, source: StudySource, cores: CorePool, results: ResultMemory) -> None:
        self.client, self._cores, self._results = client, cores, results
        self._threads, self._sent = Threads(self.fault), UploadFolder()
        self.study, self.data = source.study, source.data
        self._lock, self._closed = threading.RLock(), False
        self._run: Run | None = None
        self._settling = Debouncer(self._threads, self._settled)
        self._unsettled = False
        self._valid = True
        self._panels: list[Any] = []
        self._source: StudySource | None = source
        self.header: Header | None = None

    def start(self) -> None:
        """Build the page."""
        if self._source is not None:
            limit_inputs(self.client)
            self.open(self._source)
            self._source = None

    @property
    def busy(self) -> bool:
        """True while a simulation is running."""
        return self._run is not None

    def open(self, source: StudySource) -> None:
        """Begin anew with another study."""
        with self._lock:
            if self._closed:
                return
            self._stop()
            self._drop_panels()
            self.study, self.data, self._valid = source.study, source.data, True
            self._results.drop(self)
            self._build(source.document.with_folder(self._sent.folder))
            self.time_panel.show_data(None)
            self.modes_panel.show_study(self.study)
            self.budget_panel.show(self.study)
            if self.data is None:
                self._simulate()
            else:
                self._show_data()

    def close(self) -> None:
        """Give everything back: the simulation ends, arrays and files go."""
        with self._lock:
            self._closed = True
            self._stop()
            self._drop_panels()
            self._sent.close()
            self.data = None
            self._results.drop(self)

    def simulate(self) -> None:
        """Compute the study as it stands, as the user asks; one that is running is cancelled."""
        self._fault("")
        self._simulate()

    def _simulate(self, preview: bool = False) -> None:
        with self._lock:
            if self._closed or not self._valid:
                return
            self._stop()
            try:
                refuse_length(self.study)
            except FlexapodError as error:
                self.fault(error)
                return
            self._run = Run(coarse(self.study) if preview else self.study, self._threads, self._cores, self)
            self._show_running(True)
            self._run.start()

    def cancel(self) -> None:
        """Stop the simulation; results that are there stay."""
        with self._lock:
            if self._run is not None:
                self._stop()
                if self.data is None:
                    self._say(markup.block("Cancelled. The study is not simulated as it stands.", "warning"))
                else:
                    self._show_answer(self.data, markup.block("Cancelled. What was there stays.", "warning"))

    def fault(self, error: BaseException) -> None:
        """Report to this client, and to the log, what went wrong; the session goes on."""
        known = isinstance(error, FlexapodError)
        html = markup.error_html(error) if known else markup.fault_html(error)
        if not known or self.header is None:
            LOG.error("client %s: %s", self.client.client_id, "".join(traceback.format_exception(error)))
        if self.header is None and not self._closed:  # the page is not there yet: the words are all there is
            self.client.gui.add_html(html)
        elif known:
            self._say(html)
        else:
            self._fault(html)

    def on_wait(self, run: Run) -> None:
        """Report that the run waits for a free core."""
        self._tell(run, markup.block("Waiting for a free core: others are simulating on this machine.", "soft"))

    def on_begin(self, run: Run) -> None:
        """Report that the run has a core and begins."""
        self._tell(run, markup.block("Simulating.", "soft"))

    def on_progress(self, run: Run, share: float) -> None:
        """Show the share of the run that is done (0 to 1)."""
        with self._lock:
            if run is self._run and not self._closed and self.header is not None:
                self.header.progress(share)

    def on_end(self, run: Run, found: Dataset | BaseException) -> None:
        """Show the result of the run, or the error that ended it."""
        with self._lock:
            if run is not self._run or self._closed:
                return  # cancelled, or another one was started since
            self._run = None
            self._show_running(False)
            if isinstance(found, BaseException):
                self._say("")
                self.fault(found)
                return
            self.data = found
            self._show_data()
        self._results.take(self, found)

    def forget(self, data: Dataset) -> None:
        """Drop a result, which others need the room of, unless there is another one already."""
        with self._lock:
            if self._closed or self.data is not data:
                return
            self.data = None
            self._show_study()
            self.budget_panel.show(self.study)
            if not self.busy:
                self._say(markup.block(DROPPED, "warning"))

    def _tell(self, run: Run, html: str) -> None:
        with self._lock:
            if run is self._run:
                self._say(html)

    def _say(self, html: str) -> None:
        with self._lock:
            if not self._closed and self.header is not None:
                self.header.say(html)

    def _fault(self, html: str) -> None:
        with self._lock:
            if not self._closed and self.header is not None:
                self.header.fault(html)

    def _build(self, document: Document) -> None:
        gui = self.client.gui
        run_script(self.client, "view", f"{_name(document)} - flexapod")
        self.header = Header(self.client, _name(document), self.simulate, self.cancel)
        self.scene: Any = RobotScene(self.client) if isinstance(self.study, model.Study) else ActuatorScene(self.client)
        self.scene.show_study(self.study)  # first of all: it is what takes the browser longest
        self._picture = SceneCaption(gui, self._back, self.scene.reset_view)
        tabs = gui.add_tab_group()
        with tabs.add_tab("Time"):
            self.time_panel: time_panel.TimePanel = time_panel.TimePanel(
                self.client, self.scene, self._threads, self._point_chosen
            )
        with tabs.add_tab("Study"):
            self.study_panel: StudyPanel = StudyPanel(self.client, document, self._threads, self._edited)
        with tabs.add_tab("Modes"):
            self.modes_panel: modes_panel.ModesPanel = modes_panel.ModesPanel(self.client, self.scene, self._threads)
        with tabs.add_tab("Budget"):
            self.budget_panel: budget_panel.BudgetPanel = budget_panel.BudgetPanel(self.client, self._threads)
        with tabs.add_tab("Files"):
            self.files_panel: FilesPanel = FilesPanel(
                self.client,
                self._threads,
                self._sent,
                lambda: self.study_panel.document,
                lambda: self.study,
                lambda: self.data,
                self._uploaded,
            )
        self.scene.told = self._drawn
        self._drawn()
        self._panels = [self.time_panel, self.modes_panel, self.budget_panel, self.files_panel, self.scene]

    def _drop_panels(self) -> None:
        for panel in self._panels:
            panel.close()
        if self._panels and not self._closed:
            self.client.gui.reset()
            self.client.scene.reset()
        self._panels, self.header = [], None

    def _edited(self, found: Edit) -> None:
        with self._lock:
            if found.document is not self.study_panel.document:
                return  # of the study before: another one was opened while it was read
            self._valid = found.study is not None
            if self.header is not None:
                self.header.ready(self._valid)
            self._stop()
            if found.study is None:
                self._say(markup.block("The study is refused; the picture shows the last valid one.", "error"))
                return
            self.study, self.data = found.study, None
            self._results.drop(self)
            self._fault("")
            self._say(markup.block("Changed: rigid preview.", "soft"))
            self._show_study()
            self._unsettled = True
            self._settling.request(QUIET)

    def _settled(self) -> None:
        """Compute what takes longer than the preview, once nothing has changed for a while; modes in any case."""
        with self._lock:
            if self._closed:
                return
            self.modes_panel.show_study(self.study)
            self.budget_panel.show(self.study, self.data)
            if not self._unsettled:
                return
            self._unsettled = False
            if is_preview_fast(self.study):
                self._simulate(preview=True)
            else:
                self._say(markup.block("Changed: press Simulate for the flexible result.", "soft"))

    def _uploaded(self, document: Document) -> None:
        found = read(document)
        if found.study is not None:
            self.open(StudySource(document=document, study=found.study))

    def _show_study(self) -> None:
        self.scene.show_study(self.study)
        self.time_panel.show_data(None)

    def _show_data(self) -> None:
        if self.data is not None:
            self.scene.show_data(self.data)
            self._show_answer(self.data)
            self.time_panel.show_data(self.data)
            self.budget_panel.show(self.study, self.data)

    def _show_answer(self, data: Dataset, first: str = "") -> None:
        """Show the answer of a result, below other words if there are any."""
        if not self._closed and self.header is not None:
            self.header.answer(first + _answer(data, self.scene.point) + _preview(self.study, data))

    def _drawn(self) -> None:
        """Update the caption after the scene has changed."""
        self._picture.tell(self.scene)
        self.time_panel.follow()

    def _back(self) -> None:
        """Show the result over time in place of a mode or a pose."""
        self.scene.driver = None
        self.scene.set_time(self.scene.time)

    def _point_chosen(self) -> None:
        with self._lock:
            if self._valid and self.data is not None and not self.busy:
                self._show_answer(self.data)

    def _stop(self) -> None:
        self._unsettled = False
        if self._run is not None:
            self._run.cancel()
            self._run = None
            self._show_running(False)

    def _show_running(self, on: bool) -> None:
        if not self._closed and self.header is not None:
            self.header.running(on)


def _name(document: Document) -> str:
    return Path(document.path).name if document.path else "study"


def _preview(study: model.Study | model.ActuatorStudy, data: Dataset) -> str:
    said = preview_words(study, data)
    return markup.block(said, "warning") if said else ""


def _answer(data: Dataset, point: str) -> str:
    """The deviation of a point in a sentence, of the others below it, and what the result warns of."""
    said = sorted(summary.summaries(data), key=lambda s: getattr(s, "point", point) != point)
    html = "".join(markup.block(s.sentence, "soft" if i else "good") for i, s in enumerate(said))
    if data.attrs["partial"]:
        reached = f"Stopped at t = {float(data.time[-1]):.6g} s: {data.attrs.get('failure', '')}"
        html += markup.block(reached, "error")
    return html + "".join(markup.block(f"Warning: {line}", "warning") for line in warning_lines(data))
