"""Pistons of several sections as parameters of a kernel, and their shapes as numbers."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.elements.chains import chain, is_chain
from flexapod.mechanics.elements.steps import (
    Piece,
    StepNodes,
    Uniform,
    law,
    nodes,
    piece_nodes,
    pieces,
    shear_pieces,
    tip_elimination,
)
from flexapod.mechanics.leg.layout import Shapes
from flexapod.mechanics.leg.leg_beam import POWERS, LegBeam
from flexapod.mechanics.shapes import LateralBasis
from flexapod.mechanics.shapes.beam_functions import gauss_unit
from flexapod.mechanics.shapes.lateral import proportional_damping
from flexapod.model import Leg, damping_parts
from flexapod.model.leg.sections import SHARES, PistonStep

_GLAND = 0.01  # of the piston's length: within which the mouth takes a cut up
_MORE = 7  # points on a section more than shapes; kernels have fewer
_POINTS, _WEIGHTS = gauss_unit(24)
_ALONG = ("EA", "rhoA", "turning_a", "turning_b")
_STRESS_POINTS = 6  # on a section


@dataclass(frozen=True, kw_only=True)
class SectionLaws:
    """Properties of a piston's sections along them, from the tip to the driven end.

    Lengths (n,) [m], and of each value the coefficients of the powers of the distance from a section's end at the tip;
    E (n,) [Pa], which of them are round, and the length of the leg inside of the mouth [m].
    """

    length: Array
    values: dict[str, Array]
    E: Array
    round: tuple[bool, ...]
    mouth: float

    def over(self, name: str, x: list[Any], start: Any, section: int, free: Any) -> list[Any]:
        """1 over a value at places x of a free length, times that at the tip."""
        values = self.values[name]
        return [values[0, 0] / law(values[section].tolist(), free * (y - start)) for y in x]


def section_laws(leg: Leg, sections: int = 0, *, inwards: bool = False) -> SectionLaws:
    """Sections of a leg, with sections without length before them where there are to be more.

    ``inwards``: from the driven end to the tip, as the part inside of the mouth sees them.
    """
    parts = leg.piston.parts if inwards else tuple((length, at[::-1]) for length, at in leg.piston.parts[::-1])
    parts = ((0.0, parts[0][1][:1] * POWERS),) * (sections - len(parts)) + parts
    names = {
        "rhoA": lambda x: x.rhoA,
        "EA": lambda x: x.EA,
        "EI_a": lambda x: x.EI[0],
        "EI_b": lambda x: x.EI[1],
        "shear": lambda x: x.shear,
        "turning_a": lambda x: section_rotary_inertia(x, 0),
        "turning_b": lambda x: section_rotary_inertia(x, 1),
        "depth_a": lambda x: x.depth[0],
        "depth_b": lambda x: x.depth[1],
    }
    return SectionLaws(
        length=np.array([length for length, _ in parts]),
        values={name: np.array([_powers(length, [of(x) for x in at]) for length, at in parts])
                for name, of in names.items()},
        E=np.array([at[0].E for _, at in parts]),
        round=tuple(at[0].round for _, at in parts),
        mouth=leg.cylinder.mouth,
    )  # fmt: skip


def _powers(length: float, values: list[float]) -> Array:
    """Coefficients of the polynomial through values at `SHARES` of a length."""
    if len(set(values)) == 1:
        return np.array([values[0], *np.zeros(POWERS - 1)])
    return np.linalg.solve(np.vander(SHARES, POWERS, increasing=True), values) / length ** np.arange(POWERS)


def section_parameters(leg: Leg, beam: LegBeam, home: float) -> dict[str, object]:
    """Parameters of the sections of a leg whose length at home is given [m], by name."""
    piston, n, m, zeta = leg.piston, beam.sections, beam.axial.count, damping_parts(leg.damping)[0]
    laws = section_laws(leg, n)
    length, powers = laws.length, POWERS if beam.tapers else 1
    ends = np.concatenate([[0.0], np.cumsum(length)])
    offset = length[:, None] * _POINTS
    at = {name: np.array([law(c, x) for c, x in zip(laws.values[name], offset, strict=True)]) for name in _ALONG}
    soft = length[:, None] / at["EA"]
    before, whole = np.concatenate([[0.0], np.cumsum(soft @ _WEIGHTS)]), (soft @ _WEIGHTS).sum()
    up_to = (_WEIGHTS - nodes(len(_POINTS)).beyond).T  # of a row: integrals from 0 to the points
    tau = 1 - (before[:-1, None] + soft @ up_to) / whole
    dm = at["rhoA"] * length[:, None] * _WEIGHTS
    psi = beam.axial.values(tau.ravel())
    along, dm = piston.length - (ends[:-1, None] + offset).ravel(), dm.ravel()
    mass, whole_mass = (psi * dm) @ psi.T, dm.sum()
    free = home - leg.cylinder.mouth
    lateral = _diagonal([_damping(section_laws(leg), beam.b, beam.shear_basis, free, way) for way in beam.planes])
    inner = {} if beam.guide is None else _inner(leg, beam, beam.guide, home)
    return inner | {
        **{f"section_{name}": laws.values[name][:, :powers] for name in laws.values},
        "section_cuts": ends[1:-1],
        "gland": piston.length * (_GLAND if leg.cylinder.mouth > 0 else 1e-6),
        "section_load": loads(laws, of_points=is_chain(beam.b))[:, :powers],
        "piston_turning": np.array([(at[f"turning_{way}"] @ _WEIGHTS) @ length for way in "ab"]),
        "section_place": 1 - before[:-1] / whole,
        "section_shrink": 1 / (laws.values["EA"][:, 0] * whole),
        "piston_moments": np.array([dm @ along, dm @ along**2]) / whole_mass if whole_mass else np.zeros(2),
        "axial_first": psi @ dm,
        "axial_moment": psi @ (dm * along),
        "axial_mass": mass,
        "axial_damping": 2 * zeta * proportional_damping(mass, piston.EA / piston.length * beam.axial.stiffness)
        if whole_mass
        else np.zeros((m, m)),
        "lateral_damping": 2 * zeta * free * lateral,
    }


def _inner(leg: Leg, beam: LegBeam, basis: LateralBasis, home: float) -> dict[str, object]:
    """The same for the part inside of the mouth."""
    laws, powers, overlap = section_laws(leg, beam.sections, inwards=True), POWERS if beam.tapers else 1, 0.0
    at = {name: np.array([law(c, x) for c, x in zip(laws.values[name], laws.length[:, None] * _POINTS, strict=True)])
          for name in ("EA", "rhoA")}  # fmt: skip
    soft = laws.length * ((1 / at["EA"]) @ _WEIGHTS)
    if leg.guide is not None:
        overlap = leg.overlap(home)
    damping = np.zeros((len(beam.planes) * basis.count,) * 2)
    if overlap > 0:
        own = section_laws(leg, inwards=True)
        damping = _diagonal([_damping(own, basis, None, overlap, way) for way in beam.planes])
    return {
        **{f"inner_{name}": laws.values[name][:, :powers] for name in ("rhoA", *(f"EI_{way}" for way in beam.planes))},
        "inner_there": float(leg.guide is not None),
        "inner_cuts": np.cumsum(laws.length)[:-1],
        "inner_load": loads(laws)[:, 0],
        "inner_place": (np.cumsum(soft) - soft) / soft.sum(),
        "inner_shrink": -1 / (laws.values["EA"][:, 0] * soft.sum()),
        "inner_damping": 2 * damping_parts(leg.damping)[0] * overlap * damping,
    }


def loads(laws: SectionLaws, *, of_points: bool = False) -> Array:
    """Mass per length over its mean, 1 of pistons without mass, as `SectionLaws.values`; else its mean on a section."""
    rhoA = laws.values["rhoA"]
    mean = np.array([law(c, length * _POINTS) @ _WEIGHTS for c, length in zip(rhoA, laws.length, strict=True)])
    if not of_points or not mean.any():
        rhoA = (mean if mean.any() else np.ones_like(mean))[:, None] * np.eye(1, POWERS)
    return rhoA / (mean.mean() or 1.0)


def numeric_pieces(leg: Leg, basis: LateralBasis, free: Any, direction: int) -> list[Piece]:
    """Shapes of a leg at free lengths [m], a number or (N,), along leg x (0) or y (1), before (T1.22)."""
    return _pieces(section_laws(leg), basis, free, f"EI_{'ab'[direction]}")


def _pieces(laws: SectionLaws, basis: LateralBasis, free: Any, name: str) -> list[Piece]:
    at, chained = nodes(basis.count + _MORE), is_chain(basis)
    cuts = [np.minimum(cut / free, 1.0) for cut in np.cumsum(laws.length)[:-1]]
    places = [0.0 * np.asarray(free), *cuts, 1.0 + 0.0 * np.asarray(free)]
    gives, by_mass = _gives(laws, at, places, name, free), loads(laws, of_points=chained)
    if not chained:
        return pieces(Uniform(basis=basis), at, places, by_mass[:, 0].tolist(), gives)
    at_points = [
        [law(by_mass[j].tolist(), free * (x - start)) for x in row]
        for j, (row, start) in enumerate(zip(piece_nodes(at, places), places, strict=False))
    ]
    return chain(basis, at, places, at_points, gives, laws.mouth / free)


def _gives(laws: SectionLaws, at: StepNodes, places: list[Any], name: str, free: Any) -> list[list[Any]]:
    points = [(a, [a + (b - a) * t for t in at.t.tolist()]) for a, b in pairwise(places)]
    return [laws.over(name, x, start, j, free) for j, (start, x) in enumerate(points)]


def _thick(laws: SectionLaws, basis: LateralBasis, free: Any, name: str) -> list[Piece]:
    """The same of what shears."""
    bent = _pieces(laws, basis, free, name)
    places = [*(piece.start for piece in bent), bent[-1].end]
    return shear_pieces(bent, _gives(laws, bent[0].nodes, places, "shear", free))


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
        part = np.array([(1, -1, 1)[derivative] * piece.value(x, derivative) for piece in parts])
        there = sum(x > piece.end for piece in parts[:-1]) if len(parts) > 1 else np.zeros(part.shape[-1], dtype=int)
        found.append(np.take_along_axis(part, np.broadcast_to(there, part.shape[1:])[None], axis=0)[0])
    values = np.stack(found, axis=1)
    return values - tip_elimination(parts[0].value_start)[:, None] * values[:1]


def shear_tips(leg: Leg, beam: LegBeam, free: Array) -> Array:
    """Deflections at the tip of the shapes of shear before (T1.22), at free lengths (N,), (k, N)."""
    return _thick(section_laws(leg), beam.shear_basis or beam.b, free, "EI_b")[0].value_start


def bending_amplitudes(leg: Leg, shapes: Shapes, q: Array) -> Array:
    """Amplitudes of bending alone out of coordinates (T, n) of a leg whose piston shears, (T, 2, k) [m]."""
    k, free = shapes.beam.b.count, q[:, shapes.l_index] - leg.cylinder.mouth
    found, tips = np.zeros((len(q), 2, k)), shear_tips(leg, shapes.beam, free)
    for direction, name in enumerate(("a", "b")):
        if shapes.has(f"shear_{name}"):
            own, by_shear = (q[:, shapes.index(x) :][:, :k] for x in (name, f"shear_{name}"))
            found[:, direction] = own
            found[:, direction, 0] -= (tips.T * by_shear).sum(axis=1)
    return found


def stepped_stress(leg: Leg, basis: LateralBasis, lateral: Array, free: Array, compression: Array) -> Array:
    """Largest axial plus bending stress in a piston of several sections, (T,) [Pa]; arguments of `leg_stress`."""
    largest, laws, thrust = np.zeros(len(free)), section_laws(leg), np.abs(compression)
    planes = [numeric_pieces(leg, basis, free, k) for k in (0, 1)] if basis.count else []
    tips = [tip_elimination(parts[0].value_start) for parts in planes]
    for j, E in enumerate(laws.E):
        EA = laws.values["EA"][j].tolist()
        for share in np.linspace(0.0, 1.0, _STRESS_POINTS):
            largest = np.maximum(largest, thrust * E / law(EA, share * laws.length[j]))
            bent, offset = [], np.zeros(len(free))
            for k, (parts, first) in enumerate(zip(planes, tips, strict=True)):
                piece = parts[j]
                x, outside = piece.start + share * (piece.end - piece.start), piece.end > piece.start
                curvature, offset = piece.value(x, 2), free * (x - piece.start)
                curvature = curvature - first * curvature[:1]
                depth = law(laws.values[f"depth_{'ab'[k]}"][j].tolist(), offset)
                bent.append(outside * (lateral[:, k].T * curvature).sum(axis=0) / free**2 * E * depth / 2)
            if bent:
                bending = np.hypot(*bent) if laws.round[j] else np.abs(bent).sum(axis=0)
                largest = np.maximum(largest, bending + thrust * E / law(EA, offset))
    return largest


def _damping(laws: SectionLaws, basis: LateralBasis, shear: LateralBasis | None, free: float, way: str) -> Array:
    """Damping of ratio 1 in every mode of the bare part of a length, of bending and shear (K, K) [N s/m]."""
    size = basis.count * (1 + (shear is not None))
    M, K = np.zeros((size, size)), np.zeros((size, size))
    if not size:
        return M
    bent = _pieces(laws, basis, np.array([free]), f"EI_{way}")
    thick = _thick(laws, shear, np.array([free]), f"EI_{way}") if shear else []
    E = tip_elimination(bent[0].value_start)
    for j, piece in enumerate(bent):
        w = (piece.end - piece.start) * piece.nodes.w
        offset = free * (np.concatenate(piece.x) - piece.start)
        rhoA, EI, GA, turn_mass = (w * law(laws.values[name][j].tolist(), offset) for name in
                                      ("rhoA", f"EI_{way}", "shear", f"turning_{way}"))  # fmt: skip
        value, turn, bend = (np.hstack(y) for y in (piece.values, piece.slopes, piece.bends))
        value, turn, bend = (y - E * y[:1] for y in (value, turn, bend))
        slope = 0 * turn
        if thick:
            tip, own = thick[0].value_start, thick[j]
            turn, bend = (np.vstack([y, -tip * y[:1]]) for y in (turn, bend))
            value = np.vstack([value, np.hstack(own.values) - tip * value[:1]])
            slope = np.vstack([slope, np.hstack(own.slopes)])
        M += free * (value * rhoA) @ value.T
        K += (bend * EI) @ bend.T / free**3
        if thick:
            M += (turn * turn_mass) @ turn.T / free
            K += (slope * GA) @ slope.T / free
    return proportional_damping(M, K) if M.any() else M


def _diagonal(parts: list[Array]) -> Array:
    """Matrices of one size on the diagonal of another."""
    n, size = len(parts), len(parts[0])
    found = np.zeros((n, size, n, size))
    for k, part in enumerate(parts):
        found[k, :, k] = part
    return found.reshape(n * size, n * size)


def section_rotary_inertia(step: PistonStep, direction: int) -> float:
    """Rotary inertia of a homogeneous section, rho I [kg m]."""
    return step.rhoA * step.EI[direction] / step.EA
