"""From the tables of a single-actuator study file to the model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flexapod.model.actuator import Actuator, ActuatorInitial, ActuatorLoad, ActuatorMotion
from flexapod.model.laws import ConstantLaw, CsvLaw, RateLaw
from flexapod.model.material import Rectangle, Tube, read_material
from flexapod.model.read_motion import read_wrench
from flexapod.schema.columns import columns_of
from flexapod.schema.section import Section

_STIFFNESS = ("rhoA", "EI")
_DRIVEN = {  # what a load drives: the load and its dimension, the dimensions of the motion
    "rotation": ("torque", "torque", ("angle", "angular rate")),
    "extension": ("force", "force", ("length", "velocity")),
    "elevation": ("elevation_torque", "torque", ("angle", "angular rate")),
}


def read_actuator(section: Section) -> Actuator:
    """The beam and its hub."""
    made_of = ("E", "density", "yield_stress", "poisson", "expansion")
    section.only(*columns_of(Actuator), *made_of)
    if "section" not in section:
        section.need(*_STIFFNESS)
        for name in ("section", "material", *made_of):
            if name in section:
                raise section.error("needs a section", name, allowed="rhoA and EI, or section and material")
        return section.read(Actuator, also=made_of)
    for name in _STIFFNESS:
        if name in section:
            raise section.error("is given together with section", name, allowed="rhoA and EI, or section and material")
    return section.read(Actuator, also=made_of, then=_of_section)


def _of_section(section: Section) -> dict[str, object]:
    inner = section.child(section.data["section"], "section")
    model = Rectangle if "width" in inner or "height" in inner else Tube
    shape = inner.read(model, also=("width", "height") if model is Tube else ())
    material = read_material(section)
    return {"section": shape, "material": material, **Actuator.stiffness(shape, material)}


def read_drives(top: Section) -> tuple[ActuatorMotion, ActuatorLoad]:
    """What moves the actuator: a prescribed coordinate or a load on it; a coordinate with neither is held."""
    motion, load = top.section("motion"), top.section("load")
    laws: dict[str, Any] = {}
    loads: dict[str, Any] = {}
    if load is not None:
        load.only(*columns_of(ActuatorLoad))
        if "wrench" in load:
            loads["wrench"] = read_wrench(load)
        if "follow" in load:
            loads["follow"] = load.flag("follow")
    if motion is not None:
        motion.only(*_DRIVEN)
    for name, (drive, dimension, moved) in _DRIVEN.items():
        if load is not None and drive in load:
            loads[drive], laws[name] = _load_law(load, drive, dimension), None
            if motion is not None and name in motion:
                raise motion.error(f"is prescribed and driven by load.{drive}", name, allowed="one of the two")
        elif motion is not None and name in motion:
            laws[name] = _law(motion.child(motion.data[name], name), ActuatorMotion, name, moved)
    moved = ActuatorMotion(**laws) if motion is None else ActuatorMotion(**laws).keep(motion.written)
    return moved, ActuatorLoad() if load is None else load.build(ActuatorLoad, **loads).keep(load.written)


def read_release(section: Section | None) -> ActuatorInitial:
    """The start of a single actuator."""
    return ActuatorInitial() if section is None else section.read(ActuatorInitial)


def _load_law(load: Section, name: str, dimension: str) -> object:
    if not isinstance(load.data[name], Mapping):
        return load.build(ConstantLaw, value=load.number(name, dimension))
    return _law(load.child(load.data[name], name), ActuatorLoad, name, (dimension,))


def _law(section: Section, model: type[ActuatorMotion | ActuatorLoad], name: str, among: tuple[str, ...]) -> object:
    def table(section: Section) -> dict[str, object]:
        found = section.table({"value": among[0]}, needed=True, jumps=model is ActuatorLoad)
        return {"time": found["time"], "value": found["value"]}

    return section.one_of(
        columns_of(model)[name].models,
        among=among,
        default=RateLaw if model is ActuatorMotion else None,
        readers={CsvLaw: lambda s: s.read(CsvLaw, then=table)},
    )
