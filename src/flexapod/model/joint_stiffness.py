"""How the stiffness of a joint is written as a table: along and across the leg, or in rows, with what damps it."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from flexapod.schema.base import Key, Loss, Matrix6, Quantity
from flexapod.schema.table import Table

__all__ = ["AlongLeg", "InRows"]


class AlongLeg(Table):
    """Springs along (`axial`) and across (`radial`) the leg [N/m], with a damper [N s/m] or a loss factor."""

    axial: Annotated[float, Quantity("stiffness", above=0, why="along the leg")]
    radial: Annotated[float, Quantity("stiffness", above=0, why="across the leg")]
    damping: Annotated[float | None, Quantity("damping", least=0, why="along and across the leg")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of `damping`; left out: that of the joint")] = None

    @property
    def of_joint(self) -> dict[str, object]:
        """What a joint has of it."""
        along = np.diag([self.radial, self.radial, self.axial, 0.0, 0.0, 0.0])
        return {"stiffness": along, "leg_axes": True, **_damped(self)}


class InRows(Table):
    """Springs along and about the axes of base or platform, `rows` (6, 6) [N/m, N, N m/rad], with what damps them."""

    rows: Annotated[Matrix6, Quantity("stiffness", "force", "rotational stiffness")]
    damping: Annotated[float | None, Quantity("damping", least=0, why="along and across the leg")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of `damping`; left out: that of the joint")] = None

    @property
    def of_joint(self) -> dict[str, object]:
        """What a joint has of it."""
        return {"stiffness": self.rows, **_damped(self)}


def _damped(spring: AlongLeg | InRows) -> dict[str, object]:
    return {"stiffness_damping": spring.damping, "stiffness_loss": spring.loss}
