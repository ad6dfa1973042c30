"""A joint held by springs along and across its leg, whose axes move with the leg, Eqs. (T15.1)-(T15.2)."""

from flexapod.elements.frame import Energies
from flexapod.symbolic.vocabulary import SX, dot


def soft_joint(stiffness: SX, damping: SX, moved: SX, rate: SX, along: SX) -> Energies:
    """Springs and dampers, each (across, along), against a displacement; ``along``: the leg's direction in its axes."""
    return Energies(
        strain=_half_square(stiffness, moved, along),  # (T15.1)
        dissipation=_half_square(damping, rate, along),  # (T15.2)
    )


def _half_square(by: SX, x: SX, along: SX) -> SX:
    axial = dot(along, x) ** 2
    return 0.5 * (by[0] * (dot(x, x) - axial) + by[1] * axial)
