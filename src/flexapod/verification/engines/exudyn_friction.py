"""LuGre's friction beside Exudyn, which asks it as a user function of a connector.

The bristles of a step follow the mean of the rates at its ends, exactly for a rate that is constant; rates at its end
are Newton's, so that the friction of a step is part of what it solves for.
"""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array

Numbers = tuple[float, ...]


class Bristles:
    """LuGre's bristles at one place, a vector (n,), Eqs. (T19.1)-(T19.4).

    `numbers`: force of sliding, its share of the load [m], presliding, what breaks away over it less one, one over the
    rate of Stribeck's law, viscous friction, damping time; `step` [s].
    """

    sliding: float
    arm: float
    presliding: float
    excess: float
    slower: float
    viscous: float
    time: float
    step: float
    bent: Array
    rate: Array

    def __init__(self, numbers: Numbers, step: float, count: int = 1) -> None:
        self.sliding, self.arm, self.presliding, self.excess, self.slower, self.viscous, self.time = numbers
        self.step, self.bent, self.rate = step, np.zeros(count), np.zeros(count)

    def force(self, rate: Array, load: float = 0.0) -> Array:
        """Against the sliding at a rate (n,) at the step's end."""
        speed = float(np.linalg.norm(rate))
        sliding, z = self.sliding + self.arm * load, self._bent(rate)
        slip = rate - speed * z / self._limit(speed)
        time = self.time / (1 + self.time * speed / (4 * self.presliding))
        return sliding / self.presliding * (z + time * slip) + self.viscous * rate

    def keep(self, rate: Array) -> None:
        """A step has ended with this rate."""
        self.bent, self.rate = self._bent(rate), rate.copy()

    def _bent(self, rate: Array) -> Array:
        mean = 0.5 * (self.rate + rate)
        speed = float(np.linalg.norm(mean))
        if not speed:
            return self.bent
        most = self._limit(speed)
        steady = most * mean / speed
        return steady + (self.bent - steady) * np.exp(-speed * self.step / most)

    def _limit(self, speed: float) -> float:
        return self.presliding * (1 + self.excess * float(np.exp(-((speed * self.slower) ** 2))))
