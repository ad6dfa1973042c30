"""Springs on the angles of a joint, Eq. (T13.6)."""

from flexapod.elements.frame import Energies
from flexapod.symbolic.vocabulary import SX, dot


def flexure(stiffness: SX, angles: SX, home: SX) -> Energies:
    """A spring on each of some successive angles [N m/rad], slack at ``home``."""
    return Energies(strain=0.5 * dot(stiffness, (angles - home) ** 2))
