"""From the tables [motion], [load], [initial], [simulation] of a study file to the model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from flexapod.model.load import ConstantWrench, CsvWrench, Load, SineWrench, StepWrench, Wrench
from flexapod.model.motion import (
    AXES,
    PROFILES,
    AxisMotion,
    CombinedMotion,
    CsvMotion,
    Motion,
    Waypoint,
    WaypointMotion,
)
from flexapod.model.section import Section
from flexapod.model.simulation import FIDELITIES, OWN_BASIS, STRAIGHT, Initial, Simulation, own_fidelity
from flexapod.model.tables import POSE, WRENCH, read_table
from flexapod.typing import Array

__all__ = ["read_initial", "read_load", "read_motion", "read_simulation", "unused_settings"]

_KINDS = (*AXES, "combined", "waypoints", "csv")
_WRENCH = tuple(WRENCH.values())


def read_motion(section: Section) -> Motion:
    """The motion of a robot."""
    section.need("type")
    kind = section.text("type", _KINDS)
    if kind == "combined":
        return _combined(section)
    if kind == "waypoints":
        return _waypoints(section)
    if kind == "csv":
        return _csv(section)
    section.only("type", "amplitude", "duration", "hold", "profile", "pivot")
    return section.build(
        AxisMotion, type=kind, amplitude=section.number("amplitude", POSE[str(kind)]), **_timing(section)
    )


def read_load(section: Section | None) -> Load:
    """The load of a robot."""
    if section is None:
        return Load()
    section.only("wrench")
    section.need("wrench")
    value = section.data["wrench"]
    if isinstance(value, list):
        return Load(wrench=section.build(ConstantWrench, value=section.vector("wrench", *_WRENCH)))
    return Load(wrench=_wrench(section.child(value, "wrench")))


def read_initial(section: Section | None) -> Initial:
    """The start of a robot."""
    if section is None:
        return Initial()
    section.only("start")
    return section.build(Initial, start=section.text("start", ("equilibrium", "straight", "moving")))


def read_simulation(section: Section | None, *, basis: str, bases: tuple[str, ...]) -> Simulation:
    """The simulation settings; `basis` is the default and `bases` are the allowed ones."""
    if section is None:
        return Simulation(basis=basis)
    section.only("fidelity", "basis", "modes", "duration", "tolerance", "step", "output_step", "rho_inf")
    fidelity = section.text("fidelity", FIDELITIES)
    return section.build(
        Simulation,
        fidelity=fidelity,
        basis=_basis(section, bases) or (None if fidelity in OWN_BASIS else basis),
        modes=section.whole("modes"),
        duration=section.number("duration", "time"),
        tolerance=section.number("tolerance", "number"),
        step=section.number("step", "time"),
        output_step=section.number("output_step", "time"),
        rho_inf=section.number("rho_inf", "number"),
    )


def _basis(section: Section, bases: tuple[str, ...]) -> str | None:
    if hint := own_fidelity(section.data.get("basis")):
        raise section.error("is the basis of a fidelity", "basis", allowed=", ".join(bases), next_step=hint)
    return section.text("basis", bases)


def unused_settings(section: Section | None, simulation: Simulation) -> tuple[str, ...]:
    """Notes on settings of the file that the chosen fidelity does not use."""
    if section is None or simulation.fidelity not in STRAIGHT:
        return ()
    return tuple(
        f"simulation.{name} = {section.data[name]!r} has no effect with fidelity {simulation.fidelity!r}"
        for name in ("modes", "basis")
        if name in section
    )


def _timing(section: Section) -> dict[str, object]:
    return {"duration": section.number("duration", "time"), **_path(section)}


def _path(section: Section) -> dict[str, object]:
    return {
        "hold": section.number("hold", "time"),
        "profile": section.text("profile", PROFILES),
        "pivot": section.vector("pivot", "length", "length", "length"),
    }


def _combined(section: Section) -> CombinedMotion:
    section.only("type", "amplitudes", "duration", "hold", "profile", "pivot")
    section.need("amplitudes")
    inner = section.child(section.data["amplitudes"], "amplitudes")
    inner.only(*AXES)
    amplitudes = {axis: inner.number(axis, POSE[axis]) for axis in AXES if axis in inner}
    return section.build(CombinedMotion, amplitudes=amplitudes, **_timing(section))


def _waypoints(section: Section) -> WaypointMotion:
    section.only("type", "points", "hold", "profile", "pivot")
    section.need("points")
    value = section.data["points"]
    if not isinstance(value, list) or not value:
        raise section.error("is not a list of points", "points", allowed="[{ time = .., roll = .. }, ...]")
    points = []
    for i, item in enumerate(value, start=1):
        point = section.child(item, f"points[{i}]")
        point.only("time", *AXES)
        poses = {axis: point.number(axis, POSE[axis]) for axis in AXES}
        points.append(point.build(Waypoint, time=point.number("time", "time"), **poses))
    return section.build(WaypointMotion, points=tuple(points), **_path(section))


def _csv(section: Section) -> CsvMotion:
    section.only("type", "file", "hold", "pivot")
    section.need("file")
    file = str(section.text("file"))
    table = read_table(section.folder / file, POSE)
    return section.build(
        CsvMotion,
        file=file,
        time=table["time"],
        pose=_beside(table, AXES),
        hold=section.number("hold", "time"),
        pivot=section.vector("pivot", "length", "length", "length"),
    )


def _wrench(section: Section) -> Wrench:
    section.need("law")
    law = section.text("law", ("constant", "sine", "step", "csv"))
    if law == "constant":
        section.only("law", "value")
        return section.build(ConstantWrench, value=section.vector("value", *_WRENCH))
    if law == "sine":
        section.only("law", "amplitude", "frequency", "phase")
        return section.build(
            SineWrench,
            amplitude=section.vector("amplitude", *_WRENCH),
            frequency=section.number("frequency", "frequency"),
            phase=section.number("phase", "angle"),
        )
    if law == "step":
        section.only("law", "amplitude", "time")
        return section.build(
            StepWrench, amplitude=section.vector("amplitude", *_WRENCH), time=section.number("time", "time")
        )
    section.only("law", "file")
    section.need("file")
    file = str(section.text("file"))
    table = read_table(section.folder / file, WRENCH, jumps=True)
    return section.build(CsvWrench, file=file, time=table["time"], wrench=_beside(table, WRENCH))


def _beside(table: Mapping[str, Array], names: Iterable[str]) -> Array:
    """Columns of a table side by side; 0 where there is none."""
    return np.column_stack([table.get(name, np.zeros_like(table["time"])) for name in names])
