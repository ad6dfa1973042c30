"""Feedforward commands in place of a study's own: compensated, shaped, of least time."""

from flexapod.commissioning.feedforward.compensation import compensate
from flexapod.commissioning.feedforward.least_time import time_optimal
from flexapod.commissioning.feedforward.shaping import shape

__all__ = ["compensate", "shape", "time_optimal"]
