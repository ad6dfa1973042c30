"""The cases, from the parts to the whole, then the independent engines and what is left out."""

from flexapod.proof.case import Case
from flexapod.proof.cases.axial_free import AXIAL_FREE
from flexapod.proof.cases.bar import BAR
from flexapod.proof.cases.beam_elements import BEAM_ELEMENTS
from flexapod.proof.cases.beam_fem import BEAM_FEM
from flexapod.proof.cases.bricard import BRICARD
from flexapod.proof.cases.calculix_beams import (
    CALCULIX_BEAM,
    CALCULIX_LINEAR,
    CALCULIX_PISTON,
    CALCULIX_RELEASE,
    CALCULIX_SOLID,
)
from flexapod.proof.cases.calculix_robot import CALCULIX_PRESTRESS, CALCULIX_ROBOT
from flexapod.proof.cases.cantilever import CANTILEVER
from flexapod.proof.cases.carriages import ACCELERATED_CARRIAGES, CARRIAGE_PLACES, LONG_CRANKS
from flexapod.proof.cases.conservation import CONSERVATION
from flexapod.proof.cases.cubic_hexapod import CUBIC_HEXAPOD
from flexapod.proof.cases.dietmaier import DIETMAIER
from flexapod.proof.cases.eight_legs_misfit import EIGHT_LEGS_MISFIT
from flexapod.proof.cases.exudyn_rigid_robot import EXUDYN_RIGID_ROBOT
from flexapod.proof.cases.exudyn_robot import EXUDYN_ROBOT, EXUDYN_ROBOT_PAPER, EXUDYN_TRIPOD
from flexapod.proof.cases.exudyn_sliding_beam import EXUDYN_SLIDING_BEAM, EXUDYN_SLIDING_BEAM_LONG
from flexapod.proof.cases.exudyn_spin_up import EXUDYN_SPIN_UP
from flexapod.proof.cases.four_bar import FOUR_BAR
from flexapod.proof.cases.generalized_alpha import GENERALIZED_ALPHA
from flexapod.proof.cases.integrator import ENERGY_LOSS
from flexapod.proof.cases.left_out import NOT_MODELLED
from flexapod.proof.cases.loaded_legs import TABLE_SWAY, THRUST_ON_LEGS
from flexapod.proof.cases.locked_robot import LOCKED_ROBOT
from flexapod.proof.cases.mechanism_engines import CALCULIX_MECHANISMS, MUJOCO_MECHANISMS
from flexapod.proof.cases.mechanism_frequencies import FREQUENCIES
from flexapod.proof.cases.mobility_table import MOBILITY_TABLE
from flexapod.proof.cases.mujoco_forces import MUJOCO_FORCES
from flexapod.proof.cases.orsino import ORSINO
from flexapod.proof.cases.pinned_leg import PINNED_LEG
from flexapod.proof.cases.piston import PISTON
from flexapod.proof.cases.residual_vibration import RESIDUAL_VIBRATION
from flexapod.proof.cases.rotating_beam import ROTATING_BEAM
from flexapod.proof.cases.rotor import ROTOR
from flexapod.proof.cases.singularities import SINGULARITIES
from flexapod.proof.cases.slider_crank import SLIDER_CRANK
from flexapod.proof.cases.sliding_beam import SLIDING_BEAM
from flexapod.proof.cases.sliding_forces import SLIDING_FORCES
from flexapod.proof.cases.sliding_mesh import SLIDING_MESH
from flexapod.proof.cases.solid_beam import SOLID_BEAM, SOLID_BEAM_LONG
from flexapod.proof.cases.spin_up import SPIN_UP
from flexapod.proof.cases.squeezer import SQUEEZER
from flexapod.proof.cases.timoshenko import TIMOSHENKO
from flexapod.proof.cases.tip_body import TIP_BODY
from flexapod.proof.cases.tricept import TRICEPT_ENERGY, TRICEPT_GUIDE
from flexapod.proof.cases.tripod_stiffness import TRIPOD_PARASITIC, TRIPOD_STIFFNESS
from flexapod.proof.cases.welded_hexapod import FLEXURE_HEXAPOD, WELDED_HEXAPOD

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
    *FREQUENCIES,
    TRIPOD_STIFFNESS,
    TRIPOD_PARASITIC,
    TABLE_SWAY,
    THRUST_ON_LEGS,
    WELDED_HEXAPOD,
    FLEXURE_HEXAPOD,
    EIGHT_LEGS_MISFIT,
    MOBILITY_TABLE,
    ORSINO,
    CARRIAGE_PLACES,
    ACCELERATED_CARRIAGES,
    LONG_CRANKS,
    TRICEPT_GUIDE,
    TRICEPT_ENERGY,
    SLIDER_CRANK,
    SQUEEZER,
    FOUR_BAR,
    BRICARD,
    MUJOCO_FORCES,
    MUJOCO_MECHANISMS,
    CALCULIX_BEAM,
    CALCULIX_PISTON,
    CALCULIX_SOLID,
    CALCULIX_LINEAR,
    CALCULIX_RELEASE,
    CALCULIX_ROBOT,
    CALCULIX_PRESTRESS,
    CALCULIX_MECHANISMS,
    EXUDYN_SPIN_UP,
    EXUDYN_SLIDING_BEAM,
    EXUDYN_SLIDING_BEAM_LONG,
    EXUDYN_RIGID_ROBOT,
    EXUDYN_ROBOT,
    EXUDYN_ROBOT_PAPER,
    EXUDYN_TRIPOD,
    NOT_MODELLED,
)
