"""Claims of the paper's section 2, the single actuator."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.bases.beam_functions import clamped_free
from flexapod.errors import InputError
from flexapod.study.paper.claim import HOLDS, MISPRINT, NOT, OPEN, Claim, explained, judged, left_open
from flexapod.study.paper.study import ACTUATOR_MODES, PaperStudy
from flexapod.study.words import text

__all__ = ["actuator_claims"]

WIDTH, HEIGHT = 0.1524, 0.0095  # Table 2 [m]
ALUMINIUM = (70e9, 2700.0)  # E [Pa], density [kg/m^3]; its alloys lie within 5 %, steel at three times as much
ALLOYS = 0.05
ROUNDED = 1e-3  # half a unit in the third digit: a norm nearer to 1 would be taken for 1


def actuator_claims(result: PaperStudy) -> tuple[Claim, ...]:
    """Equations 2 to 10, Table 2, Figs. 3 and 4."""
    eps = np.array([shape.eps for shape in clamped_free(3)])
    return (_shapes(eps), _equations(), _table2(_actuator(result)), _figure4(result))


def _actuator(result: PaperStudy) -> model.Actuator:
    study = model.loads(result.actuator[ACTUATOR_MODES[0]].attrs["study"])
    if isinstance(study, model.ActuatorStudy):
        return study.actuator
    raise InputError("is the result of a robot", key="data", allowed="results of a single actuator")


def _shapes(eps: np.ndarray) -> Claim:
    alpha = (np.sin(eps) + np.sinh(eps)) / (np.cos(eps) + np.cosh(eps))
    norms = ", ".join(f"{norm:.4f}" for norm in alpha**2)
    verdict = judged(np.abs(alpha**2 - 1).max() < ROUNDED)
    return Claim(
        where="Eq. 2",
        says="Shapes normalised by the mass per length; beta^4 = omega^4 rho / EI",
        ours=f"The integral of rho Y^2 is alpha^2 = {norms} for three shapes; normalised, it would be 1",
        verdict=verdict,
        reason=explained(
            verdict,
            NOT,
            "A factor 1 / alpha is missing, and beta^4 = rho omega^2 / EI (misprint). Results do not depend on the "
            "norm.",
        ),
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
            "Eqs. 9-10 lack the axial loads by feed and gravity: a matter of the text, shown line by line in "
            "chapter T9 of the theory (T9.2) and checked in tests/consistency/test_sliding_equation.py."
        ),
    )


def _table2(actuator: model.Actuator) -> Claim:
    modulus, density = actuator.EI / (WIDTH * HEIGHT**3 / 12), actuator.rhoA / (WIDTH * HEIGHT)
    off = max(abs(modulus / ALUMINIUM[0] - 1), abs(density / ALUMINIUM[1] - 1))
    verdict = judged(off < ALLOYS)
    return Claim(
        where="Table 2",
        says="15.24 x 0.95 cm^2, 4.02 kg/m, EI = 756.65 N m^2",
        ours=f"E = {modulus / 1e9:.1f} GPa, density {density:.0f} kg/m^3",
        verdict=verdict,
        reason=explained(
            verdict,
            HOLDS,
            "The figures belong to one aluminium beam that bends about its weak axis: within "
            f"{100 * off:.1g} % of {ALUMINIUM[0] / 1e9:.0f} GPa and {ALUMINIUM[1]:.0f} kg/m^3. The paper states no E.",
        ),
    )


def _figure4(result: PaperStudy) -> Claim:
    finest = result.actuator[ACTUATOR_MODES[-1]].tip_deflection
    peak = float(np.abs(finest).max())
    off = {k: float(np.abs(d.tip_deflection - finest).max()) for k, d in result.actuator.items()}
    open_here = left_open("paper-actuator", "actuator.free_length", "actuator.tip_mass", "actuator.gravity")
    verdict = OPEN if open_here else judged(off[3] < 0.01 * peak, off[3] < 0.1 * peak)
    return Claim(
        where="Figs. 3-4",
        says="Tip vibration at 0.1 m/s and 0.785 rad/s; assumed modes and finite elements agree closely",
        ours=(
            f"Largest deflection {text(peak, 'm')}; 3 shapes are within {text(off[3], 'm', 2)} of {ACTUATOR_MODES[-1]}"
        ),
        verdict=verdict,
        reason=explained(
            verdict,
            OPEN,
            "Free length at the start, tip mass, hub and plane of motion are not given, so the curves cannot be laid "
            f"over each other. Ours is level and starts at {_actuator(result).free_length:g} m; 1 shape would be off "
            f"by {text(off[1], 'm', 2)}.",
        ),
    )
