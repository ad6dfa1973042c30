"""Problem to Dataset: simulations, kinematics, modes, checks, storage."""

from flexapod.study.actuator import simulate_actuator
from flexapod.study.checks import check_path
from flexapod.study.record import Interrupted
from flexapod.study.simulate import run, simulate

__all__ = ["Interrupted", "check_path", "run", "simulate", "simulate_actuator"]
