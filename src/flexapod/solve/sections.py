"""Pistons of several sections as parameters of a kernel, and their shapes as numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexapod.bases import LateralBasis
from flexapod.bases.beam_functions import gauss_unit
from flexapod.bases.lateral import proportional_damping
from flexapod.elements.steps import Piece, Uniform, held, pieces, sheared
from flexapod.mechanics.layout import Shapes
from flexapod.model import Leg, damping_parts
from flexapod.model.sections import Step
from flexapod.typing import Array

_GLAND = 0.01  # of the piston's length: within which the mouth takes a cut up
_POINTS, _WEIGHTS = gauss_unit(24)
_STRESS_POINTS = 6  # on a section


def steps_of(leg: Leg) -> tuple[Step, ...]:
    """Uniform pieces of a piston from the tip to the driven end."""
    return leg.piston.steps_or_one[::-1]


def section_parameters(leg: Leg, shapes: Shapes, home: float) -> dict[str, object]:
    """Parameters of the sections of a leg whose length at home is given [m], by name."""
    steps, piston = steps_of(leg), leg.piston
    n, m, zeta = shapes.sections, shapes.axial.count, damping_parts(leg.damping)[0]
    padded = (steps[0]._replace(length=0.0),) * (n - len(steps)) + steps
    length, EA, rhoA = (np.array([getattr(step, name) for step in padded]) for name in ("length", "EA", "rhoA"))
    EI = np.array([step.EI for step in padded]).T
    ends = np.concatenate([[0.0], np.cumsum(length)])
    soft = np.concatenate([[0.0], np.cumsum(length / EA)])
    place, shrink = 1 - (soft[:-1] - ends[:-1] / EA) / soft[-1], 1 / (EA * soft[-1])
    xi = ends[:-1, None] + length[:, None] * _POINTS
    dm = (rhoA * length)[:, None] * _WEIGHTS
    psi = shapes.axial.values((place[:, None] - shrink[:, None] * xi).ravel())
    along, dm = piston.length - xi.ravel(), dm.ravel()
    mass = (psi * dm) @ psi.T
    whole = rhoA @ length
    free = home - leg.cylinder.mouth
    found = [_damping(leg, shapes, free, 1 if plane == "b" else 0) for plane in shapes.planes]
    lateral = np.zeros((sum(map(len, found)),) * 2)
    for k, part in enumerate(found):
        lateral[k * len(part) : (k + 1) * len(part), k * len(part) : (k + 1) * len(part)] = part
    return {
        "section_cuts": ends[1:-1],
        "gland": piston.length * (_GLAND if leg.cylinder.mouth > 0 else 1e-6),
        "section_rhoA": rhoA,
        "section_load": loads(rhoA),
        "section_EI_a": EI[0],
        "section_EI_b": EI[1],
        "section_shear": np.array([step.shear for step in padded]),
        "section_turning_a": np.array([turning(step, 0) for step in padded]),
        "section_turning_b": np.array([turning(step, 1) for step in padded]),
        "piston_turning": np.array([sum(turning(step, k) * step.length for step in steps) for k in (0, 1)]),
        "section_place": place,
        "section_shrink": shrink,
        "piston_moments": np.array([dm @ along, dm @ along**2]) / whole if whole else np.zeros(2),
        "axial_first": psi @ dm,
        "axial_moment": psi @ (dm * along),
        "axial_mass": mass,
        "axial_damping": 2 * zeta * proportional_damping(mass, piston.EA / piston.length * shapes.axial.stiffness)
        if whole
        else np.zeros((m, m)),
        "lateral_damping": 2 * zeta * free * lateral,
    }


def loads(rhoA: Array) -> Array:
    """Mass per length over its mean, of pistons without mass 1."""
    return rhoA / rhoA.mean() if rhoA.any() else np.ones_like(rhoA)


def numeric_pieces(leg: Leg, basis: LateralBasis, free: Any, direction: int) -> list[Piece]:
    """Shapes of a leg at free lengths [m], a number or (N,), along leg x (0) or y (1), before (T1.22)."""
    steps = steps_of(leg)
    rhoA, EI = np.array([step.rhoA for step in steps]), np.array([step.EI[direction] for step in steps])
    cuts = [np.minimum(cut / free, 1.0) for cut in np.cumsum([step.length for step in steps])[:-1]]
    one = np.ones_like(cuts[0]) if cuts else 1.0
    return pieces(Uniform(basis=basis), [0 * one, *cuts, one], loads(rhoA).tolist(), (EI[0] / EI).tolist())


def leg_values(leg: Leg, basis: LateralBasis, free: Array, zeta: Array, derivative: int = 0) -> Array:
    """Shapes of a leg, or their derivatives by zeta up to the second, at free lengths [m].

    Parameters
    ----------
    leg : Leg
    basis : LateralBasis
        Those of a uniform piston.
    free : ndarray, shape (N,)
    zeta : ndarray, shape (P,)
    derivative : int

    Returns
    -------
    ndarray, shape (2, k, P, N)
        Along leg x and y.
    """
    if not leg.piston.sections or not basis.count:
        values = basis.values(zeta, derivative)[None, :, :, None]
        return np.broadcast_to(values, (2, basis.count, len(zeta), len(free)))
    return np.array([_along(numeric_pieces(leg, basis, free, k), zeta, derivative) for k in (0, 1)])


def _along(parts: list[Piece], zeta: Array, derivative: int) -> Array:
    found = []
    for x in 1.0 - zeta:
        part = np.array([_derivative(piece, x, derivative) for piece in parts])
        there = sum(x > piece.end for piece in parts[:-1]) if len(parts) > 1 else np.zeros(part.shape[-1], dtype=int)
        found.append(np.take_along_axis(part, np.broadcast_to(there, part.shape[1:])[None], axis=0)[0])
    values = np.stack(found, axis=1)
    return values - held(parts[0].value(0 * parts[0].start))[:, None] * values[:1]


def _derivative(piece: Piece, x: float, derivative: int) -> Array:
    at = x + 0 * piece.start
    return piece.give * piece.moment(at) if derivative == 2 else (-1.0) ** derivative * piece.value(at, derivative)


def shear_tips(leg: Leg, shapes: Shapes, free: Array) -> Array:
    """Deflections at the tip of the shapes of shear before (T1.22), at free lengths (N,), (k, N)."""
    softs = [steps_of(leg)[0].shear / step.shear for step in steps_of(leg)]
    return sheared(numeric_pieces(leg, shapes.sheared or shapes.b, free, 1), softs)[0].value(0 * free)


def bending_amplitudes(leg: Leg, shapes: Shapes, q: Array) -> Array:
    """Amplitudes of bending alone out of coordinates (T, n) of a leg whose piston shears, (T, 2, k) [m]."""
    k, free = shapes.b.count, q[:, shapes.l_index] - leg.cylinder.mouth
    found, tips = np.zeros((len(q), 2, k)), shear_tips(leg, shapes, free)
    for direction, name in enumerate(("a", "b")):
        if shapes.has(f"shear_{name}"):
            own, by_shear = (q[:, shapes.index(x) :][:, :k] for x in (name, f"shear_{name}"))
            found[:, direction] = own
            found[:, direction, 0] -= (tips.T * by_shear).sum(axis=1)
    return found


def stepped_stress(leg: Leg, basis: LateralBasis, lateral: Array, free: Array, compression: Array) -> Array:
    """Largest axial plus bending stress in a piston of several sections, (T,) [Pa]; arguments of `leg_stress`."""
    largest = np.zeros(len(free))
    planes = [numeric_pieces(leg, basis, free, k) for k in (0, 1)] if basis.count else []
    tips = [held(parts[0].value(0 * parts[0].start)) for parts in planes]
    for j, step in enumerate(steps_of(leg)):
        bending = np.zeros(len(free))
        for share in np.linspace(0.0, 1.0, _STRESS_POINTS if basis.count else 0):
            bent = []
            for k, (parts, E) in enumerate(zip(planes, tips, strict=True)):
                x = parts[j].start + share * (parts[j].end - parts[j].start)
                curvature = parts[j].give * parts[j].moment(x)
                curvature = curvature - E * curvature[:1]
                outside = parts[j].end > parts[j].start
                bent.append(outside * (lateral[:, k].T * curvature).sum(axis=0) / free**2 * step.E * step.depth[k] / 2)
            bending = np.maximum(bending, np.hypot(*bent) if step.round else np.abs(bent).sum(axis=0))
        largest = np.maximum(largest, bending + np.abs(compression) * step.E / step.EA)
    return largest


def _damping(leg: Leg, shapes: Shapes, free: float, direction: int) -> Array:
    """Damping of ratio 1 in every mode of the bare piston at a free length, of bending and shear (K, K) [N s/m]."""
    basis, steps = shapes.b, steps_of(leg)
    size = basis.count * (1 + shapes.shear)
    M, K = np.zeros((size, size)), np.zeros((size, size))
    if not size:
        return M
    bent = numeric_pieces(leg, basis, np.array([free]), direction)
    E = held(bent[0].value(np.zeros(1)))
    softs = [steps[0].shear / step.shear for step in steps] if shapes.shear else []
    loads = numeric_pieces(leg, shapes.sheared, np.array([free]), direction) if shapes.sheared else []
    thick = sheared(loads, softs) if loads else []
    for j, step in enumerate(steps):
        long = bent[j].end - bent[j].start
        x, w = bent[j].start + long * _POINTS, long * _WEIGHTS
        value, turn, bend = (
            y - E * y[:1] for y in (bent[j].value(x), bent[j].value(x, 1), bent[j].give * bent[j].moment(x))
        )
        slope = 0 * turn
        if thick:
            tip = thick[0].value(np.zeros(1))
            turn, bend = (np.vstack([y, -tip * y[:1]]) for y in (turn, bend))
            value = np.vstack([value, thick[j].value(x) - tip * value[:1]])
            slope = np.vstack([slope, thick[j].slope(x)])
        M += step.rhoA * free * (value * w) @ value.T
        K += step.EI[direction] / free**3 * (bend * w) @ bend.T
        if thick:
            M += turning(step, direction) / free * (turn * w) @ turn.T
            K += step.shear / free * (slope * w) @ slope.T
    return proportional_damping(M, K) if M.any() else M


def turning(step: Step, direction: int) -> float:
    """Rotary inertia of a homogeneous section, rho I [kg m]."""
    return step.rhoA * step.EI[direction] / step.EA
