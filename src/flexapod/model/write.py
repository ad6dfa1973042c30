"""From the model back to a study file in SI units: what was computed, whoever changed what on the way."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexapod.model.joint import Carriage, Joint
from flexapod.model.leg import Leg
from flexapod.model.payload import Payload
from flexapod.model.robot import Robot
from flexapod.schema.axes import word_of
from flexapod.schema.table import Table, plain
from flexapod.schema.toml import toml_text
from flexapod.typing import Array


def to_toml(study: Table) -> str:
    """The study as TOML text; read again, it is the same study.

    What was read from a text and not changed since stands there as it was written, key by key; all else in SI units,
    numbers to the last digit. Tables stay in the CSV files they came from; one given from Python is named ``table.csv``
    and must be saved there by whoever wants to read the text again.

    Parameters
    ----------
    study : Study or ActuatorStudy
        The study.

    Returns
    -------
    str
        The text, its tables one after the other.
    """
    return "# Written by flexapod\n" + toml_text(_tables(study))


def _tables(study: Table) -> dict[str, Any]:
    if study.written is not None and not study.written.changed:
        return dict(study.written.data)
    found: dict[str, object] = {}
    for name in type(study).model_fields:
        part = getattr(study, name)
        found |= _robot(part) if isinstance(part, Robot) else {name: part} if isinstance(part, Table) else {}
    tables = {name: plain(part) for name, part in study.data(found).items()}
    return {name: table for name, table in tables.items() if table}


def _robot(robot: Robot) -> dict[str, Any]:
    home, fixed = robot.home, {"fixed": True} if robot.platform_fixed else {}
    above = not (home.rotation.any() or home.position[:2].any())
    places = zip(robot.legs, robot.base_joints, robot.platform_joints, strict=True)
    legs = [plain(_leg(leg, base, platform, robot.normal)) for leg, base, platform in places]
    alike = all(leg == legs[0] for leg in legs) and len({leg.chain for leg in robot.legs}) == 1
    geometry = {
        "type": robot.type,
        **({"plane": robot.plane} if robot.plane else {}),
        "base": {"joints": robot.base_joints},
        "platform": {"joints": robot.platform_joints, **fixed},
        **({"home_height": robot.home_height} if above else {"home": home}),
        "gravity": robot.gravity,
        **{name: mount for name, mount in _mounts(robot)},
    }
    beside = {
        "payload": robot.payload and _payload(robot.payload),
        "leg": legs[0] if alike else legs,
        **{name: part for name in ("geometry", "heat", "tolerances") if (part := getattr(robot, name)) is not None},
    }
    found = robot.data(geometry | {name: part for name, part in beside.items() if part is not None})
    tables = {name: plain(found[name]) for name in found if name in beside}
    return {"robot": plain({name: found[name] for name in found if name not in beside}), **tables}


def _payload(payload: Payload) -> dict[str, object]:
    return payload.data(payload.told() | {"inertia": _diagonal(payload.inertia)})


def _mounts(robot: Robot) -> Iterator[tuple[str, object]]:
    for name in ("base_mount", "platform_mount"):
        if (mount := getattr(robot, name)) is not None:
            short = {key: _diagonal(value) for key, value in mount.told().items()}
            given = {key: value for key, value in short.items() if key == "loss" or np.asarray(value).any()}
            yield name, mount.data(given)
    if robot.base_motion is not None:
        yield "base_motion", robot.base_motion


def _diagonal(value: object) -> object:
    """A diagonal matrix as its diagonal."""
    if not isinstance(value, np.ndarray) or value.ndim != 2:
        return value
    return np.diag(value) if not (value - np.diag(np.diag(value))).any() else value


def _leg(leg: Leg, base: Array, platform: Array, normal: Array) -> dict[str, object]:
    fields = leg.told()
    del fields["chain"]  # the robot's type has it
    if leg.letters.platform and not leg.passive:
        del fields["passive"]
    if leg.passive:
        del fields["drive"]
    for name, place in (("base_joint", base), ("platform_joint", platform)):
        fields[name] = _joint(getattr(leg, name), place, normal)
        if not fields[name]:
            del fields[name]
    del fields["springs"]
    if leg.springs:
        fields["springs"] = {spring.name: spring for spring in leg.springs}
    for kind in dict.fromkeys(type(element) for element in leg.elements):
        own = kind.all_of(leg)
        fields[kind.at] = own[0] if len(own) == 1 else list(own)
    if leg.carriage is not None:
        fields["carriage"] = _carriage(leg.carriage, base, normal)
    if leg.strut is None:
        return leg.data(fields)
    del fields["cylinder"], fields["piston"]
    return leg.data(fields)


def _joint(joint: Joint, place: Array, normal: Array) -> dict[str, object]:
    return joint.data(_of_joint(joint, place, normal))


def _of_joint(joint: Joint, place: Array, normal: Array) -> dict[str, object]:
    fields = joint.told()
    if joint.axis is not None:
        fields["axis"] = word_of(joint.axis, place, normal) or joint.axis
    given = {"damping": joint.stiffness_damping, "loss": joint.stiffness_loss}
    own = {name: value for name, value in given.items() if value}
    if joint.rolling is not None:
        fields["stiffness"] = joint.rolling
    elif joint.leg_axes and joint.stiffness is not None:
        along, across = float(joint.stiffness[2, 2]), float(joint.stiffness[0, 0])
        fields["stiffness"] = {"axial": along, "radial": across, **own}
    elif joint.stiffness is not None and own:
        turns = joint.stiffness[3:].any()
        fields["stiffness"] = {"rows": joint.stiffness if turns else joint.stiffness[:3, :3], **own}
    elif joint.across_and_along is not None:
        fields["stiffness"] = joint.across_and_along[0]
    return fields


def _carriage(carriage: Carriage, place: Array, normal: Array) -> dict[str, object]:
    unused = "mass" if carriage.kind == "crank" else "inertia"
    fields = {name: value for name, value in carriage.told().items() if name != unused or value}
    return carriage.data({carriage.kind: word_of(carriage.axis, place, normal) or carriage.axis, **fields})
