"""One leg as a chain of elements, from its carriage to its tip."""

from dataclasses import dataclass
from types import SimpleNamespace

from flexapod.elements.carriage import carriage
from flexapod.elements.cylinder import cylinder
from flexapod.elements.distribution import Motion
from flexapod.elements.flexure import flexure, springs
from flexapod.elements.frame import Energies
from flexapod.elements.rotations import small_rotation
from flexapod.elements.sliding_piston import sliding_piston, tip_place, tip_turn
from flexapod.elements.tip_body import tip_body
from flexapod.elements.torsion import torsion
from flexapod.elements.universal import universal
from flexapod.mechanics.layout import Shapes
from flexapod.symbolic.lagrange import Lagrangian
from flexapod.symbolic.vocabulary import SX, symbol, vertcat, zeros


@dataclass(frozen=True, kw_only=True)
class Leg:
    """One leg as expressions: energies, place of the tip in the world, rotation from the tip's axes to the world.

    ``tip_axes`` is written in ``theta``, symbols for the rotation vector ``turn`` of the tip: derivatives by the many
    amplitudes go through these three.
    """

    lagrangian: Lagrangian
    gravity: SX
    strain: SX
    tip: SX
    tip_axes: SX
    theta: SX
    turn: SX


def leg(shapes: Shapes, p: SimpleNamespace, q: SX, v: SX, qs: SimpleNamespace, vs: SimpleNamespace) -> Leg:
    """Energies and tip of one leg from its coordinates; ``qs`` and ``vs`` are the named pieces of q and v."""
    ground, e = carriage(shapes.carriage, p, qs, vs)
    if shapes.flexure:
        ground = ground.moved(vertcat(qs.u1, qs.u2, qs.u3), vertcat(vs.u1, vs.u2, vs.u3))
    frame = universal(ground, qs, vs)
    if shapes.b.count and not shapes.a.count:  # a planar robot's leg does not bend across the plane
        qs, vs = (SimpleNamespace(**vars(part) | {"a": zeros(shapes.b.count)}) for part in (qs, vs))
    s = qs.l - p.mouth  # (T3.6)  free length outside the cylinder
    motion = Motion(
        a=shapes.a if shapes.a.count else shapes.b,
        b=shapes.b,
        axial=shapes.axial,
        frame=frame,
        s=s,
        q=q,
        v=v,
        qs=qs,
        vs=vs,
    )
    e += cylinder(frame, p, vs) + sliding_piston(motion, p)
    if shapes.torsion:
        e += torsion(frame, p, qs, vs)
    if shapes.tip_body:
        e += tip_body(motion, p, shapes.planar)
    if shapes.closure == "pose":
        e += _joints(shapes, p, qs, vs)
    theta = symbol("theta", 3)
    lagrangian = Lagrangian(q=q, v=v, kinetic=e.kinetic, potential=e.gravity + e.strain, dissipation=e.dissipation)
    return Leg(
        lagrangian=lagrangian,
        gravity=e.gravity,
        strain=e.strain,
        tip=frame.origin + frame.axes @ tip_place(motion),
        tip_axes=frame.axes @ small_rotation(theta),
        theta=theta,
        turn=tip_turn(motion),
    )


def _joints(shapes: Shapes, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace) -> Energies:
    """Springs and dampers of the joints at both ends."""
    base, base_rate = (vertcat(x.alpha, x.beta, x.spin if shapes.spin else zeros(1)) for x in (qs, vs))
    end, end_rate = (vertcat(x.gamma1, x.gamma2, x.gamma3) for x in (qs, vs))
    base, end = base - p.base_home, end - p.gamma_home
    e = springs(p.base_stiffness, p.base_damping, base, base_rate)
    e += springs(p.gamma_stiffness, p.gamma_damping, end, end_rate)
    if shapes.flexure:
        of_base, of_end = (vertcat(x.u1, x.u2, x.u3) for x in (qs, vs)), (vertcat(x.e1, x.e2, x.e3) for x in (qs, vs))
        moved, rate = (vertcat(u, x) for u, x in zip(of_base, (base, base_rate), strict=True))
        e += flexure(p.base_flexure, p.base_flexure_damping, moved, rate)
        moved, rate = (vertcat(u, x) for u, x in zip(of_end, (end, end_rate), strict=True))
        e += flexure(p.platform_flexure, p.platform_flexure_damping, moved, rate)
    return e
