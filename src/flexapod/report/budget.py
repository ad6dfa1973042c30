"""The error budget in the report of a run: at rest, at the pose of the largest deviation."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod import model, rigid
from flexapod.errors import FlexapodError
from flexapod.report import html
from flexapod.scene.robot import carried_study
from flexapod.ties import first_largest

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["budget_section", "peak_budget"]


def peak_budget(data: Dataset) -> Dataset | None:
    """Budget at the pose of a result's largest deviation of the tool; None of a robot of ideal parts.

    None also where there is none: the study cannot be read any more, the platform is fixed, drives are pure forces.
    """
    from flexapod.study import budget
    from flexapod.study.accuracy.words import is_real
    from flexapod.study.after.causes import cause_names
    from flexapod.study.cause_words import CAUSES

    study = carried_study(data)
    if not isinstance(study, model.Study) or study.robot.platform_fixed:
        return None
    ideal = not is_real(study.robot) and len(cause_names(study.robot)) == len(CAUSES)
    if ideal and study.disturbance is None:
        return None
    size = np.linalg.norm(data.tool_deviation.values, axis=1)
    t = data.time.values[[first_largest(size)]]
    path = rigid.poses(study.robot, study.motion, t)
    try:
        found = budget(study, rigid.Poses.at_rest(path.position, path.rotation))
    except FlexapodError:
        return None
    where = f"at the pose of t = {t[0]:.4g} s"
    summary = found.attrs["summary"].replace(found.attrs["where"], where, 1)
    return found.assign_attrs(pose_time=float(t[0]), where=where, summary=summary)


def budget_section(found: Dataset) -> str:
    """The budget in sentences and as a table."""
    from flexapod.study.budgets.words import table

    note = (
        f"At rest, at the pose of t = {found.attrs['pose_time']:.4g} s, where the tool deviates most; world axes. "
        "The command flexapod budget FILE --motion adds what is dynamic."
    )
    sentences = [html.paragraph(line) for line in found.attrs["summary"].splitlines()]
    return html.section("budget", "Error budget", *sentences, html.table(*table(found)), html.paragraph(note, "soft"))
