"""The error budget: for `flexapod budget`, and in the report of a run at the pose of its largest deviation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.error_budget.text import table
from flexapod.analysis.results.attributes import carried_study
from flexapod.common.errors import FlexapodError
from flexapod.common.ranking import first_largest
from flexapod.output.text.parts import Item, Remarks, Text, TextTable, warnings_of

if TYPE_CHECKING:
    from xarray import Dataset


def peak_budget(data: Dataset) -> Dataset | None:
    """Budget at the pose of a result's largest deviation of the tool; None of a robot of ideal parts.

    None also where there is none: the study cannot be read any more, the platform is fixed, drives are pure forces.
    """
    from flexapod.analysis import budget
    from flexapod.analysis.pose_errors.accuracy_text import is_real
    from flexapod.analysis.results.cause_labels import CAUSES
    from flexapod.analysis.results.causes import cause_names

    study = carried_study(data)
    if not isinstance(study, model.Study) or study.robot.platform_fixed:
        return None
    ideal = not is_real(study.robot) and len(cause_names(study.robot)) == len(CAUSES)
    if ideal and study.disturbance is None:
        return None
    size = np.linalg.norm(data.tool_deviation.values, axis=1)
    t = data.time.values[[first_largest(size)]]
    path = kinematics.poses(study.robot, study.motion, t)
    try:
        found = budget(study, kinematics.Poses.at_rest(path.position, path.rotation))
    except FlexapodError:
        return None
    where = f"at the pose of t = {t[0]:.4g} s"
    summary = found.attrs["summary"].replace(found.attrs["where"], where, 1)
    return found.assign_attrs(pose_time=float(t[0]), where=where, summary=summary)


def budget_items(data: Dataset, also: Sequence[str | None]) -> Iterator[Item]:
    """The answer, the table, further sentences and those that are told `also`, remarks."""
    first, *further = data.attrs["summary"].splitlines()
    yield first
    yield ""
    if data.sizes["part"]:
        yield TextTable(*table(data), left=(0, 1))
        yield ""
    yield from filter(None, [*further, *also])
    yield Remarks(warnings_of(data), "Warning: ")


def peak_items(found: Dataset) -> Iterator[Item]:
    """What `peak_budget` found."""
    yield from found.attrs["summary"].splitlines()
    yield TextTable(*table(found))
    yield Text(
        f"At rest, at the pose of t = {found.attrs['pose_time']:.4g} s, where the tool deviates most; world axes. "
        "The command flexapod budget FILE --motion adds what is dynamic.",
        "soft",
    )


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
        "warnings": warnings_of(data),
        "files": files,
    }
