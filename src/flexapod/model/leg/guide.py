"""Bushings that hold a piston across."""

from __future__ import annotations

from typing import Annotated

from pydantic import model_validator

from flexapod.common.tables.base import Key, Loss, Quantity
from flexapod.common.tables.table import Table
from flexapod.model.leg.spring import check_lossy


class Guide(Table):
    """Two bushings in which a piston slides: in the cylinder's mouth (`gland`), on the piston's inner end (`head`).

    Stiffness [N/m] of each across the leg, with a damper [N s/m] or a loss factor for both; `clearance` [m]: the free
    travel across, of each.
    """

    gland: Annotated[
        float, Quantity("stiffness", above=0, why="stiffness across the leg of the bushing in the cylinder's mouth")
    ]
    head: Annotated[
        float, Quantity("stiffness", above=0, why="stiffness across the leg of the bushing on the piston's inner end")
    ]
    clearance: Annotated[
        float | None,
        Quantity(
            "length",
            least=0,
            why="free travel of the piston across the leg, in each bushing; of legs that no joint holds across "
            "(UPS, SPS)",
        ),
    ] = None
    damping: Annotated[float | None, Quantity("damping", least=0, why="damper of each bushing, across the leg")] = None
    loss: Annotated[Loss | None, Key("loss factor of both bushings, in place of `damping`")] = None

    @model_validator(mode="after")
    def _sensible(self) -> Guide:
        check_lossy(self)
        return self
