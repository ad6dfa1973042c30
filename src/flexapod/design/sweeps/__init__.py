"""Many variants of a study, computed by many workers, into one store that survives being killed."""

from flexapod.common.lazy_imports import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__)
