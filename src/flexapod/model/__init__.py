"""WHAT is analysed: frozen descriptions in SI units, read from text files with units."""

from flexapod.common.lazy_imports import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__)
