"""The platform joint: three successive angles about axes fixed in the leg, in the cross, in the platform."""

from types import SimpleNamespace

from flexapod.elements.rotations import about_x, about_y, about_z
from flexapod.symbolic.vocabulary import SX


def gimbal(qs: SimpleNamespace) -> SX:
    """Gamma = Rx(gamma1) Ry(gamma2) Rz(gamma3), from the joint's frame in the platform to that in the leg, (T13.9)."""
    return about_x(qs.gamma1) @ about_y(qs.gamma2) @ about_z(qs.gamma3)
