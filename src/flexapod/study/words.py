"""Quantities in words, as in `flexapod.words`, and what a robot holds still."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod.typing import Array
from flexapod.words import Scale, along_axes, column, columns, number, scale, sentence, text

if TYPE_CHECKING:
    from flexapod.model import Robot

__all__ = [
    "Scale", "along_axes", "brief", "cleared", "cleared_lines", "column", "columns", "held", "length", "number",
    "scale", "sentence", "signed", "text",
]  # fmt: skip

_SENTENCE = re.compile(r"\. (?=[A-Z])")
NOTHING = 1e-12  # length that is rounding [m]
ROUNDING = 1e-6  # of the largest axis: what is smaller is shown as 0
UNSAID = 1e-4  # of a displacement: components below it go unsaid


def cleared(values: ArrayLike, largest: float) -> Array:
    """Values of one axis to show beside the others: 0 throughout where all are rounding beside the largest axis."""
    given = np.asarray(values, dtype=float)
    return given * (np.abs(given).max(initial=0.0) > ROUNDING * abs(largest))


def cleared_lines(lines: Array) -> Array:
    """Lines (lines, T) to show together: each that is rounding beside the largest of all is 0 throughout."""
    largest = float(np.abs(lines).max(initial=0.0))
    return np.stack([cleared(line, largest) for line in lines])


def brief(remark: str) -> tuple[str, str]:
    """The first sentence of a remark, which says it, and the others, which explain it."""
    first, _, rest = _SENTENCE.sub("\n", remark, count=1).partition("\n")
    return first, rest


def length(value: float) -> str:
    """A computed length of which what is below a picometre is rounding, in words."""
    return text(value if abs(value) >= NOTHING else 0.0, "m")


def signed(moved: Array, beside: Array | None = None) -> str:
    """Components (3,) [m] with signs: "x -1.2 µm, z +18.5 µm"; without those that are nothing beside a displacement."""
    size = float(np.linalg.norm(moved if beside is None else beside))
    return along_axes(np.where(np.abs(moved) > max(UNSAID * size, NOTHING), moved, 0.0), signed=True)


def held(robot: Robot) -> str:
    """What modes and stiffness hold still: the drives, or their commands where drives give way."""
    soft = {leg.drive.type for leg in robot.legs if not leg.drive.holds and getattr(leg.drive, "feedback", True)}
    if not soft:
        return "Drives locked"
    parts = {
        "servo": "springs and dampers of the servo drives",
        "force": "feedback of the force drives",
        "screw": "loops of the screw drives",
    }
    return f"Commands of the drives held, with the {' and the '.join(parts[kind] for kind in sorted(soft))}"
