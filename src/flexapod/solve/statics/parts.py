"""Stiffness of every part along every leg at given lengths, Eq. (T15.3)."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.mechanics.elements.springs import Spring, servo_spring, springs_along, springs_before_piston
from flexapod.model import ForceDrive, Leg, Robot


def part_stiffness(robot: Robot, length: Array) -> dict[str, Array]:
    """Stiffness along the legs of every part, (..., legs) [N/m], by name.

    Infinite where a leg does not have it, or where its drive makes up for it: inside of what an encoder measures.

    Parameters
    ----------
    robot : Robot
    length : ndarray, shape (..., legs)
        Of the rigid legs [m]; the shaft of a screw depends on it.
    """
    found: dict[str, Array] = {}
    for i, leg in enumerate(robot.legs):
        for spring in _all(leg):
            of_part = found.setdefault(spring.name, np.full(length.shape, np.inf))
            if not _inside(leg, spring):
                of_part[..., i] = 1.0 / spring.at_length(length[..., i])
    return found


def _inside(leg: Leg, spring: Spring) -> bool:
    """Test whether a part is compliant inside of what the leg's encoder measures, Eq. (T23.11)."""
    if leg.screw is None or leg.measured == "rotor" or spring.name == "drive":
        return False
    return leg.measured == "joint-to-joint" or (spring.at == "nut" and spring.name != "piston")


def mount_stiffness(at: kinematics.RigidPoses) -> dict[str, Array]:
    """Stiffness of the mounts against a force along each leg alone at its joint, (T, legs) [N/m], Eq. (T24.11)."""
    robot, path, legs, axes, found = at.robot, at.poses, at.legs, at.axes, {}
    tips = path.position[:, None] + np.einsum("tij,kj->tki", path.rotation, robot.platform_joints)
    if (mount := robot.platform_mount) is not None:
        inverse = path.rotation[:, None].swapaxes(-1, -2)
        along, arm = (inverse @ axes[..., None])[..., 0], robot.platform_joints - mount.at
        found["platform_mount"] = _against(mount.stiffness, along, np.broadcast_to(arm, along.shape))
    if (mount := robot.base_mount) is not None:
        feet = tips - axes * legs.length[..., None]
        found["base_mount"] = _against(mount.stiffness, axes, feet - mount.at)
    return found


def guide_turning(robot: Robot, length: Array) -> Array:
    """Moment at the gland over the turn that it gives guided pistons there, (legs,) [N m/rad], Eq. (T25.8)."""
    found = np.full(robot.count, np.inf)
    for i, leg in enumerate(robot.legs):
        if leg.guide is not None:
            d, give, start = leg.overlap(length[i]), np.zeros(2), 0.0
            for step in leg.piston.steps_or_one:  # int (x / d)^2 / EI dx from the head
                end = min(start + step.length, d)
                give, start = give + (end**3 - start**3) / (3 * np.array(step.EI) * d**2), end
            found[i] = 1 / (give.max() + (1 / leg.guide.gland + 1 / leg.guide.head) / d**2)
    return found


def _against(stiffness: Array, along: Array, arm: Array) -> Array:
    wrench = np.concatenate([along, np.cross(arm, along)], axis=-1)
    return 1.0 / np.einsum("...i,...i", wrench, np.linalg.solve(stiffness, wrench[..., None])[..., 0])


def _all(leg: Leg) -> list[Spring]:
    """The springs along a leg, its piston's stretch and its drive's position among them."""
    piston = Spring(name="piston", at="nut", compliance=(leg.piston.length / leg.piston.EA, 0.0, 0.0))
    drive = [spring for spring in springs_before_piston(leg) if spring.name == "drive" and leg.driven == "stroke"]
    if isinstance(leg.drive, ForceDrive) and leg.driven == "stroke" and not leg.drive.pushes:
        drive = [servo_spring(leg.drive.feedback.stiffness)]  # type: ignore[union-attr]
    return [piston, *springs_along(leg), *drive]
