"""How results converge with step, shapes and elements, and the cheapest setting that keeps an accuracy."""

from flexapod.surveys.convergence.plan import estimate
from flexapod.surveys.convergence.search import ConvergenceStopped, converge
from flexapod.surveys.convergence.trials import Trials

__all__ = ["ConvergenceStopped", "Trials", "converge", "estimate"]
