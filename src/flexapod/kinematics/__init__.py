"""Closed-form mathematics of the rigid robot: NumPy, vectorised over time."""

from flexapod.common.lazy_imports import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__)
