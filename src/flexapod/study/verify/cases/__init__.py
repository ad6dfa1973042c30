"""The cases, from the parts to the whole, then the independent engines and what is left out."""

from flexapod.study.verify.case import Case
from flexapod.study.verify.cases.axial_free import AXIAL_FREE
from flexapod.study.verify.cases.bar import BAR
from flexapod.study.verify.cases.beam_elements import BEAM_ELEMENTS
from flexapod.study.verify.cases.beam_fem import BEAM_FEM
from flexapod.study.verify.cases.bricard import BRICARD
from flexapod.study.verify.cases.calculix_beams import (
    CALCULIX_BEAM,
    CALCULIX_LINEAR,
    CALCULIX_PISTON,
    CALCULIX_RELEASE,
    CALCULIX_SOLID,
)
from flexapod.study.verify.cases.calculix_robot import CALCULIX_PRESTRESS, CALCULIX_ROBOT
from flexapod.study.verify.cases.cantilever import CANTILEVER
from flexapod.study.verify.cases.conservation import CONSERVATION
from flexapod.study.verify.cases.cubic_hexapod import CUBIC_HEXAPOD
from flexapod.study.verify.cases.dietmaier import DIETMAIER
from flexapod.study.verify.cases.exudyn_rigid_robot import EXUDYN_RIGID_ROBOT
from flexapod.study.verify.cases.exudyn_robot import EXUDYN_ROBOT, EXUDYN_ROBOT_PAPER
from flexapod.study.verify.cases.exudyn_sliding_beam import EXUDYN_SLIDING_BEAM, EXUDYN_SLIDING_BEAM_LONG
from flexapod.study.verify.cases.exudyn_spin_up import EXUDYN_SPIN_UP
from flexapod.study.verify.cases.four_bar import FOUR_BAR
from flexapod.study.verify.cases.generalized_alpha import GENERALIZED_ALPHA
from flexapod.study.verify.cases.integrator import ENERGY_LOSS
from flexapod.study.verify.cases.left_out import NOT_MODELLED
from flexapod.study.verify.cases.locked_robot import LOCKED_ROBOT
from flexapod.study.verify.cases.mujoco_forces import MUJOCO_FORCES
from flexapod.study.verify.cases.pinned_leg import PINNED_LEG
from flexapod.study.verify.cases.piston import PISTON
from flexapod.study.verify.cases.residual_vibration import RESIDUAL_VIBRATION
from flexapod.study.verify.cases.rotating_beam import ROTATING_BEAM
from flexapod.study.verify.cases.rotor import ROTOR
from flexapod.study.verify.cases.singularities import SINGULARITIES
from flexapod.study.verify.cases.slider_crank import SLIDER_CRANK
from flexapod.study.verify.cases.sliding_beam import SLIDING_BEAM
from flexapod.study.verify.cases.sliding_forces import SLIDING_FORCES
from flexapod.study.verify.cases.sliding_mesh import SLIDING_MESH
from flexapod.study.verify.cases.solid_beam import SOLID_BEAM, SOLID_BEAM_LONG
from flexapod.study.verify.cases.spin_up import SPIN_UP
from flexapod.study.verify.cases.squeezer import SQUEEZER
from flexapod.study.verify.cases.timoshenko import TIMOSHENKO
from flexapod.study.verify.cases.tip_body import TIP_BODY

__all__ = ["CASES"]

CASES: tuple[Case, ...] = (
    CANTILEVER,
    TIP_BODY,
    BEAM_ELEMENTS,
    PISTON,
    BAR,
    AXIAL_FREE,
    TIMOSHENKO,
    ROTATING_BEAM,
    ROTOR,
    PINNED_LEG,
    SPIN_UP,
    SLIDING_FORCES,
    SLIDING_BEAM,
    BEAM_FEM,
    SLIDING_MESH,
    SOLID_BEAM,
    SOLID_BEAM_LONG,
    ENERGY_LOSS,
    GENERALIZED_ALPHA,
    RESIDUAL_VIBRATION,
    CONSERVATION,
    CUBIC_HEXAPOD,
    DIETMAIER,
    SINGULARITIES,
    LOCKED_ROBOT,
    SLIDER_CRANK,
    SQUEEZER,
    FOUR_BAR,
    BRICARD,
    MUJOCO_FORCES,
    CALCULIX_BEAM,
    CALCULIX_PISTON,
    CALCULIX_SOLID,
    CALCULIX_LINEAR,
    CALCULIX_RELEASE,
    CALCULIX_ROBOT,
    CALCULIX_PRESTRESS,
    EXUDYN_SPIN_UP,
    EXUDYN_SLIDING_BEAM,
    EXUDYN_SLIDING_BEAM_LONG,
    EXUDYN_RIGID_ROBOT,
    EXUDYN_ROBOT,
    EXUDYN_ROBOT_PAPER,
    NOT_MODELLED,
)
