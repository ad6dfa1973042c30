"""The spring and damper of a drive between its command and its coordinate, Eqs. (T5.4)-(T5.5)."""

from dataclasses import dataclass

from flexapod.symbolic.vocabulary import SX


@dataclass(frozen=True, kw_only=True)
class Servo:
    """A drive on the coordinate ``q``; stiffness and damping are zero where the coordinate is prescribed."""

    stiffness: SX
    damping: SX
    q: SX
    v: SX
    q_cmd: SX
    v_cmd: SX

    @property
    def force(self) -> SX:
        """Force on the coordinate, Eq. (T5.4)."""
        return self.stiffness * (self.q_cmd - self.q) + self.damping * (self.v_cmd - self.v)

    @property
    def energy(self) -> SX:
        """Energy of the spring."""
        return 0.5 * self.stiffness * (self.q_cmd - self.q) ** 2

    @property
    def lost(self) -> SX:
        """Power that the damper takes."""
        return self.damping * (self.v_cmd - self.v) ** 2

    @property
    def given(self) -> SX:
        """Power that comes in at the commanded end, Eq. (T5.5)."""
        return self.force * self.v_cmd
