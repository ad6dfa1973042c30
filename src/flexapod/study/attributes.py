"""Attributes of Datasets: version, the whole study, solver settings, what it cost, warnings."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Iterable

from flexapod import model, version
from flexapod.solve.plant import Counters
from flexapod.study.record import Record

__all__ = ["attributes", "march_attributes"]

_log = logging.getLogger("flexapod")


def attributes(study: model.Study | model.ActuatorStudy, warnings: Iterable[str] = ()) -> dict[str, object]:
    """Attributes that every Dataset of a study carries; warnings as lines of text."""
    content = study.model_dump_json(exclude={"source_text", "path", "notes"})  # with the tables that the text names
    found = list(dict.fromkeys(warnings))
    return {
        "title": "flexapod: single actuator" if isinstance(study, model.ActuatorStudy) else "flexapod: parallel robot",
        "flexapod_version": version.__version__,
        "study": study.source_text,
        "study_file": study.path or "",
        "study_hash": hashlib.sha256(content.encode()).hexdigest()[:16],
        "warnings": "\n".join(found),
    }


def march_attributes(
    study: model.Study | model.ActuatorStudy, counters: Counters, record: Record, *, compiled: bool
) -> dict[str, object]:
    """Solver settings and counters of a time integration, and whether it reached its end."""
    s = study.simulation
    error = {} if s.tolerance is None else {"tolerance": s.tolerance, "estimated_error": record.largest_error}
    settings: dict[str, object] = {
        "integrator": "generalized-alpha, index-3 constraints",
        "rho_inf": s.rho_inf,
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
    _log.warning("Only %.6g s of %.6g s were computed: %s", record.time[-1], duration, reason)
    return {"partial": 1, "failure": reason, "time_reached": float(record.time[-1])}
