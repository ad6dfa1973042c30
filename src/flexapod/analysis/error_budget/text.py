"""An error budget in sentences: the largest culprit first, then the words of the standards.

What a run counts and a budget does not, and the other way round, a sentence each.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flexapod.analysis.error_budget.rules import PLACE, Budget
from flexapod.analysis.pose_errors.backlash import half_play
from flexapod.analysis.results.cause_labels import cause_in_words
from flexapod.common.arrays import Array
from flexapod.common.quantities import along_axes, cleared, column, text
from flexapod.common.ranking import ranked
from flexapod.model import Robot

if TYPE_CHECKING:
    from xarray import Dataset

SMALLEST = 0.005  # share below which parts go into one bar
MOST_LEFT = 0.05  # of the static deviation, beyond which rows of first order are a hint
KIND_WORDS = {
    "systematic": "systematic",
    "hysteretic": "play and friction, bound",
    "random": "random, 1 sigma",
    "dynamic_peak": "dynamic, at the peak",
    "dynamic_rms": "dynamic, share of rms",
}
_PARTS = {
    "base_joints": "base joints",
    "platform_joints": "platform joints",
    "leg_offset": "leg offsets",
    "lead": "leads",
    "EA": "the stiffness of the pistons",
    "EI": "the bending stiffness of the pistons",
    "density": "the density of the pistons",
    "bow": "the bow of the pistons",
}


def part_words(part: str) -> str:
    """What a row of a budget is about."""
    name, _, kind = part.rpartition(" ")
    if kind == "tolerance":
        return f"tolerance of {_PARTS.get(name, name)}"
    if kind in ("vibration", "noise"):
        return part
    if kind in ("play", "friction"):
        places = {"drive": "drives", "guide": "guides"}
        return f"{kind} of the {places.get(name) or 'joints at the ' + name.removesuffix('_joint')}"
    if part == "encoder":
        return "resolution of the encoders"
    if part == "ripple":
        return "ripple of the motors"
    if part == "bent_legs":
        return "bow of the legs"
    if part in _PARTS:
        return f"error of {_PARTS[part]}"
    return cause_in_words(part)


def sentences(found: Budget, where: str) -> list[str]:
    """The answer in a few sentences; the first one names the largest culprit, and what half its error would bring."""
    if not found.parts:
        return [f"Nothing that the study names moves the tool off its place {where}."]
    part = found.largest
    before, after = (_distance(x.worst) for x in (found, found.with_half(part)))
    brings = "bring" if after < before else "raise, as it makes up for others,"
    share = _per_cent(found.shares[part])
    first = (
        f"The largest culprit {where} is the {part_words(part)}, {share} of the sizes of all errors: "
        f"half of it would {brings} the worst case of the tool's place from {_m(before)} to {_m(after)}."
    )
    return [first, *_left(found), *_accuracy(found), *_repeatability(found)]


def _left(found: Budget) -> list[str]:
    """That rows leave more of the static deviation than they should."""
    left, whole = (_distance(x("systematic")) for x in (found.residual, found.total))
    if left <= MOST_LEFT * whole:
        return []
    return [f"The rows, of first order, leave {_m(left)} of the static deviation of {_m(whole)}: take them as a hint."]


def _accuracy(found: Budget) -> list[str]:
    raw, calibrated = (_distance(found.accuracy(calibrated=x)) for x in (False, True))
    drift = _distance(found.rule("systematic", lambda row: row.nature == "drifting"))
    spread = dict.fromkeys("ripple" if row.part == "ripple" else "tolerances" for row in found.rows if row.stands)
    warm = f" (heat alone: {_m(drift)})" if drift else ""
    left = found.calibrated
    most = f", the largest part of it {part_words(left.largest)}" if left.parts else ""
    more = f" with three standard deviations of {' and '.join(spread)}" if spread else ""
    return [f"Pose accuracy (AP of ISO 9283): {_m(raw)} uncalibrated{more}, {_m(calibrated)} calibrated{most}{warm}."]


def _repeatability(found: Budget) -> list[str]:
    one, both = found.unidirectional, found.bidirectional
    if not both[PLACE].any():
        nothing = "neither play nor friction nor anything that differs from one approach to the next"
        return [f"Repeatability: the study names {nothing}."]
    increment = (
        f"Smallest increment that surely shows: {_axes(both)} after a reversal"
        + (f", {_axes(one)} without one" if one[PLACE].any() else "; without one nothing that is named limits it")
        + ("." if "encoder" in found.parts else "; without what encoders resolve.")
    )
    if not one[PLACE].any():
        return [f"Bidirectional repeatability (ISO 230-2), all of it reversal: {_axes(both)}.", increment]
    return [
        f"Repeatability of one direction (ISO 230-2): {_axes(one)}; RP of ISO 9283 at most {_m(found.repeatability)}; "
        f"of both directions: {_axes(both)}.",
        increment,
    ]


def _distance(components: Array) -> float:
    return float(np.linalg.norm(components[PLACE]))


def _per_cent(share: float) -> str:
    if np.isnan(share):
        return ""
    return f"{100 * share:.0f} %" if share >= 0.005 else "< 1 %"


def _m(size: float) -> str:
    return text(size, "m")


def _axes(sizes: Array) -> str:
    return along_axes(sizes[PLACE])


def table(data: Dataset) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a budget's table, largest parts first; below them the whole of each kind and both totals."""
    order = ranked(data.share.values)
    lines, values = [], []
    for k, kind in enumerate(map(str, data.kind.values)):
        there = [i for i in order if data.how.values[i, k]]
        lines += [(part_words(str(data.part.values[i])), KIND_WORDS[kind], data.share.values[i]) for i in there]
        values += [data.budget.values[i, k] for i in there]
        if there:
            left = kind not in ("hysteretic", "random")
            lines += [(name, KIND_WORDS[kind], np.nan) for name in ("left, of second order",) * left + ("together",)]
            values += [data.budget_residual.values[k]] * left + [data.budget_total.values[k]]
    lines += [("worst case of all kinds", "", np.nan), ("root of the sum of squares", "", np.nan)]
    numbers = np.array([*values, data.worst.values, data.rss.values])
    turned = cleared(numbers[:, 3:].ravel(), np.abs(numbers[:, PLACE]).max())  # beside what they move a metre away
    (unit, places), (angle, turns) = column(numbers[:, PLACE].ravel(), "m"), column(turned, "rad")
    head = ["part", "kind", "share", *(f"{x} [{unit}]" for x in "xyz"), *(f"r{x} [{angle}]" for x in "xyz")]
    return head, [
        [part, kind, _per_cent(share), *places[at : at + 3], *turns[at : at + 3]]
        for at, (part, kind, share) in zip(range(0, 3 * len(lines), 3), lines, strict=True)
    ]


class Bar(NamedTuple):
    """A part in a chart: its `words`, its place `at` in the budget, None of several, sizes [m] by kind, share."""

    words: str
    at: int | None
    sizes: dict[str, float]
    share: float

    @property
    def share_words(self) -> str:
        """The share in per cent."""
        return _per_cent(self.share)


def bars(data: Dataset) -> list[Bar]:
    """The parts of a budget, largest first, with the sizes of the tool's place by kind; the smallest as one.

    Systematic ones by their nature; three standard deviations of random ones.
    """
    order = ranked(data.share.values)
    few = int((data.share.values >= SMALLEST).sum())
    few += few == len(order) - 1  # a single smaller part has its name
    found = [
        Bar(part_words(str(data.part.values[i])), int(i), _sizes(data, [i]), float(data.share[i])) for i in order[:few]
    ]
    if rest := [int(i) for i in order[few:]]:
        found.append(Bar(f"{len(rest)} smaller parts", None, _sizes(data, rest), float(data.share[rest].sum())))
    return found


def _sizes(data: Dataset, chosen: list[int]) -> dict[str, float]:
    """Sizes [m] of the error of the tool's place by kind, of systematic ones by nature."""
    found: dict[str, float] = {}
    for i in chosen:
        for k, kind in enumerate(map(str, data.kind.values)):
            if kind == "dynamic_rms":
                continue
            size = float(np.linalg.norm(data.budget.values[i, k, PLACE]))
            name = str(data.nature.values[i]) or "repeatable" if kind == "systematic" else kind.removesuffix("_peak")
            found[name] = found.get(name, 0.0) + (3 if kind == "random" else 1) * size
    return {name: size for name, size in found.items() if size > 0}


def run_counts(robot: Robot) -> str | None:
    """What a run counts, and what it leaves to the budget; None where it leaves nothing."""
    rubs = any(x.friction for leg in robot.legs for x in (leg.base_joint, leg.platform_joint, leg.drive))
    others = {
        "tolerances": robot.tolerances is not None,
        "play": bool(half_play(robot).any()),
        "what friction leaves behind": rubs,
    }
    named = [name for name, there in others.items() if there]
    if not named or robot.platform_fixed:
        return None
    listed = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
    warm = "" if robot.heat is None else "warm, "
    return f"Counted: one machine as drawn, {warm}under load and in motion; {listed}: flexapod budget."


def budget_counts(robot: Robot) -> str:
    """What a budget counts, and what it leaves to a run."""
    made = "one machine" if robot.tolerances is None else "all machines made to these tolerances"
    return f"Counted: {made}, at rest; what one of them does on its way: flexapod run."
