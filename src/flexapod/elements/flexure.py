"""Springs of a joint: on its angles, or a flexure that gives way along and about all axes; and what damps them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.elements.frame import Energies
from flexapod.symbolic.vocabulary import dot, reshape

if TYPE_CHECKING:
    from flexapod.symbolic.vocabulary import SX


def springs(stiffness: SX, damping: SX, angles: SX, rates: SX) -> Energies:
    """A spring [N m/rad] and a damper [N m s/rad] on each of some successive angles."""
    strain = 0.5 * dot(stiffness, angles**2)  # (T13.6)
    return Energies(strain=strain, dissipation=0.5 * dot(damping, rates**2))  # (T13.18)


def flexure(stiffness: SX, damping: SX, moved: SX, rates: SX) -> Energies:
    """6x6 stiffness and damping, column by column, against displacements and angles."""
    K, C = reshape(stiffness, 6, 6), reshape(damping, 6, 6)
    return Energies(strain=0.5 * dot(moved, K @ moved), dissipation=0.5 * dot(rates, C @ rates))  # (T13.17)-(T13.18)
