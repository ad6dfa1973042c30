"""One study in, one Dataset out: simulations, kinematics, modes, checks, storage."""

from flexapod.common.lazy_imports import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__)
