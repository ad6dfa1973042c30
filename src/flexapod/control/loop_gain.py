"""Root locus and best gain: loops over a factor on their controller, (T21.30)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import linear_sum_assignment, minimize_scalar

from flexapod.common.arguments import number, numbers
from flexapod.common.arrays import Complex
from flexapod.common.errors import InputError
from flexapod.common.units import quantity
from flexapod.control.feedback import closed_loop, law_beside, open_loop
from flexapod.control.frequency_response import oscillating_poles
from flexapod.control.state_space import check_system
from flexapod.control.zeros import zeros_of

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.control.controllers import Controller
    from flexapod.control.state_space import StateSpace

STEPS = 40  # of a decade of gains
FINEST = 1e-9  # relative accuracy of a crossing


def root_locus(system: StateSpace, controller: Controller | StateSpace, gains: ArrayLike) -> Dataset:
    """Poles of a loop over a factor on its controller.

    Parameters
    ----------
    system : StateSpace
    controller : Controller or StateSpace
        Its own gain is that of the factor 1.
    gains : array_like, shape (g,)
        Factors, 0 or more.

    Returns
    -------
    xarray.Dataset
        `pole` (gain, branch, part) [1/s], each branch one motion, as poles of neighbouring gains are paired;
        `frequency` [Hz] and `damping_ratio` (gain, branch); `open_zero` (zero, part): where branches end.
    """
    from flexapod.control.datasets import locus_dataset

    factors = numbers(gains, "gains", "factors on the controller, one at least")
    if not factors.size:
        raise InputError("are none", key="gains", allowed="factors on the controller, one at least")
    law = law_beside(check_system(system), controller)
    poles = np.stack([_poles(system, law, factor) for factor in factors])
    for i in range(1, len(poles)):
        away = np.abs(poles[i - 1][:, None] - poles[i])
        poles[i] = poles[i][linear_sum_assignment(away)[1]]
    return locus_dataset(factors, poles, _open_zeros(system, law), system.sample)


def best_gain(
    system: StateSpace, controller: Controller | StateSpace, *, least: float = 1e-3, most: float = 1e3,
    below: float | str | None = None,
) -> Dataset:  # fmt: skip
    """Factor on a controller at which the least damping ratio of all oscillating poles is largest, Eq. (T21.30).

    Parameters
    ----------
    system, controller
        As of `root_locus`.
    least, most : float
        Between which factors to look.
    below : float or str, optional
        Frequency [Hz] above which poles do not count.

    Returns
    -------
    xarray.Dataset
        `gain`, `damping_ratio` there, `frequency` of the pole that has it; over `factor`: `least_damping_ratio`.
    """
    from flexapod.control.datasets import best_dataset

    law = law_beside(check_system(system), controller)
    edge = np.inf if below is None else quantity(below, "frequency", key="below")
    least, most = number(least, "least"), number(most, "most")
    if not 0 < least < most:
        raise InputError("are no factors", key="least, most", value=f"{least}, {most}", allowed="0 < least < most")
    factors = np.geomspace(least, most, int(np.ceil(STEPS * np.log10(most / least))) + 1)
    ratios = np.array([_least_ratio(system, law, factor, edge)[0] for factor in factors])
    at = int(ratios.argmax())
    low, high = (np.log(factors[max(at - 1, 0)]), np.log(factors[min(at + 1, len(factors) - 1)]))
    found: Any = minimize_scalar(
        lambda x: -_least_ratio(system, law, np.exp(x), edge)[0],
        bounds=(low, high), method="bounded", options={"xatol": FINEST},
    )  # fmt: skip
    gain = float(np.exp(found.x)) if -found.fun >= ratios[at] else float(factors[at])
    return best_dataset(gain, *_least_ratio(system, law, gain, edge), factors, ratios)


def _scaled(law: StateSpace, factor: float) -> StateSpace:
    return replace(law, C=factor * law.C, D=factor * law.D)


def _poles(system: StateSpace, law: StateSpace, factor: float) -> Complex:
    return closed_loop(system, _scaled(law, factor)).poles()


def _least_ratio(system: StateSpace, law: StateSpace, factor: float, edge: float) -> tuple[float, float]:
    """Least damping ratio of oscillating poles below a frequency [Hz], -1 of unstable real ones, and the pole's own."""
    poles, frequency, ratio = oscillating_poles(_poles(system, law, factor), system.sample)
    counts = (frequency <= edge) & ((np.abs(poles.imag) > FINEST * np.abs(poles)) | (ratio < 0))
    counts &= frequency > FINEST * np.median(frequency)
    if not counts.any():
        return 1.0, 0.0
    at = np.flatnonzero(counts)[ratio[counts].argmin()]
    return float(ratio[at]), float(frequency[at])


def _open_zeros(system: StateSpace, law: StateSpace) -> Complex:
    """Zeros of the loop from its actuators back to them: where branches end as the factor grows without end."""
    A, B, C, D = open_loop(system, law)
    return zeros_of(A, B, C, D)
