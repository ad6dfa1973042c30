"""From the tables [motion], [load], [initial], [simulation] of a study file to the model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from flexapod.model.laws import ConstantWrench, CsvWrench, Load, SineWrench, StepWrench, Wrench
from flexapod.model.motion import AXES, AxisMotion, CombinedMotion, CsvMotion, Motion, Waypoint, WaypointMotion
from flexapod.model.simulation import FIDELITIES, OWN_BASIS, STRAIGHT, Initial, Simulation, own_fidelity
from flexapod.schema.csv_tables import POSE, WRENCH
from flexapod.schema.section import Section
from flexapod.typing import Array


def read_motion(section: Section) -> Motion:
    """The motion of a robot."""
    return section.one_of(
        (AxisMotion, CombinedMotion, WaypointMotion, CsvMotion),
        readers={
            AxisMotion: lambda s: s.read(AxisMotion, among=(POSE[str(s.text("type"))],), then=_independent),
            CombinedMotion: lambda s: s.read(CombinedMotion, then=lambda s: _amplitudes(s) | _independent(s)),
            WaypointMotion: lambda s: s.read(WaypointMotion, then=lambda s: _points(s) | _independent(s)),
            CsvMotion: lambda s: s.read(CsvMotion, then=lambda s: _poses(s) | _independent(s)),
        },
    )


def _independent(section: Section) -> dict[str, object]:
    return {"independent": section.words("independent", AXES)}


def _amplitudes(section: Section) -> dict[str, object]:
    inner = section.section("amplitudes")
    if inner is None:
        return {}
    inner.only(*AXES)
    return {"amplitudes": {axis: inner.number(axis, POSE[axis]) for axis in AXES if axis in inner}}


def _points(section: Section) -> dict[str, object]:
    value = section.data.get("points")
    if value is None:
        return {}
    if not isinstance(value, list) or not value:
        raise section.error("is not a list of points", "points", allowed="[{ time = .., roll = .. }, ...]")
    points = (section.child(item, f"points[{i}]") for i, item in enumerate(value, start=1))
    return {"points": tuple(point.read(Waypoint) for point in points)}


def _poses(section: Section) -> dict[str, object]:
    table = section.table(POSE)
    return {"time": table["time"], "pose": _beside(table, AXES)}


def read_load(section: Section | None) -> Load:
    """The load of a robot."""
    if section is None:
        return Load()
    section.only("wrench")
    section.need("wrench")
    return section.build(Load, wrench=read_wrench(section)).keep(section.written)


def read_wrench(section: Section) -> Wrench:
    """The key `wrench` of a table [load]: six numbers, or a law."""
    value = section.data["wrench"]
    if isinstance(value, list):
        return section.build(ConstantWrench, value=section.vector("wrench", *WRENCH.values()))
    kinds = (ConstantWrench, SineWrench, StepWrench, CsvWrench)
    csv = {CsvWrench: lambda s: s.read(CsvWrench, then=_wrenches)}
    return section.child(value, "wrench").one_of(kinds, readers=csv)


def _wrenches(section: Section) -> dict[str, object]:
    table = section.table(WRENCH, jumps=True)
    return {"time": table["time"], "wrench": _beside(table, WRENCH)}


def read_initial(section: Section | None) -> Initial:
    """The start of a robot."""
    return Initial() if section is None else section.read(Initial)


def read_simulation(section: Section | None, *, basis: str, bases: tuple[str, ...]) -> Simulation:
    """The simulation settings; `basis` is the default and `bases` are the allowed ones."""
    if section is None:
        return Simulation(basis=basis)

    def choices(section: Section) -> dict[str, object]:
        fidelity = section.text("fidelity", FIDELITIES)
        return {
            "fidelity": fidelity,
            "basis": _basis(section, bases) or (None if fidelity in OWN_BASIS else basis),
        }

    return section.read(Simulation, then=choices)


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


def _beside(table: Mapping[str, Array], names: Iterable[str]) -> Array:
    """Columns of a table side by side; 0 where there is none."""
    return np.column_stack([table.get(name, np.zeros_like(table["time"])) for name in names])
