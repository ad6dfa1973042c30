"""Problem of a time integration, and the messages for where it fails."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.solve.system import Flow, System
from flexapod.solve.time.command_tables import Law
from flexapod.solve.time.recording import Recording
from flexapod.solve.time.time_events import Stops

if TYPE_CHECKING:
    from flexapod.solve.time.sampled_control import SampledLoop

Measure = Callable[[Recording], list[Array]]
ASKED = 5  # as in loop.c
CAUSES = {
    1: "the step's equations were not solved",
    2: "numbers became infinite",
    3: "the linear equations are singular",
    ASKED: "a controller's function failed",
}
_ADVICE = (
    "Reduce the step, check for a singular pose, a leg near buckling or a piston almost inside its cylinder, "
    "or start from equilibrium."
)
OF_LOOPS = "Its controller may make it grow: reduce gain or delay, or sample more often. Else: "


@dataclass(frozen=True, kw_only=True)
class Weight:
    """Weights of displacements of coordinates in one group of the measure: of a leg (n,), of the payload (6,)."""

    leg: Array
    hub: Array


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A time integration: system, commands, method and output grid.

    ``tables`` see `tables.Law`; ``measure`` gives the quantities whose error is controlled, as
    groups (T, ...) with a common scale each, ``weights`` what moves them; ``restart(flow, t, h)`` goes on after a jump
    of a command or a load just before t, of which ``stops`` tells the instants; between ``knots`` (n,), its ends
    included, the commanded path is smooth; ``loop``: a sampled controller.
    """

    system: System
    method: GeneralizedAlpha
    tables: Law
    output_step: float
    outputs: int
    measure: Measure
    restart: Callable[[Flow, float, float], Flow]
    stops: Stops
    check: Callable[[Recording], None]
    tolerance: float | None
    weights: tuple[Weight, ...] = ()
    knots: Array = field(default_factory=lambda: np.zeros(0))
    loop: "SampledLoop | None" = None

    def tables_under(self, flow: Flow) -> Law:
        """Commands and loads with what a controller holds."""
        return self.loop.add_held_outputs(self.tables, flow) if self.loop else self.tables

    def stop_error(self, status: int, where: str) -> ComputationError:
        """Error for an integration that stopped; an exception of a controller's function is raised as it is."""
        if status == ASKED and self.loop and self.loop.fault:
            raise self.loop.fault
        return ComputationError(
            f"the integration stopped {where}", next_step=OF_LOOPS + _ADVICE if self.loop else _ADVICE
        )

    @property
    def adaptive(self) -> bool:
        """True where steps follow the tolerance one by one: compiled equations."""
        return self.tolerance is not None and self.system.kernel.library is not None


@dataclass(frozen=True, kw_only=True)
class Chunk:
    """Piece of a result: recording, largest estimated relative error, step used, estimated error of forces [N]."""

    recording: Recording
    error: float
    step: float
    force_error: float | None = None
