"""The rigid robot as MJCF, the text format of MuJoCo: legs and payload as open chains, cut at the platform's joints."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics
from flexapod.arrays import Array
from flexapod.elements.known import refuse_tables
from flexapod.kinematics.rotations import exponential, quaternion
from flexapod.model import Robot

#: kg, kg m^2: MuJoCo takes no body without mass; a million times a million below a real leg.
LEAST = 1e-12


def mjcf(robot: Robot) -> str:
    """The robot as text for MuJoCo: legs that nothing holds at their ends, and a payload that nothing holds.

    Every coordinate of a leg that moves (`rigid.COORDINATES`) is a joint of its name and the leg's number: that of the
    `carriage_i`, of the `cylinder_i` on the base joint, of the `piston_i` on a slide along the leg, and, where the
    platform joint is not a ball, of the `tip_i` that follows. The frame of a piston has its origin at the platform
    joint, and the slide counts from the base joint: its coordinate is the length of the leg. The `payload` is a free
    body in the platform frame.

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
    limbs, load = kinematics.rigid_limbs(robot), robot.payload
    full = [load.inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    pose = f'pos="{_numbers(robot.home_position)}" quat="{_numbers(quaternion(robot.home_rotation))}"'
    payload = (
        f'<body name="payload" {pose}>\n<freejoint name="payload"/>\n'
        f'<inertial pos="{_numbers(load.com)}" mass="{_numbers([load.mass])}" fullinertia="{_numbers(full)}"/>\n'
        "</body>"
    )
    return "\n".join([
        f'<mujoco model="{robot.type}">',
        f'<compiler angle="radian" autolimits="false" boundmass="{LEAST}" boundinertia="{LEAST}"/>',
        f'<option gravity="{_numbers(robot.gravity)}"><flag contact="disable"/></option>',
        "<worldbody>",
        *(_leg(robot, limbs, i) for i in range(robot.count)),
        payload,
        "</worldbody>",
        "</mujoco>",
    ])  # fmt: skip


def _leg(robot: Robot, limbs: kinematics.Limbs, i: int) -> str:
    leg, rod = robot.legs[i], robot.legs[i].piston
    moves: dict[str, bool] = dict(zip(kinematics.COORDINATES, limbs.unknown[i], strict=True))
    home: dict[str, float] = dict(zip(kinematics.COORDINATES, limbs.home[i], strict=True))
    across, tilt = rod.mass * rod.length**2 / 12, np.array([0.0, home["beta"], 0.0])
    frame = limbs.frames[i] @ exponential(tilt)
    joints = {
        "alpha": ("hinge", exponential(-tilt)[:, 0]),
        "beta": ("hinge", np.array([0.0, 1.0, 0.0])),
        "spin": ("hinge", np.array([0.0, 0.0, 1.0])),
        "l": ("slide", np.array([0.0, 0.0, 1.0])),
        **{f"gamma{k}": ("hinge", axis) for k, axis in enumerate(np.eye(3), start=1)},
    }

    def body(name: str, place: Array, turn: Array, coordinates: list[str], *inside: str) -> str:
        moving = [(c, *joints[c]) for c in coordinates if moves[c]]
        held = [f'<joint name="{c}_{i + 1}" type="{kind}" axis="{_numbers(axis)}"/>' for c, kind, axis in moving]
        start = f'<body name="{name}_{i + 1}" pos="{_numbers(place)}" quat="{_numbers(quaternion(turn))}">'
        return "\n".join([start, *held, *inside, "</body>"])

    none, still = np.zeros(3), np.eye(3)
    spun = leg.letters.stroke == "C"
    tip = body("tip", none, limbs.leg_frames[i], ["gamma1", "gamma2", "gamma3"], _inertial(0, 0, 0, 0))
    piston = body(
        "piston", none if moves["l"] else home["l"] * still[2], still, [*["spin"] * spun, "l"],
        _inertial(rod.mass, -rod.length / 2, across, rod.axial_inertia), *[tip] * bool(limbs.pose_closure[i]),
    )  # fmt: skip
    tube = leg.cylinder
    cylinder = body(
        "cylinder", none if leg.carriage else limbs.base[i], frame, ["alpha", "beta", *["spin"] * (not spun)],
        _inertial(tube.mass, tube.com, tube.inertia, tube.axial_inertia), piston,
    )  # fmt: skip
    if leg.carriage is None:
        return cylinder
    crank = leg.carriage.kind == "crank"
    joint = (
        f'<joint name="chi_{i + 1}" type="{"hinge" if crank else "slide"}" axis="{_numbers(limbs.carriage_axis[i])}" '
        f'pos="{_numbers(-limbs.carriage_arm[i])}" armature="{_numbers([leg.carriage.inertia])}"/>'
    )
    return (
        f'<body name="carriage_{i + 1}" pos="{_numbers(limbs.base[i])}">\n{joint}\n'
        f"{_inertial(leg.carriage.mass, 0, 0, 0)}\n{cylinder}\n</body>"
    )


def _inertial(mass: float, along: float, across: float, axial: float) -> str:
    """A body of revolution about z with its centre of mass at `along`."""
    moments = _numbers(np.maximum([across, across, axial], LEAST))
    return f'<inertial pos="{_numbers([0, 0, along])}" mass="{_numbers([max(mass, LEAST)])}" diaginertia="{moments}"/>'


def _numbers(values: Array | list[float]) -> str:
    """Numbers without loss of digits."""
    return " ".join(repr(float(x)) for x in np.ravel(values))
