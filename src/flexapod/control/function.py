"""A controller that is a function of an instant and readings, in place of a linear law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, names_of

__all__ = ["Function"]


@dataclass(frozen=True, kw_only=True)
class Function:
    """What a simulation asks once a sample: ``function(t, readings) -> values``, t [s].

    Parameters
    ----------
    function : callable
        Of an instant and the readings (p,), in the order of `inputs`; returns the values (m,) of `outputs`. Called in
        the order of samples; after a step that fails some come again with the same instants.
    inputs, outputs : tuples of str
        Single channels that it reads, as ``stroke:1``, and that it moves, as ``drive:1``.
    """

    function: Callable[[float, Array], object]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def __post_init__(self) -> None:
        """A function, and names of channels."""
        if not callable(self.function):
            raise InputError("is no function", key="function", value=self.function, allowed="function(t, readings)")
        for key in ("inputs", "outputs"):
            object.__setattr__(self, key, tuple(names_of(getattr(self, key), key)))
