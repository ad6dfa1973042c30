"""The rigid robot as MJCF, the text format of MuJoCo: legs and payload as open chains, cut at the platform's joints."""

from __future__ import annotations

from flexapod import kinematics
from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.elements.registry import refuse_tables
from flexapod.model import Robot
from flexapod.output.exchange.mjcf_trees import LEAST, leg_body, numbers, payload_inertia


def mjcf(robot: Robot) -> str:
    """The robot as text for MuJoCo: legs that nothing holds at their ends, and a payload that nothing holds.

    Bodies and joints are those of `exchange.mjcf_trees`; the `payload` is a free body in the platform frame.

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    str
        MJCF in SI; coordinates of leg after leg, then the free joint's seven.

    References
    ----------
    E. Todorov, T. Erez, Y. Tassa, "MuJoCo: a physics engine for model-based control", IROS (2012) 5026-5033.
    """
    refuse_tables(robot.legs, "MuJoCo")
    limbs = kinematics.rigid_limbs(robot)
    pose = f'pos="{numbers(robot.home_position)}" quat="{numbers(quaternion(robot.home_rotation))}"'
    payload = f'<body name="payload" {pose}>\n<freejoint name="payload"/>\n{payload_inertia(robot)}\n</body>'
    return "\n".join([
        f'<mujoco model="{robot.type}">',
        f'<compiler angle="radian" autolimits="false" boundmass="{LEAST}" boundinertia="{LEAST}"/>',
        f'<option gravity="{numbers(robot.gravity)}"><flag contact="disable"/></option>',
        "<worldbody>",
        *(leg_body(robot, limbs, i).text for i in range(robot.count)),
        payload,
        "</worldbody>",
        "</mujoco>",
    ])  # fmt: skip
