"""A fast answer after a change: the study at a coarser tolerance; which studies are computed without being asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod import model
from flexapod.study.words import number

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["TOLERANCE", "coarse", "is_quick", "preview_words"]

TOLERANCE = 1e-2  # of the fast answer
MOST = 60_000  # stored instants times lateral shapes that are computed in about a second at that tolerance


def coarse(study: model.Study | model.ActuatorStudy) -> model.Study | model.ActuatorStudy:
    """The study at the tolerance of the fast answer; itself where it is no finer."""
    own = study.simulation.tolerance
    return study if own is not None and own >= TOLERANCE else model.override(study, tolerance=TOLERANCE)


def is_quick(study: model.Study | model.ActuatorStudy) -> bool:
    """Whether the fast answer comes within a second or two: from what is asked for, however busy the machine is."""
    instants = study.duration / study.simulation.output_step
    return instants * max(1, study.simulation.lateral_shapes) <= MOST


def preview_words(study: model.Study | model.ActuatorStudy, data: Dataset) -> str:
    """What to say of a result at another tolerance than its study asks for; "" for one at the study's own."""
    used, own = data.attrs.get("tolerance"), study.simulation
    if used == own.tolerance:
        return ""
    asked = f"tolerance {number(own.tolerance)}" if own.tolerance is not None else f"steps of {number(own.step or 0)} s"
    return (
        f"Preview, right to about {number(100 * float(used or 0))} % (tolerance {number(float(used or 0))}; the study "
        f"asks for {asked}, press Simulate). Downloads hold the preview."
    )
