"""Loops and spectra of linear systems, robots and others: closed forms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from flexapod import control
from flexapod.analysis.linear import linearize
from flexapod.common.arrays import Array
from flexapod.control import StateSpace
from flexapod.verification.case import Check, case, checks
from flexapod.verification.cases.linear import DAMPER, SPRING, stewart

__all__: list[str] = []


def _system(A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> StateSpace:
    """State-space model of one drive that moves a stroke."""
    A, B = (np.asarray(x, dtype=float) for x in (A, B))
    n = len(A)
    return StateSpace(
        A=A.reshape(n, n), B=B.reshape(n, 1), C=np.reshape(np.asarray(C, dtype=float), (1, n)), D=np.asarray(D),
        inputs=("drive:1",), outputs=("stroke:1",), states=tuple(f"x{i}" for i in range(n)), units={},
    )  # fmt: skip


def _limit(stable: Callable[[float], bool], low: float, high: float) -> float:
    """Largest stable value between `low` and `high`, by bisection."""
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


@case(
    "Forces or rates of six struts fed back with one gain: damping of all modes",
    source="Preumont, Vibration Control of Active Structures: g/(2 w) + c w/(2 k) of forces, (c + g) w/(2 k) of rates",
    argument="struts of a microgram beside 1 kg",
)
def _active_damping() -> list[Check]:
    plant = linearize(stewart(light=True), inputs="drive", outputs=["stroke", "drive-force"])
    plant = plant.reduce(6)
    w = 2 * np.pi * plant.damp().frequency.values
    found = []
    for name, loop, exact in (
        ("force", control.IFF(900.0, sensor="drive-force"), 900.0 / (2 * w) + DAMPER * w / (2 * SPRING)),
        ("rate", control.DVF(700.0), (DAMPER + 700.0) * w / (2 * SPRING)),
    ):
        data = plant.close(loop).damp()
        ratio = data.damping_ratio.values[data.pole.sel(part="imaginary").values > 1.0]
        found += checks([f"{name}, mode {k}" for k in range(1, 7)], exact, ratio, 1e-6)
    return found


@case(
    "Integral of a force that is its own sensor, from sample to sample: largest gain times period",
    source="closed form: 2, 1, (sqrt 5 - 1)/2 for 0, 1, 2 samples of delay",
    argument="rounding of the poles, whose sizes pass 1 with a slope",
)
def _sampled_integrator() -> list[Check]:
    wire, T = _system([], [], [], [[1.0]]), 1e-3

    def stable(gain: float, late: int) -> bool:
        law = control.Decentralised(control.integrator(gain / T), sensor="stroke")
        return bool(np.abs(wire.close(law, sample=T, delay=late * T).poles()).max() < 1.0)

    limits = [_limit(lambda g, late=late: stable(g, late), 0.1, 3.0) for late in (0, 1, 2)]
    return checks([f"{k} samples late" for k in (0, 1, 2)], [2.0, 1.0, (np.sqrt(5) - 1) / 2], limits, 1e-9)


@case(
    "An integrator about a wire with a delay: margins, and the delays at which pairs of poles begin to grow",
    source="closed forms: phase pi/2 - g tau at g, gain pi/(2 g tau); g tau = pi/2, 5 pi/2",
    argument="a bracket of 1e-9 of the frequency; the counts are whole numbers",
)
def _delayed_loop() -> list[Check]:
    g, tau = 40.0, 0.02
    wire, law = _system([], [], [], [[1.0]]), control.Decentralised(control.integrator(g), sensor="stroke")
    data = control.margins(wire, law, delay=tau)

    def growing(late: float) -> int:
        return control.margins(wire, law, delay=late).attrs["unstable_poles"]

    after = [growing(share * np.pi / (2 * g)) for share in (0.99, 1.01, 4.99, 5.01)]
    return [
        Check("phase margin", np.pi / 2 - g * tau, data.phase_margin.item(), 1e-7, "rad"),
        Check("gain margin", np.pi / (2 * g * tau), data.gain_margin.sel(side="above").item(), 1e-7),
        Check("delay margin", np.pi / (2 * g) - tau, data.delay_margin.item(), 1e-7, "s"),
        *checks([f"poles that grow at {s} of the first delay" for s in (0.99, 1.01, 4.99, 5.01)], [0, 2, 2, 4], after,
                0.1, absolute=True),
    ]  # fmt: skip


@case(
    "A mode under white force, and under the noise of the sensor of a loop about it: variance, H2 norm",
    source="closed forms S/(4 k c), 1/sqrt(2 c k), and the integral of second order of James, Nichols & Phillips",
    argument="panels of the integral: 1e-5; the filter of the rate far above the mode: 1e-4",
)
def _shaken_mode() -> list[Check]:
    m, k, c, kp, kd, S = 2.0, 5e3, 4.0, 3e3, 25.0, 1e-3
    plant = _system([[0, 1], [-k / m, -c / m]], [0, 1 / m], [1, 0], [[0.0]])
    loop = plant.close(control.PID(kp, 0.0, kd, low_pass=1e6))
    white: tuple[Array, Array] = (np.array([1e-3, 1e5]), np.full(2, S))
    a0, a1 = k + kp, c + kd
    power = (kd**2 * a0 + kp**2 * m) / (2 * a0 * a1 * m)
    return [
        Check("variance under a force", S / (4 * k * c), plant.psd({"drive": white}).rms.item() ** 2, 1e-5, "m^2"),
        Check("H2 norm", 1 / np.sqrt(2 * c * k), plant.h2().h2_norm.item(), 1e-9, "m/N Hz^0.5"),
        Check("H2 norm of sensor noise", np.sqrt(power), loop.h2("noise", "stroke").h2_norm.item(), 1e-4, "Hz^0.5"),
    ]
