"""Oil on both sides of a piston head: two springs side by side whose compliance goes with their length, Eq. (T23.2)."""

from types import SimpleNamespace

from flexapod.symbolic.vocabulary import SX


def oil_column(p: SimpleNamespace, away: SX) -> SX:
    """What the compliance of the oil, ``away`` from home, adds to that at home, over that of all springs there."""
    share, push, longer, shorter = (p.oil[k] for k in range(4))
    return share * (1 / (push / (1 + away * longer) + (1 - push) / (1 - away * shorter)) - 1)
