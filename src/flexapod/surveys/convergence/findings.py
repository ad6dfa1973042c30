"""What a convergence study has found so far: runs by family, the rounding floor, the reference of all."""

from __future__ import annotations

from dataclasses import dataclass, field

from flexapod.surveys.convergence.family import Family
from flexapod.surveys.convergence.orders import relative_difference
from flexapod.surveys.convergence.trials import Trial

TYPICAL_FLOOR = 1e-9  # where it cannot be measured: Newton's residual test leaves 2e-10 to 4e-10
LEAST_FLOOR = 1e-12  # rounding of thousands of steps, where two runs happen to round alike
FLOOR_MARGIN = 3.0  # one difference of two runs is a sample of what rounding does, not its bound


@dataclass(kw_only=True)
class Findings:
    """Grows while the study runs, so that an interrupt loses nothing.

    `trials` by family, in the order they were run; `floor` by quantity; `reference`: the best run of all, with its own
    relative error `reference_error`, for the file's setting and the recommended one; `shape_step`: with which shapes
    are compared [s]; `notes` in words.
    """

    quantities: tuple[str, ...]
    accuracy: float
    trials: dict[str, list[Trial]] = field(default_factory=dict)
    floor: dict[str, float] = field(default_factory=dict)
    reference: Trial | None = None
    reference_error: float = float("nan")
    shape_step: float = float("nan")
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.floor = dict.fromkeys(self.quantities, TYPICAL_FLOOR)

    def add(self, family: str, trial: Trial) -> None:
        """Keep a run."""
        self.trials.setdefault(family, []).append(trial)

    def family(self, name: str) -> Family:
        """The runs of a family, coarse to fine."""
        return Family(name=name, trials=tuple(self.trials.get(name, ())), floor=self.floor)

    def set_floor(self, one: Trial, other: Trial) -> None:
        """Take the rounding floor from two runs that differ in nothing but rounding."""
        if one.failure or other.failure:
            return
        for quantity in self.quantities:
            gap = relative_difference(*other.common(one, quantity))
            if gap == gap:  # not NaN: the quantity is zero throughout
                self.floor[quantity] = max(FLOOR_MARGIN * gap, LEAST_FLOOR)

    def set_reference(self, trial: Trial, error: float) -> None:
        """Name the best run of all and its own relative error."""
        self.reference, self.reference_error = trial, error

    def error(self, trial: Trial, quantity: str) -> float:
        """Relative difference to the best run of all; NaN of a failed one or without reference."""
        if trial.failure or self.reference is None:
            return float("nan")
        return relative_difference(*trial.common(self.reference, quantity))

    def error_with_own(self, trial: Trial, quantity: str) -> float:
        """That difference with the reference's own error added."""
        return self.error(trial, quantity) + self.reference_error
