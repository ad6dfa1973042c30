"""One leg as a chain of elements, from its carriage to its tip."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import cast

import numpy as np

from flexapod.mechanics.elements.distribution import Line, PistonMotion
from flexapod.mechanics.elements.element import Along
from flexapod.mechanics.elements.flexible_cylinder import flexible_cylinder, head, hole, mouth
from flexapod.mechanics.elements.flexure import Flexures, base_angles, platform_angles, springs
from flexapod.mechanics.elements.flexure import joint_displacement as three
from flexapod.mechanics.elements.frames import Energies, small_rotation
from flexapod.mechanics.elements.guide import (
    bushings,
    inner_end,
    inner_part,
    inner_turn,
    lean,
    shortening,
    stepped_inner_part,
    stepped_shortening,
)
from flexapod.mechanics.elements.sliding_piston import sliding_piston, tip_place, tip_turn
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.stepped_piston import (
    Part,
    SteppedShapes,
    stepped_piston,
    stepped_shapes,
    straight_shapes,
)
from flexapod.mechanics.leg.joints import carriage, cylinder, universal
from flexapod.mechanics.leg.layout import Shapes
from flexapod.mechanics.leg.leg_beam import LegBeam
from flexapod.mechanics.shapes import LateralBasis
from flexapod.mechanics.symbolic.functions import Lagrangian
from flexapod.mechanics.symbolic.vocabulary import SX, symbol, taylor_series, vertcat, zeros

INNER = ("cuts", "rhoA", "load", "place", "shrink")


@dataclass(frozen=True, kw_only=True)
class LegEquations:
    """One leg as expressions: energies, place of the tip in the world, rotation from the tip's axes to the world.

    ``foot``: place of the base joint, as the base carries it. ``elements``: energies of each, which are in the sums.
    ``tip_axes`` is written in ``theta``, symbols for the rotation vector ``turn`` of the tip: derivatives by the many
    amplitudes go through these three.
    ``present``: symbols for what depends on the stroke alone, and what to put for them once all is differentiated.
    """

    lagrangian: Lagrangian
    gravity: SX
    strain: SX
    tip: SX
    tip_axes: SX
    theta: SX
    turn: SX
    elements: Mapping[Slot, Energies]
    present: tuple[SX, SX]
    foot: SX


def leg(shapes: Shapes, p: SimpleNamespace, q: SX, v: SX, qs: SimpleNamespace, vs: SimpleNamespace) -> LegEquations:
    """Energies and tip of one leg from its coordinates; ``qs`` and ``vs`` are the named pieces of q and v."""
    base = None
    for one in shapes.elements:
        base = one.base_frame(base, p, qs, vs)
    ground, carried = carriage(shapes.chain.carriage, p, qs, vs, base)
    foot, flexes = ground.origin, shapes.holds(Flexures)  # a flexure gives way in axes that do not turn with the leg
    if flexes:
        ground = ground.moved(three(qs, "u"), three(vs, "u"))
    frame = universal(ground, qs, vs)
    if shapes.has("u1") and not flexes:
        frame = frame.moved(three(qs, "u"), three(vs, "u"))
    beam = shapes.beam
    if beam.b.count and not beam.a.count:  # a planar robot's leg does not bend across the plane
        qs, vs = (SimpleNamespace(**vars(part) | {"a": zeros(beam.b.count)}) for part in (qs, vs))
    s = qs.l - p.mouth  # (T3.6)  free length outside the cylinder
    a, b, present = beam.a if beam.a.count else beam.b, beam.b, (zeros(0), zeros(0))
    inner: LateralBasis | SteppedShapes | None = beam.guide
    if beam.sections:
        qs, vs = (_stack_planes(beam.planes, part) for part in (qs, vs))
        a, inner, present = _of_sections(beam, p, s, qs.l)
        b = a
    line = _line(beam, p, qs, vs)
    motion = PistonMotion(a=a, b=b, axial=beam.axial, frame=frame, line=line, s=s, q=q, v=v, qs=qs, vs=vs)
    bodies = cylinder(frame, p, vs) + (stepped_piston if beam.sections else sliding_piston)(motion, p)
    inside, shift, turn, by_head = _inside(beam, motion, p, inner)
    x = Along(p=p, q=qs, v=vs, elements=shapes.elements, base=base, foot=ground, cylinder=frame, piston=motion)
    of_elements = {one: one.energy(x) for one in shapes.elements}
    joints = _joints(p, qs, vs) if shapes.has("gamma1") else Energies()
    at = {end: [e for one, e in of_elements.items() if one.kind.end == end] for end in ("base", "", "platform")}
    e = sum([*at["base"], bodies, inside, *at[""], joints, *at["platform"]], carried)
    place = tip_place(motion) + shift
    if shapes.has("e1") and not flexes:
        place += three(qs, "e")
    theta = symbol("theta", 3)
    lagrangian = Lagrangian(q=q, v=v, kinetic=e.kinetic, potential=e.gravity + e.strain, dissipation=e.dissipation)
    return LegEquations(
        lagrangian=lagrangian,
        gravity=e.gravity,
        strain=e.strain,
        tip=frame.origin + frame.axes @ place,
        tip_axes=frame.axes @ small_rotation(theta),
        theta=theta,
        turn=tip_turn(motion) + turn,
        elements=of_elements,
        present=(vertcat(present[0], by_head[0]), vertcat(present[1], by_head[1])),
        foot=foot,
    )


def _of_sections(
    beam: LegBeam,
    p: SimpleNamespace,
    s: SX,
    l: SX,  # noqa: E741
) -> tuple[SteppedShapes, SteppedShapes | None, tuple[SX, SX]]:
    """Shapes of a piston of several sections near its present length, outside and inside of the mouth.

    Returned are also the symbols for what depends on that length, and what to put for them.
    """
    of_plane = np.concatenate([beam.b.tip, np.zeros(beam.shear * beam.b.count)])
    tip = np.tile(of_plane, len(beam.planes))
    if not tip.size:
        none = straight_shapes(beam.axial.count)
        return none, None if beam.guide is None else none, (zeros(0), zeros(0))
    part = Part(p=p, s=s, l=l, end=l, tapers=beam.tapers)
    integrals = stepped_shapes(part, beam.b, beam.shear_basis, beam.axial, beam.planes)
    if beam.guide is None:
        near, present = taylor_series(list(integrals.values()), l)
        return SteppedShapes(count=tip.size, tip=tip, **dict(zip(integrals, near, strict=True))), None, present
    own = {f"section_{name}": getattr(p, f"inner_{name}") for name in (*INNER, *(f"EI_{k}" for k in beam.planes))}
    within = Part(
        p=SimpleNamespace(gland=p.gland, **own), s=p.guide_reach - l, l=l, end=l - p.Lp, way=-1,
        tapers=beam.tapers, there=p.inner_there,
    )  # fmt: skip
    inside = stepped_shapes(within, beam.guide, None, beam.axial, beam.planes)
    near, present = taylor_series([*integrals.values(), *inside.values()], l)
    outer, inner = near[: len(integrals)], near[len(integrals) :]
    head = np.tile(beam.guide.tip, len(beam.planes))
    return (
        SteppedShapes(count=tip.size, tip=tip, **dict(zip(integrals, outer, strict=True))),
        SteppedShapes(count=head.size, tip=head, **dict(zip(inside, inner, strict=True))),
        present,
    )


def _line(beam: LegBeam, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace) -> Line:
    """Line of the piston through the mouth: that of a bending cylinder, and the gland's displacement from it."""
    place, slope, place_rate, slope_rate = (zeros(2) for _ in range(4))
    if beam.cylinder is not None:
        (place, slope), (place_rate, slope_rate) = (mouth(beam.cylinder, p, x) for x in (qs, vs))
    if beam.guide is not None:
        place, slope = (x + vertcat(qs.ga[i], qs.gb[i]) for i, x in enumerate((place, slope)))
        place_rate, slope_rate = (x + vertcat(vs.ga[i], vs.gb[i]) for i, x in enumerate((place_rate, slope_rate)))
    return Line(mouth=p.mouth, place=place, slope=slope, place_rate=place_rate, slope_rate=slope_rate)


def _inside(
    beam: LegBeam, f: PistonMotion, p: SimpleNamespace, inner: LateralBasis | SteppedShapes | None
) -> tuple[Energies, SX, SX, tuple[SX, SX]]:
    """Parts inside of a compliant mouth: energies, shift and turn of the tip beyond those of the piston.

    Returned are also the symbols for what depends on the stroke alone, and what to put for them.
    """
    e, from_base, turn, at, tube = Energies(), zeros(1), zeros(1), None, beam.cylinder
    if inner is None and tube is None:
        return e, zeros(3), zeros(3), (zeros(0), zeros(0))
    if inner is not None:
        gap = inner_end(f, p, inner)
        if tube is not None:
            at = head(tube, p, f.qs.l)
            gap -= hole(tube, p, f, at)
        part = stepped_inner_part(f, p, inner) if isinstance(inner, SteppedShapes) else inner_part(f, p, inner)
        e += part + bushings(f, p, gap, f.rate(gap))
        turn = inner_turn(f, p, inner)
    if tube is not None:
        bent, from_base = flexible_cylinder(f, tube, p, at)
        e += bent
    if isinstance(f.a, SteppedShapes):
        at_tip, short, short_X = stepped_shortening(f, p, cast("SteppedShapes | None", inner), from_base)
    else:
        at_tip, short, short_X = shortening(f, p, cast("LateralBasis | None", inner), from_base)
    present = (zeros(0), zeros(0)) if at is None else at.present
    return e + lean(f, p, short, short_X), vertcat(0, 0, at_tip), vertcat(0, 0, turn), present


def _joints(p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace) -> Energies:
    """Springs and dampers of the joints at both ends."""
    e = springs(p.base_stiffness, p.base_damping, base_angles(qs) - p.base_home, base_angles(vs))
    return e + springs(p.gamma_stiffness, p.gamma_damping, platform_angles(qs) - p.gamma_home, platform_angles(vs))


def _stack_planes(planes: Sequence[str], x: SimpleNamespace) -> SimpleNamespace:
    """Coordinates, or rates, whose lateral parts count the shapes of bending and shear of all planes."""
    a, b = x.a, x.b
    if hasattr(x, "shear_b"):
        b = vertcat(b, x.shear_b)
        a = vertcat(a, x.shear_a) if hasattr(x, "shear_a") else 0 * b
    found = {"a": a, "b": b} | ({"ha": x.ha, "hb": x.hb} if hasattr(x, "ha") else {})
    if len(planes) > 1:
        found = {name: vertcat(*(y if name.endswith(of) else 0 * y for of in planes)) for name, y in found.items()}
    return SimpleNamespace(**vars(x) | found)
