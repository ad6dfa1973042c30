"""Buckling of legs whose pistons have sections, Eq. (T8.23)."""

import numpy as np

from flexapod.common.arrays import Array
from flexapod.model import Leg

HALVINGS = 60


def stepped_buckling(leg: Leg, free: Array) -> Array:
    """Least thrust under which a leg between pinned ends buckles, rigid to the mouth, (T,) [N]; free lengths (T,) [m].

    Of a strip in its weaker direction.
    """
    steps = leg.piston.steps[::-1]  # from the tip
    starts = np.concatenate([[0.0], np.cumsum([step.length for step in steps])[:-1]])
    out = np.clip(free - starts[:, None], 0.0, np.array([[step.length] for step in steps]))[::-1]  # from the mouth
    found = [_least(leg.cylinder.mouth, out, np.array([step.EI[k] for step in steps[::-1]])) for k in (0, 1)]
    return np.minimum(*found)


def _least(mouth: float, out: Array, EI: Array) -> Array:
    """Least thrust at which the deflection comes back to the line of the joints, by halving."""
    whole = out.sum(axis=0)
    low, high = np.zeros_like(whole), EI.max() * (np.pi / whole) ** 2
    for _ in range(HALVINGS):
        thrust = 0.5 * (low + high)
        back = _phase(mouth, out, EI, thrust) >= np.pi
        low, high = np.where(back, low, thrust), np.where(back, thrust, high)
    return 0.5 * (low + high)


def _phase(mouth: float, out: Array, EI: Array, thrust: Array) -> Array:
    """Phase p at the tip of v = r sin p, v' = k r cos p, k^2 = P / EI, which grows with the thrust."""
    wave = np.sqrt(thrust / EI[:, None])
    phase, turns, before = np.arctan(wave[0] * mouth), np.zeros_like(thrust), wave[0]
    for k, length in zip(wave, out, strict=True):
        phase = np.arctan(k / before * np.tan(phase))  # (T8.23)  deflection and slope go on
        phase = phase + k * length
        half = np.round(phase / np.pi)
        turns, phase, before = turns + half, phase - half * np.pi, k
    return phase + turns * np.pi
