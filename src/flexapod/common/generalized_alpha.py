"""Constants of the generalized-alpha method, Eqs. (T6.1)-(T6.5), (T6.13)-(T6.14)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class GeneralizedAlpha:
    """Chung & Hulbert (1993) with the spectral radius ``rho`` at infinite frequency.

    References
    ----------
    J. Chung, G. M. Hulbert, J. Appl. Mech. 60 (1993) 371-375; M. Arnold, O. Bruls, Multibody Syst. Dyn. 18 (2007)
    185-202; M. Arnold, O. Bruls, A. Cardona, Numer. Math. 129 (2015) 149-179.
    """

    rho: float

    @property
    def alpha_m(self) -> float:
        """Weight of the old auxiliary acceleration."""
        return (2 * self.rho - 1) / (self.rho + 1)

    @property
    def alpha_f(self) -> float:
        """Weight of the old acceleration."""
        return self.rho / (self.rho + 1)

    @property
    def gamma(self) -> float:
        """Velocity weight, second order."""
        return 0.5 - self.alpha_m + self.alpha_f

    @property
    def beta(self) -> float:
        """Position weight, largest high-frequency damping."""
        return 0.25 * (1 - self.alpha_m + self.alpha_f) ** 2

    @property
    def delta(self) -> float:
        """The auxiliary acceleration belongs to the time t + delta h, Eq. (T6.13)."""
        return self.alpha_m - self.alpha_f

    @property
    def velocity_defect(self) -> float:
        """Share of h^2 v_ddot that index-3 velocities normal to the constraints keep, Eq. (T6.14)."""
        return 1 / 6 - 0.5 * self.delta - self.beta
