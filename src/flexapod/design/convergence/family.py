"""Orders and rates of convergence, Eqs. (T12.1)-(T12.4); families of runs; what a study has found so far."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.quantities import fill_template
from flexapod.design.convergence.trials import Trial

HIGHEST = 40.0  # orders beyond it are not orders


def relative_difference(values: Array, reference: Array) -> float:
    """Largest distance between two curves over the largest size of the reference, Eq. (T12.1); NaN if that is 0.

    Parameters
    ----------
    values, reference : ndarray, shape (T, ..., component)
        The last axis holds the components of a vector.
    """
    largest = float(np.linalg.norm(reference, axis=-1).max(initial=0.0))
    gap = float(np.linalg.norm(values - reference, axis=-1).max(initial=0.0))
    return gap / largest if largest > 0 else float("nan")  # (T12.1)


def observed_order(sizes: tuple[float, float, float], errors: tuple[float, float]) -> float:
    """Order p of two results and the finest, from the differences of the two to the finest, Eq. (T12.2).

    Parameters
    ----------
    sizes : (coarse, fine, finest)
        Steps, or lengths of elements; only their ratios count.
    errors : (coarse, fine)
        Differences to the finest.

    Returns
    -------
    float
        NaN where the error does not fall, or faster than any order up to 40.

    References
    ----------
    I. Celik et al., Procedure for estimation and reporting of uncertainty due to discretization in CFD applications,
    Journal of Fluids Engineering 130 (2008) 078001, doi:10.1115/1.2960953.
    """
    a, b = np.log(sizes[0] / sizes[2]), np.log(sizes[1] / sizes[2])
    if not (a > b > 0 and errors[0] > errors[1] > 0):
        return float("nan")
    target = errors[0] / errors[1]

    def ratio(p: float) -> float:
        return float(np.expm1(p * a) / np.expm1(p * b)) if p else float(a / b)  # (T12.2)  rises with p

    low, high = 0.0, HIGHEST
    if not ratio(low) < target < ratio(high):
        return float("nan")
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ratio(middle) < target else (low, middle)
    return low


def finest_error(size: float, finest: float, error: float, order: float) -> float:
    """Error of the finest result itself, Eq. (T12.3), from a coarser one's difference to it.

    Without a known order (NaN), or one below 1, the difference itself.
    """
    if not order >= 1:
        return error
    return error / float(np.expm1(order * np.log(size / finest)))  # (T12.3)


def shape_factor(counts: Sequence[int], errors: Sequence[float]) -> float | None:
    """Factor by which each further shape divides the error, where it fits better than a power, Eq. (T12.4).

    Parameters
    ----------
    counts, errors : sequences
        At least three numbers of shapes, with errors above the rounding floor.

    Returns
    -------
    float or None
        None where a power fits better, or with fewer than three.
    """
    if len(counts) < 3:
        return None
    k, y = np.asarray(counts, dtype=float), np.log(np.asarray(errors, dtype=float))
    slope, misfit = _line(k, y)
    return float(np.exp(-slope)) if slope < 0 and misfit < _line(np.log(k), y)[1] else None  # (T12.4)


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Slope and sum of squared residuals of the straight line through points."""
    x, y = x - x.mean(), y - y.mean()
    slope = float(x @ y / (x @ x))
    return slope, float(np.square(y - slope * x).sum())


#: Families: what is refined, in words, and the order that theory gives.
FAMILIES: dict[str, tuple[str, float | None]] = {
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
            [np.nan if t.failure or found is None else relative_difference(*t.common_values(found, quantity))
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
        """Factor by which each further shape divides the error; None where the fall is algebraic."""
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
        """Rate at which the error falls, as text."""
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


TYPICAL_FLOOR = 1e-9  # where it cannot be measured: Newton's residual test leaves 2e-10 to 4e-10
LEAST_FLOOR = 1e-12  # rounding of thousands of steps, where two runs happen to round alike
FLOOR_MARGIN = 3.0  # one difference of two runs is a sample of what rounding does, not its bound
_NONE = "No setting is recommended"
_FOR = _NONE + " for an accuracy of {accuracy:g}: "
_ELSE = ". Ask for less, or look at the table."
NOTES = {
    "missed": _FOR + "the checked combinations miss it" + _ELSE,
    "nothing to try": _FOR + "no combination keeps it" + _ELSE,
    "too few runs": _NONE + ": too few runs succeeded.",
    "no reference": _NONE + ": the reference failed ({failure}).",
    "coarse step": (
        "The step was halved no further than {step:~3 s}: the next run would take about {cost:.0f} s. Errors of steps "
        "are as uncertain as the finest one's own error."
    ),
    "rigid legs": "The file's legs are rigid and have no deviation: steps are studied with assumed modes.",
}
"""Words of notes by kind."""


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

    def note(self, kind: str, **numbers: object) -> None:
        """Keep a note, one of `NOTES`, with its numbers."""
        self.notes.append(fill_template(NOTES[kind], **numbers))

    def family(self, name: str) -> Family:
        """The runs of a family, coarse to fine."""
        return Family(name=name, trials=tuple(self.trials.get(name, ())), floor=self.floor)

    def set_floor(self, one: Trial, other: Trial) -> None:
        """Take the rounding floor from two runs that differ in nothing but rounding."""
        if one.failure or other.failure:
            return
        for quantity in self.quantities:
            gap = relative_difference(*other.common_values(one, quantity))
            if gap == gap:  # not NaN: the quantity is zero throughout
                self.floor[quantity] = max(FLOOR_MARGIN * gap, LEAST_FLOOR)

    def set_reference(self, trial: Trial, error: float) -> None:
        """Name the best run of all and its own relative error."""
        self.reference, self.reference_error = trial, error

    def error(self, trial: Trial, quantity: str) -> float:
        """Relative difference to the best run of all; NaN of a failed one or without reference."""
        if trial.failure or self.reference is None:
            return float("nan")
        return relative_difference(*trial.common_values(self.reference, quantity))

    def error_with_own(self, trial: Trial, quantity: str) -> float:
        """Relative difference to the best run of all plus the reference's own error."""
        return self.error(trial, quantity) + self.reference_error
