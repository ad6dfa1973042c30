"""The single actuator, in its plane or in space: a study in, a Dataset out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod import model
from flexapod.analysis.checks.checks import check_actuator_path
from flexapod.analysis.checks.plausibility import actuator_warnings
from flexapod.analysis.results.arguments import FileLike, read_subject
from flexapod.analysis.results.attributes import attributes, march_attributes
from flexapod.analysis.results.robot_results import energy_results
from flexapod.analysis.results.time_history import Progress, Record, check_progress, collect, result_or_interrupt
from flexapod.analysis.results.variables import ACTUATOR_FORMS, DIRECTIONS, SPACE_FORMS, dataset
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.solve.batch import tips
from flexapod.solve.shapes import amplitudes, lateral_signs, places
from flexapod.solve.time.actuator_march import ActuatorMarch, prepare_actuator

if TYPE_CHECKING:
    from xarray import Dataset


#: What a motion moves, in results.
_DRIVEN = {"rotation": "angle", "elevation": "elevation", "extension": "length"}


@one_thread()
def simulate_actuator(
    actuator: model.Actuator | model.ActuatorStudy | FileLike,
    motion: model.ActuatorMotion | None = None,
    *,
    load: model.ActuatorLoad | None = None,
    initial: model.ActuatorInitial | None = None,
    fidelity: str | None = None,
    modes: int | None = None,
    basis: str | None = None,
    tolerance: float | None = None,
    step: float | None = None,
    duration: float | None = None,
    output_step: float | None = None,
    rho_inf: float | None = None,
    progress: Progress | None = None,
) -> Dataset:
    """Motion of a beam that slides out of a turning hub.

    Parameters
    ----------
    actuator : Actuator, ActuatorStudy or path
        An actuator with its motion (or load), a whole study, or its file.
    motion : ActuatorMotion, optional
        In place of the study's.
    load : ActuatorLoad, optional
        Torque and axial force; a coordinate that is driven so must not be prescribed in `motion`.
    initial : ActuatorInitial, optional
        In place of the study's.
    fidelity, modes, basis, tolerance, step, duration, output_step, rho_inf : optional
        In place of those of [simulation]; times in s.
    progress : callable, optional
        Called with simulated and whole time [s].

    Returns
    -------
    xarray.Dataset
        `tip_deflection`, `length`, `angle`, `mode_amplitude`, energies, `torque`, `force` over time, SI units; in space
        the deflection has a direction, and there are `elevation`, `elevation_torque`, `tip_stretch`, `tip_twist`.
        ``partial = 1`` in the attributes if the integration stopped before its end.

    Raises
    ------
    InputError
        The beam leaves its hub, or settings do not fit.
    ComputationError
        The first steps fail.
    Interrupted
        By Ctrl-C, with what was computed.

    Examples
    --------
    >>> data = fx.simulate_actuator(fx.preset("paper-actuator"), modes=2)
    >>> print(f"{1e3 * float(abs(data.tip_deflection).max()):.1f} mm")
    13.8 mm
    """
    settings = {
        "fidelity": fidelity, "modes": modes, "basis": basis, "tolerance": tolerance, "step": step,
        "duration": duration, "output_step": output_step, "rho_inf": rho_inf,
    }  # fmt: skip
    study = _as_study(actuator, motion, load, initial, settings)
    return _simulated(study, progress)


def _simulated(study: model.ActuatorStudy, progress: Progress | None) -> Dataset:
    check_progress(progress)
    remarks = check_actuator_path(study)
    march = prepare_actuator(study)
    angles = range(march.system.kernel.shapes.l_index, -1, -1)  # l, and backwards the angles of the hub before it
    record = collect(march.chunks, angles, study.duration, progress)
    return result_or_interrupt(lambda: _dataset(study, march, record, remarks), record)


def _dataset(study: model.ActuatorStudy, march: ActuatorMarch, record: Record, remarks: list[str]) -> Dataset:
    warnings = [*study.warnings, *remarks, *actuator_warnings(study.actuator, march.system.kernel.shapes, record)]
    attrs = {
        **attributes(study, warnings),
        **march_attributes(study, march.counters, record, compiled=march.system.kernel.library is not None),
    }
    count = march.system.kernel.shapes.beam.a.count
    coords: dict[str, ArrayLike] = {"time": record.time}
    if count:
        coords["mode"] = np.arange(1, count + 1)
    if study.actuator.space:
        coords["direction"] = list(DIRECTIONS)
    forms = {**ACTUATOR_FORMS, **(SPACE_FORMS if study.actuator.space else {})}
    return dataset(_results(study, march, record), coords, attrs, forms)


def _as_study(
    actuator: model.Actuator | model.ActuatorStudy | FileLike,
    motion: model.ActuatorMotion | None,
    load: model.ActuatorLoad | None,
    initial: model.ActuatorInitial | None,
    settings: dict[str, object],
) -> model.ActuatorStudy:
    actuator = read_subject(actuator)  # type: ignore[assignment]
    given = {"motion": motion, "load": load, "initial": initial}
    changes = {name: value for name, value in given.items() if value is not None}
    if isinstance(actuator, model.ActuatorStudy):
        changed = actuator.replace(**changes) if changes else actuator
    elif isinstance(actuator, model.Actuator):
        # A motion without an end of its own needs the duration before the study can be made.
        known = {} if settings["duration"] is None else {"duration": settings["duration"]}
        simulation = model.Simulation(basis="clamped-free", **known)
        changed = model.ActuatorStudy(actuator=actuator, simulation=simulation, **changes)  # type: ignore[arg-type]
    else:
        raise InputError(
            "is neither an actuator nor the study of one",
            key="actuator",
            value=type(actuator).__name__,
            allowed="flexapod.load(FILE), its .actuator, or FILE itself",
        )
    return model.override(changed, **settings)  # type: ignore[arg-type]


def _results(study: model.ActuatorStudy, march: ActuatorMarch, record: Record) -> dict[str, Array]:
    """All variables of a simulation; deflections towards larger angles, in space also towards elevations, (T9.9)."""
    shapes, q, hub = march.system.kernel.shapes, record.q[:, 0], study.actuator.hub_radius
    bent = np.stack([sign * amplitudes(shapes, q, name) for name, sign in lateral_signs(shapes, 1.0, 1.0)], axis=1)
    if shapes.chain.planar:
        bent = bent[:, 0]
    at = places(shapes)
    results = {"tip_deflection": bent @ shapes.beam.a.tip} | {_DRIVEN[motion]: q[:, i] for motion, i in at.items()}
    results |= {f"{_DRIVEN[motion]}_rate": record.rate[:, 0, shapes.l_index - i] for motion, i in at.items()}
    if shapes.beam.a.count:
        results["mode_amplitude"] = bent
    if shapes.chain.planar:
        place = _tip(results["angle"], results["length"], results["tip_deflection"], bent, shapes.beam.a.slope_tip, hub)
        results["tip_position"] = place
    else:
        results["tip_position"] = tips(march.system, record.q)[:, 0]
        for name, part in (("tip_stretch", "c"), ("tip_twist", "t")):
            results[name] = q[:, shapes.index(part)] if dict(shapes.layout).get(part) else np.zeros(len(q))
    results |= {model.DRIVEN_BY[motion]: record.drive[:, 0, k] for k, motion in enumerate(at)}
    return results | {"length": results["length"] - hub} | energy_results(record)


def _tip(beta: Array, length: Array, v: Array, a: Array, slopes: Array, hub: float) -> Array:
    """Tip in the plane of motion, (T, 2) [m], with the foreshortening of the bent beam, Eqs. (T3.11), (T8.9)."""
    along = length - 0.5 * np.einsum("ti,ij,tj->t", a, slopes, a) / (length - hub)
    c, s = np.cos(beta), np.sin(beta)
    return np.stack([along * c - v * s, along * s + v * c], axis=1)
