"""Fast answers after a change: what the rigid robot says at once, and the study at a coarser tolerance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.checks import check_actuator_path, check_path
from flexapod.app.browser import markup
from flexapod.common.errors import InputError
from flexapod.common.quantities import number

if TYPE_CHECKING:
    from xarray import Dataset

TOLERANCE = 1e-2  # of the fast answer
MOST = 60_000  # stored instants times lateral shapes that are computed in about a second at that tolerance


def coarse(study: model.Study | model.ActuatorStudy) -> model.Study | model.ActuatorStudy:
    """The study at the tolerance of the fast answer; itself where it is no finer."""
    own = study.simulation.tolerance
    return study if own is not None and own >= TOLERANCE else model.override(study, tolerance=TOLERANCE)


def is_preview_fast(study: model.Study | model.ActuatorStudy) -> bool:
    """Test whether the fast answer takes a second or two, from the size of the study, not the load of the machine."""
    instants = study.duration / study.simulation.output_step
    return instants * max(1, study.simulation.lateral_shapes) <= MOST


def preview_words(study: model.Study | model.ActuatorStudy, data: Dataset) -> str:
    """Text on a result at another tolerance than its study asks for; "" for one at the study's own."""
    used, own = data.attrs.get("tolerance"), study.simulation
    if used == own.tolerance:
        return ""
    asked = f"tolerance {number(own.tolerance)}" if own.tolerance is not None else f"steps of {number(own.step or 0)} s"
    return (
        f"Preview, right to about {number(100 * float(used or 0))} % (tolerance {number(float(used or 0))}; the study "
        f"asks for {asked}, press Simulate). Downloads hold the preview."
    )


INSTANTS = 201


def preview_html(study: model.Study | model.ActuatorStudy) -> str:
    """Leg lengths, stroke margins and singularity on the path, as HTML; and why the path is refused, if it is."""
    try:
        remarks = check_path(study) if isinstance(study, model.Study) else check_actuator_path(study)
        refusal = ""
    except InputError as error:
        remarks, refusal = [], markup.error_html(error)
    body = _robot(study) if isinstance(study, model.Study) else _actuator(study)
    return refusal + body + "".join(markup.block(remark, "warning") for remark in remarks)


def _robot(study: model.Study) -> str:
    t = np.linspace(0.0, study.duration, INSTANTS)
    path = kinematics.poses(study.robot, study.motion, t)
    length = kinematics.reach(study.robot, path).length
    rows, bad = [], []
    for i, leg in enumerate(study.robot.legs):
        low, high = float(length[:, i].min()), float(length[:, i].max())
        margin = None if leg.stroke is None else min(low - leg.stroke.min, leg.stroke.max - high)
        left = "no limits" if margin is None else f"{1e3 * margin:.1f}"
        rows.append([str(i + 1), f"{1e3 * low:.1f}", f"{1e3 * high:.1f}", left])
        bad.append(margin is not None and margin < 0)
    header = ["Leg", "shortest [mm]", "longest [mm]", "stroke left [mm]"]
    found = kinematics.singularity(study.robot, path)
    worst = float(found.smallest_singular_value[found.worst])
    singular = f"Smallest singular value {worst:.3g} at t = {t[found.worst]:.3g} s (0 is singular; scaled Jacobian)."
    return markup.table_html(header, rows, bad) + markup.block(singular)


def _actuator(study: model.ActuatorStudy) -> str:
    actuator, law = study.actuator, study.motion.extension
    if law is None:
        return markup.block("The extension is driven by a force: the free length is a result.")
    t = np.linspace(0.0, study.duration, INSTANTS)
    free = actuator.free_length + kinematics.motion_law(law, t).position
    return markup.block(
        f"Free length {free.min():.4g} to {free.max():.4g} m of {actuator.length:.4g} m; "
        f"{study.simulation.lateral_shapes} shapes."
    )
