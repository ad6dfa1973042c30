"""flexapod: how far a payload misses its path because the legs bend, stretch and vibrate, and why.

Public names load on first use, so that ``import flexapod`` stays fast.
"""

from flexapod.common.lazy_imports import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, former={"rigid": "kinematics"})
