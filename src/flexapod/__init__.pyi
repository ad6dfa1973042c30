import flexapod.analysis
import flexapod.output.figures
from flexapod import control as control
from flexapod import kinematics as kinematics
from flexapod import model as model
from flexapod.analysis import accuracy as accuracy
from flexapod.analysis import budget as budget
from flexapod.analysis import compliance as compliance
from flexapod.analysis import forward_kinematics as forward_kinematics
from flexapod.analysis import inverse_dynamics as inverse_dynamics
from flexapod.analysis import inverse_kinematics as inverse_kinematics
from flexapod.analysis import linearize as linearize
from flexapod.analysis import mobility as mobility
from flexapod.analysis import modes as modes
from flexapod.analysis import parts as parts
from flexapod.analysis import play as play
from flexapod.analysis import run as run
from flexapod.analysis import simulate as simulate
from flexapod.analysis import simulate_actuator as simulate_actuator
from flexapod.analysis import simulate_solid as simulate_solid
from flexapod.analysis import stiffness as stiffness
from flexapod.analysis import transmissibility as transmissibility
from flexapod.analysis import verdict as verdict
from flexapod.analysis import vibration as vibration
from flexapod.commissioning.feedforward import compensate as compensate
from flexapod.commissioning.feedforward import shape as shape
from flexapod.commissioning.feedforward import time_optimal as time_optimal
from flexapod.common.citations import cite as cite
from flexapod.common.errors import ComputationError as ComputationError
from flexapod.common.errors import FlexapodError as FlexapodError
from flexapod.common.errors import InputError as InputError
from flexapod.common.tables.base import Key as Key
from flexapod.common.tables.base import Quantity as Quantity
from flexapod.common.version import __version__ as __version__
from flexapod.control.measurements import read_frf as read_frf
from flexapod.design.convergence import converge as converge
from flexapod.design.convergence.ladder import ladder as ladder
from flexapod.design.maps import workspace_map as workspace_map
from flexapod.design.optimisation.optimise import optimise as optimise
from flexapod.design.sensitivity import sensitivity as sensitivity
from flexapod.design.stored_study import load as load
from flexapod.design.sweeps import sweep as sweep
from flexapod.mechanics.elements.element import Along as Along
from flexapod.mechanics.elements.element import Contribution as Contribution
from flexapod.mechanics.elements.element import Element as Element
from flexapod.mechanics.elements.element import Output as Output
from flexapod.mechanics.elements.frames import Energies as Energies
from flexapod.mechanics.elements.frames import Frame as Frame
from flexapod.model import ActuatorStudy as ActuatorStudy
from flexapod.model import Study as Study
from flexapod.model import loads as loads
from flexapod.model import open_values as open_values
from flexapod.model import preset as preset
from flexapod.output.exchange.formats import export as export
from flexapod.verification.paper.study import replicate as replicate

plot = flexapod.output.figures
study = flexapod.analysis
