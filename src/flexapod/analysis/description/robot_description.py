"""A study before it is computed: lengths, margins, singularity, loads, stiffness, frequencies, vibration to expect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.checks.estimates import bending_moments, buckling_loads
from flexapod.analysis.checks.stability import loop_remarks, unstable
from flexapod.analysis.description.actuator_description import ActuatorDescription, describe_actuator
from flexapod.analysis.description.clearance import (
    LegClearance,
    StrokeEnd,
    TurnedJoint,
    joint_turns,
    leg_clearance,
    stroke_ends,
)
from flexapod.analysis.description.hydraulic_description import (
    HydraulicDescription,
    describe_hydraulics,
    hydraulic_remarks,
    oil_frequency,
)
from flexapod.analysis.description.leg_description import (
    Extreme,
    LegDescription,
    LegPath,
    bearing_remarks,
    describe_leg,
    load_remarks,
)
from flexapod.analysis.description.residual_vibration import ExpectedVibration, RestingRobot, expected_vibration
from flexapod.analysis.description.screw_description import (
    BackDriving,
    ScrewDescription,
    back_driving,
    describe_screws,
    screw_remarks,
)
from flexapod.analysis.pose_errors.disturbances import Shaking, home_shaking
from flexapod.analysis.pose_errors.home_accuracy import HomeAccuracy, RestOffset, home_accuracy, rest_offset
from flexapod.analysis.results.elongations import guide_results
from flexapod.analysis.results.idealizations import Idealization, idealization, soft_drives
from flexapod.analysis.results.mode_shapes import mode_kinds
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError, InputError
from flexapod.common.quantities import sentence
from flexapod.common.ranking import EQUALS, first_largest
from flexapod.common.resources import one_thread
from flexapod.mechanics.elements.springs import springs_along
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.structural_damping import ViscousLosses, viscous_losses
from flexapod.solve.robot_system import refuse_massless
from flexapod.solve.statics.lost_motion import lost_motion, places_with_friction
from flexapod.solve.statics.parts import part_stiffness
from flexapod.solve.statics.stiffness import compliance, stiffness_of

SHOWN = 6
ROUNDING = 1e-12  # of the largest compliance: below it a plane holds the platform


@dataclass(frozen=True, kw_only=True)
class ModeLine:
    """A mode of the locked robot: `frequency` [Hz] undamped, `damping_ratio`, `kind` as text."""

    frequency: float
    damping_ratio: float
    kind: str


@dataclass(frozen=True, kw_only=True)
class StiffnessDescription:
    """Stiffness at the tool: `least`, `most` [N/m] along, `turning_least`, `turning_most` [N m/rad] about a direction.

    Against a force alone (the platform free to turn) and a moment alone; `softest` (3,): direction of `least`, world.
    """

    least: float
    most: float
    softest: tuple[float, ...]
    turning_least: float
    turning_most: float


@dataclass(frozen=True, kw_only=True)
class PoseDescription:
    """The robot at one pose, drives locked, about its static equilibrium.

    `sag` [m] of the centre of mass, `rest`: the same with signs, and what of it is by heat; `stiffness`, `modes`: the
    lowest. None and empty where there is no such thing; `problem` then says why, or that loops are
    unstable. `parts`: of legs with more than ideal parts, by name and leg [N/m], inf where it has none, or where its
    drive makes up for it. `lost_motion` [m] of each leg by friction of its drive, half of it to and fro. `bushings`
    [N]: what gland and head of each leg bear across it.
    """

    name: str
    time: float
    sag: float | None = None
    rest: RestOffset | None = None
    stiffness: StiffnessDescription | None = None
    modes: tuple[ModeLine, ...] = ()
    problem: str | None = None
    parts: Mapping[str, tuple[float, ...]] | None = None
    lost_motion: tuple[float, ...] = ()
    bushings: tuple[tuple[float, ...], ...] = ()


def describe_pose(name: str, rest: RestingRobot) -> PoseDescription:
    """The robot at rest at an instant of its path."""
    study, path, time = rest.study, rest.rigid.poses, rest.time
    robot = study.robot
    parts, lost = _parts(rest.rigid), _lost_motion(rest.rigid)
    try:
        locked, found = rest.locked_robot, rest.modes
        stiffness = None if robot.platform_fixed else _stiffness(stiffness_of(robot, locked).total)
    except FlexapodError as error:
        return PoseDescription(name=name, time=time, problem=str(error), parts=parts, lost_motion=lost)
    lines = zip(found.frequency, found.damping_ratio, mode_kinds(found), strict=True)
    modes = tuple(ModeLine(frequency=float(f), damping_ratio=float(ratio), kind=kind) for f, ratio, kind in lines)
    inside = guide_results(robot, locked.system, found.equilibrium.state.q)
    pressed = np.linalg.norm(inside["guide_force"], axis=-1).tolist() if inside else []
    bushings = tuple(tuple(pair) for pair in pressed)
    if robot.platform_fixed:
        return PoseDescription(
            name=name, time=time, modes=modes[:SHOWN], parts=parts, lost_motion=lost, bushings=bushings
        )
    sag = found.equilibrium.state.pose[:3] - path.point(robot.com)[0][0]
    return PoseDescription(
        name=name, time=time, sag=float(np.linalg.norm(sag)), rest=rest_offset(study, path, sag),
        stiffness=stiffness, modes=modes[:SHOWN], parts=parts, lost_motion=lost, bushings=bushings,
        problem=next(map(sentence, unstable(found.growth)), None),
    )  # fmt: skip


def _parts(at: kinematics.RigidPoses) -> dict[str, tuple[float, ...]] | None:
    robot = at.robot
    if not any(springs_along(leg) for leg in robot.legs):
        return None
    found = part_stiffness(robot, at.legs.length[0])
    return {name: tuple(values.tolist()) for name, values in found.items()}


def _lost_motion(at: kinematics.RigidPoses) -> tuple[float, ...]:
    if "drive" not in places_with_friction(at.robot):
        return ()
    return tuple(lost_motion(at.robot, at.legs.length[0]).tolist())


def _stiffness(total: Array) -> StiffnessDescription:
    give = compliance(total)[0]
    shift, vectors = np.linalg.eigh(give[:3, :3])
    turning = np.linalg.eigvalsh(give[3:, 3:])
    most, turning_most = (values[values > ROUNDING * values[-1]][0] for values in (shift, turning))  # others are held
    softest = vectors[:, -1] * np.sign(vectors[first_largest(np.abs(vectors[:, -1]), EQUALS), -1])
    return StiffnessDescription(
        least=float(1 / shift[-1]),
        most=float(1 / most),
        softest=tuple(softest.tolist()),
        turning_least=float(1 / turning[-1]),
        turning_most=float(1 / turning_most),
    )


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
    """Description of a robot, as `describe` returns it; times in s.

    `held`: kinds of drives that give way, of which poses hold the commands; `losses` as dampers; `back`: with motors
    of screws off; `oil`: lowest frequencies on it [Hz], least and largest; `accuracy` of the machine as built and what
    `disturbances` do to it at home, or in words why that cannot be said; what is `ideal`. In words: `motions` that the
    mechanism has, `remarks` of doubt.
    """

    kind: str = "robot"
    file: str | None
    duration: float
    motion_end: float
    fidelity: str
    held: tuple[str, ...]
    motions: tuple[str, ...]
    losses: ViscousLosses | None
    legs: tuple[LegDescription, ...]
    screws: tuple[ScrewDescription, ...]
    back: BackDriving | None
    hydraulics: tuple[HydraulicDescription, ...]
    oil: tuple[float, float] | None
    angles: tuple[JointAngle, ...]
    turns: tuple[TurnedJoint, ...]
    stroke_ends: tuple[StrokeEnd, ...]
    clearance: LegClearance | None  # None where no two legs could meet but at a joint
    singularity: Singularity | None  # None of a platform that is fixed
    poses: tuple[PoseDescription, ...]
    vibration: ExpectedVibration | None
    accuracy: HomeAccuracy | str | None
    disturbances: Shaking | str | None
    ideal: Idealization | None
    remarks: tuple[str, ...]

    def as_dict(self) -> dict[str, object]:
        """Description as plain data."""
        return asdict(self)


@one_thread()
def describe(study: model.Study | model.ActuatorStudy) -> RobotDescription | ActuatorDescription:
    """Describe the study of a robot or an actuator by estimates, without a simulation.

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
    path, elastic = RigidPath(study), ElasticRobot(study.robot, study.simulation, study.load)
    remarks = [*check_path(study, path), *_in_time(study)]
    legs, singularity = describe_legs(path), _singularity(path)
    screws, hydraulics = describe_screws(path), describe_hydraulics(path)
    end = min(study.motion.end_time - study.motion.hold, study.duration)
    rests = {"start": RestingRobot(study, elastic, 0.0), "end of the motion": RestingRobot(study, elastic, end)}
    worst = singularity.time if singularity else end
    if min(worst, abs(worst - end)) > 0.02 * end and worst < end:
        rests["nearest to a singularity"] = RestingRobot(study, elastic, worst)
    return RobotDescription(
        file=study.path,
        duration=study.duration,
        motion_end=end,
        fidelity=study.simulation.fidelity,
        held=soft_drives(study.robot),
        motions=tuple(kinematics.mobility_words(kinematics.rigid_limbs(study.robot))),
        losses=viscous_losses(study.robot, study.simulation),
        legs=legs,
        screws=screws,
        back=back_driving(path, screws),
        hydraulics=hydraulics,
        oil=oil_frequency(path) if hydraulics else None,
        angles=_angles(path),
        turns=joint_turns(path),
        clearance=leg_clearance(path),
        stroke_ends=stroke_ends(study.robot),
        singularity=singularity,
        poses=tuple(describe_pose(name, rest) for name, rest in rests.items()),
        vibration=expected_vibration(rests["end of the motion"]),
        accuracy=home_accuracy(study),
        disturbances=home_shaking(study),
        ideal=idealization(study.robot),
        remarks=tuple(
            dict.fromkeys(
                [
                    *study.warnings,
                    *remarks,
                    *loop_remarks(path, elastic),
                    *bearing_remarks(path),
                    *load_remarks(legs, study.robot, study.simulation.fidelity),
                    *screw_remarks(study.robot, screws),
                    *hydraulic_remarks(study.robot, hydraulics),
                ]
            )
        ),
    )


def _angles(path: RigidPath) -> tuple[JointAngle, ...]:
    found = []
    for joint, angle in path.reach.angles.items():
        k, leg = np.unravel_index(first_largest(angle), angle.shape)
        extreme = Extreme(value=float(angle[k, leg]), time=float(path.time[k]))
        found.append(JointAngle(joint=joint, leg=int(leg) + 1, largest=extreme))
    return tuple(found)


def _in_time(study: model.Study) -> list[str]:
    """Why a simulation will be refused although everything at rest has an answer."""
    try:
        refuse_massless(study)
    except InputError as error:
        return [remark("not in time", key=error.key, value=error.value, what=error.what)]
    return []


def _singularity(path: RigidPath) -> Singularity | None:
    if path.robot.platform_fixed:
        return None
    home, found = kinematics.singularity(path.robot, kinematics.home_pose(path.robot)), path.nearest
    return Singularity(
        home_smallest_singular_value=float(home.smallest_singular_value[0]),
        home_condition=float(home.condition[0]),
        smallest_singular_value=found.smallest_singular_value,
        condition=found.condition,
        time=float(path.time[found.worst]),
    )


def describe_legs(path: RigidPath) -> tuple[LegDescription, ...]:
    """Extremes of the legs on the rigid path of a study."""
    robot, forces = path.robot, path.forces
    thrust = np.einsum("tli,tli->tl", forces.joint_force, path.axes)
    moment, euler = bending_moments(path), buckling_loads(robot, path.legs.length)
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
                moment=moment[:, :, i],
                euler=euler[:, i],
            ),
            float(robot.home_lengths[i]),
        )
        for i, leg in enumerate(robot.legs)
    )  # fmt: skip
