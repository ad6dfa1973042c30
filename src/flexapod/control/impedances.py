"""Mechanical impedance at a joint, and springs and dampers that would feel the same, (T21.40)-(T21.42)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arguments import frequencies
from flexapod.common.errors import InputError
from flexapod.control.state_space import a_system

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.control.state_space import StateSpace

__all__ = ["impedance"]


def impedance(system: StateSpace, hz: ArrayLike, *, force: str, place: str) -> Dataset:
    """Force over velocity at one place, Eq. (T21.40).

    Parameters
    ----------
    system : StateSpace
    hz : array_like, shape (f,)
        Frequencies above 0.
    force : str
        Input [N]: the force at the place.
    place : str
        Output [m]: displacement of the place along the force.

    Returns
    -------
    xarray.Dataset
        Over `frequency`: `impedance` (frequency, part) [N s/m]; the spring and the damper which beside each other
        (`parallel_stiffness` [N/m], `parallel_damping` [N s/m]), or one behind the other (`series_stiffness`,
        `series_damping`), have it, Eqs. (T21.41)-(T21.42). A stiffness below 0 is that of a mass, infinite that of
        what does not give way.
    """
    from flexapod.control.datasets import impedance_dataset

    part = a_system(system).select(force, place)
    if len(part.inputs) != 1 or len(part.outputs) != 1:
        raise InputError("are more than one channel", key="force, place", value=f"{force}, {place}")
    frequency = frequencies(hz)
    if not (frequency > 0).all():
        raise InputError("is not above 0", key="hz", allowed="frequencies above 0 Hz")
    omega = 2 * np.pi * frequency
    mobility = 1j * omega * part.at(frequency)[0, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        Z = 1.0 / mobility
        parallel = -omega * Z.imag, Z.real  # (T21.41)
        series = omega / mobility.imag, 1.0 / mobility.real  # (T21.42)
    return impedance_dataset(frequency, Z, parallel, series)
