"""A piston of several sections that slides out of its cylinder, Eqs. (T3.16)-(T3.22).

Lateral shapes are those of the stepped beam (`steps`); integrals are sums over Gauss points between the cuts, exact for
these polynomials. The shapes depend on the free length, and what sliding does to them is their derivative by it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np

from flexapod.bases import AxialBasis, LateralBasis
from flexapod.bases.beam_functions import gauss_unit
from flexapod.elements.distribution import Distribution, Motion, gravity_energy, kinetic_energy
from flexapod.elements.frame import Energies
from flexapod.elements.shear import rotary_energy, shear_energy
from flexapod.elements.steps import Piece, Sheared, Uniform, held, pieces, sheared
from flexapod.symbolic.vocabulary import SX, diagcat, horzcat, jtimes, quadratic, reshape, sin, sqrt, vertcat, zeros

_MORE = 3  # Gauss points of a piece beyond its shapes: exact for the moment of the foreshortening, the highest power
_TINY = 1e-18  # under the root of |x|: its derivative is not 0 / 0


@dataclass(frozen=True, kw_only=True)
class Shown:
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


def straight(axial: int) -> SteppedShapes:
    """Of a piston that does not bend and has a number of axial shapes."""
    found: dict[str, Any] = {f.name: zeros(0, 0) for f in fields(SteppedShapes) if f.default is not None}
    found |= dict.fromkeys(("phi_psi", "sliding_psi"), zeros(0, axial))
    found |= {"count": 0, "tip": np.zeros(0), "tip_slope": np.zeros(0)}
    return SteppedShapes(**found)


def places(p: SimpleNamespace, s: SX) -> list[SX]:
    """Ends of the pieces from tip to mouth: 0, the cuts over s, 1; cuts in the cylinder are at the mouth.

    The mouth takes a cut up within the length `gland` on either side, with two continuous derivatives, Eq. (T3.17).
    """
    found = [SX(0.0)]
    for k in range(p.section_cuts.numel()):
        t = (p.section_cuts[k] - s) / p.gland
        low, high = sqrt((t + 1) ** 2 + _TINY), sqrt((t - 1) ** 2 + _TINY)
        near = (low - high) / 2  # t, between -1 and 1
        found.append(1 + p.gland / s * ((t + 1 - low) / 2 - (1 - near) ** 3 * (3 + near) / 16))
    return [*found, SX(1.0)]


def stepped_shapes(  # the arguments are those of one leg's beam
    basis: LateralBasis,
    shear: LateralBasis | None,
    axial: AxialBasis,
    planes: Sequence[str],
    p: SimpleNamespace,
    s: SX,
    l: SX,  # noqa: E741
) -> dict[str, SX]:
    """What depends on the free length s = l - mouth alone, by the names of `SteppedShapes`.

    ``shear``: shapes by whose forces the piston shears; none of a slender one.
    ``planes``: directions that bend in their own way, a before b; one stands for both.
    """
    ends, count = places(p, s), p.section_rhoA.numel()
    t, w = gauss_unit(basis.count + _MORE)
    section = [j for j in range(count) for _ in t]
    x = horzcat(*(a + (b - a) * t[None, :] for a, b in pairwise(ends)))
    length = horzcat(*((b - a) * w[None, :] for a, b in pairwise(ends)))
    loads = None if shear is None else Uniform(basis=shear)
    beams = [_Beam(p, s, l, ends, Uniform(basis=basis), loads, name) for name in planes]
    shown = [beam.shown(x, section) for beam in beams]
    at = Shown(**{f.name: vertcat(*(getattr(one, f.name) for one in shown)) for f in fields(Shown)})
    own = [_stiffness(p, one, length, section, name) for one, name in zip(shown, planes, strict=True)]
    beyond, moment = _beyond(p, ends, x, section, s, l)
    bent, dm = _gram(at.turn, length, at.bend), _by_point(p.section_rhoA, section) * length * s
    tau = _by_point(p.section_place, section) - _by_point(p.section_shrink, section) * s * x
    psi = vertcat(*(sin(k * np.pi * tau) if k else tau for k in range(axial.count)), zeros(0, x.numel()))
    X, one = l - s * x, SX.ones(1, x.numel())
    thick = {} if shear is None else _thick(p, at, shown, planes, length, section, s)
    return thick | {
        "tip_slope": vertcat(*(-beam.tip_slope for beam in beams)),
        "stiffness": diagcat(*own),
        "slope_tip": _gram(at.slope, length, at.slope),
        "slope_first": _gram(at.slope, length * beyond, at.slope),
        "slope_moment": _gram(at.slope, length * moment, at.slope),
        "turn": bent.T - bent,
        "phi": _gram(at.value, dm, one),
        "phi_X": _gram(at.value, dm, X),
        "sliding": _gram(at.slid, dm, one),
        "sliding_X": _gram(at.slid, dm, X),
        "phi_phi": _gram(at.value, dm, at.value),
        "phi_sliding": _gram(at.value, dm, at.slid),
        "sliding_sliding": _gram(at.slid, dm, at.slid),
        "phi_psi": _gram(at.value, dm, psi),
        "sliding_psi": _gram(at.slid, dm, psi),
    }


def _thick(
    p: SimpleNamespace, at: Shown, shown: list[Shown], planes: Sequence[str], length: SX, section: list[int], s: SX
) -> dict[str, SX]:
    """Integrals of shear and of turning sections, by name."""
    turning = [_by_point(getattr(p, f"section_turning_{plane}"), section) * length * s for plane in planes]
    one = SX.ones(1, length.numel())
    pairs = {"turn_turn": ("turn", "turn"), "turn_slid": ("turn", "slid"), "slid_slid": ("slid", "slid")}
    parts = [
        {"turn": plane.turn, "slid": plane.slid_turn - plane.turn, "weight": weight}
        for plane, weight in zip(shown, turning, strict=True)
    ]
    return {
        "shear_stiffness": _gram(at.sheared, length * _by_point(p.section_shear, section), at.sheared),
        "turned": vertcat(*(_gram(x["turn"], x["weight"], one) for x in parts)),
        "turned_slid": vertcat(*(_gram(x["slid"], x["weight"], one) for x in parts)),
        **{name: diagcat(*(_gram(x[a], x["weight"], x[b]) for x in parts)) for name, (a, b) in pairs.items()},
    }


@dataclass(frozen=True)
class _Beam:
    """The stepped beam of one plane."""

    p: SimpleNamespace
    s: SX
    l: SX  # noqa: E741
    ends: list[SX]
    uniform: Uniform
    loads: Uniform | None
    plane: str

    @cached_property
    def pieces(self) -> list[Piece]:
        """Its pieces from tip to mouth."""
        return self._pieces(self.uniform)

    @cached_property
    def sheared(self) -> list[Sheared]:
        """The same of its shear."""
        if self.loads is None:
            return []
        shear = self.p.section_shear
        return sheared(self._pieces(self.loads), [shear[0] / shear[j] for j in range(shear.numel())])

    def _pieces(self, uniform: Uniform) -> list[Piece]:
        EI = getattr(self.p, f"section_EI_{self.plane}")
        count = EI.numel()
        loads = [self.p.section_load[j] for j in range(count)]
        return pieces(uniform, self.ends, loads, [EI[0] / EI[j] for j in range(count)])

    def rate(self, expression: SX) -> SX:
        """Derivative by s, times s, of an expression of the free length alone."""
        return self.s * jtimes(expression, self.l, SX(1.0))

    def shown(self, x: SX, section: list[int]) -> Shown:
        """Its shapes at the points: of bending, then of shear."""
        bent = _beside([self._bent(self.pieces[j], x[k]) for k, j in enumerate(section)])
        E = held(self.pieces[0].value(SX(0.0)))
        bent = _held(bent, bent, E, self.rate(E))
        if not self.sheared:
            return bent
        own, tip = (
            _beside([self._by_shear(self.sheared[j], x[k]) for k, j in enumerate(section)]),
            self.sheared[0].value(SX(0.0)),
        )
        own = _held(own, bent, tip, self.rate(tip))
        return Shown(**{f.name: vertcat(getattr(bent, f.name), getattr(own, f.name)) for f in fields(Shown)})

    @property
    def tip_slope(self) -> SX:
        """Slopes of bending at the tip."""
        value, slope = (self.pieces[0].value(SX(0.0), n) for n in (0, 1))
        slope -= held(value) @ slope[0]
        return vertcat(slope, -self.sheared[0].value(SX(0.0)) @ slope[0]) if self.sheared else slope

    def _bent(self, piece: Piece, x: SX) -> Shown:
        d, start = x - piece.start, self.rate(piece.start)
        value, slope, bend = piece.value(x), piece.value(x, 1), piece.give * piece.moment(x)
        r0, r1, r2, r3 = (self.rate(part) for part in piece.cubic)
        _, p1, p2, p3 = piece.cubic
        slid = r0 + d * (r1 + d * (r2 + d * r3)) - start * (p1 + d * (2 * p2 + 3 * p3 * d)) - x * slope
        slid_turn = r1 + d * (2 * r2 + 3 * r3 * d) - start * (2 * p2 + 6 * p3 * d) - x * bend
        none = 0 * slope
        return Shown(value=value, slope=slope, turn=slope, bend=bend, sheared=none, slid=slid, slid_turn=slid_turn)

    def _by_shear(self, part: Sheared, x: SX) -> Shown:
        piece, value, slope = part.piece, part.value(x), part.slope(x)
        linear = self.rate(piece.m1) * (x - piece.start) - piece.m1 * self.rate(piece.start)
        slid, none = part.soft * linear + self.rate(part.q0) - x * slope, 0 * slope
        return Shown(value=value, slope=slope, turn=none, bend=none, sheared=slope, slid=slid, slid_turn=none)


def _beside(columns: list[Shown]) -> Shown:
    return Shown(**{f.name: horzcat(*(getattr(column, f.name) for column in columns)) for f in fields(Shown)})


def _held(at: Shown, first: Shown, E: SX, rate: SX) -> Shown:
    """Shapes less E times the first of bending, so that this alone moves the tip, Eq. (T1.22)."""
    kept = {f.name: getattr(at, f.name) - E @ getattr(first, f.name)[0, :] for f in fields(Shown)}
    kept["slid"] -= rate @ first.value[0, :]
    kept["slid_turn"] -= rate @ first.turn[0, :]
    return Shown(**kept)


def _stiffness(p: SimpleNamespace, at: Shown, length: SX, section: list[int], plane: str) -> SX:
    """Of a plane: int EI v''^2, to be divided by s^3."""
    return _gram(at.bend, length * _by_point(getattr(p, f"section_EI_{plane}"), section), at.bend)


def _beyond(
    p: SimpleNamespace,
    ends: list[SX],
    x: SX,
    section: list[int],
    s: SX,
    l: SX,  # noqa: E741
) -> tuple[SX, SX]:
    """Mass between points and tip, and its moment about the base joint, over s; (1, points) each."""
    mass, moment, masses, moments = SX(0.0), SX(0.0), [], []
    for j, (a, b) in enumerate(pairwise(ends)):
        m = p.section_rhoA[j]
        for k in (k for k, at in enumerate(section) if at == j):
            masses.append(mass + m * (x[k] - a))
            moments.append(moment + m * (x[k] - a) * (l - s * (x[k] + a) / 2))
        mass, moment = mass + m * (b - a), moment + m * (b - a) * (l - s * (a + b) / 2)
    return horzcat(*masses), horzcat(*moments)


def _by_point(values: SX, section: list[int]) -> SX:
    return horzcat(*(values[j] for j in section))


def _gram(left: SX, weight: SX, right: SX) -> SX:
    return (left * _each(weight, left)) @ right.T


def _each(row: SX, like: SX) -> SX:
    return vertcat(*[row] * like.shape[0])


def of_planes(planes: Sequence[str], x: SimpleNamespace) -> SimpleNamespace:
    """Coordinates, or rates, whose lateral parts count the shapes of bending and shear of all planes."""
    a, b = x.a, x.b
    if hasattr(x, "shear_b"):
        b = vertcat(b, x.shear_b)
        a = vertcat(a, x.shear_a) if hasattr(x, "shear_a") else 0 * b
    if len(planes) > 1:
        a, b = vertcat(a, 0 * b), vertcat(0 * a, b)
    return SimpleNamespace(**vars(x) | {"a": a, "b": b})


def stepped_piston(f: Motion, p: SimpleNamespace) -> Energies:
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


def _strain_energy(f: Motion, p: SimpleNamespace, qs: SimpleNamespace) -> SX:
    """Bending of the free length and stretch of the whole piston, Eq. (T3.21)."""
    bending = quadratic(qs.a, f.a.stiffness) + quadratic(qs.b, f.a.stiffness)
    if f.a.shear_stiffness is not None:
        bending += 2 * f.s**3 * shear_energy(f, qs)
    return 0.5 / f.s**3 * bending + 0.5 * p.EA / p.Lp * quadratic(qs.c, f.axial.stiffness)


def _modal_damping(f: Motion, p: SimpleNamespace) -> SX:
    """Equal damping ratio for every mode of the bare piston at home; falls with the free length, Eq. (T3.22)."""
    k = f.a.count
    lateral = reshape(p.lateral_damping, k, k)
    bending = quadratic(f.vs.a, lateral) + quadratic(f.vs.b, lateral)
    return 0.5 / f.s * bending + 0.5 * quadratic(f.vs.c, reshape(p.axial_damping, f.axial.count, f.axial.count))


def _mass(f: Motion, p: SimpleNamespace) -> Distribution:
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
