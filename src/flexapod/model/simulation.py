"""How a study is computed: fidelity, basis, time, tolerance; and how it starts."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from flexapod.errors import InputError, closest
from flexapod.model.base import Frozen, Positive

__all__ = ["DEFAULT_TOLERANCE", "FIDELITIES", "LATER_BASES", "LATER_FIDELITIES", "Initial", "Simulation"]

FIDELITIES = ("rigid", "lumped", "assumed-modes")
LATER_FIDELITIES = ("finite-segment", "beam-fem")
LATER_BASES = ("segments", "hermite")
DEFAULT_TOLERANCE = 1e-4


class Initial(Frozen):
    """Start of a robot: `equilibrium` (static, at rest), `straight` (undeformed) or `moving` (rigid velocity field)."""

    start: Literal["equilibrium", "straight", "moving"] = "equilibrium"


class Simulation(Frozen):
    """Settings of a simulation.

    `fidelity`; `basis` and `modes` of the lateral shapes (per plane); `duration` [s] (None: the motion with its hold);
    `tolerance` (relative, of the step control) or fixed `step` [s]; `output_step` [s]; `rho_inf`, spectral radius of
    the integrator at infinite frequency.
    """

    fidelity: str = "assumed-modes"
    basis: Literal["tip-load", "clamped-free", "tip-mass"] = "tip-load"
    modes: int = Field(default=3, strict=True, ge=0, le=12)
    duration: Positive | None = None
    tolerance: Annotated[Positive, Field(lt=1)] | None = None
    step: Positive | None = None
    output_step: Positive = 1e-3
    rho_inf: float = Field(default=0.9, strict=True, ge=0, le=1)

    def __init__(self, **fields: object) -> None:
        if fields.get("tolerance") is None and fields.get("step") is None:
            fields = fields | {"tolerance": DEFAULT_TOLERANCE}
        if fields.get("basis") in LATER_BASES:
            raise InputError(
                "comes with a later version of flexapod",
                key="basis",
                value=fields["basis"],
                allowed="tip-load, clamped-free, tip-mass",
            )
        super().__init__(**fields)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        check_fidelity(self.fidelity)
        if self.tolerance is not None and self.step is not None:
            raise InputError(
                "is given together with tolerance",
                key="step",
                value=self.step,
                allowed="tolerance (steps are chosen) or step (fixed), not both",
            )
        if self.fidelity == "assumed-modes" and self.modes == 0:
            raise InputError(
                "leaves no lateral shape for 'assumed-modes'",
                key="modes",
                value=0,
                allowed="1 to 12",
                next_step='Choose fidelity = "lumped" for legs that only stretch, "rigid" for a straight beam',
            )
        return self

    @property
    def lateral_shapes(self) -> int:
        """Shapes per lateral plane that the fidelity uses: `modes`, or 0 for rigid and lumped legs."""
        return self.modes if self.fidelity == "assumed-modes" else 0

    @property
    def stored_step(self) -> float:
        """Time between stored results [s]: `output_step`, or a fixed `step` longer than it."""
        return max(self.output_step, self.step or 0.0)

    def outputs(self, duration: float) -> int:
        """Number of intervals between stored results in `duration` [s]; a rest shorter than one is left out."""
        return math.floor(duration / self.stored_step + 1e-6)


def check_fidelity(fidelity: str) -> None:
    """Refuse a fidelity that does not exist, and name those that come later."""
    if fidelity in LATER_FIDELITIES:
        raise InputError(
            "comes with a later version of flexapod",
            key="fidelity",
            value=fidelity,
            allowed=", ".join(FIDELITIES),
            next_step='Choose "assumed-modes" for bending legs',
        )
    if fidelity not in FIDELITIES:
        raise InputError(
            "is not known",
            key="fidelity",
            value=fidelity,
            allowed=", ".join(FIDELITIES),
            next_step=closest(fidelity, FIDELITIES),
        )
