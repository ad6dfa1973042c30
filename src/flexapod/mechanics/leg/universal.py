"""The base joint: a universal joint, and with a spin about the leg's axis a spherical one, Eqs. (T3.4)-(T3.5)."""

from __future__ import annotations

from types import SimpleNamespace

from flexapod.mechanics.elements.frames import Frame
from flexapod.mechanics.elements.rotations import about_x, about_y, about_z
from flexapod.mechanics.symbolic.vocabulary import cos, sin, vertcat, zeros


def universal(frame: Frame, qs: SimpleNamespace, vs: SimpleNamespace) -> Frame:
    """Frame of the cylinder; a planar leg has no alpha, a leg that cannot spin no spin."""
    has_alpha, has_spin = hasattr(qs, "alpha"), hasattr(qs, "spin")
    alpha, alpha_dot = (qs.alpha, vs.alpha) if has_alpha else (zeros(1), zeros(1))
    rate = vertcat(alpha_dot * cos(qs.beta), vs.beta, alpha_dot * sin(qs.beta))  # (T3.5)
    turned = frame.turned(about_x(alpha), zeros(3)).turned(about_y(qs.beta), rate)  # (T3.4)
    return turned.turned(about_z(qs.spin), vertcat(0, 0, vs.spin)) if has_spin else turned  # (T13.4)
