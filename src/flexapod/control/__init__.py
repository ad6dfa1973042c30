"""Linear systems with named channels, and loops around them: they take any state space, robots or not.

Public names load on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.runtime.loading import loaded

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

_HOMES = {
    "state_space": ("StateSpace",),
}
_NAMES = {name: module for module, names in _HOMES.items() for name in names}

__all__ = ["StateSpace"]


def __getattr__(name: str) -> object:
    if name not in _NAMES:
        raise AttributeError(f"module 'flexapod.control' has no attribute {name!r}")
    value = globals()[name] = getattr(loaded(f"flexapod.control.{_NAMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({name for name in globals() if name.startswith("__")} | {*_NAMES})
