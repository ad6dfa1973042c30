"""How results converge with step, shapes and elements, and the cheapest setting that keeps an accuracy."""

from flexapod.study.converge.plan import estimate
from flexapod.study.converge.search import ConvergenceStopped, converge
from flexapod.study.converge.trials import Trials

__all__ = ["ConvergenceStopped", "Trials", "converge", "estimate"]
