"""Header above the tabs, caption of the scene, and the study that a session begins with.

The header shows the answer or what is wrong, Simulate, progress. A session begins with a study file, or with
results that carry their study.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import viser
from viser import ClientHandle, Icon

from flexapod import model
from flexapod.analysis.results.attributes import study_from_attributes
from flexapod.app.browser import markup
from flexapod.app.browser.document import Document
from flexapod.common.errors import InputError
from flexapod.common.files import RESULTS
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.tables.named_files import NamedFiles
from flexapod.model.stored_tables import stored_tables

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.analysis import store
    from flexapod.analysis.results import stored_run
    from flexapod.app.browser.scene import PageScene
    from flexapod.output.scene import geometry
else:
    stored_run = LazyModule("flexapod.analysis.results.stored_run")
    store = LazyModule("flexapod.analysis.store")
    geometry = LazyModule("flexapod.output.scene.geometry")


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
        self._words.content = html if html == self._answer else markup.reserve_height(self._answer, html)

    def fault(self, html: str) -> None:
        """Show a fault below the words until the next change or simulation that is asked for; "" for none."""
        if self._fault.content != html:
            self._fault.content = html

    def running(self, on: bool) -> None:
        """Show that a simulation begins or has ended: Cancel or Simulate can be pressed, and progress is 0."""
        self._progress.value, self._runs = 0.0, on
        self._update()

    def progress(self, share: float) -> None:
        """Show how much is done (0 to 1)."""
        self._progress.value = 100.0 * min(max(share, 0.0), 1.0)

    def ready(self, on: bool) -> None:
        """Show whether there is a study that can be simulated."""
        self._ready = on
        self._update()

    def _update(self) -> None:
        """Enable or disable both buttons; neither is hidden, so that what is below stays under the mouse."""
        self._simulate.disabled, self._cancel.disabled = self._runs or not self._ready, not self._runs


class SceneCaption:
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


@dataclass(frozen=True, kw_only=True)
class StudySource:
    """Source that a session begins with: a study file, its study, and results if there are any."""

    document: Document
    study: model.Study | model.ActuatorStudy
    data: Dataset | None = None


def _document(study: model.Study | model.ActuatorStudy, path: str) -> Document:
    """The text of a study with its tables: visitors change the text, and nothing else of this machine is read."""
    return Document(study.source_text, path, NamedFiles(Path(), closed=True, stored=stored_tables(study)))


def open_source(file: Path) -> StudySource:
    """Read a study file, or results with their study, as the source of a session.

    InputError as of `flexapod.load`, or where the file is not a result of a simulation.
    """
    if file.suffix.lower() not in RESULTS:
        study = model.load(file)
        return StudySource(document=_document(study, str(file)), study=study)

    data = store.open_results(file)
    stored_run.check_run(data, str(file))
    path, text = data.attrs.get("study_file") or str(file), str(data.attrs["study"])
    try:
        study = study_from_attributes(data.attrs, str(file))
    except InputError as error:
        if "com_deviation" not in data:
            raise InputError(f"carries a study that is refused: {error}", file=file) from None
        study = _without_tables(data, text, str(file))
        text, path = study.source_text, str(file)
    _check_kind(study, data, str(file))
    return StudySource(document=_document(study, str(path)), study=study, data=data)


def _check_kind(study: model.Study | model.ActuatorStudy, data: Dataset, file: str) -> None:
    """Refuse results whose study is of something else, or does not know the shapes they were computed with."""
    if isinstance(study, model.Study) != ("com_deviation" in data):
        raise InputError("holds a study of something else than its results", file=file, key="study")
    if isinstance(study, model.Study) and len(study.robot.legs) != data.sizes["leg"]:
        raise InputError(
            "holds a study with another number of legs than its results",
            file=file,
            key="study",
            value=len(study.robot.legs),
            allowed=str(data.sizes["leg"]),
        )
    match_shapes: Any = geometry.computed_study  # of one kind or the other
    try:
        match_shapes(study, data)
    except InputError as error:
        raise error.with_location(file=file) from None


def _without_tables(data: Dataset, text: str, file: str) -> model.Study:
    """The study of a robot's results whose tables are elsewhere: the motion as it was commanded, no load."""
    robot = model.loads_robot(text, path=file)
    pose = np.concatenate([data.translation_command.values, data.rotation_command.values], axis=1)
    motion = model.CsvMotion(time=data.time.values, pose=pose)
    note = (
        "tables that the study names are not here: the motion is the one that the results carry, the load is left out"
    )
    return model.Study(robot=robot, motion=motion, path=file, notes=(note,))
