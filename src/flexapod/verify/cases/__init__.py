"""The cases, from the parts to the whole, then the independent engines and what is left out."""

from collections.abc import Iterator
from types import ModuleType

from flexapod.verify.case import Case
from flexapod.verify.cases import (
    bending,
    bricard,
    calculix_beams,
    calculix_robots,
    control,
    exports,
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
    mujoco_forces, calculix_beams, calculix_robots, exudyn,
    exudyn_parts, exports,
)  # fmt: skip

NOT_MODELLED = Case(
    name="not-modelled",
    statement="Damping by integral force feedback",
    source="Preumont et al. 2007",
    argument="half a unit of the printed digits",
    compute=list,
    not_run="the software has no force feedback",
)


def _rows(module: ModuleType) -> Iterator[Case]:
    """The cases of a subject in the order in which they are written, alone or as a list."""
    for value in vars(module).values():
        yield from (case for case in (value if isinstance(value, list) else [value]) if isinstance(case, Case))


CASES = (*(case for module in _SUBJECTS for case in _rows(module)), NOT_MODELLED)
