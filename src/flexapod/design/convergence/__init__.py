"""Convergence of results with step, shapes and elements, and the cheapest setting that keeps an accuracy."""

from flexapod.design.convergence.plan import estimate
from flexapod.design.convergence.search import ConvergenceStopped, converge
from flexapod.design.convergence.trials import Trials

__all__ = ["ConvergenceStopped", "Trials", "converge", "estimate"]
