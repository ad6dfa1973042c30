"""Compliance of a leg as springs of MuJoCo, and its drive as an actuator."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import as_pose
from flexapod.common.errors import InputError
from flexapod.mechanics.elements.springs import Place, series_stiffness, springs_along
from flexapod.model.leg.damping import damping_parts
from flexapod.output.exchange.decks_legs import LegAtPose, drive_stiffness, legs_at_pose
from flexapod.output.exchange.mjcf_trees import Bending, JointSpring, LegCompliance

STEP = {"rigid": 2e-5, "shortest": 1e-6, "longest": 1e-4}  # s
SHARE = 0.3  # of a leg's own time sqrt(m / k) that a step may have
MOST = 0.9  # of a piston's stretch that is between its parts: the rest keeps the inner one from being held
LAG = 5  # steps in which a spring swings what is given some inertia only for its sake
STIFF = 1e4  # of a prescribed carriage, in its leg's stiffness: adds 1e-4 of the leg's compliance
LIGHT = 1e-7  # of the payload's inertia: what turns between piston and platform without mass of its own


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A drive on the coordinate `on` of a leg: a `servo` that holds its command, a `push` that is a force, or both.

    `home`: the command at home [m, rad].
    """

    on: Literal["l", "chi"]
    servo: JointSpring | None
    push: bool
    home: float


@dataclass(frozen=True, kw_only=True)
class LegSprings:
    """Compliance `gives` and drives of all legs (None: passive), and the step [s] for which they are made."""

    gives: list[LegCompliance]
    drives: list[Drive | None]
    step: float


def rigid_springs(robot: model.Robot) -> LegSprings:
    """Springs of rigid legs: servos only; a prescribed drive is as stiff as the step and its own mass allow."""
    limbs, step = kinematics.rigid_limbs(robot), STEP["rigid"]
    light = {f"gamma{k}": JointSpring(armature=LIGHT * _turning(robot)) for k in (1, 2, 3)}
    drives = []
    for i, leg in enumerate(robot.legs):
        mass = max(_moved(leg, _arm(limbs, i)), LIGHT * _carried(robot))
        stiffness = drive_stiffness(leg, _length(limbs, i))
        hard = JointSpring(stiffness=mass * (SHARE / step) ** 2, damping=SHARE * mass / step)
        own = JointSpring(stiffness=stiffness, damping=max(_damping(leg), stiffness * step))
        drives.append(_drive(limbs, i, leg, own if np.isfinite(stiffness) else hard))
    gives = [LegCompliance(joints=light, begin=float(zero)) for zero in limbs.carriage_zero]
    return LegSprings(gives=gives, drives=drives, step=step)


def flexible_springs(robot: model.Robot, bends: bool) -> LegSprings:
    """Legs stretch, with all springs along them, and where they bend (`bends`) do so in the middle of their free part.

    What is before the mass of a piston is the servo of its drive: between them stands no mass.

    InputError: a leg that these springs cannot stand for.
    """
    limbs, legs = kinematics.robot_limbs(robot), _legs(robot)
    along = [_along(leg, at, bends) for leg, at in zip(robot.legs, legs, strict=True)]
    step = _step(robot, along, legs)
    gives, drives = [], []
    for i, (leg, at, (k, outer)) in enumerate(zip(robot.legs, legs, along, strict=True)):
        delay = max(damping_parts(leg.damping)[1], step)
        held = k
        if leg.driven == "carriage":
            own = drive_stiffness(leg, 0.0)
            held = own if np.isfinite(own) else STIFF * _arm(limbs, i) ** 2 / (1 / k + 1 / outer)
        drives.append(_drive(limbs, i, leg, JointSpring(stiffness=held, damping=max(_damping(leg), held * delay))))
        joints = _joints(leg, step, at)
        joints |= {"l": JointSpring(stiffness=k, damping=k * delay)} if leg.strut is not None else {}
        between = JointSpring(stiffness=outer, damping=outer * delay)
        piston = _bending(leg, at, step, between, twists=bool(limbs.pose_closure[i])) if bends else None
        begin = float(limbs.carriage_zero[i])
        gives.append(LegCompliance(joints=joints, base=_base(leg, step), piston=piston, begin=begin))
    return LegSprings(gives=gives, drives=drives, step=step)


def _step(robot: model.Robot, along: list[tuple[float, float]], legs: list[LegAtPose]) -> float:
    """Step: a share of the shortest time in which a part of a piston oscillates on the springs along it [s]."""
    times = []
    for leg, at, (inner, outer) in zip(robot.legs, legs, along, strict=True):
        mass, cut = leg.piston.mass, bool(np.isfinite(outer))
        tip = _outer(at) * mass if cut else 0.0
        times += [np.sqrt((mass - tip) / inner), *[np.sqrt(tip / outer)] * cut]
    return float(np.clip(SHARE * min(times), STEP["shortest"], STEP["longest"]))


def _outer(at: LegAtPose) -> float:
    """Share of the outer part in a piston that is cut in the middle of its free part."""
    return at.free_length / (2 * at.piston_length)


def _legs(robot: model.Robot) -> list[LegAtPose]:
    try:
        return legs_at_pose(robot, as_pose(robot, None), np.zeros(robot.count))
    except InputError as error:
        raise InputError(
            "is not written to MJCF", key=error.key, value=error.value, allowed=error.allowed,
            next_step='Write the rigid robot, fidelity = "rigid", or leave it out',
        ) from None  # fmt: skip


def _along(leg: model.Leg, at: LegAtPose, bends: bool) -> tuple[float, float]:
    """Stiffness along a leg [N/m] above the mass of its cylinder, before the inner part of its piston and between both.

    In series they are the whole. The piston's own is shared so that its weight stretches it as it should, by half of
    what it would at the tip: ``c_inner + share c_outer = c / 2``; inf: all stands before one piece.
    """
    piston, tip = at.piston_length / at.EA, _softness(leg, "platform")
    between = min(0.5 / (1 - _outer(at)), MOST) * piston + tip if bends else 0.0
    before = piston + tip - between
    if not leg.cylinder.mass:
        before += _softness(leg, "base")
    if leg.driven == "stroke" and at.drive and np.isfinite(at.drive):
        before += 1 / at.drive
    return 1 / before, 1 / between if between else np.inf


def _bending(leg: model.Leg, at: LegAtPose, step: float, along: JointSpring, *, twists: bool) -> Bending:
    """A cantilever's springs at the middle of its free part."""
    s, tip = at.free_length, leg.platform_joint.across_and_along
    softness = s**3 / (12 * at.EI) + (1 / tip[0] if tip else 0.0)
    twist = leg.piston.torsional_stiffness / leg.piston.length
    return Bending(
        free=s,
        across=_damped(1 / softness, step),
        along=along,
        turn=_damped(at.EI / s, step),
        twist=replace(_damped(twist, step), armature=twist * (LAG * step) ** 2) if twists else None,
    )


def _joints(leg: model.Leg, step: float, at: LegAtPose) -> dict[str, JointSpring]:
    """Springs of joints that hold their angles, and what parts without mass need to turn with."""
    below, above = leg.base_joint, leg.platform_joint
    light = LAG * (LAG * step) ** 2 * at.EI / at.free_length
    of = {
        "alpha": (below.bending, below.damping), "beta": (below.bending, below.damping),
        "spin": (below.torsion, below.damping), "gamma1": (above.bending, above.damping),
        "gamma2": (above.bending, above.damping), "gamma3": (above.torsion, above.damping),
    }  # fmt: skip
    found = {}
    for name, (stiffness, damping) in of.items():
        k, c = stiffness or 0.0, damping or 0.0
        own = k * (LAG * step) ** 2 if k else light
        armature = own if name not in ("alpha", "beta") else 0.0
        found[name] = JointSpring(stiffness=k, damping=max(c, k * step), armature=armature)
    return found


def _base(leg: model.Leg, step: float) -> dict[str, JointSpring]:
    """Springs of the base joint by leg axis; along it only where a mass stands above them."""
    across, along = leg.base_joint.across_and_along, _softness(leg, "base")
    found = {} if across is None else dict.fromkeys("xy", _damped(across[0], step))
    return found | ({"z": _damped(1 / along, step)} if along and leg.cylinder.mass else {})


def _softness(leg: model.Leg, at: Place) -> float:
    """Compliance of the springs along a leg at its base or platform joint [m/N], 0 without any."""
    stiffness = series_stiffness((spring for spring in springs_along(leg) if spring.at == at), 0.0, 0.0)[0]
    return 1 / stiffness if stiffness else 0.0


def _damped(stiffness: float, step: float) -> JointSpring:
    """A spring that steps of this length do not excite: a damper that takes one to bring it to rest."""
    return JointSpring(stiffness=stiffness, damping=stiffness * step)


def _drive(limbs: kinematics.Limbs, i: int, leg: model.Leg, servo: JointSpring) -> Drive | None:
    if not leg.driven:
        return None
    push = isinstance(leg.drive, model.ForceDrive)
    carried = leg.driven == "carriage"
    home = float(limbs.carriage_zero[i]) if carried else _length(limbs, i)
    return Drive(on="chi" if carried else "l", servo=None if push and leg.drive.pushes else servo, push=push, home=home)


def _damping(leg: model.Leg) -> float:
    """Damping of a servo or a feedback [N s/m, N m s/rad]; 0 of other drives."""
    drive = leg.drive
    if isinstance(drive, model.ForceDrive):
        return drive.feedback.damping if drive.feedback else 0.0
    return drive.damping if isinstance(drive, model.ServoDrive) else 0.0


def _length(limbs: kinematics.Limbs, i: int) -> float:
    return float(limbs.home[i, kinematics.COORDINATES.index("l")])


def _arm(limbs: kinematics.Limbs, i: int) -> float:
    """Length of a crank's arm [m]; 1 where the carriage slides."""
    return float(np.linalg.norm(limbs.carriage_arm[i])) or 1.0


def _moved(leg: model.Leg, arm: float) -> float:
    """Mass of what the drive of a leg moves itself [kg], of a crank its inertia [kg m^2]."""
    carriage = leg.carriage
    own = 0.0 if carriage is None else carriage.mass * arm**2 + carriage.inertia
    return own + leg.piston.mass * arm**2


def _carried(robot: model.Robot) -> float:
    """Mass of all that moves [kg]."""
    load = 0.0 if robot.payload is None else robot.payload.mass
    return load + sum(leg.piston.mass + leg.cylinder.mass for leg in robot.legs)


def _turning(robot: model.Robot) -> float:
    """Mean moment of inertia of the payload [kg m^2]."""
    return 1.0 if robot.payload is None else float(np.trace(robot.payload.inertia)) / 3
