"""The spring and damper of a drive between its command and its coordinate, Eqs. (T5.4)-(T5.5), and its integral."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX


@dataclass(frozen=True, kw_only=True)
class Servo:
    """A drive on the coordinate ``q``; stiffness and damping are zero where the coordinate is prescribed.

    ``more``: what elements ask of the motor beside, as a summed error does, Eq. (T23.15).
    """

    stiffness: SX
    damping: SX
    q: SX
    v: SX
    q_cmd: SX
    v_cmd: SX
    more: SX | None = None

    @property
    def force(self) -> SX:
        """Force on the coordinate, Eqs. (T5.4) and (T23.15)."""
        return self._held if self.more is None else self._held + self.more

    @property
    def _held(self) -> SX:
        return self.stiffness * (self.q_cmd - self.q) + self.damping * (self.v_cmd - self.v)

    @property
    def energy(self) -> SX:
        """Energy of the spring."""
        return 0.5 * self.stiffness * (self.q_cmd - self.q) ** 2

    @property
    def damper_power(self) -> SX:
        """Power lost in the damper."""
        return self.damping * (self.v_cmd - self.v) ** 2

    @property
    def input_power(self) -> SX:
        """Power that enters at the commanded end, Eq. (T5.5), and by further requested forces."""
        power = self._held * self.v_cmd
        return power if self.more is None else power + self.more * self.v
