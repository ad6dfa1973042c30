"""The platform joint: three successive angles about axes fixed in the leg, in the cross, in the platform."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

from flexapod.mechanics.elements.rotations import about_x, about_y, about_z

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX


def gimbal(axes: SX, qs: SimpleNamespace) -> SX:
    """Axes behind the joint: those before it, turned by gamma1, gamma2, gamma3 one after the other, Eq. (T13.9)."""
    return axes @ about_x(qs.gamma1) @ about_y(qs.gamma2) @ about_z(qs.gamma3)
