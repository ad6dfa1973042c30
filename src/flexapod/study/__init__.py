"""Problem to Dataset: simulations, kinematics, modes, checks, storage."""

from flexapod.study.actuator import simulate_actuator
from flexapod.study.checks import check_path
from flexapod.study.converge import converge
from flexapod.study.kinematics import forward_kinematics, inverse_dynamics, inverse_kinematics
from flexapod.study.ladder import ladder
from flexapod.study.paper.study import PaperStudy, replicate
from flexapod.study.record import Interrupted
from flexapod.study.simulation import run, simulate
from flexapod.study.solid import simulate_solid
from flexapod.study.static import modes, stiffness
from flexapod.study.store import open_results, save
from flexapod.study.summary import summary

__all__ = [
    "Interrupted",
    "PaperStudy",
    "check_path",
    "converge",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_kinematics",
    "ladder",
    "modes",
    "open_results",
    "replicate",
    "run",
    "save",
    "simulate",
    "simulate_actuator",
    "simulate_solid",
    "stiffness",
    "summary",
]
