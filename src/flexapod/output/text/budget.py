"""The error budget: for `flexapod budget`, and in the report of a run at the pose of its largest deviation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.error_budget.rules import PLACE
from flexapod.analysis.error_budget.text import KIND_WORDS, part_words, per_cent
from flexapod.analysis.results.attributes import carried_study
from flexapod.common.errors import FlexapodError
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.quantities import column, zero_rounding
from flexapod.common.ranking import descending_order, first_largest
from flexapod.output.text.parts import Item, Remarks, Text, TextTable, warning_lines

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis
    from flexapod.analysis.pose_errors import home_accuracy
    from flexapod.analysis.results import cause_labels, causes
else:
    analysis = LazyModule("flexapod.analysis")
    home_accuracy = LazyModule("flexapod.analysis.pose_errors.home_accuracy")
    cause_labels = LazyModule("flexapod.analysis.results.cause_labels")
    causes = LazyModule("flexapod.analysis.results.causes")


def peak_budget(data: Dataset) -> Dataset | None:
    """Budget at the pose of a result's largest deviation of the tool; None of a robot of ideal parts.

    None also where there is none: the study cannot be read any more, the platform is fixed, drives are pure forces.
    """
    study = carried_study(data)
    if not isinstance(study, model.Study) or study.robot.platform_fixed:
        return None
    ideal = not home_accuracy.differs_from_drawing(study.robot) and len(causes.cause_names(study.robot)) == len(
        cause_labels.CAUSES
    )
    if ideal and study.disturbance is None:
        return None
    size = np.linalg.norm(data.tool_deviation.values, axis=1)
    t = data.time.values[[first_largest(size)]]
    path = kinematics.poses(study.robot, study.motion, t)
    try:
        found = analysis.budget(study, kinematics.Poses.at_rest(path.position, path.rotation))
    except FlexapodError:
        return None
    where = f"at the pose of t = {t[0]:.4g} s"
    summary = found.attrs["summary"].replace(found.attrs["where"], where, 1)
    return found.assign_attrs(pose_time=float(t[0]), where=where, summary=summary)


def budget_items(data: Dataset, also: Sequence[str | None]) -> Iterator[Item]:
    """The answer, the table, further sentences and those given as `also`, remarks."""
    first, *further = data.attrs["summary"].splitlines()
    yield first
    yield ""
    if data.sizes["part"]:
        yield TextTable(*table(data), left=(0, 1))
        yield ""
    yield from filter(None, [*further, *also])
    yield Remarks(warning_lines(data), "Warning: ")


def table(data: Dataset) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a budget's table, largest parts first; below them the whole of each kind and both totals."""
    order = descending_order(data.share.values)
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
    turned = zero_rounding(
        numbers[:, 3:].ravel(), np.abs(numbers[:, PLACE]).max()
    )  # beside what they move a metre away
    (unit, places), (angle, turns) = column(numbers[:, PLACE].ravel(), "m"), column(turned, "rad")
    head = ["part", "kind", "share", *(f"{x} [{unit}]" for x in "xyz"), *(f"r{x} [{angle}]" for x in "xyz")]
    return head, [
        [part, kind, per_cent(share), *places[at : at + 3], *turns[at : at + 3]]
        for at, (part, kind, share) in zip(range(0, 3 * len(lines), 3), lines, strict=True)
    ]


def peak_items(found: Dataset) -> Iterator[Item]:
    """Sentences and table of a budget of `peak_budget`."""
    yield from found.attrs["summary"].splitlines()
    yield TextTable(*table(found))
    yield Text(
        f"At rest, at the pose of t = {found.attrs['pose_time']:.4g} s, where the tool deviates most; world axes. "
        "The command flexapod budget FILE --motion adds what is dynamic.",
        "soft",
    )


def budget_counts(robot: model.Robot) -> str:
    """Sentence on the parts that a budget counts, and those that it leaves to a run."""
    made = "one machine" if robot.tolerances is None else "all machines made to these tolerances"
    return f"Counted: {made}, at rest; what one of them does on its way: flexapod run."


def budget_as_dict(data: Dataset, files: Sequence[Path]) -> dict[str, object]:
    """The budget as plain data."""
    kinds = list(map(str, data.kind.values))
    parts = [
        {
            "part": str(part),
            "nature": str(data.nature.values[i]),
            "share": float(data.share[i]),
            **{kind: data.budget.values[i, k].tolist() for k, kind in enumerate(kinds) if data.how.values[i, k]},
            "how": {kind: str(data.how.values[i, k]) for k, kind in enumerate(kinds) if data.how.values[i, k]},
        }
        for i, part in enumerate(data.part.values)
    ]
    whole = ("worst", "rss", "repeatability_unidirectional", "repeatability_bidirectional")
    return {
        "summary": data.attrs["summary"].splitlines(),
        "components": list(map(str, data.component.values)),
        "parts": parts,
        "total": dict(zip(kinds, data.budget_total.values.tolist(), strict=True)),
        "residual": dict(zip(kinds, data.budget_residual.values.tolist(), strict=True)),
        **{name: data[name].values.tolist() for name in whole},
        "pose_accuracy": dict(zip(map(str, data.state.values), data.pose_accuracy.values.tolist(), strict=True)),
        **({"worst_time": float(data.worst_time)} if "worst_time" in data else {}),
        "warnings": warning_lines(data),
        "files": files,
    }
