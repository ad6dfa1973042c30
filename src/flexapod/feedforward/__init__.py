"""Commands that a study should follow instead of its own: compensated, shaped, of least time."""

from flexapod.feedforward.compensation import compensate
from flexapod.feedforward.shaping import shape

__all__ = ["compensate", "shape"]
