"""Loops beyond springs and dampers on their rotors, in undamped modes, Eqs. (T23.58)-(T23.60)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Complex
from flexapod.mechanics.shapes.beam_functions import check_finite
from flexapod.model import Robot
from flexapod.solve.batch import RestStates
from flexapod.solve.kernel import evaluate
from flexapod.solve.modal.eigenproblem import reacting_modes
from flexapod.solve.system import System

GROWS = 1e-9  # real part over size of an eigenvalue: less is rounding
UNSTABLE = (
    "the loops of the drives are unstable{where}: deviations grow by a factor of 2.7 in {time:~3 s}; smaller gains, a "
    'motor of more bandwidth, or damping by the rotor\'s rate (encoder.rate = "rotor") may help'
)
"""That deviations grow, at a place in words, by a factor of e in a time [s]."""


@dataclass(frozen=True, kw_only=True)
class ModalLoops:
    """L loops in r undamped modes of unit stiffness, in which each is a spring and a damper on its rotor.

    ``rotor``, ``measured``, ``damped`` (r, L): travel of the rotors, what is measured and what has the measured rate,
    by the modes; ``stiffness`` [N/m], ``damping`` [N s/m], ``integral`` [N/(m s)], ``lag`` [s] (L,).
    """

    rotor: Array
    measured: Array
    damped: Array
    stiffness: Array
    damping: Array
    integral: Array
    lag: Array

    def dynamic(self, s: NDArray[np.complexfloating]) -> Complex:
        """Terms of the loops in the dynamic stiffness (f, r, r) at s (f,) [1/s], Eq. (T23.58)."""
        s = s[:, None, None]
        k, c, g, lag = (x[:, None] for x in (self.stiffness, self.damping, self.integral, self.lag))
        asked = (k + g / s) * self.measured.T + s * c * self.damped.T
        return np.asarray(self.rotor @ (asked / (1 + s * lag) - (k + s * c) * self.rotor.T), dtype=np.complex128)

    def eigenpairs(self, omega: Array, D: Array) -> tuple[Complex, Complex]:
        """Eigenvalues [1/s], and their shapes (r, any), of modes with damping (r, r), Eq. (T23.59).

        A force that comes at once is no unknown; a rotor has mass, so that what has none is as without loops.
        """
        modes, (late, sums) = reacting_modes(omega, D), (self.lag > 0, self.integral > 0)
        (s, r), rate = modes.slowness.shape, modes.rate  # times are in 1 over the first frequency
        z, y = slice(0, s), slice(s, s + r)
        force, total = slice(s + r, s + r + late.sum()), slice(s + r + late.sum(), s + r + late.sum() + sums.sum())
        b, seen, damped = (modes.basis.T @ x for x in (self.rotor, self.measured, self.damped))
        A, E = np.zeros((2, total.stop, total.stop))
        asked, asked_rate, summed = self.stiffness * seen, self.damping * damped, np.eye(len(sums))[:, sums]
        at_once = b * ~late
        A[z, z] = np.eye(s) - b * self.stiffness @ b.T + at_once @ asked.T
        E[z, z] = rate * (modes.D - b * self.damping @ b.T + at_once @ asked_rate.T)
        unit = np.sqrt(self.stiffness)  # of forces and of what is summed, by the loops
        A[z, force], A[z, total] = -(b * unit)[:, late], -(at_once * unit) @ summed
        E[z, y], E[y, z], A[y, y] = modes.slowness, -modes.slowness.T, np.eye(r)
        A[force, z], E[force, z] = (asked / unit)[:, late].T, rate * (asked_rate / unit)[:, late].T
        A[force, force], A[force, total] = np.eye(late.sum()), -summed[late]
        E[force, force] = rate * np.diag(self.lag[late])
        A[total, z], E[total, total] = (self.integral / unit * seen)[:, sums].T / rate, np.eye(sums.sum())
        check_finite(A, E)
        values, shapes = np.linalg.eig(-np.linalg.solve(A, E))
        return (rate / values).astype(np.complex128), (modes.basis @ shapes[z]).astype(np.complex128)


def growth_rate(values: Complex) -> float:
    """Rate at which the fastest of them grows [1/s]; 0 where all decay."""
    grows = values.real > GROWS * np.abs(values)
    return float(values.real[grows].max(initial=0.0))


def loops_in_modes(robot: Robot, system: System, x: RestStates, flat: Array) -> list[ModalLoops]:
    """The loops of a robot at each of p states, by its modes there in flat coordinates (p, N, r)."""
    n, legs, r = system.n, system.legs, system.kernel.shapes.index("r")
    sizes = [(n, n), (n, n), (1,), (n,)]
    *_, slope = evaluate(system.kernel, "leg_loop", len(x) * legs, [x.q, system.leg_p], sizes)
    which = [i for i, leg in enumerate(robot.legs) if leg.screw is not None and leg.screw.loops]
    screws = [leg.screw for leg in robot.legs if leg.screw is not None and leg.screw.loops]
    by_leg = flat[:, : legs * n].reshape(len(x), legs, n, -1)
    measured = (slope.reshape(len(x), legs, n, 1) * by_leg).sum(axis=2)[:, which]
    rotor = by_leg[:, which, r]
    turns = np.array([screw.encoder.rate == "rotor" for screw in screws])[:, None]
    damped = np.where(turns, rotor, measured)
    gains = np.array([(*screw.loop_spring, screw.integral, screw.lag) for screw in screws]).T
    names = dict(zip(("stiffness", "damping", "integral", "lag"), gains, strict=True))
    parts = zip(rotor, measured, damped, strict=True)
    return [ModalLoops(rotor=b.T, measured=mu.T, damped=nu.T, **names) for b, mu, nu in parts]
