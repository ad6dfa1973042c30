"""Cogging and ripple of a motor: a torque that returns with its turns, as a potential of the rotor, Eq. (T23.21)."""

from types import SimpleNamespace

from flexapod.symbolic.vocabulary import SX, cos, dot, vertcat


def ripple(p: SimpleNamespace, qs: SimpleNamespace) -> SX:
    """Energy of the harmonics of the torque, of mean 0."""
    angle = p.ripple_wave * qs.r
    return dot(p.ripple, vertcat(*(1 - cos(k * angle) for k in range(1, 5))))
