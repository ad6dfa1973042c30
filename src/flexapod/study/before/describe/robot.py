"""A study before it is computed: lengths, margins, singularity, loads, stiffness, vibration to expect."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from flexapod import model, rigid
from flexapod.errors import InputError
from flexapod.solve.robot_march import refuse_massless
from flexapod.study.accuracy.words import accuracy_words
from flexapod.study.before.checks import check_path
from flexapod.study.before.describe.actuator import ActuatorDescription, describe_actuator
from flexapod.study.before.describe.leg import Extreme, LegDescription, LegPath, describe_leg, load_remarks
from flexapod.study.before.describe.pose import PoseDescription, VibrationToExpect, describe_pose, vibration_to_expect
from flexapod.study.before.describe.screw import ScrewDescription, back_words, describe_screws, screw_remarks
from flexapod.study.before.estimates import bending_moment
from flexapod.study.disturbances import vibration_words
from flexapod.study.path import RigidPath
from flexapod.study.words import held
from flexapod.typing import Array

__all__ = ["RobotDescription", "Singularity", "describe", "describe_legs"]


@dataclass(frozen=True, kw_only=True)
class Singularity:
    """Scaled Jacobian (T2.24) on the path: smallest singular value and condition at home and where it is worst."""

    home_smallest_singular_value: float
    home_condition: float
    smallest_singular_value: float
    condition: float
    time: float


@dataclass(frozen=True, kw_only=True)
class JointAngle:
    """Largest angle [rad] of those of a kind that must stay below 85 deg, and whose leg it is."""

    joint: str
    leg: int
    largest: Extreme


@dataclass(frozen=True, kw_only=True)
class RobotDescription:
    """What `describe` finds for a robot; times in s.

    In words: what poses `held` still, `motions` that the mechanism has, `back` what happens with the motors of screws
    off, `accuracy` of the machine as built, what `disturbances` do to it, `remarks` of doubt.
    """

    kind: str = "robot"
    file: str | None
    duration: float
    motion_end: float
    fidelity: str
    held: str
    motions: tuple[str, ...]
    legs: tuple[LegDescription, ...]
    screws: tuple[ScrewDescription, ...]
    back: str
    angles: tuple[JointAngle, ...]
    singularity: Singularity
    poses: tuple[PoseDescription, ...]
    vibration: VibrationToExpect | None
    accuracy: tuple[str, ...]
    disturbances: tuple[str, ...]
    remarks: tuple[str, ...]

    def as_dict(self) -> dict[str, object]:
        """Everything as plain data."""
        return asdict(self)


def describe(study: model.Study | model.ActuatorStudy) -> RobotDescription | ActuatorDescription:
    """What a study will ask of its robot or actuator, estimated without a simulation.

    Parameters
    ----------
    study : Study or ActuatorStudy

    Raises
    ------
    InputError
        A path that no robot could follow, as `check_path`.
    """
    if isinstance(study, model.ActuatorStudy):
        return describe_actuator(study)
    path = RigidPath(study)
    remarks = [*check_path(study, path), *_in_time(study)]
    legs, singularity = describe_legs(path), _singularity(study.robot, path.time, path.poses)
    screws = describe_screws(path)
    end = min(study.motion.end_time - study.motion.hold, study.duration)
    instants = {"start": 0.0, "end of the motion": end}
    worst = singularity.time
    if min(worst, abs(worst - end)) > 0.02 * end and worst < end:
        instants["nearest to a singularity"] = worst
    return RobotDescription(
        file=study.path,
        duration=study.duration,
        motion_end=end,
        fidelity=study.simulation.fidelity,
        held=held(study.robot),
        motions=tuple(rigid.mobility_words(rigid.rigid_limbs(study.robot))),
        legs=legs,
        screws=screws,
        back=back_words(path, screws) if screws else "",
        angles=_angles(path),
        singularity=singularity,
        poses=tuple(describe_pose(study, name, instant) for name, instant in instants.items()),
        vibration=vibration_to_expect(study, end),
        accuracy=accuracy_words(study),
        disturbances=vibration_words(study),
        remarks=tuple(
            dict.fromkeys(
                [
                    *study.warnings,
                    *remarks,
                    *load_remarks(legs, study.robot, study.simulation.fidelity),
                    *screw_remarks(path, screws),
                ]
            )
        ),
    )


def _angles(path: RigidPath) -> tuple[JointAngle, ...]:
    found = []
    for joint, angle in path.reach.angles.items():
        k, leg = np.unravel_index(angle.argmax(), angle.shape)
        extreme = Extreme(value=float(angle[k, leg]), time=float(path.time[k]))
        found.append(JointAngle(joint=joint, leg=int(leg) + 1, largest=extreme))
    return tuple(found)


def _in_time(study: model.Study) -> list[str]:
    """Why a simulation will be refused although everything at rest has an answer."""
    try:
        refuse_massless(study)
    except InputError as error:
        return [f"a simulation is not possible: {error.key} = {error.value} {error.what}"]
    return []


def _singularity(robot: model.Robot, t: Array, path: rigid.Poses) -> Singularity:
    home, found = rigid.singularity(robot, rigid.home_pose(robot)), rigid.singularity(robot, path)
    return Singularity(
        home_smallest_singular_value=float(home.smallest_singular_value[0]),
        home_condition=float(home.condition[0]),
        smallest_singular_value=float(found.smallest_singular_value[found.worst]),
        condition=float(found.condition[found.worst]),
        time=float(t[found.worst]),
    )


def describe_legs(path: RigidPath) -> tuple[LegDescription, ...]:
    """Extremes of the legs on the rigid path of a study."""
    robot, forces = path.robot, path.forces
    thrust = np.einsum("tli,tli->tl", forces.joint_force, path.axes)
    moment = bending_moment(path, forces.joint_force)
    return tuple(
        describe_leg(
            i + 1,
            leg,
            LegPath(
                time=path.time,
                length=path.legs.length[:, i],
                carriage=path.reach.carriage[:, i],
                force=forces.drive_force[:, i],
                thrust=thrust[:, i],
                moment=moment[:, i],
            ),
            float(robot.home_lengths[i]),
        )
        for i, leg in enumerate(robot.legs)
    )  # fmt: skip
