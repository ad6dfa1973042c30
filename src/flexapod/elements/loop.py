"""A motor whose force lags behind what its loop asks for, by what that measures, Eqs. (T23.51)-(T23.53)."""

from dataclasses import dataclass
from types import SimpleNamespace

from flexapod.symbolic.vocabulary import SX


@dataclass(frozen=True, kw_only=True)
class Loop:
    """Force of a motor on its rotor.

    ``p``: `drive_layout.LOOP_PARAMETERS`; ``place`` and ``rate``: what is measured, ``q_cmd`` and ``v_cmd`` what it is
    to be, ``turns``: rate of the rotor; ``summed``: force of the summed error, None without; ``j``: rate of the motor's
    impulse, the force that lags.
    """

    p: SimpleNamespace
    place: SX
    rate: SX
    turns: SX
    q_cmd: SX
    v_cmd: SX
    summed: SX | None
    j: SX

    @property
    def asked(self) -> SX:
        """Force that the loop asks for, Eq. (T23.52)."""
        rate = self.rate + self.p.loop_rate_at_rotor * (self.turns - self.rate)
        held = self.p.loop_stiffness * (self.q_cmd - self.place) + self.p.loop_damping * (self.v_cmd - rate)
        return held if self.summed is None else held + self.summed

    @property
    def force(self) -> SX:
        """Force on the rotor: at once what is asked for, or what lags behind it."""
        return self.p.loop_at_once * self.asked + (1 - self.p.loop_at_once) * self.j

    def lag(self, j_dot: SX) -> SX:
        """What vanishes where the force lags as it does, Eq. (T23.53)."""
        return self.p.loop_lag * j_dot + self.j - self.asked
