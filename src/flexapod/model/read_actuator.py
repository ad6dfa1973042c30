"""From the tables of a single-actuator study file to the model."""

from __future__ import annotations

from flexapod.model.actuator import Actuator, ActuatorInitial, ActuatorLoad, ActuatorMotion
from flexapod.model.damping import read_damping
from flexapod.model.laws import (
    ConstantLaw,
    CsvLaw,
    LoadLaw,
    MotionLaw,
    ProfileLaw,
    RateLaw,
    SineLaw,
    SpinUpLaw,
    StepLaw,
)
from flexapod.model.material import Rectangle, Tube
from flexapod.model.motion import PROFILES
from flexapod.model.read_robot import read_material
from flexapod.model.section import Section
from flexapod.model.tables import read_table

__all__ = ["read_actuator", "read_drives", "read_release"]

_NUMBERS = {
    "length": "length",
    "free_length": "length",
    "tip_mass": "mass",
    "tip_inertia": "inertia",
    "hub_inertia": "inertia",
    "hub_radius": "length",
    "angle": "angle",
    "gravity": "acceleration",
}
_INITIAL = {"tip_displacement": "length", "angle_rate": "angular rate", "length_rate": "velocity"}
_RATES = {"angle": "angular rate", "length": "velocity"}


def read_actuator(section: Section) -> Actuator:
    """The beam and its hub."""
    stiffness, made_of = ("rhoA", "EI"), ("section", "material", "E", "density", "yield_stress", "poisson")
    section.only(*_NUMBERS, "damping", *stiffness, *made_of)
    numbers = {name: section.number(name, dimension) for name, dimension in _NUMBERS.items()}
    fields = numbers | {"damping": read_damping(section)}
    if "section" not in section:
        section.need(*stiffness)
        for name in made_of:
            if name in section:
                raise section.error("needs a section", name, allowed="rhoA and EI, or section and material")
        line, bending = section.number("rhoA", "line density"), section.number("EI", "bending stiffness")
        return section.build(Actuator, rhoA=line, EI=bending, **fields)
    for name in stiffness:
        if name in section:
            raise section.error("is given together with section", name, allowed="rhoA and EI, or section and material")
    shape = _shape(section.child(section.data["section"], "section"))
    return section.build(Actuator.from_section, section=shape, material=read_material(section), **fields)


def read_drives(top: Section) -> tuple[ActuatorMotion, ActuatorLoad]:
    """What moves the actuator: a prescribed coordinate or a load on it; a coordinate with neither is held."""
    motion, load = top.section("motion"), top.section("load")
    laws: dict[str, MotionLaw | None] = {"rotation": RateLaw(rate=0.0), "extension": RateLaw(rate=0.0)}
    loads: dict[str, LoadLaw] = {}
    if load is not None:
        load.only("torque", "force")
        for name, freed, dimension in (("torque", "rotation", "torque"), ("force", "extension", "force")):
            if name in load:
                loads[name] = _load_law(load, name, dimension)
                laws[freed] = None
    if motion is not None:
        motion.only("rotation", "extension")
        for name, load_name, dimension in (("rotation", "torque", "angle"), ("extension", "force", "length")):
            if name in motion and load_name in loads:
                raise motion.error(f"is prescribed and driven by load.{load_name}", name, allowed="one of the two")
            if name in motion:
                laws[name] = _motion_law(motion.child(motion.data[name], name), dimension)
    return ActuatorMotion(**laws), ActuatorLoad(**loads)


def read_release(section: Section | None) -> ActuatorInitial:
    """The start of a single actuator."""
    if section is None:
        return ActuatorInitial()
    section.only(*_INITIAL)
    return section.build(ActuatorInitial, **{name: section.number(name, kind) for name, kind in _INITIAL.items()})


def _shape(section: Section) -> Tube | Rectangle:
    if "width" in section or "height" in section:
        section.only("width", "height")
        return section.build(
            Rectangle, width=section.number("width", "length"), height=section.number("height", "length")
        )
    section.only("diameter", "inner_diameter", "width", "height")
    return section.build(
        Tube,
        diameter=section.number("diameter", "length"),
        inner_diameter=section.number("inner_diameter", "length"),
    )


def _motion_law(section: Section, dimension: str) -> MotionLaw:
    if "law" not in section:
        section.only("rate", "law", "amplitude", "duration")
        section.need("rate")
        law = "rate"
    else:
        law = section.text("law", ("rate", "spin-up", "csv", *PROFILES))
    if law == "rate":
        section.only("law", "rate")
        return section.build(RateLaw, rate=section.number("rate", _RATES[dimension]))
    if law == "spin-up":
        section.only("law", "rate", "duration")
        return section.build(
            SpinUpLaw, rate=section.number("rate", _RATES[dimension]), duration=section.number("duration", "time")
        )
    return _csv(section, dimension, jumps=False) if law == "csv" else _profile(section, str(law), dimension)


def _load_law(load: Section, name: str, dimension: str) -> LoadLaw:
    if not isinstance(load.data[name], dict):
        return load.build(ConstantLaw, value=load.number(name, dimension))
    section = load.child(load.data[name], name)
    section.need("law")
    law = section.text("law", ("constant", "sine", "step", "csv", *PROFILES))
    if law == "constant":
        section.only("law", "value")
        return section.build(ConstantLaw, value=section.number("value", dimension))
    if law == "sine":
        section.only("law", "amplitude", "frequency", "phase")
        return section.build(
            SineLaw,
            amplitude=section.number("amplitude", dimension),
            frequency=section.number("frequency", "frequency"),
            phase=section.number("phase", "angle"),
        )
    if law == "step":
        section.only("law", "amplitude", "time")
        return section.build(
            StepLaw, amplitude=section.number("amplitude", dimension), time=section.number("time", "time")
        )
    return _csv(section, dimension, jumps=True) if law == "csv" else _profile(section, str(law), dimension)


def _profile(section: Section, law: str, dimension: str) -> ProfileLaw:
    section.only("law", "amplitude", "duration")
    return section.build(
        ProfileLaw,
        law=law,
        amplitude=section.number("amplitude", dimension),
        duration=section.number("duration", "time"),
    )


def _csv(section: Section, dimension: str, *, jumps: bool) -> CsvLaw:
    section.only("law", "file")
    section.need("file")
    file = str(section.text("file"))
    table = read_table(section.folder / file, {"value": dimension}, needed=True, jumps=jumps)
    return section.build(CsvLaw, file=file, time=table["time"], value=table["value"])
