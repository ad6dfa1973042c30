"""Checks that a robot must pass before its kinematics are looked at: counts, places, lengths at home."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.axes import plane_order
from flexapod.common.units import DIMENSIONS
from flexapod.model.leg.chain import chains_of

if TYPE_CHECKING:
    from flexapod.model.leg.leg import Leg
    from flexapod.model.study.robot import Robot


def check_counts(robot: Robot) -> None:
    """Refuse a number of legs or joints that the type does not have, and legs that one robot cannot have together."""
    try:
        chains = chains_of(robot.type)
    except InputError as error:
        raise error.with_location(prefix="robot.type") from None
    found = tuple(leg.chain for leg in robot.legs)
    if found != chains:
        words = f"says {', '.join(chains)}; the legs are {', '.join(found)}"
        if len(found) != len(chains):
            words = f"says {len(chains)} legs, and there are {len(found)}"
        raise InputError(words, key="robot.type", value=robot.type, allowed="as many legs as the type says")
    for name, joints in (("base", robot.base_joints), ("platform", robot.platform_joints)):
        if len(joints) != len(chains):
            raise InputError(
                f"has {len(joints)} joints for {len(chains)} legs",
                key=f"robot.{name}",
                allowed="one for each leg, in the order of the legs",
            )
    if robot.payload is None and not robot.platform_fixed:
        raise InputError("is missing", key="payload", next_step="Only a platform with fixed = true needs none")
    for name, values in (
        ("axial_modes", {leg.axial_modes for leg in robot.legs}),
        ("carriage", {leg.carriage.kind for leg in robot.legs if leg.carriage is not None}),
    ):
        if len(values) > 1:
            allowed = "one number for all legs" if name == "axial_modes" else "sliders or cranks, not both in one robot"
            raise InputError("differs between legs", key=f"leg.{name}", value=sorted(values), allowed=allowed)
    inside = {
        "guide": [leg.guide for leg in robot.legs],
        "cylinder.diameter": [leg.cylinder.section for leg in robot.legs],
    }
    for name, parts in inside.items():
        if any(part is not None for part in parts) and any(leg.piston.shear for leg in robot.legs):
            raise InputError(
                "does not go together with pistons that shear",
                key=f"leg.{name}",
                allowed="slender pistons, or thick ones clamped at the mouths of rigid cylinders",
            )


def check_built(robot: Robot) -> None:
    """Refuse errors and temperatures of what the robot does not have."""
    geometry, heat, count = robot.geometry, robot.heat, robot.count
    if geometry is not None:
        geometry.check(count, robot.normal if robot.plane else None)
        if geometry.lead is not None and np.abs(geometry.lead).max() > MOST_ERROR:
            raise InputError(
                "is not an error of a lead: real over called travel, less 1", key="geometry.lead",
                value=geometry.lead.tolist(), allowed=f"at most {MOST_ERROR:g} in size; class C10 is 7e-4",
            )  # fmt: skip
        if geometry.lead is not None and not any(_has_lead(leg) for leg in robot.legs):
            raise InputError(
                "is of drives that this robot does not have", key="geometry.lead", allowed="driven strokes and sliders"
            )
    if heat is not None:
        heat.check(count)
        if heat.warms("cylinder") and all(leg.strut is not None for leg in robot.legs):
            raise InputError("is of a part that no leg has", key="heat.cylinder", next_step="A strut is a piston here")
        if heat.gradient is not None and not all(leg.swings for leg in robot.legs):
            raise InputError(
                "bends legs whose joints carry moments, and what that does is not known here",
                key="heat.gradient",
                allowed="legs UPS, SPS and their like",
            )
        if heat.warms("screw") and all(leg.drive.type != "screw" for leg in robot.legs):
            raise InputError(
                "is of a part that no leg has", key="heat.screw", allowed='legs whose drive has type = "screw"'
            )


def check_tolerances(robot: Robot) -> None:
    """Refuse scatter of bending where joints carry moments."""
    given = robot.tolerances
    for name in ("EI", "bow") if given is not None else ():
        if getattr(given, name) is not None and not all(leg.swings for leg in robot.legs):
            raise InputError(
                "is of legs whose joints carry moments, and what that does is not known here",
                key=f"tolerances.{name}",
                allowed="legs UPS, SPS and their like",
            )
    most = MOST_ERROR * float(np.min(robot.home_lengths))
    lengths = {name: (most, f"{most:.4g} m") for name in ("base_joints", "platform_joints", "leg_offset", "bow")}
    for name, (bound, words) in {**lengths, "lead": (MOST_ERROR, f"{MOST_ERROR:g}")}.items():
        spread = getattr(given, name, None)
        size = 0.0 if spread is None else max(spread.sigma or 0.0, spread.box or 0.0)
        if size > bound:
            raise InputError(
                "is not an error of a machine: another one would be built", key=f"tolerances.{name}", value=size,
                allowed=f"at most {words}, {100 * MOST_ERROR:g} % of the shortest leg at home or of the travel",
            )  # fmt: skip


def check_springs(robot: Robot) -> None:
    """Refuse springs along legs that are held across, where flexures of other legs give displacements fixed axes."""
    if not any(joint.flexes for leg in robot.legs for joint in (leg.base_joint, leg.platform_joint)):
        return
    for i, leg in enumerate(robot.legs, start=1):
        if leg.measured == "joint-to-joint":
            raise InputError(
                f"leg {i}: holds displacements of joints along the leg, and those of flexures have axes of base and "
                "platform",
                key="leg.drive.encoder.at",
                value=leg.measured,
                allowed="rotor, stroke; or joints of stiffness { axial, radial } in all legs",
            )
        ends = {"base": leg.base_joint, "platform": leg.platform_joint}
        turns = leg.swings and not any(joint.bending or joint.torsion for joint in ends.values())
        for spring in leg.springs:
            if not turns and spring.at in ends and ends[spring.at].across_and_along is None:
                raise InputError(
                    f"leg {i}: would give way along the leg's direction at home, for flexures of other legs have axes "
                    "of base and platform; and this leg is held across",
                    key=f"leg.springs.{spring.name}",
                    allowed=f'at = "nut", or {spring.at}_joint.stiffness = {{ axial, radial }} of this leg',
                )


def check_mounts(robot: Robot) -> None:
    """Refuse frames that move where the robot's equations hold them still."""
    for name in ("base_mount", "platform_mount", "base_motion"):
        fixed = name == "platform_mount" and robot.platform_fixed
        if getattr(robot, name) is not None and (robot.plane or fixed):
            raise InputError(
                f"moves a {name.partition('_')[0]} that "
                + ("is held" if fixed else f"cannot leave the plane {robot.plane}"),
                key=f"robot.{name}",
                allowed="a platform that the legs carry" if fixed else "robots in space",
                next_step="Leave it out, or leave platform.fixed out" if fixed else "Leave it out, or robot.plane",
            )


def _has_lead(leg: Leg) -> bool:
    slides = leg.carriage is not None and leg.carriage.kind == "slider"
    return leg.driven == "stroke" or (leg.driven == "carriage" and slides)


def check_spread(robot: Robot) -> None:
    """Refuse joints that all lie at one point."""
    if len(robot.legs) == 1 or robot.platform_fixed:
        return
    for name, joints in (("base", robot.home_bases), ("platform", robot.platform_joints)):
        if np.ptp(joints, axis=0).max() < DIMENSIONS["length"].least:
            raise InputError(
                f"all {name} joints lie at one point: the legs cannot hold the platform against turning",
                key=f"robot.{name}",
                value=joints[0].tolist(),
                next_step=f"Give robot.{name} a radius, or places apart from each other",
            )


def check_plane(robot: Robot) -> None:
    """Refuse places and directions outside the plane of a planar robot, and strips outside of one."""
    if robot.plane is None:
        for i, leg in enumerate(robot.legs, start=1):
            if leg.strut is not None and leg.strut.section is not None:
                raise InputError(
                    f"leg {i}: a strip bends in a plane only",
                    key="leg.strut",
                    allowed="a round section, or robot.plane",
                )
        return
    normal = plane_order(robot.plane)[2]
    for key, vector in _in_plane(robot):
        if abs(vector[normal]) > 1e-12 * max(1.0, np.abs(vector).max()):
            raise InputError(
                f"leads out of the plane {robot.plane}",
                key=key,
                value=vector.tolist(),
                allowed=f"{'xyz'[normal]} = 0, or two numbers",
            )
    turns = np.delete(robot.home.rotation, normal)
    axes = [axis for leg in robot.legs for axis in _hinges(leg)]
    if turns.any() or any(np.abs(np.delete(axis, normal)).max() > 1e-9 * np.abs(axis).max() for axis in axes):
        raise InputError(
            f"turns out of the plane {robot.plane}",
            key="robot.home.rotation" if turns.any() else "leg.base_joint.axis",
            allowed=f"axes along {'xyz'[normal]}, the normal: leave them out",
        )


def _in_plane(robot: Robot) -> Iterator[tuple[str, Array]]:
    yield "robot.home.position", robot.home.position
    yield from (("robot.base", place) for place in robot.base_joints)
    yield from (("robot.platform", place) for place in robot.platform_joints)
    for leg in robot.legs:
        if leg.carriage is not None:
            yield "leg.carriage", leg.carriage.axis if leg.carriage.arm is None else leg.carriage.arm


def _hinges(leg: Leg) -> list[Array]:
    crank = None if leg.carriage is None or leg.carriage.arm is None else leg.carriage.axis
    return [axis for axis in (crank, leg.base_joint.axis, leg.platform_joint.axis) if axis is not None]


def _check_bores(where: str, leg: Leg) -> None:
    """Refuse a piston that does not go into its cylinder, and a screw that does not go into its piston."""
    inner = leg.piston.sections[0] if leg.piston.sections else leg.piston
    bores = (
        ("cylinder.inner_diameter", leg.cylinder.inner_diameter, "piston", inner.diameter),
        ("piston.inner_diameter", inner.inner_diameter, "screw", leg.screw.root_diameter if leg.screw else None),
    )
    for key, bore, body, width in bores:
        if bore is not None and width is not None and width > bore:
            raise InputError(
                f"{where}: is too narrow for the {body} of {1e3 * width:.4g} mm that moves in it",
                key=f"leg.{key}",
                value=bore,
                allowed=f"at least {width:.6g} m",
                next_step="Choose a wider bore, or a thinner body",
            )


MOST_ERROR = 0.05  # of a leg's length: what plays or is crooked by more is made otherwise


def check_leg(number: int, leg: Leg, length: float) -> None:
    """Refuse a leg that cannot stand at home, where it is `length` [m] long (nan: its strut does not reach)."""
    where = f"leg {number}"
    if math.isnan(length):
        raise InputError(
            f"{where}: the strut reaches the platform at home from no position of its carriage",
            key="leg.strut.length",
            value=leg.piston.length,
            next_step="Check robot.base, robot.home_height and the direction of leg.carriage",
        )
    if length < 1e-9:
        raise InputError(
            f"{where}: base and platform joint coincide at home",
            key="robot.home_height",
            next_step="Check the joints of this leg and home_height",
        )
    if leg.cylinder.mouth >= length:
        raise InputError(
            f"{where}: no piston is left outside the cylinder at home, where the leg is {length:.6g} m long",
            key="leg.cylinder.mouth",
            value=leg.cylinder.mouth,
            allowed=f"below {length:.6g} m",
        )
    small = (
        ("base_joint.play", leg.base_joint.play),
        ("platform_joint.play", leg.platform_joint.play),
        ("base_joint.eccentricity", leg.base_joint.eccentricity),
        ("platform_joint.eccentricity", leg.platform_joint.eccentricity),
        ("piston.bow", leg.piston.bow),
        ("guide.clearance", None if leg.guide is None else leg.guide.clearance),
        ("drive.nut.backlash" if leg.screw is not None else "drive.backlash", leg.backlash * (leg.driven == "stroke")),
        ("drive.encoder.resolution", leg.screw.encoder.resolution if leg.screw and leg.measured != "rotor" else None),
    )
    for key, value in small:
        if value is not None and value > MOST_ERROR * length:
            raise InputError(
                f"{where}: is not an error of a leg that is {length:.4g} m long at home",
                key=f"leg.{key}",
                value=value,
                allowed=f"at most {100 * MOST_ERROR:g} % of that, {MOST_ERROR * length:.4g} m",
            )
    _check_bores(where, leg)
    if abs(leg.cylinder.com) > length:
        raise InputError(
            f"{where}: the cylinder's centre of mass lies beyond the leg's ends at home",
            key="leg.cylinder.com",
            value=leg.cylinder.com,
            allowed=f"between the universal joint (0) and the mouth ({leg.cylinder.mouth:.6g} m)",
        )
    if leg.strut is not None and leg.carriage is None and abs(length - leg.strut.length) > 1e-9 * length:
        raise InputError(
            f"{where}: the strut is not as long as the way from base to platform joint at home",
            key="leg.strut.length",
            value=leg.strut.length,
            allowed=f"{length:.9g} m",
        )
