"""A function of Python in place of a linear law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from flexapod.arrays import Array

__all__ = ["Function"]


@dataclass(frozen=True, kw_only=True)
class Function:
    """A controller that is called at each sample of `flexapod.simulate`.

    Parameters
    ----------
    function : callable
        Of the instant [s] and the readings (p,): the outputs (m,). Samples come in their order; after a step of the
        time integration that fails some come again.
    inputs, outputs : tuples of str
        Channels that it reads (``stroke:1``, ``tool:z``) and that it moves (``drive:3``).
    """

    function: Callable[[float, Array], object]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
