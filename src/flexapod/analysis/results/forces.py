"""How exact the forces of a run within a tolerance are: estimate over peak, Eq. (T6.34), and remarks on it."""

from __future__ import annotations

import numpy as np

from flexapod.analysis.results.bodies import flexible_axes
from flexapod.analysis.results.time_history import Record
from flexapod.model import Robot, Study
from flexapod.solve.system import System

__all__ = ["force_error", "force_warnings"]

BEYOND = 10.0  # tolerances that forces may be off by without a remark
INSTANTS = 200  # of a record that tell the peak
FINEST = 1e-8  # tolerance that is advised at most: rounding is not far


def force_error(robot: Robot, system: System, record: Record) -> float | None:
    """Estimated error of the legs' forces over their peak, as of a run within a tolerance; None where none is known."""
    if record.force_error is None or system.rows < 3:
        return None
    some = record.part(slice(None, None, max(1, len(record.time) // INSTANTS)))
    along = np.einsum("tli,tli->tl", some.lam[..., :3], flexible_axes(robot, system, some))
    peak = float(np.abs(along).max())
    return record.force_error / peak if peak > 0 else None


def force_warnings(study: Study, error: float | None) -> list[str]:
    """A remark where forces are beyond ten times the tolerance, with the one that would do.

    Errors of vibrations that steps begin to follow fall with the root of the tolerance, later with the tolerance.
    """
    tolerance = study.simulation.tolerance
    if error is None or tolerance is None or error <= BEYOND * tolerance:
        return []
    finer = tolerance * (BEYOND * tolerance / error) ** 2
    digit = 10.0 ** np.floor(np.log10(max(finer, FINEST)))
    advised = np.floor(max(finer, FINEST) / digit * (1 + 1e-9)) * digit
    number = f"{advised:.0e}".replace("e-0", "e-")
    return [
        f"forces of the legs may be off by {100 * error:.2g} % of their peak, {error / tolerance:.0f} times the "
        "tolerance: steps pass over vibrations that hardly move the payload. Where forces matter set "
        f"simulation.tolerance = {number}"
    ]
