"""Machine as built and at operating temperature: its deviations and its poses, Eqs. (T16.1)-(T16.6)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics.closures import TAKEN, Task, eliminate_legs, gaps
from flexapod.kinematics.laws import Law, spline, spline_law
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN, FREE, HELD, Limbs
from flexapod.kinematics.mechanism import coordinates_of
from flexapod.kinematics.rigid_poses import inverse_kinematics
from flexapod.kinematics.robot import cache_per_robot, rigid_limbs
from flexapod.kinematics.rotations import carried_twists, exponential
from flexapod.kinematics.screws import screws
from flexapod.kinematics.trajectory import Poses
from flexapod.model.heat import HEAT_PARTS
from flexapod.model.leg.material import MATERIALS

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

    from flexapod.model import Heat, Leg, Robot

GEOMETRY = ("base_joints", "platform_joints", "leg_offset", "lead")
CHI, L = COORDINATES.index("chi"), COORDINATES.index("l")
STEPS = 20


@dataclass(frozen=True, kw_only=True)
class BuiltPart:
    """Deviation of n legs from the nominal machine by one cause, in proportion to its `size` at an instant.

    ``base``, ``platform`` (n, 3) [m]: shifts of joints, world axes and platform axes; ``fixed``, ``share`` (n, 8): what
    is added to held and driven `COORDINATES` q, fixed + share q; ``values`` (T or 1, n): sizes at the instants
    ``time`` (T,), or always.
    """

    name: str
    base: Array
    platform: Array
    fixed: Array
    share: Array
    values: Array
    time: Array | None = None

    @property
    def cause(self) -> str:
        """Name of the cause in results."""
        return "geometry" if self.name in GEOMETRY else self.name

    def size(self, t: Array) -> Law:
        """Size at instants (T,) with its rates, each (T, n)."""
        if self.time is None:
            still = np.zeros((len(t), self.values.shape[1]))
            return Law(self.values + still, still, still)
        return spline_law(t, self._curve, first=float(self.time[0]), last=float(self.time[-1]))

    @cached_property
    def _curve(self) -> BSpline:
        return spline(self.time, self.values)  # type: ignore[arg-type]


@cache_per_robot
def built_parts(robot: Robot) -> tuple[BuiltPart, ...]:
    """Deviations from the nominal machine, cause by cause; none of a nominal robot."""
    return (*_geometry(robot), *_heat(robot))


def _geometry(robot: Robot) -> list[BuiltPart]:
    given, n = robot.geometry, robot.count
    if given is None:
        return []
    legs, found = rigid_limbs(robot), []
    acts = legs.given
    for name in GEOMETRY:
        value = getattr(given, name)
        if value is None:
            continue
        parts = {key: np.zeros((n, 3)) for key in ("base", "platform")} | {
            key: np.zeros((n, 8)) for key in ("fixed", "share")
        }
        if name in ("base_joints", "platform_joints"):
            parts[name.removesuffix("_joints")] = value
        elif name == "leg_offset":
            parts["fixed"][:, L] = np.where(acts[:, L], value, 0.0)
        else:
            turns = legs.carriage == "crank"
            driven = (legs.state[:, [CHI, L]] == DRIVEN) & [not turns, True]
            driven &= np.array([[leg.measured == "rotor"] for leg in robot.legs])
            parts["share"][:, [CHI, L]] = np.where(driven, np.broadcast_to(value, n)[:, None], 0.0)  # (T16.2)
            parts["fixed"] = -parts["share"] * legs.home
        found.append(BuiltPart(name=name, **parts, values=np.ones((1, n))))
    return found


def _heat(robot: Robot) -> list[BuiltPart]:
    heat, n = robot.heat, robot.count
    if heat is None:
        return []
    acts = rigid_limbs(robot).given[:, L]
    found = []
    for part in HEAT_PARTS:
        if not heat.warms(part):
            continue
        fixed, share, nothing = np.zeros((n, 8)), np.zeros((n, 8)), np.zeros((n, 3))
        for i, leg in enumerate(robot.legs):
            if acts[i]:
                fixed[i, L], share[i, L] = _grows(leg, part)
        grown = expansion(robot, heat, part) * (heat.temperatures(part, n) - heat.reference)  # (T16.3)
        varies = any(name.partition(" ")[0] == part for name in heat.columns)
        found.append(
            BuiltPart(
                name=f"heat_{part}",
                base=robot.base_joints if part == "base" else nothing,
                platform=robot.platform_joints if part == "platform" else nothing,
                fixed=fixed,
                share=share,
                values=grown if varies else grown[:1],
                time=heat.time if varies else None,
            )
        )
    return found


def _grows(leg: Leg, part: str) -> tuple[float, float]:
    """Length of a part of a leg of length l between its joints, a + b l: a and b, Eq. (T16.4).

    What lies before the place of measurement is made up for.
    """
    if leg.measured == "joint-to-joint" or (leg.measured == "stroke" and part == "screw"):
        return 0.0, 0.0
    if part == "piston":
        return leg.piston.length, 0.0
    inner = -leg.piston.length  # from the base joint to the piston's driven end: l + inner
    if leg.strut is not None or part in ("base", "platform"):
        return 0.0, 0.0
    if leg.drive.type != "screw":
        return (inner, 1.0) if part == "cylinder" else (0.0, 0.0)
    bearing = leg.drive.bearing.position  # up to there the cylinder, from there the screw
    return (bearing, 0.0) if part == "cylinder" else (inner - bearing, 1.0)


def expansion(robot: Robot, heat: Heat, part: str) -> Array:
    """Expansion of a part of each leg, (n,) [1/K]: as given, of its material, or of steel."""
    given, steel = getattr(heat.expansion, part, None), MATERIALS["steel"].expansion
    made_of = {
        "piston": [leg.piston.expansion for leg in robot.legs],
        "cylinder": [leg.cylinder.material and leg.cylinder.material.expansion for leg in robot.legs],
        "screw": [leg.drive.material.expansion if leg.drive.type == "screw" else None for leg in robot.legs],
    }
    own = made_of.get(part, [None] * robot.count)
    return np.array([given if given is not None else steel if value is None else value for value in own])


def shifts(robot: Robot, t: float = 0.0, parts: tuple[BuiltPart, ...] | None = None) -> tuple[Array, Array]:
    """Shifts of base joints (world axes) and platform joints (platform axes) at an instant, (n, 3) each [m]."""
    base, platform = np.zeros((2, robot.count, 3))
    for part in built_parts(robot) if parts is None else parts:
        size = part.size(np.array([t])).position[0, :, None]
        base, platform = base + size * part.base, platform + size * part.platform
    return base, platform


def added(part: BuiltPart, t: Array, q: Law) -> Law:
    """Contribution of a part to coordinates q (T, n, 8) at instants (T,), with rates, Eq. (T16.5)."""
    size, first, second = (x[..., None] for x in part.size(t))
    length = part.fixed + part.share * q.position
    rate, change = part.share * q.rate, part.share * q.acceleration
    return Law(size * length, size * rate + first * length, size * change + 2 * first * rate + second * length)


def added_by_all(robot: Robot, t: Array, q: Law) -> Law:
    """Contribution of all parts together to coordinates q (T, n, 8), with rates."""
    every = [added(part, t, q) for part in built_parts(robot)]
    return Law(*(np.sum(column, axis=0) for column in zip(*every, strict=True)))


def plate_grows(part: BuiltPart, t: Array, path: Poses, robot: Robot) -> Law:
    """Lengths (T, n) that legs UPS need more where a plate has grown since t = 0, with rates, Eq. (T16.25).

    `path`: poses at the instants (T,).
    """
    size = part.size(t)
    first = part.size(np.zeros(1)).position
    more = Law(size.position - first, size.rate, size.acceleration)
    R, w, change = path.rotation, path.omega[:, None], path.alpha[:, None]
    arm, tip = robot.platform_joints @ R.swapaxes(1, 2), part.platform @ R.swapaxes(1, 2)

    def turning(x: Array) -> tuple[Array, Array, Array]:
        rate = np.cross(w, x)
        return x, rate, np.cross(change, x) + np.cross(w, rate)

    s, v, a = (
        x + y[:, None] for x, y in zip(turning(arm), (path.position, path.velocity, path.acceleration), strict=True)
    )
    s = s - robot.base_joints
    length = np.linalg.norm(s, axis=-1, keepdims=True)
    n = s / length
    rate = _dots(n, v)
    n1 = (v - n * rate) / length
    n2 = (a - 2 * n1 * rate - n * (_dots(n, a) + _dots(n1, v))) / length
    z, z1, z2 = turning(tip)
    z, z1, z2 = part.base - z, -z1, -z2
    along = _dots(n, z)[..., 0]
    along1 = (_dots(n1, z) + _dots(n, z1))[..., 0]
    along2 = (_dots(n2, z) + 2 * _dots(n1, z1) + _dots(n, z2))[..., 0]
    return Law(
        more.position * along,
        more.rate * along + more.position * along1,
        more.acceleration * along + 2 * more.rate * along1 + more.position * along2,
    )


def _dots(x: Array, y: Array) -> Array:
    return (x * y).sum(axis=-1, keepdims=True)


def is_plate(part: BuiltPart) -> bool:
    """Test whether a part moves joints of base or platform over time."""
    return part.time is not None and bool(part.base.any() or part.platform.any())


def built_limbs(robot: Robot, limbs: Limbs, parts: tuple[BuiltPart, ...] | None = None) -> Limbs:
    """Legs of the robot as built at t = 0: joints elsewhere, rods of another length."""
    parts = built_parts(robot) if parts is None else parts
    if not parts:
        return limbs
    base, platform = shifts(robot, 0.0, parts)
    home, none = limbs.home.copy(), np.zeros((1, *limbs.home.shape))
    for part in parts:
        more = added(part, np.zeros(1), Law(limbs.home[None], none, none)).position[0]
        home += np.where(limbs.state == HELD, more, 0.0)
    return replace(limbs, base=limbs.base + base, platform=limbs.platform + platform, home=home)


def built_poses(robot: Robot, path: Poses, t: Array | None = None) -> Poses:
    """Poses at rest of the robot as built, under commands that bring the nominal one to `path`, Eq. (T16.6).

    Parameters
    ----------
    robot : Robot
    path : Poses
        T poses of the rigid path.
    t : ndarray, shape (T,), optional
        Instants at which they are taken [s], for temperatures over time; default 0.

    Raises
    ------
    ComputationError
        The legs do not fit together without strain.
    """
    legs, t = rigid_limbs(robot), np.zeros(len(path)) if t is None else t
    rest = Poses.at_rest(path.position, path.rotation)
    q = coordinates_of(inverse_kinematics(robot, rest))
    none = np.zeros_like(q)
    base, platform = np.zeros((2, len(t), len(legs), 3))
    for part in built_parts(robot):
        size = part.size(t).position[..., None]
        base, platform = base + size * part.base, platform + size * part.platform
        none = none + added(part, t, Law(q, np.zeros_like(q), np.zeros_like(q))).position
    found, gap = nearby(legs, q + np.where(legs.state == FREE, 0.0, none), rest, base, platform)
    if not (gap < TAKEN * legs.L_c).all():
        raise ComputationError(
            f"the legs as built do not fit together without strain: {1e6 * gap.max():.3g} um are left open",
            next_step="Errors in directions that joints hold strain the robot: a run with elastic legs follows them",
        )
    return found


def nearby(limbs: Limbs, q: Array, at: Poses, base: Array, platform: Array) -> tuple[Poses, Array]:
    """Poses next to T others of legs whose joints are shifted, Eq. (T16.6), and the remaining gaps (T,) [m].

    Parameters
    ----------
    limbs : Limbs
    q : ndarray, shape (T, n, 8)
        Coordinates: held and driven ones as they are, free ones to start from.
    at : Poses
        Where to start.
    base, platform : ndarray, shape (T, n, 3)
        Shifts of the joints [m], world axes and platform axes.
    """
    task = Task(limbs.state == FREE, ~limbs.hub_held, np.zeros(3))
    p, R, before = at.position.copy(), at.rotation.copy(), np.inf
    for _ in range(STEPS):
        chain = screws(limbs, q)
        apart = gaps(limbs, chain, Poses.at_rest(p, R))
        arms = (limbs.platform + platform) @ R.swapaxes(-1, -2)
        apart[..., :3] += base - platform @ R.swapaxes(-1, -2)
        dq, step = eliminate_legs(limbs, task, chain, carried_twists(arms)[..., task.platform]).solve(-apart)
        twist = np.zeros((len(q), 6))
        twist[:, task.platform] = step
        q, p, R = q + dq, p + twist[:, :3], exponential(twist[:, 3:]) @ R
        moved = max(np.abs(dq).max(initial=0.0), np.abs(twist).max(initial=0.0))
        if moved < 1e-9 and moved >= 0.1 * before:  # quadratic until only rounding is left
            break
        before = moved
    apart = gaps(limbs, screws(limbs, q), Poses.at_rest(p, R))
    apart[..., :3] += base - platform @ R.swapaxes(-1, -2)
    return Poses.at_rest(p, R), np.abs(apart).max(axis=(1, 2), initial=0.0)
