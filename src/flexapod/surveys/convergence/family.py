"""A family of runs, coarse to fine: errors against the finest or a common reference, orders, rates, in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexapod.surveys.convergence.orders import finest_error, observed_order, relative_difference, shape_factor
from flexapod.surveys.convergence.trials import Trial
from flexapod.typing import Array

#: Families: what is refined, in words, and the order that theory gives.
FAMILIES = {
    "step": ("step", 2.0),
    "shapes": ("number of shapes per plane", None),
    "elements": ("number of beam elements", 4.0),
    "segments": ("number of segments", 2.0),
}
ABOVE = 10.0  # an error of this many rounding floors is known to 10 %, an order to 0.15
SETTLED = 0.5  # an observed order this near to that of theory is one


@dataclass(frozen=True, kw_only=True)
class Family:
    """Runs that differ in one thing.

    `trials`, coarse to fine, failed ones too; `floor` by quantity: relative difference that is rounding.
    """

    name: str
    trials: tuple[Trial, ...]
    floor: Mapping[str, float]

    @property
    def reference(self) -> Trial | None:
        """The finest run that did not fail."""
        return next((trial for trial in reversed(self.trials) if not trial.failure), None)

    def size(self, trial: Trial) -> float:
        """Step [s], or length of an element or of a piece as long as one shape, of the free length."""
        return (trial.setting.step or np.nan) if self.name == "step" else 1.0 / trial.setting.shapes

    def errors(self, quantity: str) -> Array:
        """Relative difference of each run to the reference; NaN of failed ones, 0 of the reference."""
        found = self.reference
        return np.array(
            [np.nan if t.failure or found is None else relative_difference(*t.common(found, quantity))
             for t in self.trials]
        )  # fmt: skip

    def orders(self, quantity: str) -> Array:
        """Observed order between each run and the one before; NaN at the floor, for the reference, after a failure."""
        errors, found = self.errors(quantity), np.full(len(self.trials), np.nan)
        if self.reference is None:
            return found
        least, finest = ABOVE * self.floor[quantity], self.size(self.reference)
        for i in range(1, len(errors)):
            if min(errors[i - 1], errors[i]) > least:
                sizes = self.size(self.trials[i - 1]), self.size(self.trials[i]), finest
                found[i] = observed_order(sizes, (errors[i - 1], errors[i]))
        return found

    def own_error(self, quantity: str) -> float:
        """Error of the reference itself, from the fall of the others, never below the floor; NaN of one alone."""
        errors, orders = self.errors(quantity), self.orders(quantity)
        others = [i for i, t in enumerate(self.trials) if not t.failure and t is not self.reference]
        if not others or self.reference is None:
            return float("nan")
        last = others[-1]
        order = min(orders[last], FAMILIES[self.name][1] or np.inf)  # never faster than theory promises
        own = finest_error(self.size(self.trials[last]), self.size(self.reference), errors[last], order)
        return max(own, self.floor[quantity])

    def bounds(self, quantity: str) -> Array:
        """Error of each run with that of the reference added."""
        return self.errors(quantity) + self.own_error(quantity)

    def order(self, quantity: str) -> float:
        """Observed order of the finest pair that has one; NaN without."""
        known = self.orders(quantity)
        known = known[np.isfinite(known)]
        return float(known[-1]) if known.size else float("nan")

    def factor(self, quantity: str) -> float | None:
        """What each shape more divides the error by; None where the fall is algebraic."""
        if self.name != "shapes" or self.reference is None:
            return None
        most = self.reference.setting.shapes / 2  # nearer to the reference its own error would count
        used = [
            (t.setting.shapes, e)
            for t, e in zip(self.trials, self.errors(quantity), strict=True)
            if e > ABOVE * self.floor[quantity] and t.setting.shapes <= most
        ]
        return shape_factor([k for k, _ in used], [e for _, e in used])

    def rate(self, quantity: str) -> str:
        """How the error falls, in words."""
        factor, order, theory = self.factor(quantity), self.order(quantity), FAMILIES[self.name][1]
        if factor is not None:
            return f"spectral: each shape more divides the error by about {factor:.2g}"
        if np.isnan(order):
            errors = self.errors(quantity)
            at_floor = np.nanmin(errors[:-1], initial=np.inf) <= ABOVE * self.floor[quantity]
            return "no order: errors reach the rounding floor" if at_floor else "no order: errors do not fall steadily"
        if theory is None:
            return f"algebraic, observed order {order:.1f}"
        settled = "" if abs(order - theory) <= SETTLED else ", not yet in the range where it shows"
        return f"observed order {order:.2f} (theory {theory:g}{settled})"
