"""Commands that a study should follow instead of its own: compensated, shaped, of least time."""

from flexapod.feedforward.compensation import compensate

__all__ = ["compensate"]
