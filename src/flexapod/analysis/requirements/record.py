"""Settling in the record of a run, in place of its estimate."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.model import Study

if TYPE_CHECKING:
    from xarray import Dataset

LAST = 0.2  # part of the rest after the motion about whose middle the tool is said to vibrate
FEWEST = 20  # stored instants after the motion


def settled_after(time: Array, deviation: Array, end: float, band: float) -> float:
    """Time after the end of a motion [s] from which on a deviation (T, 3) [m] stays within a band of where it rests.

    It rests in the middle between the extremes of the last part of the record. NaN where that is too short to tell: the
    band is left in its last part, too, or there are hardly any instants.
    """
    after = np.flatnonzero(time >= end)
    if len(after) < FEWEST:
        return np.nan
    t, moved = time[after], deviation[after]
    last = t >= t[-1] - LAST * (t[-1] - t[0])
    rest = 0.5 * (moved[last].max(axis=0) + moved[last].min(axis=0))
    outside = np.linalg.norm(moved - rest, axis=1) > band
    if outside[last].any():
        return np.nan
    return float(t[np.flatnonzero(outside)[-1] + 1] - end) if outside.any() else 0.0


def with_record(found: Dataset, study: Study, data: Dataset) -> Dataset:
    """A verdict whose settling time is that in the results of a run; not judged where these end too early."""
    names = list(map(str, found.requirement.values))
    if "settling_time" not in names or study.requirement is None:
        return found
    end = study.motion.end_time - study.motion.hold
    time = settled_after(data.time.values, data.tool_deviation.values, end, study.requirement.settling_band)
    at, judged = names.index("settling_time"), bool(np.isfinite(time))
    changed = found.copy(deep=True)
    margin = float(changed.wanted[at]) - time
    for name, value in (("found", time), ("margin", margin), ("kept", judged and margin >= 0), ("judged", judged)):
        changed[name][at] = value
    words = "" if judged else "the run ends before the tool has settled: a longer motion.hold tells"
    for name, text in (("why", words), ("state", "in this run")):
        texts = list(map(str, changed[name].values))
        texts[at] = text
        changed = changed.assign_coords({name: ("requirement", np.array(texts, dtype=str))})
    return changed
