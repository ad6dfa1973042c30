"""A leg on the rigid path: lengths, margins, forces, stresses, buckling."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.analysis.checks.estimates import STATIONS, piston_section
from flexapod.analysis.checks.plausibility import NEAR_BUCKLING, SLENDERNESS, buckling_numbers, thick_numbers
from flexapod.analysis.results.remarks import Doubt, remark, worst_remarks
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.ranking import first_largest, first_least, largest_item
from flexapod.model import Leg, Robot
from flexapod.model.study.simulation import SOLID

OFF_LOAD = 2.0  # times another load: 12 % of stiffness


@dataclass(frozen=True, kw_only=True)
class Extreme:
    """The largest or smallest value of a quantity, and its instant [s]."""

    value: float
    time: float


def minimum(t: Array, values: Array) -> Extreme:
    """The least of values (T,) at instants `t`."""
    return Extreme(value=float(values.min()), time=float(t[first_least(values)]))


def maximum(t: Array, values: Array) -> Extreme:
    """The largest of values (T,) at instants `t`."""
    return Extreme(value=float(values.max()), time=float(t[first_largest(values)]))


@dataclass(frozen=True, kw_only=True)
class CarriageTravel:
    """Least and largest position of a carriage [m, of a crank rad]; least distance from its limits, None without."""

    kind: str
    low: Extreme
    high: Extreme
    margin: Extreme | None


@dataclass(frozen=True, kw_only=True)
class Stress:
    """Largest stresses in a piston [Pa]: axial, bending, and their sum; `yield_stress` where it is known."""

    axial: float
    bending: float
    total: Extreme
    yield_stress: float | None


@dataclass(frozen=True, kw_only=True)
class LegDescription:
    """One leg on the rigid path, SI units.

    `home`, `shortest`, `longest`: joint to joint; `stroke`: allowed, None without limits; `stroke_margin`: least
    distance from them; `guided`: least length of piston in the cylinder, None of a strut; `slenderness`: least free
    length over width; `carriage`: where that goes, None without one; `drive`: what drives the leg ("stroke", "slider",
    "crank", "" of a passive leg); `force_min`, `force_max`: of the drive [N, of cranks N m], positive pushes out;
    `euler_share`: largest thrust over Euler load (T8.11), 0 if never pushed, `euler_load` there; `stress`: None where
    section or material is not known.
    """

    leg: int
    chain: str
    home: float
    shortest: Extreme
    longest: Extreme
    stroke: tuple[float, float] | None
    stroke_margin: Extreme | None
    guided: Extreme | None
    slenderness: float
    carriage: CarriageTravel | None
    drive: str
    force_min: Extreme
    force_max: Extreme
    euler_share: Extreme
    euler_load: float
    stress: Stress | None


@dataclass(frozen=True, kw_only=True)
class LegPath:
    """A leg along the rigid path, each shape (T,), `moment` at `STATIONS` from the tip (stations, T).

    `time` [s]; `length` joint to joint [m]; `carriage` [m, rad]; `force` of the drive [N, N m] and `thrust` along the
    leg at its tip [N]; bending `moment` [N m]; `euler`: thrust at which it buckles [N].
    """

    time: Array
    length: Array
    carriage: Array
    force: Array
    thrust: Array
    moment: Array
    euler: Array


def describe_leg(number: int, leg: Leg, path: LegPath, home: float) -> LegDescription:
    """Extremes of a leg.

    Parameters
    ----------
    number : int
        From 1.
    leg : Leg
    path : LegPath
    home : float
        Length at home [m].
    """
    t, length = path.time, path.length
    free = length - leg.cylinder.mouth
    along = path.force if leg.driven == "stroke" else path.thrust
    pushed = np.maximum(along, path.thrust)  # the axial force goes from the drive's to the tip's along the piston
    euler = path.euler
    near = first_largest(pushed / euler)
    inside = np.minimum(leg.piston.length, leg.piston.length - free)
    return LegDescription(
        leg=number,
        chain=leg.chain,
        home=home,
        shortest=minimum(t, length),
        longest=maximum(t, length),
        stroke=None if leg.stroke is None else (leg.stroke.min, leg.stroke.max),
        stroke_margin=_margin(leg, t, length),
        guided=None if leg.strut is not None else minimum(t, inside),
        slenderness=float(free.min() / leg.piston.width),
        carriage=_way(leg, t, path.carriage),
        drive=leg.carriage.kind if leg.carriage and leg.driven == "carriage" else leg.driven,
        force_min=minimum(t, path.force),
        force_max=maximum(t, path.force),
        euler_share=Extreme(value=max(0.0, float(pushed[near] / euler[near])), time=float(t[near])),
        euler_load=float(euler[near]),
        stress=_stress(leg, t, np.maximum(np.abs(along), np.abs(path.thrust)), path.moment, free),
    )


def _way(leg: Leg, t: Array, place: Array) -> CarriageTravel | None:
    if leg.carriage is None:
        return None
    travel = leg.carriage.stroke
    margin = None if travel is None else minimum(t, np.minimum(place - travel.min, travel.max - place))
    return CarriageTravel(kind=leg.carriage.kind, low=minimum(t, place), high=maximum(t, place), margin=margin)


def _margin(leg: Leg, t: Array, length: Array) -> Extreme | None:
    if leg.stroke is None:
        return None
    return minimum(t, np.minimum(length - leg.stroke.min, leg.stroke.max - length))


def _stress(leg: Leg, t: Array, force: Array, moment: Array, free: Array) -> Stress | None:
    piston = leg.piston
    if not piston.sections and (piston.depth is None or piston.E is None):
        return None
    # by section: axial stress of a force, bending stress of a moment, of a strip about its weak axis
    steps = piston.steps_or_one[::-1]
    per_force = np.array([step.E / step.EA for step in steps])
    per_moment = np.array(
        [max(step.E * d / (2 * EI) for d, EI in zip(step.depth, step.EI, strict=True)) for step in steps]
    )
    ends = np.cumsum([step.length for step in steps])[:-1]
    section = np.searchsorted(ends, np.multiply.outer(STATIONS, free))
    axial = force * per_force.max()
    bending = (moment * per_moment[section]).max(axis=0)
    return Stress(
        axial=float(axial.max()),
        bending=float(bending.max()),
        total=maximum(t, axial + bending),
        yield_stress=piston.yield_stress,
    )


def load_remarks(legs: tuple[LegDescription, ...], robot: Robot, fidelity: str) -> list[str]:
    """Doubts about loads and about legs too thick for the `fidelity`, each of the leg where it is worst."""
    remarks = []
    worst = largest_item(legs, key=lambda leg: leg.euler_share.value)
    slim = [found for found, leg in zip(legs, robot.legs, strict=True) if not leg.piston.shear]
    share, slender = worst.euler_share, largest_item(slim, key=lambda leg: -leg.slenderness) if slim else None
    if share.value > NEAR_BUCKLING:
        numbers = buckling_numbers(share.value, share.value * worst.euler_load, f" at t = {share.time:.6g} s")
        remarks.append(Doubt(leg=worst.leg - 1, kind="buckling", severity=share.value, numbers=numbers))
    if slender is not None and slender.slenderness < SLENDERNESS:
        kind = "thick on the path, solid" if fidelity == SOLID else "thick on the path"
        numbers = {"ratio": slender.slenderness, **_thick(robot.legs[slender.leg - 1], slender.slenderness)}
        remarks.append(Doubt(leg=slender.leg - 1, kind=kind, severity=1 / slender.slenderness, numbers=numbers))
    return [*worst_remarks([*remarks, *_unloading(legs, robot)]), *_yielding(legs)]


def bearing_remarks(path: RigidPath) -> list[str]:
    """Joints on rolling bearings that bear another load at the start than that about which their law is taken."""
    at_start = np.abs(np.einsum("li,li->l", path.forces.joint_force[0], path.axes[0]))
    found: dict[str, list[tuple[float, int, float]]] = {}
    for i, leg in enumerate(path.robot.legs):
        for end, joint in (("base", leg.base_joint), ("platform", leg.platform_joint)):
            if joint.rolling is not None:
                given = joint.rolling.load + (joint.rolling.preload or 0.0)
                here = float(at_start[i]) + (joint.rolling.preload or 0.0)
                found.setdefault(end, []).append((max(here / given, given / max(here, 1e-300)), i + 1, at_start[i]))
    remarks = []
    for end, joints in found.items():
        off, leg, load = max(joints)
        if off > OFF_LOAD:
            known = getattr(path.robot.legs[leg - 1], f"{end}_joint").rolling.load
            remarks.append(remark("bearing", leg=leg, end=end, load=float(load), known=known))
    return remarks


def _thick(leg: Leg, slenderness: float) -> dict[str, object]:
    return thick_numbers(piston_section(leg.piston), slenderness * leg.piston.width)


def _unloading(legs: tuple[LegDescription, ...], robot: Robot) -> list[Doubt]:
    """The leg whose thrust goes farthest beyond what the preload of its nut takes, if any does."""
    over = []
    for found, leg in zip(legs, robot.legs, strict=True):
        force = largest_item((found.force_min, found.force_max), key=lambda force: abs(force.value))
        if leg.screw is not None and abs(force.value) > leg.screw.nut.linear_to:
            when, limit = f" at t = {force.time:.6g} s", leg.screw.nut.linear_to
            numbers = {"thrust": abs(force.value), "when": when, "limit": limit}
            over.append(Doubt(leg=found.leg - 1, kind="nut", severity=abs(force.value) / limit, numbers=numbers))
    return [largest_item(over, key=lambda doubt: doubt.severity)] if over else []


def _yielding(legs: tuple[LegDescription, ...]) -> list[str]:
    """The leg that is stressed farthest above its yield stress, if any is."""
    over = [
        (leg.stress.total.value / leg.stress.yield_stress, leg.leg, leg.stress)
        for leg in legs
        if leg.stress is not None and leg.stress.yield_stress is not None
    ]
    ratio, leg, stress = largest_item(over, key=lambda entry: entry[0]) if over else (0.0, 0, None)
    if stress is None or ratio <= 1:
        return []
    return [remark("yields", leg=leg, stress=stress.total.value / 1e6, time=stress.total.time, ratio=ratio)]
