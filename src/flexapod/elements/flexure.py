"""Springs of a joint: on its angles, or a flexure that gives way along and about all axes, Eqs. (T13.6), (T13.17)."""

from flexapod.elements.frame import Energies
from flexapod.symbolic.vocabulary import SX, dot, reshape


def springs(stiffness: SX, angles: SX) -> Energies:
    """A spring on each of some successive angles [N m/rad]."""
    return Energies(strain=0.5 * dot(stiffness, angles**2))  # (T13.6)


def flexure(stiffness: SX, moved: SX) -> Energies:
    """6x6 stiffness, column by column, against displacements and angles."""
    return Energies(strain=0.5 * dot(moved, reshape(stiffness, 6, 6) @ moved))  # (T13.17)
