"""From the table [disturbance] of a study file to the model."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

from flexapod.errors import InputError
from flexapod.model.disturbance import CURVES, Disturbance, Floor, Spectrum, check_density
from flexapod.model.robot import Robot
from flexapod.schema.csv_tables import WRENCH
from flexapod.schema.section import Section
from flexapod.schema.table import Table
from flexapod.typing import Array

__all__ = ["FLOOR", "FORCE_NOISE", "WRENCH_NOISE", "read_disturbance"]

M = TypeVar("M", bound=Table)
KINDS = ("acceleration", "velocity", "displacement")
FLOOR = {kind: dict.fromkeys("xyz", f"{kind} spectrum") for kind in KINDS}
WRENCH_NOISE = {name: f"{dimension} spectrum" for name, dimension in WRENCH.items()}
FORCE_NOISE = {"force": "force spectrum"}


def read_disturbance(top: Section, robot: Robot) -> Disturbance | None:
    """What shakes the robot of a study file."""
    section = top.section("disturbance")
    if section is None:
        return None
    cranks = [leg.carriage is not None and leg.carriage.kind == "crank" for leg in robot.legs]
    drive = [f"{'torque' if crank else 'force'} spectrum" for crank in cranks]
    noise = {f"leg {i}": dimension for i, dimension in enumerate(drive, start=1)}
    noise |= {"force": drive[0]} if len(set(drive)) == 1 else {}
    readers = {
        "floor": _floor,
        "wrench": lambda s: _spectrum(s, Spectrum, WRENCH_NOISE, tuple(WRENCH_NOISE)),
        "force_noise": lambda s: _spectrum(s, Spectrum, noise, tuple(noise)[: len(cranks)]),
    }

    def tables(section: Section) -> dict[str, object]:
        return {name: read(_table(section, name)) for name, read in readers.items() if name in section}

    found = section.read(Disturbance, then=lambda s: dict.fromkeys(readers) | tables(s))
    if found == Disturbance():
        raise InputError("names nothing that shakes", file=top.file, key="disturbance", allowed=", ".join(readers))
    return found


def _table(section: Section, name: str) -> Section:
    """The table under a key; a text stands for its first key."""
    value: Any = section.data[name]
    if isinstance(value, str):
        value = {"curve" if name == "floor" and not value.endswith(".csv") else "spectrum": value}
    return section.child(value, name)


def _floor(section: Section) -> Floor:
    if "curve" not in section:
        of = section.text("of", KINDS) or KINDS[0]
        return _spectrum(section, Floor, FLOOR[of], tuple("xyz"))
    section.only("curve")
    return section.build(Floor.by_curve, curve=section.text("curve", tuple(CURVES)))


def _spectrum(section: Section, model: type[M], columns: dict[str, str], names: tuple[str, ...]) -> M:
    def table(section: Section) -> dict[str, object]:
        found = section.table(columns, name="spectrum", along="frequency")
        frequency = found.pop("frequency")
        if "force" in found and len(found) > 1:
            raise section.error("has 'force' and columns of single legs", "spectrum", allowed="either of the two")
        shown = ("force",) if "force" in found else names
        density: Array = np.column_stack([found.get(name, np.zeros_like(frequency)) for name in shown])
        try:
            check_density(frequency, density)
        except InputError as error:
            raise error.located(file=section.folder / str(section.text("spectrum"))) from None
        return {"frequency": frequency, "density": density}

    return section.read(model, then=table)
