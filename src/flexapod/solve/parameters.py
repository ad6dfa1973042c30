"""Physical parameters of a model as the flat vectors that kernels read."""

import numpy as np

from flexapod import rigid
from flexapod.mechanics.layout import LEG_PARAMETERS, PAYLOAD_PARAMETERS
from flexapod.model import Actuator, ForceDrive, Leg, Robot, ServoDrive, damping_parts
from flexapod.typing import Array


def _pack(layout: tuple[tuple[str, int], ...], values: dict[str, object]) -> Array:
    parts = [np.asarray(values[name], dtype=float).ravel() for name, _ in layout]
    for (name, size), part in zip(layout, parts, strict=True):
        if part.size != size:
            raise ValueError(f"parameter {name} needs {size} numbers, got {part.size}")
    return np.concatenate(parts)


def drive_spring(leg: Leg) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] between command and stroke; zero where the stroke is prescribed."""
    match leg.drive:
        case ServoDrive(stiffness=stiffness, damping=damping):
            return stiffness, damping
        case ForceDrive(feedback=feedback) if feedback is not None:
            return feedback.stiffness, feedback.damping
    return 0.0, 0.0


def leg_parameters(robot: Robot) -> Array:
    """Parameters of the legs, (legs, size of LEG_PARAMETERS)."""
    frames = rigid.home_frames(robot)
    rows = []
    for leg, base, frame in zip(robot.legs, robot.base_joints, frames, strict=True):
        stiffness, damping = drive_spring(leg)
        zeta, damping_time = damping_parts(leg.damping)
        values: dict[str, object] = {
            "rhoA": leg.piston.rhoA,
            "EI": leg.piston.EI,
            "EA": leg.piston.EA,
            "Lp": leg.piston.length,
            "mouth": leg.cylinder.mouth,
            "piston_axial_inertia": leg.piston.axial_inertia,
            "cylinder_mass": leg.cylinder.mass,
            "cylinder_com": leg.cylinder.com,
            "cylinder_inertia": leg.cylinder.inertia,
            "cylinder_axial_inertia": leg.cylinder.axial_inertia,
            "zeta": zeta,
            "damping_time": damping_time,
            "drive_stiffness": stiffness,
            "drive_damping": damping,
            "gravity": robot.gravity,
            "base": base,
            "R0": frame.T,  # column by column
            "tip_mass": 0.0,
            "tip_inertia": 0.0,
        }
        rows.append(_pack(LEG_PARAMETERS, values))
    return np.array(rows)


def joint_parameters(robot: Robot) -> Array:
    """Platform joints of the legs from the payload's CoM, platform axes, (legs, 3) [m]."""
    return np.ascontiguousarray(robot.platform_joints - robot.payload.com)


def payload_parameters(robot: Robot) -> Array:
    """Parameters of the payload; tool from its CoM."""
    load = robot.payload
    return _pack(
        PAYLOAD_PARAMETERS,
        {
            "mass": load.mass,
            "inertia": load.inertia.T,
            "gravity": robot.gravity,
            "tool": load.tool - load.com,
        },
    )


#: Axes of the planar actuator's leg frame in the plane of motion (X right, Y up): z_leg = X, x_leg = Y, so y_leg = Z.
PLANE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def actuator_parameters(actuator: Actuator) -> Array:
    """Parameters of the single planar actuator, (1, size of LEG_PARAMETERS); beta is its angle from the horizontal."""
    values: dict[str, object] = dict.fromkeys((name for name, size in LEG_PARAMETERS if size == 1), 0.0)
    zeta, damping_time = damping_parts(actuator.damping)
    values |= {
        "rhoA": actuator.rhoA,
        "EI": actuator.EI,
        "EA": 1.0,  # inextensible: no axial shape reads it
        "Lp": actuator.length,
        "mouth": actuator.hub_radius,
        "cylinder_inertia": actuator.hub_inertia,
        "zeta": zeta,
        "damping_time": damping_time,
        "gravity": [0.0, -actuator.gravity, 0.0],
        "base": np.zeros(3),
        "R0": PLANE.T,
        "tip_mass": actuator.tip_mass,
        "tip_inertia": actuator.tip_inertia,
    }
    return _pack(LEG_PARAMETERS, values)[None, :]
