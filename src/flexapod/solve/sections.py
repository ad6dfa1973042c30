"""Pistons of several sections as parameters of a kernel, and their shapes as numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexapod.bases import LateralBasis
from flexapod.bases.beam_functions import gauss_unit
from flexapod.bases.lateral import proportional_damping
from flexapod.elements.steps import Piece, Uniform, held, pieces
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
    """Damping of ratio 1 in every mode of the bare piston at a free length, (k, k) [N s/m]."""
    basis = shapes.b
    M, K = np.zeros((basis.count, basis.count)), np.zeros((basis.count, basis.count))
    if not basis.count:
        return M
    parts = numeric_pieces(leg, basis, free, direction)
    E = held(parts[0].value(np.zeros(1)))
    for piece, step in zip(parts, steps_of(leg), strict=True):
        x, w = piece.start + (piece.end - piece.start) * _POINTS, (piece.end - piece.start) * _WEIGHTS
        value, bend = (y - E @ y[:1] for y in (piece.value(x), piece.give * piece.moment(x)))
        M += step.rhoA * free * (value * w) @ value.T
        K += step.EI[direction] / free**3 * (bend * w) @ bend.T
    return proportional_damping(M, K) if M.any() else M
