"""The cases, from the parts to the whole."""

from flexapod.study.verify.case import Case
from flexapod.study.verify.cases.bar import BAR
from flexapod.study.verify.cases.cantilever import CANTILEVER
from flexapod.study.verify.cases.cubic_hexapod import CUBIC_HEXAPOD
from flexapod.study.verify.cases.dietmaier import DIETMAIER
from flexapod.study.verify.cases.integrator import ENERGY_LOSS
from flexapod.study.verify.cases.pinned_leg import PINNED_LEG
from flexapod.study.verify.cases.rotating_beam import ROTATING_BEAM
from flexapod.study.verify.cases.singularities import SINGULARITIES
from flexapod.study.verify.cases.sliding_beam import SLIDING_BEAM
from flexapod.study.verify.cases.spin_up import SPIN_UP
from flexapod.study.verify.cases.tip_body import TIP_BODY

__all__ = ["CASES"]

CASES: tuple[Case, ...] = (
    CANTILEVER,
    TIP_BODY,
    BAR,
    ROTATING_BEAM,
    PINNED_LEG,
    SPIN_UP,
    SLIDING_BEAM,
    ENERGY_LOSS,
    CUBIC_HEXAPOD,
    DIETMAIER,
    SINGULARITIES,
)
