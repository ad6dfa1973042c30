"""A piston of several sections that slides out of its cylinder, Eqs. (T3.16)-(T3.22).

Lateral shapes are those of the stepped beam (`steps`); integrals are sums over Gauss points between the cuts, exact for
these polynomials. The shapes depend on the free length, and what sliding does to them is their derivative by it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np

from flexapod.mechanics.elements.chains import chain, is_chain
from flexapod.mechanics.elements.distribution import (
    Distribution,
    PistonMotion,
    gravity_energy,
    kinetic_energy,
    rotary_energy,
    shear_energy,
)
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.steps import (
    Piece,
    StepNodes,
    Uniform,
    law,
    nodes,
    pieces,
    shear_pieces,
    tip_elimination,
)
from flexapod.mechanics.shapes import AxialBasis, LateralBasis
from flexapod.mechanics.symbolic.vocabulary import (
    SX,
    diagcat,
    horzcat,
    jtimes,
    quadratic,
    repeat_row,
    reshape,
    sin,
    sqrt,
    vertcat,
    weighted_gram,
    zeros,
)

_MORE = 3  # Gauss points of a piece beyond its shapes: exact for the moment of the foreshortening, the highest power
_TAPERED = 2  # more where a section tapers: frequencies to 1e-6 with diameters of 3 to 1
_SHOWN = ("value", "slope", "bend")
_TINY = 1e-18  # under the root of |x|: its derivative is not 0 / 0


@dataclass(frozen=True, kw_only=True)
class GaussPointShapes:
    """Lateral shapes at Gauss points x of the free length, (K, points), by x: rates are s d/ds at a material point.

    `turn`, `sheared`: slopes of bending and of shear; `slid`, `slid_turn`: rates of `value` and `turn`.
    """

    value: SX
    slope: SX
    turn: SX
    bend: SX
    sheared: SX
    slid: SX
    slid_turn: SX


@dataclass(frozen=True, kw_only=True)
class SteppedShapes:
    """Lateral shapes at the present free length with the names of `LateralBasis`, and the piston's mass in them.

    Integrals carry what they weigh: `stiffness` EI, those of slopes but `slope_tip` the mass, the others below int dm.
    """

    count: int
    tip: np.ndarray
    tip_slope: SX | np.ndarray
    stiffness: SX
    slope_tip: SX
    slope_first: SX
    slope_moment: SX
    turn: SX
    phi: SX
    phi_X: SX
    sliding: SX
    sliding_X: SX
    phi_phi: SX
    phi_sliding: SX
    sliding_sliding: SX
    phi_psi: SX
    sliding_psi: SX
    shear_stiffness: SX | None = None
    turned: SX | None = None
    turned_slid: SX | None = None
    turn_turn: SX | None = None
    turn_slid: SX | None = None
    slid_slid: SX | None = None


def straight_shapes(axial: int) -> SteppedShapes:
    """Shapes of a piston that does not bend and has a number of axial shapes."""
    found: dict[str, Any] = {f.name: zeros(0, 0) for f in fields(SteppedShapes) if f.default is not None}
    found |= dict.fromkeys(("phi_psi", "sliding_psi"), zeros(0, axial))
    found |= {"count": 0, "tip": np.zeros(0), "tip_slope": np.zeros(0)}
    return SteppedShapes(**found)


@dataclass(frozen=True, kw_only=True)
class Part:
    """Part of a piston that is clamped at the mouth: the outer one to the tip, or the inner one to the other end.

    ``p``: `section_...` from the free end; ``s``: length; ``end``: of the free one from the base joint; ``way``: 1 of
    the outer, -1 of the inner one, which gets shorter as l grows; ``tapers``: whether sections may.
    ``there``: 0 where it has no mass.
    """

    p: SimpleNamespace
    s: SX
    l: SX  # noqa: E741
    end: SX
    way: int = 1
    tapers: bool = False
    there: SX | float = 1.0

    @property
    def count(self) -> int:
        """Number of sections."""
        return self.p.section_place.numel()

    def rate(self, expression: SX) -> SX:
        """Derivative by s, times s."""
        return self.way * self.s * jtimes(expression, self.l, SX(1.0))

    def place(self, x: SX) -> SX:
        """Distances from the base joint."""
        return self.end - self.way * self.s * x

    def law(self, name: str, section: int, x: Any, start: SX) -> SX:
        """Value on a section at x, by its distance from the start there."""
        values = getattr(self.p, f"section_{name}")
        size = values.numel() // self.count
        return law([values[section * size + k] for k in range(size)], self.s * (x - start))

    @cached_property
    def ends(self) -> list[SX]:
        """Ends of the pieces from the free end: 0, the cuts over s, 1; cuts beyond are at the mouth.

        The mouth takes a cut up within the length `gland` on either side, with two continuous derivatives, Eq. (T3.17).
        """
        found = [SX(0.0)]
        for k in range(self.p.section_cuts.numel()):
            t = (self.p.section_cuts[k] - self.s) / self.p.gland
            low, high = sqrt((t + 1) ** 2 + _TINY), sqrt((t - 1) ** 2 + _TINY)
            near = (low - high) / 2  # t, between -1 and 1
            found.append(1 + self.p.gland / self.s * ((t + 1 - low) / 2 - (1 - near) ** 3 * (3 + near) / 16))
        return [*found, SX(1.0)]


def stepped_shapes(
    part: Part, basis: LateralBasis, shear: LateralBasis | None, axial: AxialBasis, planes: Sequence[str]
) -> dict[str, SX]:
    """Quantities that depend on the length of a part alone, by the names of `SteppedShapes`.

    ``shear``: shapes by whose forces the piston shears; none of a slender one.
    ``planes``: directions that bend in their own way, a before b; one stands for both.
    """
    at = nodes(basis.count + _MORE + _TAPERED * part.tapers)
    beams = [_Beam(part, at, basis, shear, name) for name in planes]
    shown = [beam.shapes_at_points for beam in beams]
    names = [f.name for f in fields(GaussPointShapes)]
    all_ = GaussPointShapes(**{name: vertcat(*(getattr(one, name) for one in shown)) for name in names})
    rigidity = [beam.section_weights(f"EI_{beam.plane}") for beam in beams]
    own = [weighted_gram(one.bend, EI, one.bend) for one, EI in zip(shown, rigidity, strict=True)]
    beam = beams[0]
    length, (beyond, moment), X = beam.lengths, beam.beyond, part.place(beam.x)
    bent, dm, tau = weighted_gram(all_.turn, length, all_.bend), part.s * beam.section_weights("rhoA"), beam.shares
    psi = vertcat(*(sin(k * np.pi * tau) if k else tau for k in range(axial.count)), zeros(0, tau.numel()))
    one = SX.ones(1, tau.numel())
    thick = {} if shear is None else _thick(part, all_, shown, beams)
    return thick | {
        "tip_slope": vertcat(*(-beam.tip_slope for beam in beams)),
        "stiffness": diagcat(*own),
        "slope_tip": weighted_gram(all_.slope, length, all_.slope),
        "slope_first": weighted_gram(all_.slope, length * beyond, all_.slope),
        "slope_moment": weighted_gram(all_.slope, length * moment, all_.slope),
        "turn": bent.T - bent,
        "phi": weighted_gram(all_.value, dm, one),
        "phi_X": weighted_gram(all_.value, dm, X),
        "sliding": weighted_gram(all_.slid, dm, one),
        "sliding_X": weighted_gram(all_.slid, dm, X),
        "phi_phi": weighted_gram(all_.value, dm, all_.value),
        "phi_sliding": weighted_gram(all_.value, dm, all_.slid),
        "sliding_sliding": weighted_gram(all_.slid, dm, all_.slid),
        "phi_psi": weighted_gram(all_.value, dm, psi),
        "sliding_psi": weighted_gram(all_.slid, dm, psi),
    }


def _thick(part: Part, at: GaussPointShapes, shown: list[GaussPointShapes], beams: list[_Beam]) -> dict[str, SX]:
    """Integrals of shear and of turning sections, by name."""
    turning = [beam.section_weights(f"turning_{beam.plane}") * part.s for beam in beams]
    one = SX.ones(1, turning[0].numel())
    pairs = {"turn_turn": ("turn", "turn"), "turn_slid": ("turn", "slid"), "slid_slid": ("slid", "slid")}
    parts = [
        {"turn": plane.turn, "slid": plane.slid_turn - plane.turn, "weight": weight}
        for plane, weight in zip(shown, turning, strict=True)
    ]
    return {
        "shear_stiffness": weighted_gram(at.sheared, beams[0].section_weights("shear"), at.sheared),
        "turned": vertcat(*(weighted_gram(x["turn"], x["weight"], one) for x in parts)),
        "turned_slid": vertcat(*(weighted_gram(x["slid"], x["weight"], one) for x in parts)),
        **{name: diagcat(*(weighted_gram(x[a], x["weight"], x[b]) for x in parts)) for name, (a, b) in pairs.items()},
    }


@dataclass(frozen=True)
class _Beam:
    """The stepped beam of one plane, at its Gauss points."""

    part: Part
    nodes: StepNodes
    basis: LateralBasis
    shear: LateralBasis | None
    plane: str

    @cached_property
    def pieces(self) -> list[Piece]:
        """Pieces of the beam from free end to mouth, by bending."""
        return self._pieces(self.basis)

    @cached_property
    def shear_pieces(self) -> list[Piece]:
        """Pieces of the beam by shear; none of a slender piston."""
        return [] if self.shear is None else shear_pieces(self._pieces(self.shear), self._over("shear"))

    def _pieces(self, basis: LateralBasis) -> list[Piece]:
        ends, gives = self.part.ends, self._over(f"EI_{self.plane}")
        if is_chain(self.basis):
            return chain(basis, self.nodes, ends, self._on("load"), gives, self.part.l / self.part.s - 1)
        loads, size = self.part.p.section_load, self.part.p.section_load.numel() // self.part.count
        return pieces(Uniform(basis=basis), self.nodes, ends, [loads[j * size] for j in range(self.part.count)], gives)

    def _on(self, name: str) -> list[list[SX]]:
        """Values of the sections at the points."""
        starts = self.part.ends[:-1]
        return [
            [self.part.law(name, j, x, start) for x in self._at(start, self.part.ends[j + 1])]
            for j, start in enumerate(starts)
        ]

    def _at(self, start: SX, end: SX) -> list[SX]:
        return [start + (end - start) * t for t in self.nodes.t.tolist()]

    def _over(self, name: str) -> list[list[SX]]:
        """Value at the free end over the values at the points, section by section."""
        first = getattr(self.part.p, f"section_{name}")[0]
        return [[first / value for value in row] for row in self._on(name)]

    @cached_property
    def x(self) -> SX:
        """Gauss points of all pieces."""
        return horzcat(*(x for piece in self.pieces for x in piece.x))

    @cached_property
    def lengths(self) -> SX:
        """Lengths that the points stand for: weights of integrals."""
        return horzcat(*((b - a) * w for a, b in pairwise(self.part.ends) for w in self.nodes.w.tolist()))

    def section_weights(self, name: str) -> SX:
        """Values of the sections at the points, times the points' lengths."""
        mass = self.part.there if name == "rhoA" else 1.0
        return mass * self.lengths * horzcat(*(value for row in self._on(name) for value in row))

    @cached_property
    def beyond(self) -> tuple[SX, SX]:
        """Mass between points and free end, and its moment about the base joint, over s; (1, points) each."""
        mass, moment, masses, moments = SX(0.0), SX(0.0), [], []
        for piece, rhoA in zip(self.pieces, self._on("rhoA"), strict=True):
            long = piece.end - piece.start
            by = [m * self.part.place(x) for m, x in zip(rhoA, piece.x, strict=True)]
            here, there = long * self.nodes.integral(rhoA), long * self.nodes.integral(by)
            masses += [mass + here - long * y for y in self.nodes.rest(rhoA)]
            moments += [moment + there - long * y for y in self.nodes.rest(by)]
            mass, moment = mass + here, moment + there
        return self.part.there * horzcat(*masses), self.part.there * horzcat(*moments)

    @cached_property
    def shares(self) -> SX:
        """Shares tau of the compliance between driven end and points."""
        p, found = self.part.p, []
        for j, (piece, rhoA) in enumerate(zip(self.pieces, self._on("rhoA"), strict=True)):
            long, first = piece.end - piece.start, self.part.law("rhoA", j, piece.start, piece.start)
            soft = [first / m for m in rhoA] if self.part.tapers else [SX(1.0) for _ in rhoA]  # EA is as rho A
            along = [self.nodes.integral(soft) - y for y in self.nodes.rest(soft)]
            found += [p.section_place[j] - p.section_shrink[j] * self.part.s * long * y for y in along]
        return horzcat(*found)

    @cached_property
    def shapes_at_points(self) -> GaussPointShapes:
        """Shapes at the points: of bending, then of shear."""
        bent, E = self._moved(self.pieces), tip_elimination(self.pieces[0].value_start)
        bent = _held(bent, bent, E, self.part.rate(E))
        if not self.shear_pieces:
            return bent
        tip, own = self.shear_pieces[0].value_start, self._moved(self.shear_pieces)
        own = replace(own, turn=0 * own.slope, sheared=own.slope, slid_turn=0 * own.slope)
        own = _held(own, bent, tip, self.part.rate(tip))
        return GaussPointShapes(
            **{f.name: vertcat(getattr(bent, f.name), getattr(own, f.name)) for f in fields(GaussPointShapes)}
        )

    @property
    def tip_slope(self) -> SX:
        """Slopes of bending at the free end."""
        value, slope = self.pieces[0].value_start, self.pieces[0].slope_start
        slope -= tip_elimination(value) @ slope[0]
        return vertcat(slope, -self.shear_pieces[0].value_start @ slope[0]) if self.shear_pieces else slope

    def _moved(self, parts: list[Piece]) -> GaussPointShapes:
        """Shapes at the points, which slide along the piston: it moves by rate x + x over them."""
        value, slope, bend = (horzcat(*(y for one in parts for y in getattr(one, f"{x}s"))) for x in _SHOWN)
        past = self.part.rate(self.x) + self.x
        slid = self.part.rate(value) - repeat_row(past, slope) * slope
        slid_turn = self.part.rate(slope) - repeat_row(past, bend) * bend
        return GaussPointShapes(
            value=value, slope=slope, turn=slope, bend=bend, sheared=0 * slope, slid=slid, slid_turn=slid_turn
        )


def _held(at: GaussPointShapes, first: GaussPointShapes, E: SX, rate: SX) -> GaussPointShapes:
    """Shapes less E times the first of bending, so that this alone moves the tip, Eq. (T1.22)."""
    kept = {f.name: getattr(at, f.name) - E @ getattr(first, f.name)[0, :] for f in fields(GaussPointShapes)}
    kept["slid"] -= rate @ first.value[0, :]
    kept["slid_turn"] -= rate @ first.turn[0, :]
    return GaussPointShapes(**kept)


def stepped_piston(f: PistonMotion, p: SimpleNamespace) -> Energies:
    """Energies of the piston: its mass, its spin about the leg, bending and stretch."""
    body = _mass(f, p)
    spin = 0.5 * p.piston_axial_inertia * f.frame.omega[2] ** 2  # (T3.12)
    if f.a.shear_stiffness is not None:
        spin += rotary_energy(f, p)
    return Energies(
        kinetic=kinetic_energy(f, body) + spin,
        gravity=gravity_energy(f, body, p.gravity),
        strain=_strain_energy(f, p, f.qs),
        dissipation=_modal_damping(f, p) + p.damping_time * _strain_energy(f, p, f.vs),
    )


def _strain_energy(f: PistonMotion, p: SimpleNamespace, qs: SimpleNamespace) -> SX:
    """Bending of the free length and stretch of the whole piston, Eq. (T3.21)."""
    bending = quadratic(qs.a, f.a.stiffness) + quadratic(qs.b, f.a.stiffness)
    if f.a.shear_stiffness is not None:
        bending += 2 * f.s**3 * shear_energy(f, qs)
    return 0.5 / f.s**3 * bending + 0.5 * p.EA / p.Lp * quadratic(qs.c, f.axial.stiffness)


def _modal_damping(f: PistonMotion, p: SimpleNamespace) -> SX:
    """Equal damping ratio for every mode of the bare piston at home; falls with the free length, Eq. (T3.22)."""
    k = f.a.count
    lateral = reshape(p.lateral_damping, k, k)
    bending = quadratic(f.vs.a, lateral) + quadratic(f.vs.b, lateral)
    return 0.5 / f.s * bending + 0.5 * quadratic(f.vs.c, reshape(p.axial_damping, f.axial.count, f.axial.count))


def _mass(f: PistonMotion, p: SimpleNamespace) -> Distribution:
    """Whole piston along the leg; what its outer part does across it, Eqs. (T3.19)-(T3.20)."""
    b, m, n = f.a, p.rhoA * p.Lp, f.axial.count
    inner, com, second = f.qs.l - p.Lp, p.piston_moments[0], p.piston_moments[1]
    along = m * (inner + com)
    return Distribution(
        first=SimpleNamespace(one=m, X=along, phi=b.phi, sliding=b.sliding, psi=p.axial_first),
        moment=SimpleNamespace(
            one=along,
            X=m * (inner**2 + 2 * inner * com + second),
            phi=b.phi_X,
            sliding=b.sliding_X,
            psi=inner * p.axial_first + p.axial_moment,
        ),
        lateral_mass=SX(1.0),
        phi_phi=b.phi_phi,
        phi_sliding=b.phi_sliding,
        sliding_sliding=b.sliding_sliding,
        axial_mass=SX(1.0),
        psi_psi=reshape(p.axial_mass, n, n),
        phi_psi=b.phi_psi,
        sliding_psi=b.sliding_psi,
        short=f.foreshortening("slope_first"),
        short_X=f.foreshortening("slope_moment"),
    )
