"""Reachability of poses: codes and reasons, as numbers and as text, Eqs. (T2.24), (T2.37)-(T2.38)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod import kinematics
from flexapod.analysis.checks.checks import SINGULAR
from flexapod.analysis.results.bodies import joint_angle_limits, joint_angles
from flexapod.common.arrays import Array
from flexapod.kinematics.inverse import BETA_LIMIT
from flexapod.model import Robot
from flexapod.solve.statics import assembly_mode, equilibrium

Codes = NDArray[np.int8]


class Reason(NamedTuple):
    """Why a pose is not reached: one word for files, and words for people."""

    flag: str
    words: str


REASONS = (
    Reason("reached", "reached"),
    Reason("leg_too_short", "a leg is shorter than its stroke allows"),
    Reason("leg_too_long", "a leg is longer than its stroke allows"),
    Reason("no_free_length", "a piston has no free length left"),
    Reason("pulled_out", "a piston is pulled out of its cylinder"),
    Reason("joint_folds", "a universal joint folds"),
    Reason("singular", "singular, or cut off from home by a singularity"),
    Reason("no_stiffness", "no equilibrium: the stiffness is singular"),
    Reason("gives_way", "no equilibrium: the legs give way"),
    Reason("not_settled", "no equilibrium found: close to buckling"),
    Reason("unstable", "no equilibrium: the robot buckles under its load"),
    Reason("falls_through", assembly_mode.FALLS_THROUGH),
    Reason("no_mass", "the mass matrix is not positive"),
    Reason("out_of_reach", "a leg does not reach its platform joint"),
    Reason("carriage_stops", "a carriage leaves its stroke"),
    Reason("joint_stops", "a joint turns farther than its largest angle"),
    Reason("far_from_home", "too far from home for the motions that are told apart there"),
)
"""Reasons by code."""

_CODE = {reason.flag: code for code, reason in enumerate(REASONS)}
REACHED, CUT_OFF = _CODE["reached"], _CODE["singular"]
FALLS_THROUGH, NO_MASS = _CODE["falls_through"], _CODE["no_mass"]
_OF_EQUILIBRIUM = {
    equilibrium.FOUND: "reached",
    equilibrium.SINGULAR: "no_stiffness",
    equilibrium.GIVES_WAY: "gives_way",
    equilibrium.NOT_SETTLED: "not_settled",
    equilibrium.UNSTABLE: "unstable",
    equilibrium.TOO_FAR: "far_from_home",
}


def flags() -> dict[str, object]:
    """Attributes of a variable of codes (CF conventions), and the words."""
    return {
        "flag_values": np.arange(len(REASONS), dtype=np.int8),
        "flag_meanings": " ".join(reason.flag for reason in REASONS),
        "words": "; ".join(reason.words for reason in REASONS),
    }


def leg_limits(robot: Robot) -> tuple[Array, Array, Array]:
    """Stroke limits (legs, 2), mouths and piston lengths (legs,) [m]; 0 and inf where a leg has no limits."""
    limits = [(leg.stroke.min, leg.stroke.max) if leg.stroke else (0.0, np.inf) for leg in robot.legs]
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    piston = [leg.piston.length if leg.strut is None else np.inf for leg in robot.legs]
    return np.array(limits), mouth, np.array(piston)


def rigid_codes(at: kinematics.RigidPoses, *, from_home: bool) -> Codes:
    """Codes (P,) of what strokes, pistons and joints say to P poses.

    Where several limits are left, the stroke counts before the piston, the piston before the joint, and of a leg too
    short and another too long the one that is further off.

    Parameters
    ----------
    at : RigidPoses
    from_home : bool
        Whether a pose also counts as out of reach where the scaled Jacobian is singular (smallest singular value
        below 1e-8) or its determinant has not the sign that it has at home: every way there passes a singularity.
    """
    robot, path, found = at.robot, at.poses, at.reach
    length = found.length
    limits, mouth, piston = leg_limits(robot)
    short, long = (limits[:, 0] - length).max(axis=1), (length - limits[:, 1]).max(axis=1)
    guided = np.where(mouth > 0, mouth + piston, np.inf)
    code = np.zeros(len(path), dtype=np.int8)
    marks = [  # later ones overrule earlier ones
        ("singular", _cut_off(at) if from_home else np.zeros(len(path), dtype=bool)),
        ("out_of_reach", found.lost),
        ("joint_folds", np.any([(angle > BETA_LIMIT).any(axis=1) for angle in found.angles.values()], axis=0)),
        ("joint_stops", _turned_too_far(at)),
        ("carriage_stops", _stopped(robot, found.carriage)),
        ("pulled_out", (length > guided).any(axis=1)),
        ("no_free_length", (length <= mouth).any(axis=1)),
        ("leg_too_long", (long > 0) & (long >= short)),
        ("leg_too_short", (short > 0) & (short > long)),
    ]
    for flag, mask in marks:
        code[mask] = _CODE[flag]
    return code


def equilibrium_codes(code: NDArray[np.integer]) -> Codes:
    """Codes of the results of searches for an equilibrium."""
    table = np.array([_CODE[_OF_EQUILIBRIUM[k]] for k in range(len(_OF_EQUILIBRIUM))], dtype=np.int8)
    return table[code]


def slider_limits(robot: Robot) -> Array:
    """Least and largest place of the sliders (legs, 2) [m]; infinite without one, and of cranks."""
    limits = kinematics.carriage_limits(robot)
    return limits if kinematics.rigid_limbs(robot).carriage == "slider" else np.full_like(limits, np.inf) * [-1, 1]


def _stopped(robot: Robot, place: Array) -> NDArray[np.bool_]:
    limits = kinematics.carriage_limits(robot)
    return np.any((place < limits[:, 0]) | (place > limits[:, 1]), axis=1)


def _turned_too_far(at: kinematics.RigidPoses) -> NDArray[np.bool_]:
    largest, path = joint_angle_limits(at.robot), at.poses
    if not np.isfinite(largest).any() or not len(path):
        return np.zeros(len(path), dtype=bool)
    return np.any(joint_angles(at.robot, at.directions, path.rotation) > largest, axis=(1, 2))


def _cut_off(at: kinematics.RigidPoses) -> NDArray[np.bool_]:
    if not len(at.poses):
        return np.zeros(0, dtype=bool)
    with np.errstate(invalid="ignore", divide="ignore"):  # a leg without length has no direction: another code is its
        found = at.singularity
    return (found.smallest_singular_value < SINGULAR) | (np.sign(found.determinant) != _sign_at_home(at.robot))


def _sign_at_home(robot: Robot) -> float:
    return float(np.sign(kinematics.singularity(robot, kinematics.home_pose(robot)).determinant[0]))
