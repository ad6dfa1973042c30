"""Commands that a study should follow instead of its own: compensated, shaped, of least time."""

from flexapod.feedforward.compensate import compensate
from flexapod.feedforward.least_time import time_optimal
from flexapod.feedforward.shaping import shape

__all__ = ["compensate", "shape", "time_optimal"]
