"""The cases, from the parts to the whole, then the independent engines and what is left out."""

from flexapod.proof.case import Case
from flexapod.proof.cases import (
    bending,
    bricard,
    calculix_beams,
    calculix_robots,
    exudyn,
    four_bar,
    frequencies,
    hexapods,
    integration,
    mechanisms,
    mujoco_forces,
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
    slider_crank, squeezer, four_bar, bricard, mujoco_forces, calculix_beams, calculix_robots, exudyn,
)  # fmt: skip

NOT_MODELLED = Case(
    name="not-modelled",
    statement="Lag of a turning beam with Coriolis forces between stretch and bending, 1.6 % less at speed 10, hub 0; "
    "its steady stretch, 5.143e-4 m in the spin-up of Simo & Vu-Quoc; impulses and insensitivity of the shapers ZV, "
    "ZVD, ZVDD and EI; damping by integral force feedback",
    source="Yoo & Shin 1998; L (tan a / a - 1) of a linear rod; Singer & Seering 1990, Singhose et al. 1994; Preumont "
    "et al. 2007",
    argument="half a unit of the printed digits",
    compute=list,
    not_run="the software has no such models: the single actuator bends and does not stretch (a robot's legs do), and "
    "there are neither shapers nor force feedback",
)

#: Of each subject in the order in which they are written.
CASES = (*(case for module in _SUBJECTS for case in vars(module).values() if isinstance(case, Case)), NOT_MODELLED)
