"""The cases, from the parts to the whole, then the independent engines."""

from collections.abc import Iterator
from types import ModuleType

from flexapod.verification.case import Case
from flexapod.verification.cases import (
    bending,
    bricard,
    calculix_beams,
    control,
    exudyn,
    exudyn_parts,
    feed_forward,
    four_bar,
    frequencies,
    hexapods,
    integration,
    linear,
    machines,
    mechanisms,
    mujoco_forces,
    real_parts,
    slider_crank,
    sliding,
    solids,
    squeezer,
    stiffness,
    turning,
)

__all__ = ["CASES"]

_SUBJECTS = (
    bending, solids, turning, sliding, integration, hexapods, frequencies, stiffness, mechanisms,
    slider_crank, squeezer, four_bar, bricard, real_parts, machines, linear, control, feed_forward,
    mujoco_forces, calculix_beams, exudyn, exudyn_parts,
)  # fmt: skip


def _rows(module: ModuleType) -> Iterator[Case]:
    """The cases of a subject in the order in which they are written, alone or as a list."""
    for value in vars(module).values():
        yield from (case for case in (value if isinstance(value, list) else [value]) if isinstance(case, Case))


CASES = tuple(case for module in _SUBJECTS for case in _rows(module))
