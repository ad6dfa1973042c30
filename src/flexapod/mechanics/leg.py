"""One leg as a chain of elements, from its carriage to its tip."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from flexapod.elements.carriage import carriage
from flexapod.elements.cylinder import cylinder
from flexapod.elements.distribution import Motion
from flexapod.elements.flexure import flexure, springs
from flexapod.elements.frame import Energies, Frame
from flexapod.elements.mount import WORLD, displaced, mount, plate
from flexapod.elements.ripple import ripple
from flexapod.elements.rotations import small_rotation
from flexapod.elements.screw import screw
from flexapod.elements.sliding_piston import sliding_piston, tip_place, tip_turn
from flexapod.elements.soft_joint import soft_joint
from flexapod.elements.stepped_piston import SteppedShapes, of_planes, stepped_piston, stepped_shapes
from flexapod.elements.tip_body import tip_body
from flexapod.elements.torsion import torsion
from flexapod.elements.universal import universal
from flexapod.mechanics.layout import Shapes
from flexapod.symbolic.lagrange import Lagrangian
from flexapod.symbolic.vocabulary import SX, constant, expanded, matrix33, symbol, vertcat, zeros

ALONG = constant(np.array([[0.0], [0.0], [1.0]]))  # a leg's own direction


@dataclass(frozen=True, kw_only=True)
class Leg:
    """One leg as expressions: energies, place of the tip in the world, rotation from the tip's axes to the world.

    ``series``: energies of the springs between rotor and stroke, which are among the others.
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
    series: Energies
    present: tuple[SX, SX]


def leg(shapes: Shapes, p: SimpleNamespace, q: SX, v: SX, qs: SimpleNamespace, vs: SimpleNamespace) -> Leg:
    """Energies and tip of one leg from its coordinates; ``qs`` and ``vs`` are the named pieces of q and v."""
    base, standing = _base(shapes, p, qs, vs)
    ground, e = carriage(shapes.carriage, p, qs, vs, base)
    e += standing
    if shapes.flexure:
        ground = ground.moved(_three(qs, "u"), _three(vs, "u"))
    frame = universal(ground, qs, vs)
    if shapes.soft_base:
        along = ground.axes.T @ frame.axes[:, 2] if shapes.flexure else ALONG
        e += soft_joint(p.base_soft, p.base_soft_damping, _three(qs, "u"), _three(vs, "u"), along)
        frame = frame if shapes.flexure else frame.moved(_three(qs, "u"), _three(vs, "u"))
    if shapes.b.count and not shapes.a.count:  # a planar robot's leg does not bend across the plane
        qs, vs = (SimpleNamespace(**vars(part) | {"a": zeros(shapes.b.count)}) for part in (qs, vs))
    s = qs.l - p.mouth  # (T3.6)  free length outside the cylinder
    a, b, present = shapes.a if shapes.a.count else shapes.b, shapes.b, (zeros(0), zeros(0))
    if shapes.sections:
        qs, vs = (of_planes(shapes.planes, part) for part in (qs, vs))
        integrals = stepped_shapes(b if b.count else a, shapes.axial, shapes.planes, p, s, qs.l)
        near, present = expanded(list(integrals.values()), qs.l)
        tip = np.tile((b if b.count else a).tip, len(shapes.planes))
        a = b = SteppedShapes(count=tip.size, tip=tip, **dict(zip(integrals, near, strict=True)))
    motion = Motion(
        a=a,
        b=b,
        axial=shapes.axial,
        frame=frame,
        s=s,
        q=q,
        v=v,
        qs=qs,
        vs=vs,
    )
    e += cylinder(frame, p, vs) + (stepped_piston if shapes.sections else sliding_piston)(motion, p)
    if shapes.torsion:
        e += torsion(frame, p, qs, vs)
    series = screw(p, qs, vs, oil=shapes.oil) if shapes.series else Energies()
    e += series
    if shapes.ripple:
        e += Energies(strain=ripple(p, qs))
    if shapes.tip_body:
        e += tip_body(motion, p, shapes.planar)
    if shapes.closure == "pose":
        e += _joints(shapes, p, qs, vs)
    place = tip_place(motion)
    if shapes.soft_platform:
        along = matrix33(p.leg_frame).T @ ALONG if shapes.flexure else ALONG
        e += soft_joint(p.platform_soft, p.platform_soft_damping, _three(qs, "e"), _three(vs, "e"), along)
        place = place if shapes.flexure else place + _three(qs, "e")
    theta = symbol("theta", 3)
    lagrangian = Lagrangian(q=q, v=v, kinetic=e.kinetic, potential=e.gravity + e.strain, dissipation=e.dissipation)
    return Leg(
        lagrangian=lagrangian,
        gravity=e.gravity,
        strain=e.strain,
        tip=frame.origin + frame.axes @ place,
        tip_axes=frame.axes @ small_rotation(theta),
        theta=theta,
        turn=tip_turn(motion),
        series=series,
        present=present,
    )


def _base(
    shapes: Shapes, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace
) -> tuple[Frame | None, Energies]:
    """Frame of a base that moves, None of one that stands still; the leg's share of mounts and plate."""
    base, e = None, Energies()
    if shapes.base_motion:
        base = displaced(WORLD, p.base_motion_at, qs.g, vs.g)
    if shapes.base_mount:
        base = displaced(base or WORLD, p.base_mount_at, qs.f, vs.f)
        e += mount(p.base_mount_stiffness, p.base_mount_damping, qs.f, vs.f)
        e += plate(base, p.base_mount_at, p.base_plate_mass, p.base_plate_inertia, p.gravity)
    if shapes.platform_mount:
        e += mount(p.platform_mount_stiffness, p.platform_mount_damping, qs.m, vs.m)
    return base, e


def _joints(shapes: Shapes, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace) -> Energies:
    """Springs and dampers of the joints at both ends."""
    base, base_rate = (vertcat(x.alpha, x.beta, x.spin if shapes.spin else zeros(1)) for x in (qs, vs))
    end, end_rate = (vertcat(x.gamma1, x.gamma2, x.gamma3) for x in (qs, vs))
    base, end = base - p.base_home, end - p.gamma_home
    e = springs(p.base_stiffness, p.base_damping, base, base_rate)
    e += springs(p.gamma_stiffness, p.gamma_damping, end, end_rate)
    if shapes.flexure:
        moved, rate = vertcat(_three(qs, "u"), base), vertcat(_three(vs, "u"), base_rate)
        e += flexure(p.base_flexure, p.base_flexure_damping, moved, rate)
        moved, rate = vertcat(_three(qs, "e"), end), vertcat(_three(vs, "e"), end_rate)
        e += flexure(p.platform_flexure, p.platform_flexure_damping, moved, rate)
    return e


def _three(of: SimpleNamespace, name: str) -> SX:
    """Displacement of a joint, or its rate."""
    return vertcat(*(getattr(of, f"{name}{k}") for k in (1, 2, 3)))
