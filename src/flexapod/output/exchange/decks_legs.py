"""Legs and payload of a robot at a pose, as decks need them: joints as free axes and springs, in world axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics, model
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.leg_geometry import FREE, Limbs, limbs
from flexapod.kinematics.mechanism import legs_at
from flexapod.kinematics.screws import screws
from flexapod.mechanics.elements.springs import Place, series_stiffness, springs_along, springs_before_piston

_STIFF = 1e5  # of a locked drive, in EA / l: adds 1e-5 of a leg's compliance
_NAMES: tuple[str, ...] = ("chi", "alpha", "beta", "spin", "l", "gamma1", "gamma2", "gamma3")
_HOME = 1e-9  # rad, m
_LENGTH = _NAMES.index("l")


@dataclass(frozen=True, kw_only=True)
class CarriageAtPose:
    """A compliant carriage: it moves the base joint along `direction` (3,) and turns the leg by `turn` (3,).

    Turns are [1/m]; `mass` [kg] that moves along; `spring` [N/m], 0 without drive; `force` [N] of a force drive.
    """

    direction: Array
    turn: Array
    mass: float
    spring: float
    force: float


@dataclass(frozen=True, kw_only=True)
class LegAtPose:
    """A leg at a pose, SI, world axes.

    `base`, `tip` (3,): its joints; `axes` (3, 3): columns x, y, z of the leg, z towards the tip; `turns` (k, 3): axes
    about which the base joint lets the leg turn, with springs `turn_springs` (k,) [N m/rad]; `piston_turns`: the piston
    may turn in the cylinder; `ends` (m, 3): axes about which the platform joint lets the tip turn, with `end_springs`,
    None: a ball; `base_gives`, `tip_gives` (k, 3): directions in which the joints give way, with springs
    `base_springs`, `tip_springs` (k,) [N/m]; `carriage`: what gives way below the base joint, None: nothing does;
    `mouth`, `piston_length` [m]; `EA`, `EI`, `rhoA` of the piston; `mass`, `com`, `inertia`, `axial_inertia` of the
    cylinder; `drive` [N/m], inf for a prescribed stroke, 0 for one without drive; `force` [N] that a force drive gives
    beside that spring.
    """

    base: Array
    tip: Array
    axes: Array
    turns: Array
    turn_springs: Array
    piston_turns: bool
    ends: Array | None
    end_springs: Array
    base_gives: Array
    base_springs: Array
    tip_gives: Array
    tip_springs: Array
    carriage: CarriageAtPose | None
    mouth: float
    piston_length: float
    EA: float
    EI: float
    rhoA: float
    mass: float
    com: float
    inertia: float
    axial_inertia: float
    drive: float
    force: float

    @property
    def length(self) -> float:
        """Length of the leg from joint to joint [m]."""
        return float(np.linalg.norm(self.tip - self.base))

    @property
    def free_length(self) -> float:
        """Length of the piston outside the cylinder [m]."""
        return self.length - self.mouth

    @property
    def side(self) -> float:
        """Side of the square bar that has the piston's EI / EA [m]."""
        return float(np.sqrt(12 * self.EI / self.EA))

    @property
    def drive_spring(self) -> float:
        """Stiffness of the spring that holds the piston's end [N/m]."""
        return min(self.drive, _STIFF * self.EA / self.length)

    def axis_points(self, place: float | Array) -> Array:
        """Points on the axis at distances from the universal joint, (3,) or (n, 3) [m]."""
        return self.base + np.multiply.outer(place, self.axes[:, 2])


@dataclass(frozen=True, kw_only=True)
class PayloadAtPose:
    """The payload at a pose: `mass` [kg], `com` (3,) [m], `inertia` (3, 3) [kg m^2] about it, world axes."""

    mass: float
    com: Array
    inertia: Array


def axial_inertia(leg: model.Leg) -> float:
    """Axial inertia of what spins with the cylinder, where a body with its transverse inertia can have it."""
    whole = leg.cylinder.axial_inertia + leg.piston.axial_inertia
    return whole if leg.cylinder.mass and whole <= 2 * leg.cylinder.inertia else leg.cylinder.axial_inertia


def legs_at_pose(robot: model.Robot, path: kinematics.Poses, force: Array) -> list[LegAtPose]:
    """The legs at one pose; `force` (legs,) [N] of force drives.

    InputError: a leg that solid elements and point masses cannot stand for, or joints with springs away from home.
    """
    real, chains = limbs(robot), kinematics.rigid_limbs(robot)
    q = legs_at(chains, path).q
    if (real.state != chains.state).any():
        if np.abs(q - real.home).max() > _HOME:
            raise InputError(
                "is not home, where joints with springs are without force: decks begin there",
                key="pose",
                next_step="Leave the pose out",
            )
        q = real.home[None]
    columns, tips = screws(real, q).columns[0], path.point(robot.platform_joints)[0][0]
    return [
        _leg(i, leg, real, columns[i], tips[i], float(q[0, i, _LENGTH]), float(force[i]))
        for i, leg in enumerate(robot.legs)
    ]


def _leg(i: int, leg: model.Leg, real: Limbs, columns: Array, tip: Array, length: float, force: float) -> LegAtPose:
    """Leg i; `columns` (6, 8): velocities of its tip and turns of its joints for each coordinate."""
    _check_leg(i + 1, leg, length)
    cylinder, piston, below, above = leg.cylinder, leg.piston, leg.base_joint, leg.platform_joint
    if leg.turning:
        raise _refused("leg.piston.keyed", "true", value=False)
    if leg.screw is not None and leg.screw.command == "torque":
        raise _refused("leg.drive.command", "position, servo", value="torque", next_step='Take "position" for the deck')
    z, y = columns[:3, _LENGTH], columns[3:, _NAMES.index("beta")]
    springs = dict(zip(_NAMES[1:4], (below.bending, below.bending, below.torsion), strict=True))
    springs |= dict(zip(_NAMES[5:], (above.bending, above.bending, above.torsion), strict=True))
    loose = [name for name, state in zip(_NAMES, real.state[i], strict=True) if state == FREE and name in springs]
    alone = leg.letters.stroke == "C"
    turns = [name for name in loose if name in ("alpha", "beta") or (name == "spin" and not alone)]
    ends = [name for name in loose if name.startswith("gamma")]
    axes, sprung = (
        [np.array([part[name] for name in names]) for names in (turns, ends)]
        for part in (dict(zip(_NAMES, columns[3:].T, strict=True)), {k: v or 0.0 for k, v in springs.items()})
    )
    on_carriage = leg.driven == "carriage"
    own = np.column_stack([np.cross(y, z), y, z])
    (base_gives, base_springs), (tip_gives, tip_springs) = (
        _joint_compliance(leg, own, at) for at in ("base", "platform")
    )
    if force and len(base_gives):
        allowed = "prescribed, servo, screw, or a base joint and springs that do not give way"
        raise _refused("leg.drive.type", allowed, value=leg.drive.type, next_step='Take "prescribed" for the deck')
    return LegAtPose(
        base=tip - length * z,
        tip=tip,
        axes=own,
        turns=axes[0].reshape(-1, 3),
        turn_springs=sprung[0],
        piston_turns=alone and "spin" in loose,
        ends=axes[1].reshape(-1, 3) if real.pose_closure[i] else None,
        end_springs=sprung[1],
        base_gives=base_gives,
        base_springs=base_springs,
        tip_gives=tip_gives,
        tip_springs=tip_springs,
        carriage=_carriage(leg, columns[:, 0], length * z, force if on_carriage else 0.0),
        mouth=cylinder.mouth,
        piston_length=piston.length,
        EA=piston.EA,
        EI=piston.EI,
        rhoA=piston.rhoA,
        mass=cylinder.mass,
        com=cylinder.com,
        inertia=cylinder.inertia,
        axial_inertia=axial_inertia(leg),
        drive=np.inf if leg.strut is not None or on_carriage else drive_stiffness(leg, length),
        force=0.0 if on_carriage else force,
    )


def _joint_compliance(leg: model.Leg, axes: Array, at: Place) -> tuple[Array, Array]:
    """Directions (k, 3) in which a joint is compliant, and springs (k,) [N/m]; `axes` (3, 3): columns, of the leg."""
    joint = leg.base_joint if at == "base" else leg.platform_joint
    if joint.flexes:
        raise _refused(f"leg.{at}_joint.stiffness", "{ axial, radial }, bending and torsion")
    along = series_stiffness((spring for spring in springs_along(leg) if spring.at == at), 0.0, 0.0)[0]
    across = joint.across_and_along[0] if joint.across_and_along else 0.0
    springs = np.array([across, across, along])
    return axes.T[springs > 0], springs[springs > 0]


def _carriage(leg: model.Leg, twist: Array, reach: Array, force: float) -> CarriageAtPose | None:
    """The carriage of a leg where it is compliant; of a crank at the end of its arm. `twist` (6,) of the tip."""
    spring = drive_stiffness(leg, 0.0)
    if leg.carriage is None or np.isinf(spring):
        return None
    way = twist[:3] - np.cross(twist[3:], reach)  # of the base joint
    arm = float(np.linalg.norm(way))
    mass = leg.carriage.mass + leg.carriage.inertia / arm**2
    return CarriageAtPose(
        direction=way / arm, turn=twist[3:] / arm, mass=mass, spring=spring / arm**2, force=force / arm
    )


def drive_stiffness(leg: model.Leg, length: float) -> float:
    """Stiffness of a locked drive with all springs behind it [N/m, N m/rad], 0 of a passive leg."""
    drive = leg.drive
    if leg.passive:
        return 0.0
    if leg.gives:
        softness = sum(float(spring.at_length(np.array(length))) for spring in springs_before_piston(leg))
        return np.inf if (leg.drive.holds and leg.holds_stroke) or not softness else 1 / softness
    if drive.type == "servo":
        return drive.stiffness
    return drive.feedback.stiffness if drive.type == "force" and drive.feedback else np.inf


def _refused(
    key: str, allowed: str, *, value: object = None,
    next_step: str = "Leave it out for the deck: `flexapod modes` with it and without says what that changes",
) -> InputError:  # fmt: skip
    return InputError("is not written in decks", key=key, value=value, allowed=allowed, next_step=next_step)


def _check_leg(i: int, leg: model.Leg, length: float) -> None:
    if leg.screw is not None and leg.screw.loops:
        if leg.screw.lag:
            raise _refused("leg.drive.motor.bandwidth", "torques that come at once", value=leg.screw.motor.bandwidth)
        raise _refused("leg.drive.encoder.at", 'rotor; or command = "position"', value=leg.measured)
    if leg.piston.sections:
        one = "Give one diameter: that of the section whose stiffness counts most"
        raise _refused("leg.piston.sections", "one section", next_step=one)
    if leg.piston.shear:
        said = "Leave it out; `check` says by how much shear counts"
        raise _refused("leg.piston.shear", "false: Euler-Bernoulli beams", value=True, next_step=said)
    for key, there in (("leg.guide", leg.guide), ("leg.cylinder.diameter", leg.cylinder.section)):
        if there is not None:
            raise _refused(key, "a piston clamped in the mouth of a rigid cylinder")
    free = length - leg.cylinder.mouth
    if leg.piston.length < free * (1 - 1e-9):
        raise InputError(
            f"of leg {i} does not reach back to the mouth of its cylinder at this pose",
            key="leg.piston.length",
            value=leg.piston.length,
            allowed=f"at least {free:.6g} m, the leg's length less leg.cylinder.mouth",
            next_step="Choose another pose, or a longer piston",
        )
    if not leg.piston.rhoA:
        raise InputError(
            f"of leg {i} leaves its solid elements without mass: finite element programs want some for frequencies",
            key="leg.piston.rhoA",
            value=0,
            next_step="Give a small rhoA, as 1e-6 kg/m",
        )
    if not leg.cylinder.mass and (leg.cylinder.inertia or leg.cylinder.axial_inertia):
        raise InputError(
            f"of leg {i} has inertia without mass, which point masses cannot have",
            key="leg.cylinder.inertia",
            value=leg.cylinder.inertia,
            next_step="Give leg.cylinder.mass, or no inertia",
        )
