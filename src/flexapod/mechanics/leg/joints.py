"""Carriage, cylinder and joints of a leg, Eqs. (T3.4)-(T3.5), (T3.12), (T13.1)-(T13.3), (T13.5).

A carriage is a slider on a rail or a crank on a shaft. The cylinder is a rigid body that turns about the base
joint, a universal joint or, with a spin about the leg's axis, a spherical one. The platform joint has three
successive angles about axes fixed in the leg, in the cross, in the platform.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

from flexapod.mechanics.elements.frames import Energies, Frame, about_axis, about_x, about_y, about_z
from flexapod.mechanics.symbolic.vocabulary import cos, cross, dot, matrix33, sin, vertcat, zeros

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX


def carriage(
    kind: str, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace, base: Frame | None = None
) -> tuple[Frame, Energies]:
    """Frame of the base joint, and the energies of what carries it; ``kind``: "", "slider", "crank".

    ``base``: frame of a base that moves, at the origin while it is where it is drawn.
    """
    if base is not None:
        return _on_moving_base(kind, p, qs, vs, base)
    R0 = matrix33(p.R0)
    if not kind:
        return Frame(origin=p.base, axes=R0, velocity=zeros(3), omega=zeros(3)), Energies()
    axis = p.carriage_axis
    if kind == "slider":
        frame = Frame(  # (T13.1)
            origin=p.base + axis * qs.chi, axes=R0, velocity=R0.T @ axis * vs.chi, omega=zeros(3)
        )
        return frame, Energies(
            kinetic=0.5 * p.carriage_mass * vs.chi**2, gravity=-p.carriage_mass * dot(p.gravity, frame.origin)
        )
    turn = about_axis(axis, qs.chi)
    axes, arm, shaft = turn @ R0, turn @ p.carriage_arm, p.base - p.carriage_arm
    frame = Frame(  # (T13.2)
        origin=shaft + arm,
        axes=axes,
        velocity=axes.T @ cross(axis, arm) * vs.chi,
        omega=R0.T @ axis * vs.chi,
    )
    weight = -p.carriage_mass * dot(p.gravity, shaft + turn @ p.carriage_com)
    return frame, Energies(kinetic=0.5 * p.carriage_inertia * vs.chi**2, gravity=weight)  # (T13.3)


def _on_moving_base(
    kind: str, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace, base: Frame
) -> tuple[Frame, Energies]:
    """Frame of the base joint and energies of its carriage on a base that moves, Eq. (T24.4)."""

    def home(frame: Frame) -> Frame:
        return frame.turned(matrix33(p.R0), zeros(3))

    if not kind:
        return home(base.moved(p.base, zeros(3))), Energies()
    axis, mass = p.carriage_axis, p.carriage_mass
    if kind == "slider":
        frame = base.moved(p.base + axis * qs.chi, axis * vs.chi)
        return home(frame), _body(frame, mass, p.gravity)
    shaft = base.moved(p.base - p.carriage_arm, zeros(3)).turned(about_axis(axis, qs.chi), axis * vs.chi)
    centre = shaft.moved(p.carriage_com, zeros(3))
    about = p.carriage_inertia - mass * dot(p.carriage_com, p.carriage_com)
    spin = Energies(kinetic=0.5 * about * dot(axis, shaft.omega) ** 2)
    return home(shaft.moved(p.carriage_arm, zeros(3))), _body(centre, mass, p.gravity) + spin


def _body(frame: Frame, mass: SX, gravity: SX) -> Energies:
    """Energies of a mass at the origin of a frame."""
    kinetic = 0.5 * mass * dot(frame.velocity, frame.velocity)
    return Energies(kinetic=kinetic, gravity=-mass * dot(gravity, frame.origin))


def cylinder(frame: Frame, p: SimpleNamespace, vs: SimpleNamespace) -> Energies:
    """Energies of a body whose CoM lies on the leg's axis; under a cylindrical joint it does not spin along."""
    m, d, w, u = p.cylinder_mass, p.cylinder_com, frame.omega, frame.velocity
    spin = w[2] - (1 - p.cylinder_spins) * vs.spin if hasattr(vs, "spin") else w[2]
    transverse = p.cylinder_inertia + m * d**2
    turning = transverse * (w[0] ** 2 + w[1] ** 2) + p.cylinder_axial_inertia * spin**2  # (T3.12)
    carried = m * (0.5 * dot(u, u) + d * (u[0] * w[1] - u[1] * w[0]))  # (T13.5)
    return Energies(kinetic=0.5 * turning + carried, gravity=frame.weight(p.gravity, m, vertcat(0, 0, m * d)))


def gimbal(axes: SX, qs: SimpleNamespace) -> SX:
    """Axes behind the joint: those before it, turned by gamma1, gamma2, gamma3 one after the other, Eq. (T13.9)."""
    return axes @ about_x(qs.gamma1) @ about_y(qs.gamma2) @ about_z(qs.gamma3)


def universal(frame: Frame, qs: SimpleNamespace, vs: SimpleNamespace) -> Frame:
    """Frame of the cylinder; a planar leg has no alpha, a leg that cannot spin no spin."""
    has_alpha, has_spin = hasattr(qs, "alpha"), hasattr(qs, "spin")
    alpha, alpha_dot = (qs.alpha, vs.alpha) if has_alpha else (zeros(1), zeros(1))
    rate = vertcat(alpha_dot * cos(qs.beta), vs.beta, alpha_dot * sin(qs.beta))  # (T3.5)
    turned = frame.turned(about_x(alpha), zeros(3)).turned(about_y(qs.beta), rate)  # (T3.4)
    return turned.turned(about_z(qs.spin), vertcat(0, 0, vs.spin)) if has_spin else turned  # (T13.4)
