"""The single actuator by solid finite elements: a study in, a Dataset out."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.checks import check_actuator_path
from flexapod.analysis.results.arguments import FileLike, read_subject
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.rigid_path import path_instants
from flexapod.analysis.results.time_history import Interrupted, Progress
from flexapod.analysis.results.variables import ACTUATOR_FORMS, Variable, dataset
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.units import quantities
from flexapod.solve.fem.reduction import StationModel, reduced_beam
from flexapod.solve.fem.sliding import HubMotion, SlidingBeam, march_solid_beam

if TYPE_CHECKING:
    from xarray import Dataset

#: Section of the paper's beam (Table 2), which bends along its 9.5 mm: 12 ft x 6 in x 3/8 in.
PAPER_SECTION = model.Rectangle(width=0.1524, height=0.0095)

_FORMS = ACTUATOR_FORMS | {
    "frequency": Variable(("time",), "Hz", "lowest bending frequency at the length and rates of the moment"),
    "static_deflection": Variable(("time",), "m", "deflection of the tip at rest under the loads of the moment"),
}


def simulate_solid(
    study: model.ActuatorStudy | FileLike,
    *,
    section: model.Rectangle | model.Tube | None = None,
    size: float = 0.005,
    kind: str = "hex20",
    poisson: float = 0.0,
    spacing: float | None = None,
    step: float = 1e-3,
    duration: float | None = None,
    output_step: float | None = None,
    progress: Progress | None = None,
) -> Dataset:
    """Motion of a solid beam that slides out of a turning hub.

    E and density are those that give the study's EI and rhoA with the section. The guide holds the section averages of
    deflection and rotation at stations; the solid is condensed onto them.

    Parameters
    ----------
    study : ActuatorStudy or path
        With prescribed rotation and extension, without damping.
    section : Rectangle or Tube, optional
        Default: the study's, else that of the paper's beam. A rectangle bends along its height.
    size : float
        Wanted edge of the elements [m].
    kind : {"hex20", "hex8", "hex8r", "hex8i"}
        Quadratic hexahedra (Abaqus C3D20), or linear ones: with full integration (C3D8), which lock in bending; with
        reduced integration (C3D8R), too soft by 1 / n^2 with n of them across the depth; with incompatible modes
        (C3D8I), which bend like a beam.
    poisson : float
        Poisson's ratio; at 0 the solid is the beam of the other fidelities.
    spacing : float, optional
        Distance of the stations [m]; default a 36th of the beam, at least one element.
    step : float
        Largest time step [s].
    duration, output_step : float, optional
        In place of those of [simulation] [s].
    progress : callable, optional
        Called with simulated and whole time [s].

    Returns
    -------
    xarray.Dataset
        `tip_deflection` (mean of the end section, in the frame of the hub), `length`, `angle` and their rates,
        `frequency`, `static_deflection` over time; mesh, unknowns and times of computation as attributes.

    Raises
    ------
    InputError
        Degenerate meshes, a motion or load that the solid does not take, a beam that leaves its hub.
    Interrupted
        By Ctrl-C, with what was computed.

    Examples
    --------
    >>> data = fx.simulate_solid(fx.preset("paper-actuator"), size=0.02, duration=0.05, step=0.005)
    >>> data.tip_deflection.dims, data.frequency.units
    (('time',), 'Hz')
    """
    study = _only_prescribed(read_subject(study))
    size, spacing, step = _in_si(size, spacing, step, poisson)
    _check_section(section)
    study = model.override(study, duration=duration, output_step=output_step)
    mesh = _Mesh(section or study.actuator.section or PAPER_SECTION, size, kind, poisson, spacing)
    return _simulated(study, mesh, step, progress)


def _in_si(size: Any, spacing: Any, step: Any, poisson: float) -> tuple[Any, Any, Any]:
    """Lengths and time step with texts as SI numbers; what is no number is refused."""
    size, spacing = (quantities(x, "length", key=key) for x, key in ((size, "size"), (spacing, "spacing")))
    step = quantities(step, "time", key="step")
    _check_numbers(size=size, poisson=poisson, step=step, spacing=size if spacing is None else spacing)
    return size, spacing, step


def _check_numbers(**values: float) -> None:
    for key, value in values.items():
        if isinstance(value, bool) or not isinstance(value, int | float | np.number):
            raise InputError("is not a number", key=key, value=value, allowed="an SI number, as 0.005")
    if not (np.isfinite(values["step"]) and values["step"] > 0):
        raise InputError("is not a time step", key="step", value=values["step"], allowed="above 0 s")


def _check_section(section: object) -> None:
    if section is not None and not isinstance(section, model.Rectangle | model.Tube):
        raise InputError(
            "is not a section", key="section", value=section, allowed="flexapod.model.Rectangle(...) or Tube(...)"
        )


class _Mesh(NamedTuple):
    """Parameters of a mesh: section, element size, kind of element, Poisson's ratio, distance of stations."""

    section: model.Rectangle | model.Tube
    size: float
    kind: str
    poisson: float
    spacing: float | None


def _simulated(study: model.ActuatorStudy, mesh: _Mesh, step: float, progress: Progress | None) -> Dataset:
    remarks = check_actuator_path(study)
    begin = time.perf_counter()
    reduced = _reduced(study.actuator, mesh)
    _stays_held(study, reduced)
    middle = time.perf_counter()
    beam, motion, t = _in_hub(study.actuator, reduced), _motion(study), _outputs(study)
    tip = march_solid_beam(beam, motion, study.initial.tip_displacement, t, step, progress)
    attrs = attributes(study, [*study.warnings, *remarks]) | {
        "fidelity": "solid-fem",
        "element": mesh.kind,
        "element_size": mesh.size,
        "poisson": mesh.poisson,
        "unknowns": reduced.unknowns,
        "stations": reduced.stations,
        "station_spacing": reduced.spacing,
        "integrator": "Gauss collocation, order 4",
        "step": step,
        "wall_time_reduction": middle - begin,
        "wall_time": time.perf_counter() - begin,
        "partial": int(len(tip) < len(t)),
    }
    t = t[: len(tip)]
    result = dataset(_results(beam, motion, t, tip), {"time": t}, attrs, _FORMS)
    if attrs["partial"]:
        raise Interrupted(result)
    return result


def _outputs(study: model.ActuatorStudy) -> Array:
    s = study.simulation
    return np.asarray(s.stored_step * np.arange(s.outputs(study.duration) + 1), dtype=float)


def _only_prescribed(study: object) -> model.ActuatorStudy:
    if not isinstance(study, model.ActuatorStudy):
        raise InputError(
            "is not the study of a single actuator", key="study", value=type(study).__name__, allowed="[actuator]"
        )
    study.actuator.refuse_space()
    _laws(study)
    if any(jump < study.duration for jump in study.motion.rate_jumps):
        raise InputError(
            "jumps in rate within the simulated time", key="motion", allowed="laws that are smooth after the start"
        )
    if study.actuator.damping:
        raise InputError("is not taken by the solid", key="actuator.damping", value=study.actuator.damping, allowed="0")
    return study


def _reduced(actuator: model.Actuator, mesh: _Mesh) -> StationModel:
    return reduced_beam(
        mesh.section,
        actuator.length,
        mesh.size,
        E=actuator.EI / mesh.section.second_moment,
        density=actuator.rhoA / mesh.section.area,
        poisson=mesh.poisson,
        kind=mesh.kind,
        spacing=mesh.spacing,
    )


def _in_hub(actuator: model.Actuator, reduced: StationModel) -> SlidingBeam:
    return SlidingBeam(
        model=reduced,
        hub_radius=actuator.hub_radius,
        tip_mass=actuator.tip_mass,
        tip_inertia=actuator.tip_inertia,
        gravity=actuator.gravity,
    )


def _stays_held(study: model.ActuatorStudy, reduced: StationModel) -> None:
    """Refuse a motion at whose ends less than two stations are free or held."""
    free = study.actuator.free_length
    if study.motion.extension is not None:
        free = free + kinematics.motion_law(study.motion.extension, path_instants(study)).position
    low, high = 2 * reduced.spacing, reduced.length - 2 * reduced.spacing
    if np.min(free) < low or np.max(free) > high:
        raise InputError(
            "brings the mouth within two stations of an end of the beam",
            key="motion.extension",
            value=f"free length {np.min(free):.4g} to {np.max(free):.4g} m",
            allowed=f"{low:.4g} to {high:.4g} m",
            next_step="Shorten the motion, or lay the stations closer (spacing)",
        )


def _laws(study: model.ActuatorStudy) -> tuple[model.MotionLaw, model.MotionLaw]:
    rotation, extension = study.motion.rotation, study.motion.extension
    if rotation is None or extension is None:
        raise InputError(
            "leaves rotation or extension free",
            key="motion",
            allowed="both prescribed",
            next_step="The solid takes no driving torque or force: use the other fidelities",
        )
    return rotation, extension


def _motion(study: model.ActuatorStudy) -> Callable[[float], HubMotion]:
    actuator, laws = study.actuator, _laws(study)

    def motion(t: float) -> HubMotion:
        turn, feed = (kinematics.motion_law(law, np.array([t])) for law in laws)
        return HubMotion(
            length=actuator.free_length + float(feed.position[0]),
            length_rate=float(feed.rate[0]),
            length_acceleration=float(feed.acceleration[0]),
            angle=actuator.angle + float(turn.position[0]),
            angle_rate=float(turn.rate[0]),
            angle_acceleration=float(turn.acceleration[0]),
        )

    return motion


def _results(beam: SlidingBeam, motion: Callable[[float], HubMotion], t: Array, tip: Array) -> dict[str, Array]:
    path = [motion(instant) for instant in t.tolist()]
    return {
        "tip_deflection": tip,
        "length": np.array([x.length for x in path]),
        "angle": np.array([x.angle for x in path]),
        "length_rate": np.array([x.length_rate for x in path]),
        "angle_rate": np.array([x.angle_rate for x in path]),
        "frequency": np.array([beam.frequencies(x, 1)[0] for x in path]),
        "static_deflection": np.array([beam.static_deflection(x) for x in path]),
    }
