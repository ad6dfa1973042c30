"""Pistons of several sections as parameters of a kernel, and their shapes as numbers."""

from __future__ import annotations

import numpy as np

from flexapod.bases import LateralBasis
from flexapod.bases.beam_functions import gauss_unit
from flexapod.bases.lateral import proportional_damping
from flexapod.elements.steps import Piece, Uniform, pieces
from flexapod.mechanics.layout import Shapes
from flexapod.model import Leg, damping_parts
from flexapod.model.sections import Step
from flexapod.typing import Array

_GLAND = 0.01  # of the piston's length: within which the mouth takes a cut up
_POINTS, _WEIGHTS = gauss_unit(24)


def steps_of(leg: Leg) -> tuple[Step, ...]:
    """Uniform pieces of a piston from the tip to the driven end; a uniform one is a piece."""
    p = leg.piston
    if p.sections:
        return p.steps[::-1]
    depth = (p.depth or 0.0, p.depth or 0.0)
    return (Step(p.length, p.EA, (p.EI, p.EI), p.rhoA, p.torsional_stiffness, p.E or 0.0, depth, 0.0, p.yield_stress),)


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


def numeric_pieces(leg: Leg, basis: LateralBasis, free: float, direction: int) -> list[Piece]:
    """Shapes of a leg at a free length [m], along leg x (0) or y (1)."""
    steps = steps_of(leg)
    rhoA, EI = np.array([step.rhoA for step in steps]), np.array([step.EI[direction] for step in steps])
    cuts = np.minimum(np.cumsum([step.length for step in steps])[:-1] / free, 1.0)
    return pieces(Uniform(basis=basis), [0.0, *cuts.tolist(), 1.0], loads(rhoA).tolist(), (EI[0] / EI).tolist())


def _damping(leg: Leg, shapes: Shapes, free: float, direction: int) -> Array:
    """Damping of ratio 1 in every mode of the bare piston at a free length, (k, k) [N s/m]."""
    basis = shapes.b
    M, K = np.zeros((basis.count, basis.count)), np.zeros((basis.count, basis.count))
    if not basis.count:
        return M
    for piece, step in zip(numeric_pieces(leg, basis, free, direction), steps_of(leg), strict=True):
        x, w = piece.start + (piece.end - piece.start) * _POINTS, (piece.end - piece.start) * _WEIGHTS
        value, bend = piece.value(x), piece.give * piece.moment(x)
        M += step.rhoA * free * (value * w) @ value.T
        K += step.EI[direction] / free**3 * (bend * w) @ bend.T
    return proportional_damping(M, K) if M.any() else M
