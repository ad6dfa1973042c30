"""Settings of Exudyn's integration that its models share, without importing it."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Integration:
    """Generalized-alpha with fixed steps.

    Attributes
    ----------
    duration, step : float
        [s]; the step is shortened so that a whole number of steps makes the duration.
    rho_inf : float
        Spectral radius at infinite frequency, below 1: constraints are solved for positions.
    tolerance : float
        Of Newton's method: residual [N], absolute, and relative to that at the start of a step. Too loose a one puts
        noise into the forces; rounding of element forces, EA over element length times the last place of a coordinate,
        puts an end to it between 1e-8 and, on very fine meshes, 1e-6.
    """

    duration: float
    step: float = 2.5e-4
    rho_inf: float = 0.9
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        for key in ("duration", "step", "tolerance"):
            value = getattr(self, key)
            if not (isfinite(value) and value > 0):
                raise InputError("is not positive", key=key, value=value, allowed="above 0")
        if not 0 <= self.rho_inf < 1:
            raise InputError(
                "cannot be used with constraints", key="rho_inf", value=self.rho_inf, allowed="0 up to below 1"
            )

    @property
    def steps(self) -> int:
        """Number of steps."""
        return max(1, round(self.duration / self.step))

    @property
    def time(self) -> Array:
        """Instants (T,) [s], both ends included."""
        return np.linspace(0.0, self.duration, self.steps + 1)


def extrapolate_first_order(coarse: Array, fine: Array) -> Array:
    """Limit of a result whose error is of first order, from a mesh and one twice as fine (Richardson)."""
    return 2 * fine - coarse
