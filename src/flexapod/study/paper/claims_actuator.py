"""Claims of the paper's section 2, the single actuator."""

from __future__ import annotations

import numpy as np

from flexapod.bases.beam_functions import clamped_free
from flexapod.study.paper.claim import HOLDS, MISPRINT, OPEN, Claim
from flexapod.study.paper.study import ACTUATOR_MODES, PaperStudy
from flexapod.study.words import text

__all__ = ["actuator_claims"]


def actuator_claims(result: PaperStudy) -> tuple[Claim, ...]:
    """Equations 2 to 10, Table 2, Figs. 3 and 4."""
    return (_shapes(), _equations(), _table2(), _figure4(result))


def _shapes() -> Claim:
    eps = np.array([shape.eps for shape in clamped_free(3)])
    alpha = (np.sin(eps) + np.sinh(eps)) / (np.cos(eps) + np.cosh(eps))
    norms = ", ".join(f"{norm:.4f}" for norm in alpha**2)
    return Claim(
        where="Eq. 2",
        says="Shapes normalised by the mass per length; beta^4 = omega^4 rho / EI",
        ours=f"The integral of rho Y^2 is alpha^2 = {norms} for three shapes, not 1",
        verdict=MISPRINT,
        reason="A factor 1 / alpha is missing, and beta^4 = rho omega^2 / EI. Results do not depend on the norm.",
    )


def _equations() -> Claim:
    return Claim(
        where="Eqs. 4-10",
        says="Energies of the sliding, turning beam",
        ours="Derived anew: one kinetic and one potential energy, differentiated",
        verdict=MISPRINT,
        reason=(
            "Eq. 4 leaves out bounds and hub, Eq. 5 the tip mass's couplings, Eq. 6 differentiates y instead of u, "
            "Eq. 7 lacks the elastic part, Eq. 8 makes the tip force a constant load instead of a stiffness, "
            "Eqs. 9-10 lack the axial loads by feed and gravity."
        ),
    )


def _table2() -> Claim:
    width, height, rhoA, EI = 0.1524, 0.0095, 4.02, 756.65
    modulus, density = EI / (width * height**3 / 12), rhoA / (width * height)
    return Claim(
        where="Table 2",
        says="15.24 x 0.95 cm^2, 4.02 kg/m, EI = 756.65 N m^2",
        ours=f"E = {modulus / 1e9:.1f} GPa, density {density:.0f} kg/m^3",
        verdict=HOLDS,
        reason="The figures belong to one aluminium beam that bends about its weak axis; the paper states no E.",
    )


def _figure4(result: PaperStudy) -> Claim:
    finest = result.actuator[ACTUATOR_MODES[-1]].tip_deflection
    off = {k: float(np.abs(d.tip_deflection - finest).max()) for k, d in result.actuator.items()}
    return Claim(
        where="Figs. 3-4",
        says="Tip vibration at 0.1 m/s and 0.785 rad/s; assumed modes and finite elements agree closely",
        ours=(
            f"Largest deflection {text(float(np.abs(finest).max()), 'm')}; 3 shapes are within {text(off[3], 'm', 2)} "
            f"of {ACTUATOR_MODES[-1]}"
        ),
        verdict=OPEN,
        reason=(
            "Free length at the start, tip mass, hub and plane of motion are not given, so the curves cannot be laid "
            f"over each other. Ours is level and starts at 1.83 m; 1 shape would be off by {text(off[1], 'm', 2)}."
        ),
    )
