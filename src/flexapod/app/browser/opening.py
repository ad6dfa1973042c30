"""What everybody begins with: a study file, or results that carry their study."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod import model
from flexapod.analysis.results.attributes import study_in
from flexapod.app.browser.document import Document
from flexapod.common.errors import InputError
from flexapod.common.files import RESULTS
from flexapod.common.tables.named_files import NamedFiles
from flexapod.model.stored import stored_tables

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True, kw_only=True)
class StudySource:
    """What everybody begins with: a study file, its study, and results if there are any."""

    document: Document
    study: model.Study | model.ActuatorStudy
    data: Dataset | None = None


def _document(study: model.Study | model.ActuatorStudy, path: str) -> Document:
    """The text of a study with its tables: visitors change the text, and nothing else of this machine is read."""
    return Document(study.source_text, path, NamedFiles(Path(), closed=True, stored=stored_tables(study)))


def open_source(file: Path) -> StudySource:
    """What a study file or results on disk begin with.

    InputError as of `flexapod.load`, or where the file is not a result of a simulation.
    """
    if file.suffix.lower() not in RESULTS:
        study = model.load(file)
        return StudySource(document=_document(study, str(file)), study=study)
    from flexapod.analysis.results.stored_run import check_run
    from flexapod.analysis.store import open_results

    data = open_results(file)
    check_run(data, str(file))
    path, text = data.attrs.get("study_file") or str(file), str(data.attrs["study"])
    try:
        study = study_in(data.attrs, str(file))
    except InputError as error:
        if "com_deviation" not in data:
            raise InputError(f"carries a study that is refused: {error}", file=file) from None
        study = _without_tables(data, text, str(file))
        text, path = study.source_text, str(file)
    _check_kind(study, data, str(file))
    return StudySource(document=_document(study, str(path)), study=study, data=data)


def _check_kind(study: model.Study | model.ActuatorStudy, data: Dataset, file: str) -> None:
    """Refuse results whose study is of something else, or does not know the shapes they were computed with."""
    from flexapod.output.scene.geometry import as_computed

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
    match_shapes: Any = as_computed  # of one kind or the other
    try:
        match_shapes(study, data)
    except InputError as error:
        raise error.located(file=file) from None


def _without_tables(data: Dataset, text: str, file: str) -> model.Study:
    """The study of a robot's results whose tables are elsewhere: the motion as it was commanded, no load."""
    robot = model.loads_robot(text, path=file)
    pose = np.concatenate([data.translation_command.values, data.rotation_command.values], axis=1)
    motion = model.CsvMotion(time=data.time.values, pose=pose)
    note = (
        "tables that the study names are not here: the motion is the one that the results carry, the load is left out"
    )
    return model.Study(robot=robot, motion=motion, path=file, notes=(note,))
