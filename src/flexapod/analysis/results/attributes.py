"""Attributes of Datasets: version, the whole study, solver settings, cost, warnings; and the study read back."""

from __future__ import annotations

import hashlib
import logging
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod import model
from flexapod.analysis.results.packed_tables import pack, unpack
from flexapod.analysis.results.time_history import Record
from flexapod.common import version
from flexapod.common.errors import FlexapodError, InputError
from flexapod.common.tables.named_files import NamedFiles
from flexapod.model.file.files import loads_among
from flexapod.model.stored_tables import stored_tables

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.solve.time.recording import Counters

TABLES = "study_tables"
"""Attribute with the tables that the text of a study names; there is none where it names none."""
FORMER = "table.csv"
"""Name that former texts gave to a table from Python, of whatever file lay there."""
KEPT = 16  # of the last studies, so that their results need not be read as text again
_log = logging.getLogger("flexapod")
_known: OrderedDict[str, model.Study | model.ActuatorStudy] = OrderedDict()
_latest: list[tuple[model.Study | model.ActuatorStudy, str]] = []  # the last study of a result, and its hash


def attributes(study: model.Study | model.ActuatorStudy, warnings: Iterable[str] = ()) -> dict[str, object]:
    """Attributes that every Dataset of a study carries; warnings as lines of text."""
    found, digest = list(dict.fromkeys(warnings)), _digest(study)
    _remember(digest, study)
    tables = stored_tables(study)
    return {
        "title": "flexapod: single actuator" if isinstance(study, model.ActuatorStudy) else "flexapod: parallel robot",
        "flexapod_version": version.__version__,
        "study": study.source_text,
        "study_file": study.path or "",
        "study_hash": digest,
        "warnings": "\n".join(found),
        **({TABLES: pack(tables)} if tables else {}),
    }


def _digest(study: model.Study | model.ActuatorStudy) -> str:
    """Hash of what a study says, tables included; known of the one that it was asked of last."""
    for known, digest in _latest:
        if known is study:
            return digest
    digest = _hash(_content(study))
    _latest[:] = [(study, digest)]
    return digest


def _content(study: model.Study | model.ActuatorStudy) -> str:
    return study.model_dump_json(exclude={"source_text", "path", "notes"})  # with the tables that the text names


def _hash(content: str) -> str:
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def _remember(digest: str, study: model.Study | model.ActuatorStudy) -> None:
    _known[digest] = study
    while len(_known) > KEPT:
        _known.popitem(last=False)


def result_study(data: Dataset) -> model.Study | model.ActuatorStudy:
    """The study that a result carries: the one it was computed of while that is known, else read from its text.

    Raises
    ------
    InputError
        It cannot be read any more: a table is damaged, or gone that former results name and do not hold.
    """
    known = _recalled(data)
    if known is None:
        known = study_from_attributes(data.attrs)
        _remember(str(data.attrs.get("study_hash")), known)
    return known


def study_from_attributes(attrs: Mapping[Any, Any], file: str | None = None) -> model.Study | model.ActuatorStudy:
    """The study in the attributes of a result, with the tables that they hold; `file`: that of the result.

    Raises
    ------
    InputError
        As of `result_study`, or they hold none.
    """
    text, path = attrs.get("study"), attrs.get("study_file", "")
    if not isinstance(text, str) or not isinstance(path, str):
        raise InputError("holds no study", file=file, key="study", allowed="a result of flexapod")
    study = loads_among(text, path or file, stored_files(attrs))
    if TABLES in attrs:
        return study.hold_tables()
    _check_former(study, str(attrs.get("study_hash")))
    return study


def _check_former(study: model.Study | model.ActuatorStudy, digest: str) -> None:
    """Refuse another table than the one from Python that a former result names and does not hold."""
    named = [key for key, table in stored_tables(study).items() if table.name == FORMER]
    if named and digest not in (_digest(study), _hash(_content(study).replace(f'"{FORMER}"', "null"))):
        raise InputError(
            "is not the table of this result, which does not hold it",
            key=named[0],
            value=FORMER,
            allowed="the one that it was computed with",
            next_step="Compute it again: results hold their tables now",
        )


def stored_files(attrs: Mapping[Any, Any]) -> NamedFiles | None:
    """Tables stored in a result, as the files that its study names; None of a former result, which has none."""
    if TABLES not in attrs:
        return None
    folder = Path(str(attrs.get("study_file") or "")).parent
    return NamedFiles(folder, stored=unpack(attrs[TABLES]))


def _recalled(data: Dataset) -> model.Study | model.ActuatorStudy | None:
    known = _known.get(str(data.attrs.get("study_hash")))
    if known is None or (known.source_text, known.path or "") != (data.attrs["study"], data.attrs.get("study_file")):
        return None
    return known


def robot_of(data: Dataset) -> model.Robot:
    """The robot of a result, whether or not the tables of its motion and load are still there."""
    known = _recalled(data)
    if isinstance(known, model.Study):
        return known.robot
    path = data.attrs.get("study_file") or None
    return model.loads_robot(data.attrs["study"], path=path, files=stored_files(data.attrs))


def march_attributes(
    study: model.Study | model.ActuatorStudy, counters: Counters, record: Record, *, compiled: bool
) -> dict[str, object]:
    """Solver settings and counters of a time integration, and whether it reached its end."""
    s = study.simulation
    error = {} if s.tolerance is None else {"tolerance": s.tolerance, "estimated_error": record.largest_error}
    method = {"integrator": "generalized-alpha, index-3 constraints", "rho_inf": s.rho_inf}
    if s.tolerance is not None and compiled:
        method = {"integrator": "Radau IIA of order 5, rates of the constraints"}
    settings: dict[str, object] = {
        **method,
        "fidelity": s.fidelity,
        "basis": s.lateral_basis if s.lateral_shapes else "none",
        "modes": s.lateral_shapes,
        "compiled": int(compiled),
        "output_step": s.output_step,
        "step": record.smallest_step,
        **error,
    }
    if isinstance(study, model.Study):
        axial = s.axial_shapes(study.robot.legs[0].axial_modes)
        settings |= {"axial_modes": axial, "start": study.initial.start}
    return settings | _cost(counters, record) | _ending(record, study.duration)


def _cost(counters: Counters, record: Record) -> dict[str, object]:
    return {
        "steps": counters.steps,
        "newton_iterations": counters.iterations,
        "factorisations": counters.factorisations,
        "rejected_steps": counters.rejected,
        "wall_time": record.wall_time,
    }


def _ending(record: Record, duration: float) -> dict[str, object]:
    if record.failure is None and not record.interrupted:
        return {"partial": 0}
    reason = "stopped by the user" if record.failure is None else str(record.failure)
    reached = float(record.time[-1])
    if reached < duration * (1 - 1e-9):
        _log.warning("Only %.6g s of %.6g s were computed: %s", reached, duration, reason)
    else:
        _log.warning("All %.6g s were computed, but not as exactly as was asked: %s", duration, reason)
    return {"partial": 1, "failure": reason, "time_reached": reached}


def robot_study(data: Dataset) -> model.Study:
    """The study of a robot that a result carries as text; InputError for that of a single actuator."""
    study = result_study(data)
    if not isinstance(study, model.Study):
        raise InputError("is the result of a single actuator", key="data", allowed="results of a robot")
    return study


def carried_study(data: Dataset) -> model.Study | model.ActuatorStudy | None:
    """The study that a result carries; None where it cannot be read any more, as when a table is gone."""
    try:
        return result_study(data)
    except FlexapodError:
        return None


def motion_end(data: Dataset) -> float | None:
    """Instant from which the rigid payload rests [s]; None where it moves until the end or never."""
    if "com_position_rigid" not in data:
        return None
    path = data.com_position_rigid.values
    away = np.abs(path - path[-1]).max(axis=1)
    moving = np.flatnonzero(away > 1e-9 * max(float(away.max()), 1e-12))
    if not moving.size or moving[-1] >= len(path) - 2:
        return None
    return float(data.time[moving[-1] + 1])


def motion_coordinates(data: Dataset) -> Dataset:
    """Commanded surge, sway, heave [m], roll, pitch, yaw [rad], their rates and accelerations (time, coordinate)."""
    from flexapod.common.datasets import build_dataset

    dims, parts = ("time", "coordinate"), {}
    for name, ending in (("position", ""), ("rate", "_rate"), ("acceleration", "_acceleration")):
        both = [data[f"{kind}_command{ending}"].values for kind in ("translation", "rotation")]
        parts[name] = (dims, np.concatenate(both, axis=1))
    return build_dataset(parts, {"time": data.time, "coordinate": list(model.AXES)})
