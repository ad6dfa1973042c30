"""Linear systems with named channels, and loops around them: they take any state space, robots or not.

Public names load on first use.
"""

from flexapod.common.lazy_imports import lazy_names

#: Names of the release before.
_FORMER = {"Function": "FunctionController", "Fused": "SensorFusion", "Together": "Parallel"}

__getattr__, __dir__, __all__ = lazy_names(__name__, former=_FORMER)
