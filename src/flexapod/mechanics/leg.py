"""Energies and tip of one sliding flexible leg, Eqs. (T3.6)-(T3.15)."""

from dataclasses import dataclass
from types import SimpleNamespace

from flexapod.mechanics.damping import dissipation
from flexapod.mechanics.distribution import Distribution, Field, Motion, kinetic_energy, piston, tip_body
from flexapod.mechanics.layout import Shapes
from flexapod.mechanics.rotations import universal_joint, universal_joint_rate
from flexapod.symbolic.lagrange import Lagrangian
from flexapod.symbolic.vocabulary import SX, constant, dot, matrix33, quadratic, time_derivative, vertcat, zeros


@dataclass(frozen=True, kw_only=True)
class Leg:
    """One leg as expressions: Lagrangian parts and tip in the world frame."""

    lagrangian: Lagrangian
    gravity: SX
    strain: SX
    tip: SX


def leg(shapes: Shapes, p: SimpleNamespace, q: SX, v: SX, qs: SimpleNamespace, vs: SimpleNamespace) -> Leg:
    """Energies and tip of one leg from its coordinates; ``qs`` and ``vs`` are the named pieces of q and v."""
    alpha, alpha_dot = (zeros(1), zeros(1)) if shapes.planar else (qs.alpha, vs.alpha)
    s = qs.l - p.mouth  # (T3.6)  free length outside the cylinder
    R = universal_joint(alpha, qs.beta)
    omega = universal_joint_rate(qs.beta, alpha_dot, vs.beta)
    motion = Motion(shapes=shapes, s=s, q=q, v=v, qs=qs, vs=vs, omega=omega)
    bodies = [piston(motion, p), *([tip_body(motion, p)] if shapes.planar else [])]
    T = sum((kinetic_energy(motion, body) for body in bodies), rigid_rotation(p, omega))
    if shapes.planar:
        T += tip_rotation(motion, p)
    g = R.T @ matrix33(p.R0).T @ p.gravity  # gravity in leg coordinates
    V_g = sum((gravity_energy(motion, body, g) for body in bodies), -p.cylinder_mass * p.cylinder_com * g[2])
    V_g -= (sum(body.first.one for body in bodies) + p.cylinder_mass) * dot(p.gravity, p.base)  # zero at the base plane
    V_s = strain_energy(shapes, p, s, qs)
    tip = p.base + matrix33(p.R0) @ R @ tip_in_leg(motion, qs.l)
    loss = dissipation(shapes, p, s, vs) + p.damping_time * strain_energy(shapes, p, s, vs)  # (T5.6)
    lagrangian = Lagrangian(q=q, v=v, kinetic=T, potential=V_g + V_s, dissipation=loss)
    return Leg(lagrangian=lagrangian, gravity=V_g, strain=V_s, tip=tip)


def rigid_rotation(p: SimpleNamespace, omega: SX) -> SX:
    """Cylinder about the U joint, and the spin of cylinder and piston about the leg, Eq. (T3.12)."""
    transverse = p.cylinder_inertia + p.cylinder_mass * p.cylinder_com**2
    axial = p.cylinder_axial_inertia + p.piston_axial_inertia
    return 0.5 * (transverse * (omega[0] ** 2 + omega[1] ** 2) + axial * omega[2] ** 2)


def tip_rotation(f: Motion, p: SimpleNamespace) -> SX:
    """Rotary inertia of a body fixed to the tip of a planar leg, Eq. (T3.13)."""
    slope = dot(constant(f.shapes.a.tip_slope).T, f.qs.a) / f.s if f.shapes.a.count else zeros(1)
    return 0.5 * p.tip_inertia * (f.omega[1] + time_derivative(slope, (f.q, f.v))) ** 2


def gravity_energy(f: Motion, body: Distribution, g: SX) -> SX:
    """- int g . r dm with the foreshortening's fall, Eq. (T3.14); g in leg coordinates."""
    height = body.integral(Field(X=SX(1), psi=f.qs.c)) + body.short
    return -(g[0] * body.integral(Field(phi=f.qs.a)) + g[1] * body.integral(Field(phi=f.qs.b)) + g[2] * height)


def strain_energy(shapes: Shapes, p: SimpleNamespace, s: SX, qs: SimpleNamespace) -> SX:
    """Bending of the free length and stretch of the whole piston, Eq. (T3.15); quadratic in the amplitudes ``qs``."""
    bending = quadratic(qs.a, shapes.a.stiffness) + quadratic(qs.b, shapes.b.stiffness)
    return 0.5 * p.EI / s**3 * bending + 0.5 * p.EA / p.Lp * quadratic(qs.c, shapes.axial.stiffness)


def tip_in_leg(f: Motion, l: SX) -> SX:  # noqa: E741
    """Tip (v(1), w(1), l + c_0 + e(1)) in leg coordinates, Eq. (T3.11)."""
    v = dot(constant(f.shapes.a.tip).T, f.qs.a) if f.shapes.a.count else zeros(1)
    w = dot(constant(f.shapes.b.tip).T, f.qs.b) if f.shapes.b.count else zeros(1)
    stretch = f.qs.c[0] if f.shapes.axial.count else zeros(1)
    return vertcat(v, w, l + stretch + f.foreshortening("slope_tip") / f.s)
