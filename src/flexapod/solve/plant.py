"""What a time integration works on, whatever its body: flat arrays, held coordinates, tables."""

from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np

from flexapod.mechanics.layout import LEG_PARAMETERS, columns
from flexapod.solve.kernel import Kernel
from flexapod.typing import Array, Mask

TABLE = 8  # table row of a leg: l, l', l'', force, beta, beta', beta'', torque


@dataclass(frozen=True, kw_only=True)
class Plant:
    """Robot (``payload_p`` given, six legs) or single planar actuator (one leg) as the time loop sees it.

    ``held_l``, ``held_beta``: bool per leg, the coordinates that follow their table.
    """

    kernel: Kernel
    leg_p: Array
    payload_p: Array
    held_l: Mask
    held_beta: Mask

    @property
    def legs(self) -> int:
        """Number of legs."""
        return len(self.leg_p)

    @property
    def robot(self) -> bool:
        """Whether legs carry a payload."""
        return self.payload_p.size > 0

    @property
    def n(self) -> int:
        """Coordinates of a leg."""
        return self.kernel.shapes.size

    @property
    def size(self) -> int:
        """All coordinates."""
        return self.legs * self.n + (6 if self.robot else 0)

    @cached_property
    def force_floor(self) -> float:
        """Rounding of the stiffest spring's force [N]: what a residual cannot fall below at lengths of a metre."""
        EA, Lp, drive = (self.leg_p[:, columns(LEG_PARAMETERS, name)] for name in ("EA", "Lp", "drive_stiffness"))
        stretch = EA / Lp * (self.kernel.shapes.axial.count > 0)
        return float(8 * np.finfo(float).eps * np.maximum(stretch, drive).max())

    @property
    def held(self) -> Mask:
        """Mask (size,) of coordinates that follow their table."""
        mask, l_index = np.zeros((self.legs, self.n), dtype=bool), self.kernel.shapes.l_index
        mask[:, l_index], mask[:, l_index - 1] = self.held_l, self.held_beta
        return np.concatenate([mask.ravel(), np.zeros(self.size - mask.size, dtype=bool)])


@dataclass(frozen=True, kw_only=True)
class Flow:
    """Flat state of a time integration; ``a`` is the auxiliary acceleration, ``sums`` dissipated energy and works."""

    q: Array
    v: Array
    v_dot: Array
    a: Array
    lam: Array
    drive: Array  # (legs, 2): force along l, torque about beta of held coordinates
    pose: Array
    sums: Array = field(default_factory=lambda: np.zeros(3))
    powers: Array = field(default_factory=lambda: np.zeros(3))

    def copy(self) -> "Flow":
        """Independent copy."""
        return replace(self, **{name: getattr(self, name).copy() for name in self.__dataclass_fields__})


@dataclass(kw_only=True)
class Counters:
    """What the integration cost."""

    steps: int = 0
    iterations: int = 0
    factorisations: int = 0
    rejected: int = 0


@dataclass(frozen=True, kw_only=True)
class Recording:
    """States at T output instants (axis 0); ``energy``: kinetic, gravity, strain; ``sums``: lost, drives, wrench."""

    time: Array
    q: Array
    v: Array
    v_dot: Array
    lam: Array
    drive: Array
    pose: Array
    energy: Array
    sums: Array
    closure: Array

    def ending(self, last: "Recording") -> "Recording":
        """The same with another last instant."""
        names = [field.name for field in fields(self) if field.name != "time"]
        ends = {name: np.concatenate([getattr(self, name)[:-1], getattr(last, name)]) for name in names}
        return replace(self, **ends)


def record_width(plant: Plant) -> int:
    """Numbers in one output row."""
    k = plant.legs * plant.n
    return k + 2 * plant.size + 5 * plant.legs + 7 + 3 + 3 + 1


def unpack(plant: Plant, time: Array, rows: Array) -> Recording:
    """Name the columns of output rows (T, record_width)."""
    T, legs, n, N = len(rows), plant.legs, plant.n, plant.size
    sizes = [legs * n, N, N, 3 * legs, 2 * legs, 7, 3, 3, 1]
    parts = np.split(rows, np.cumsum(sizes)[:-1], axis=1)
    return Recording(
        time=time,
        q=parts[0].reshape(T, legs, n),
        v=parts[1],
        v_dot=parts[2],
        lam=parts[3].reshape(T, legs, 3),
        drive=parts[4].reshape(T, legs, 2),
        pose=parts[5],
        energy=parts[6],
        sums=parts[7],
        closure=parts[8][:, 0],
    )
