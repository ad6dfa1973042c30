"""A single actuator's study before it is computed: lengths, slenderness, frequencies, sag."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.checks import check_actuator_path
from flexapod.analysis.results.rigid_path import path_instants
from flexapod.common.errors import FlexapodError
from flexapod.solve.modal.actuator_modes import actuator_modes

SHOWN = 4


@dataclass(frozen=True, kw_only=True)
class BeamDescription:
    """The beam at one free length, SI units, hub and extension held.

    `frequency` [Hz], `damping_ratio` and `kind` of the lowest modes of each kind about the straight beam at rest, or
    `problem` in words;
    `slenderness`: free length over depth, None without a section; `sag`: of the tip where the beam lies level, by
    rhoA g s^4 / 8 EI + m g s^3 / 3 EI.
    """

    name: str
    free_length: float
    frequency: tuple[float, ...]
    damping_ratio: tuple[float, ...]
    kind: tuple[str, ...]
    slenderness: float | None
    sag: float
    problem: str | None = None

    @property
    def by_kind(self) -> list[tuple[str, str, str]]:
        """Kind, frequencies [Hz] and damping ratios [%] in figures."""
        rows = []
        for kind in dict.fromkeys(self.kind):
            chosen = [i for i, other in enumerate(self.kind) if other == kind]
            frequency = ", ".join(f"{self.frequency[i]:.4g}" for i in chosen)
            rows.append((kind, frequency, ", ".join(f"{100 * self.damping_ratio[i]:.2g}" for i in chosen)))
        return rows


@dataclass(frozen=True, kw_only=True)
class ActuatorDescription:
    """Description of a single actuator, as `describe` returns it; `driven`: the coordinates that a load drives."""

    kind: str = "actuator"
    file: str | None
    duration: float
    fidelity: str
    driven: tuple[str, ...]
    angles: tuple[float, float] | None
    free_lengths: tuple[float, float] | None
    beam: tuple[BeamDescription, ...]
    tip_displacement: float
    elevations: tuple[float, float] | None
    elevation_displacement: float
    elevation_rate: float
    angle_rate: float
    length_rate: float
    remarks: tuple[str, ...]

    def as_dict(self) -> dict[str, object]:
        """Description as plain data."""
        return asdict(self)


def describe_actuator(study: model.ActuatorStudy) -> ActuatorDescription:
    """Describe the study of a single actuator: ranges of its path, beam, displacements, rates, remarks.

    Raises
    ------
    InputError
        A beam that leaves its hub.
    """
    remarks, actuator, t = check_actuator_path(study), study.actuator, path_instants(study)
    rotation, extension = study.motion.rotation, study.motion.extension
    angles = lengths = elevations = None
    if actuator.space and study.motion.elevation is not None:
        raised = actuator.elevation + kinematics.motion_law(study.motion.elevation, t).position
        elevations = (float(raised[0]), float(raised[-1]))
    if rotation is not None:
        turned = actuator.angle + kinematics.motion_law(rotation, t).position
        angles = (float(turned[0]), float(turned[-1]))
    places = {"at the start": actuator.free_length}
    if extension is not None:
        free = actuator.free_length + kinematics.motion_law(extension, t).position
        lengths = (float(free.min()), float(free.max()))
        same = 1e-9 * actuator.length
        named = {"at the end": float(free[-1]), "shortest": lengths[0], "longest": lengths[1]}
        for name, length in named.items():
            if all(abs(length - other) > same for other in places.values()):
                places[name] = length
    return ActuatorDescription(
        file=study.path,
        duration=study.duration,
        fidelity=study.simulation.fidelity,
        driven=tuple(name for name in model.DRIVEN_BY if getattr(study.motion, name) is None),
        angles=angles,
        free_lengths=lengths,
        beam=tuple(_beam(study, name, length) for name, length in places.items()),
        tip_displacement=study.initial.tip_displacement,
        elevations=elevations,
        elevation_displacement=study.initial.elevation_displacement,
        elevation_rate=study.initial.elevation_rate,
        angle_rate=study.initial.angle_rate,
        length_rate=study.initial.length_rate,
        remarks=(*study.warnings, *remarks),
    )


def _beam(study: model.ActuatorStudy, name: str, free: float) -> BeamDescription:
    a = study.actuator
    frequency, ratio, kinds, problem = np.zeros(0), np.zeros(0), (), None
    try:
        found = actuator_modes(a, study.simulation, free_length=free)
        shown = [i for i, kind in enumerate(found.kind) if found.kind[:i].count(kind) < SHOWN]
        frequency, ratio, kinds = found.frequency[shown], found.damping_ratio[shown], [found.kind[i] for i in shown]
    except FlexapodError as error:
        problem = str(error)
    return BeamDescription(
        name=name,
        free_length=free,
        frequency=tuple(frequency.tolist()),
        damping_ratio=tuple((ratio + 0.0).tolist()),
        kind=tuple(kinds),
        slenderness=None if a.section is None else free / a.section.depth,
        sag=abs(a.gravity) * (a.rhoA * free**4 / 8 + a.tip_mass * free**3 / 3) / a.EI,
        problem=problem,
    )
