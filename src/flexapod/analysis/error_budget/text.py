"""Text of an error budget: the largest contributor, the terms of standards, and the scope of budget and run."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flexapod.analysis.error_budget.rules import PLACE, Budget
from flexapod.analysis.results.cause_labels import cause_label
from flexapod.common.arrays import Array
from flexapod.common.quantities import along_axes, fill_template
from flexapod.common.ranking import descending_order

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


WORDS = {
    "nothing": "Nothing that the study names moves the tool off its place {where}.",
    "largest": (
        "The largest culprit {where} is the {part}, {share} of the sizes of all errors: half of it would {brings} the "
        "worst case of the tool's place from {before:~3 m} to {after:~3 m}."
    ),
    "left": "The rows, of first order, leave {left:~3 m} of the static deviation of {whole:~3 m}: take them as a hint.",
    "accuracy": (
        "Pose accuracy (AP of ISO 9283): {raw:~3 m} uncalibrated{spread}, {calibrated:~3 m} calibrated{most}{heat}."
    ),
    "spread": " with three standard deviations of {what}",
    "most": ", the largest part of it {part}",
    "heat": " (heat alone: {drift:~3 m})",
    "repeatable": (
        "Repeatability: the study names neither play nor friction nor anything that differs from one approach to the "
        "next."
    ),
    "repeatability": (
        "Repeatability of one direction (ISO 230-2): {one}; RP of ISO 9283 at most {rp:~3 m}; of both directions: "
        "{both}."
    ),
    "reversal": "Bidirectional repeatability (ISO 230-2), all of it reversal: {both}.",
    "increment": "Smallest increment that surely shows: {both} after a reversal{alike}{last}",
    "one way": ", {one} without one",
    "no way": "; without one nothing that is named limits it",
    "no encoders": "; without what encoders resolve.",
}
"""The sentences of a summary, and what may stand in them."""


def part_words(part: str) -> str:
    """Text for the part that a row of a budget is about."""
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
    return cause_label(part)


def sentences(found: Budget, where: str) -> list[str]:
    """The answer in a few sentences: first the largest contributor, and the benefit of half its error."""
    if not found.parts:
        return [_say("nothing", where=where)]
    part = found.largest
    before, after = (_distance(x.worst) for x in (found, found.with_half(part)))
    first = _say(
        "largest",
        where=where,
        part=part_words(part),
        share=per_cent(found.shares[part]),
        brings="bring" if after < before else "raise, as it makes up for others,",
        before=before,
        after=after,
    )
    return [first, *_left(found), _accuracy(found), *_repeatability(found)]


def _left(found: Budget) -> list[str]:
    """Sentence where the residual of the rows is too large a share of the static deviation; else none."""
    left, whole = (_distance(x("systematic")) for x in (found.residual, found.total))
    return [_say("left", left=left, whole=whole)] if left > MOST_LEFT * whole else []


def _accuracy(found: Budget) -> str:
    raw, calibrated = (_distance(found.accuracy(calibrated=x)) for x in (False, True))
    drift, left = (
        _distance(found.sum_of_rows("systematic", lambda row: row.nature == "drifting")),
        found.calibrated_budget,
    )
    spread = dict.fromkeys("ripple" if row.part == "ripple" else "tolerances" for row in found.rows if row.stands)
    return _say(
        "accuracy",
        raw=raw,
        spread=_say("spread", what=" and ".join(spread)) if spread else "",
        calibrated=calibrated,
        most=_say("most", part=part_words(left.largest)) if left.parts else "",
        heat=_say("heat", drift=drift) if drift else "",
    )


def _repeatability(found: Budget) -> list[str]:
    one, both = found.unidirectional[PLACE], found.bidirectional[PLACE]
    if not both.any():
        return [_say("repeatable")]
    alike = _say("one way", one=along_axes(one)) if one.any() else _say("no way")
    last = "." if "encoder" in found.parts else _say("no encoders")
    increment = _say("increment", both=along_axes(both), alike=alike, last=last)
    if not one.any():
        return [_say("reversal", both=along_axes(both)), increment]
    said = _say("repeatability", one=along_axes(one), rp=found.repeatability, both=along_axes(both))
    return [said, increment]


def _say(kind: str, **numbers: object) -> str:
    return fill_template(WORDS[kind], **numbers)


def _distance(components: Array) -> float:
    return float(np.linalg.norm(components[PLACE]))


def per_cent(share: float) -> str:
    """A share in per cent; nothing where there is none."""
    if np.isnan(share):
        return ""
    return f"{100 * share:.0f} %" if share >= 0.005 else "< 1 %"


class Bar(NamedTuple):
    """A part in a chart: its `words`, its place `at` in the budget, None of several, sizes [m] by kind, share."""

    words: str
    at: int | None
    sizes: dict[str, float]
    share: float

    @property
    def share_words(self) -> str:
        """The share in per cent."""
        return per_cent(self.share)


def bars(data: Dataset) -> list[Bar]:
    """The parts of a budget, largest first, with the sizes of the tool's place by kind; the smallest as one.

    Systematic ones by their nature; three standard deviations of random ones.
    """
    order = descending_order(data.share.values)
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
