"""Remarks on results that leave the theory: slopes, strokes, axial loads, slenderness, strains."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from flexapod.analysis.checks.estimates import (
    BendingSection,
    beam_section,
    bending_errors,
    buckling_load,
    buckling_loads,
    piston_section,
    soft_guide_legs,
)
from flexapod.analysis.results.bodies import flexible_axes
from flexapod.analysis.results.legs import bending_amplitudes_of_leg, bending_basis, lateral_amplitudes
from flexapod.analysis.results.remarks import Doubt, remark, worst_remarks
from flexapod.analysis.results.time_history import Record
from flexapod.common.arrays import Array
from flexapod.common.ranking import first_largest, first_least
from flexapod.mechanics.leg.layout import Shapes
from flexapod.mechanics.shapes import LateralBasis
from flexapod.model import Actuator, Leg, Robot
from flexapod.model.study.simulation import SOLID
from flexapod.solve.batch import RestStates
from flexapod.solve.sections import leg_values, stepped_stress
from flexapod.solve.shapes import amplitudes, lateral_signs
from flexapod.solve.system import System

SLOPE = 0.1  # tip slope up to which second order in the amplitudes is enough
SLENDERNESS = 10.0  # free length over width below which shear is no longer small
STROKE_ROUNDING = 1e-9  # excess over a stroke that is rounding or solver residual [m]
NEAR_BUCKLING = 0.5  # share of the Euler load from which stiffness has changed by half
STATIONS = np.linspace(0.0, 1.0, 21)
KINDS = {"slope", "stroke", "buckling", "nut", "slenderness", "yield"}  # of remarks on a leg


@dataclass(frozen=True)
class _When:
    """Text for the kth of several states: its instant of `time` [s], or empty at rest."""

    time: Array | None = None

    def __getitem__(self, k: int) -> str:
        return "" if self.time is None else f" at t = {self.time[k]:.6g} s"


def robot_warnings(robot: Robot, system: System, record: Record) -> list[str]:
    """Remarks on a simulation of a robot, each with leg, instant, value and limit."""
    return _leg_warnings(robot, system, record, _When(record.time))


def rest_warnings(robot: Robot, system: System, states: RestStates) -> list[str]:
    """Remarks on a robot at rest, each with leg, value and limit."""
    return _leg_warnings(robot, system, states, _When())


def _leg_warnings(robot: Robot, system: System, record: Record | RestStates, when: _When) -> list[str]:
    axes = flexible_axes(robot, system, record)
    compression = np.einsum("tli,tli->tl", record.lam[..., :3], axes)
    shapes, basis, found = system.kernel.shapes, bending_basis(system.kernel.shapes), []
    inside = soft_guide_legs(robot)
    own = system if shapes.beam.a.count or shapes.beam.b.count else None
    loads = buckling_loads(robot, record.q[..., shapes.l_index], own) if inside.any() else None
    low, high, most_thrust = record.q.min(axis=0), record.q.max(axis=0), np.abs(compression).max(axis=0)
    amplitude = np.sqrt(2) * lateral_amplitudes(shapes, np.maximum(high, -low)).max(
        axis=1
    )  # of both directions together
    slope, curved = amplitude @ np.abs(basis.tip_slope), amplitude @ np.abs(_curvatures(basis)).max(axis=1, initial=0.0)
    for i, leg in enumerate(robot.legs):
        load = None if loads is None else loads[:, i]
        lengths = (low[i, shapes.l_index], high[i, shapes.l_index])
        closer = leg.piston.sections or shapes.beam.shear
        doubt = KINDS if closer else _in_doubt(leg, lengths, (slope[i], curved[i]), most_thrust[i], load)
        if not doubt:
            continue
        length, push = record.q[:, i, shapes.l_index], compression[:, i]
        free, bent = length - leg.cylinder.mouth, bending_amplitudes_of_leg(leg, shapes, record.q[:, i])
        remarks: list[_Found] = []
        if "slope" in doubt:
            remarks += _slope(leg_values(leg, basis, free, np.ones(1), 1)[:, :, 0] / free, bent, when)
        remarks += _stroke(leg, length, when) if "stroke" in doubt else []
        remarks += _axial(leg, free, push, when, load) if "buckling" in doubt else []
        remarks += _nut(leg, push, when) if "nut" in doubt else []
        remarks += _slender(leg, basis, free, when) if "slenderness" in doubt else []
        remarks += _stress(leg, basis, bent, free, push, when) if "yield" in doubt else []
        found += [Doubt(leg=i, kind=kind, severity=bad, numbers=numbers) for kind, bad, numbers in remarks]
    return worst_remarks(found)


def _in_doubt(
    leg: Leg, lengths: tuple[float, float], bent: tuple[float, float], thrust: float, load: Array | None
) -> set[str]:
    """Kinds of remarks that extremes of a leg alone do not exclude.

    `lengths`: least and largest [m]; `bent`: bounds of slope and curvature of a free length of one [m]; `thrust`: the
    largest [N]; `load`: Euler loads (T,) [N], where more than its piston gives way.
    """
    piston, limit, (low, high) = leg.piston, leg.stroke, lengths
    shortest, longest = low - leg.cylinder.mouth, high - leg.cylinder.mouth
    stress = 0.0
    if piston.E is not None and piston.depth is not None:
        stress = piston.E * (thrust / piston.EA + bent[1] / shortest**2 * piston.depth / 2)
    push, most = (thrust * longest**2, piston.least_EI * (np.pi / 2) ** 2) if load is None else (thrust, load.min())
    excluded = {
        "slope": bent[0] <= SLOPE * shortest,
        "stroke": limit is None or (low >= limit.min and high <= limit.max),
        "buckling": push <= NEAR_BUCKLING * most,
        "nut": leg.screw is None or thrust <= leg.screw.nut.linear_to,
        "slenderness": piston.shear or shortest >= SLENDERNESS * piston.width,
        "yield": piston.yield_stress is None or stress <= piston.yield_stress,
    }
    return {kind for kind in KINDS if not excluded[kind]}


def actuator_warnings(actuator: Actuator, shapes: Shapes, record: Record) -> list[str]:
    """Remarks on a simulation of a single actuator."""
    basis, free = shapes.beam.a, record.q[:, 0, shapes.l_index] - actuator.hub_radius
    lateral = np.stack([amplitudes(shapes, record.q[:, 0], name) for name, _ in lateral_signs(shapes, 1, 1)], axis=1)
    when = _When(record.time)
    found = _slope(basis.tip_slope[None, :, None] / free, lateral, when)
    if actuator.section is not None and actuator.material is not None:
        depth, material = actuator.section.depth, actuator.material
        section = beam_section(actuator)
        if free.min() < SLENDERNESS * depth and section is not None:
            k = first_least(free)
            found.append(_thick(free[k], depth, section, basis, when[k]))
        if material.yield_stress is not None:
            bending = _bending(basis, lateral, free) * material.E * depth / 2
            found += _yielding(bending, material.yield_stress, when)
    return [f"the beam: {remark(kind, **numbers)}" for kind, _, numbers in found]


def leg_stress(leg: Leg, basis: LateralBasis, lateral: Array, free: Array, compression: Array) -> Array | None:
    """Largest axial plus bending stress in a piston at T instants [Pa], Eq. (T8.10); None without section and material.

    Parameters
    ----------
    leg : Leg
    basis : LateralBasis
    lateral : ndarray, shape (T, 2, k)
        Amplitudes [m].
    free, compression : ndarray, shape (T,)
        Free length [m] and axial force [N].
    """
    piston = leg.piston
    if piston.sections:
        return stepped_stress(leg, basis, lateral, free, compression)
    if piston.depth is None or piston.E is None:
        return None
    bending = _bending(basis, lateral, free) * piston.E * piston.depth / 2
    return np.abs(compression) * piston.E / piston.EA + bending


_Found = tuple[str, float, Mapping[str, object]]  # kind, severity (value over limit), numbers of a remark


def _slope(slopes: Array, lateral: Array, when: _When) -> list[_Found]:
    """Remark on the tip slope, by the slopes of the shapes at the tip, (directions, k, T) [1/m]."""
    if not lateral.shape[-1]:
        return []
    slope = np.linalg.norm((np.moveaxis(slopes, -1, 0) * lateral).sum(axis=-1), axis=1)
    k = first_largest(slope)
    if slope[k] <= SLOPE:
        return []
    return [("slope", slope[k] / SLOPE, {"slope": slope[k], "when": when[k], "limit": SLOPE})]


def _stroke(leg: Leg, length: Array, when: _When) -> list[_Found]:
    """Strokes that are a result, not commands, may leave their limits; the stops there are not part of the model."""
    if leg.stroke is None:
        return []
    excess = np.maximum(leg.stroke.min - length, length - leg.stroke.max)
    k = first_largest(excess)
    if excess[k] <= STROKE_ROUNDING:
        return []
    low, high = leg.stroke.min, leg.stroke.max
    return [("stroke", excess[k], {"low": low, "high": high, "excess": 1e3 * excess[k], "when": when[k]})]


def _axial(leg: Leg, free: Array, compression: Array, when: _When, load: Array | None) -> list[_Found]:
    if load is None and (compression * free**2).max() <= NEAR_BUCKLING * leg.piston.least_EI * (np.pi / 2) ** 2:
        return []  # even with the least root that (T8.11) can have
    share = compression / (buckling_load(leg, free) if load is None else load)
    k = first_largest(share)
    if share[k] <= NEAR_BUCKLING:
        return []
    return [("buckling", share[k], buckling_numbers(share[k], compression[k], when[k]))]


def _nut(leg: Leg, thrust: Array, when: _When) -> list[_Found]:
    """A thrust that unloads one half of a preloaded nut (T15.9)."""
    if leg.screw is None:
        return []
    share, k = np.abs(thrust) / leg.screw.nut.linear_to, first_largest(np.abs(thrust))
    limit = leg.screw.nut.linear_to
    return [("nut", share[k], {"thrust": abs(thrust[k]), "when": when[k], "limit": limit})] if share[k] > 1 else []


def buckling_numbers(share: float, force: float, when: str) -> dict[str, object]:
    """An axial force [N] near the Euler load (T8.11), or above it, and when: for all that remark on it."""
    does = "buckles" if share >= 1 else "is close to buckling"
    return {"share": share, "force": force, "when": when, "does": does}


def _slender(leg: Leg, basis: LateralBasis, free: Array, when: _When) -> list[_Found]:
    width, k = leg.piston.width, first_least(free)
    if free[k] >= SLENDERNESS * width or leg.piston.shear:
        return []
    return [_thick(free[k], width, piston_section(leg.piston), basis, when[k])]


def _thick(free: float, width: float, section: BendingSection, basis: LateralBasis, when: str) -> _Found:
    ratio, kind = free / width, "thick, solid" if basis.name == SOLID else "thick"
    return (kind, SLENDERNESS / ratio, {"ratio": ratio, "when": when, **thick_numbers(section, free)})


def thick_numbers(section: BendingSection, free: float) -> dict[str, object]:
    """Errors [%] of shapes without shear or rotary inertia in a leg that is not slender."""
    per_cent = (100 * error for error in bending_errors(section, free))
    return {"limit": SLENDERNESS, **dict(zip(("deflection", "frequency", "inertia"), per_cent, strict=True))}


def _bending(basis: LateralBasis, lateral: Array, free: Array) -> Array:
    """Largest curvature along the free piston, (T,) [1/m]."""
    if not basis.count:
        return np.zeros(len(free))
    square = np.zeros((len(STATIONS), len(free)))
    for k in range(lateral.shape[1]):  # one lateral direction of an actuator, two of a leg
        square += (_curvatures(basis).T @ lateral[:, k].T) ** 2
    return np.sqrt(square.max(axis=0)) / free**2


@lru_cache(maxsize=64)
def _curvatures(basis: LateralBasis) -> Array:
    """Second derivatives of the shapes at the stations, (k, 21)."""
    return basis.values(STATIONS, 2)


def _stress(
    leg: Leg, basis: LateralBasis, lateral: Array, free: Array, compression: Array, when: _When
) -> list[_Found]:
    stress = leg_stress(leg, basis, lateral, free, compression)
    if stress is None or leg.piston.yield_stress is None:
        return []
    return _yielding(stress, leg.piston.yield_stress, when)


def _yielding(stress: Array, limit: float, when: _When) -> list[_Found]:
    k = first_largest(stress)
    if stress[k] <= limit:
        return []
    return [("yield", stress[k] / limit, {"stress": stress[k] / 1e6, "when": when[k], "limit": limit / 1e6})]
