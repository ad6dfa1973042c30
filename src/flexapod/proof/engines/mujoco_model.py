"""The rigid robot as MJCF, the text format of MuJoCo: legs and payload as open chains, cut at the spherical joints."""

from __future__ import annotations

import numpy as np

from flexapod import rigid
from flexapod.model import Leg, Robot
from flexapod.typing import Array

__all__ = ["mjcf"]

#: kg, kg m^2: MuJoCo takes no body without mass; a million times a million below a real leg.
LEAST = 1e-12


def mjcf(robot: Robot) -> str:
    """The robot as text for MuJoCo: six legs on universal joints, and a payload that nothing holds.

    A leg is a `cylinder_i` on two hinges, the first fixed to the base along x_i, the second to the cylinder along y_i,
    so that it turns about its own axis as the universal joint makes it; and a `piston_i` on a slide along the leg. The
    frame of a piston has its origin at the spherical joint, and the slide counts from the universal joint: its
    coordinate is the length of the leg. The `payload` is a free body in the platform frame.

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    str
        MJCF in SI; coordinates (alpha, beta, length) of legs 1 to 6, then the free joint's seven.

    References
    ----------
    E. Todorov, T. Erez, Y. Tassa, "MuJoCo: a physics engine for model-based control", IROS (2012) 5026-5033.
    """
    frames = rigid.home_frames(robot)
    legs = [
        _leg(i, leg, base, frame)
        for i, (leg, base, frame) in enumerate(zip(robot.legs, robot.base_joints, frames, strict=True), start=1)
    ]
    load = robot.payload
    full = [load.inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    payload = (
        f'<body name="payload" pos="{_numbers([0, 0, robot.home_height])}">\n<freejoint name="payload"/>\n'
        f'<inertial pos="{_numbers(load.com)}" mass="{_numbers([load.mass])}" fullinertia="{_numbers(full)}"/>\n'
        "</body>"
    )
    return "\n".join([
        '<mujoco model="6-UPS">',
        f'<compiler angle="radian" autolimits="false" boundmass="{LEAST}" boundinertia="{LEAST}"/>',
        f'<option gravity="{_numbers(robot.gravity)}"><flag contact="disable"/></option>',
        "<worldbody>",
        *legs,
        payload,
        "</worldbody>",
        "</mujoco>",
    ])  # fmt: skip


def _leg(number: int, leg: Leg, base: Array, frame: Array) -> str:
    cylinder, rod = leg.cylinder, leg.piston
    across = rod.mass * rod.length**2 / 12
    return (
        f'<body name="cylinder_{number}" pos="{_numbers(base)}" quat="{_numbers(_quaternion(frame))}">\n'
        f'<joint name="alpha_{number}" type="hinge" axis="1 0 0"/>\n'
        f'<joint name="beta_{number}" type="hinge" axis="0 1 0"/>\n'
        f"{_inertial(cylinder.mass, cylinder.com, cylinder.inertia, cylinder.axial_inertia)}\n"
        f'<body name="piston_{number}">\n<joint name="length_{number}" type="slide" axis="0 0 1"/>\n'
        f"{_inertial(rod.mass, -rod.length / 2, across, rod.axial_inertia)}\n</body>\n</body>"
    )


def _inertial(mass: float, along: float, across: float, axial: float) -> str:
    """A body of revolution about z with its centre of mass at `along`."""
    moments = _numbers([across, across, axial])
    return f'<inertial pos="{_numbers([0, 0, along])}" mass="{_numbers([mass])}" diaginertia="{moments}"/>'


def _quaternion(frame: Array) -> Array:
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(frame).as_quat(scalar_first=True)


def _numbers(values: Array | list[float]) -> str:
    """Numbers without loss of digits."""
    return " ".join(repr(float(x)) for x in np.ravel(values))
