"""Overconstrained robots in which nothing is compliant, Eqs. (T6.26)-(T6.27)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.solve.batch import RestStates, matrices_at_rest
from flexapod.solve.statics.minimum_energy_forces import least_energy
from flexapod.solve.system import State, System
from flexapod.solve.time.recording import Recording

DEPENDENT = 1e-9  # singular value, relative to the largest, below which closures depend on each other
MISFIT = 1e-9  # m, or rad: by which a coordinate may miss what should hold it, rounding of positions


def release_redundant(system: System, x: State) -> System:
    """System that leaves as many of its held coordinates to the closures as these determine, Eq. (T6.26)."""
    G = system.matrices(x, np.zeros(6)).G
    free = G[:, ~system.fixed_mask] if system.independent is None else G @ system.independent
    size = np.linalg.svd(free, compute_uv=False)
    rank = int((size > DEPENDENT * size.max(initial=0.0)).sum())
    if rank == len(G):
        return system
    left = np.linalg.svd(free)[0][:, rank:]
    pivots = np.isin(np.arange(system.held.shape[1]), system.kernel.shapes.pivots)  # others would move without mass
    held = np.flatnonzero((system.held & pivots).ravel())
    slack = np.zeros(system.held.size, dtype=bool)
    slack[held[_independent_columns(left.T @ G[:, held])]] = True
    return replace(system, slack=slack.reshape(system.held.shape))


def _independent_columns(A: Array) -> list[int]:
    """Indices of as many columns as are independent, each the longest residual of those before."""
    rest, least, chosen = A.copy(), DEPENDENT * np.abs(A).max(), []
    for _ in range(len(A)):
        size = np.linalg.norm(rest, axis=0)
        k = int(np.argmax(size))
        if size[k] <= least:
            break
        chosen.append(k)
        unit = rest[:, k] / size[k]
        rest -= np.outer(unit, unit @ rest)
    return chosen


def minimum_energy_recording(system: System, recording: Recording, table: Array) -> Recording:
    """The recording with the forces of least strain energy of the legs, among all that hold the robot, Eq. (T6.27).

    Parameters
    ----------
    system : System
        As `independent` gives it.
    recording : Recording
    table : ndarray, shape (T, legs, ports, 4)
        Of the same instants.

    Raises
    ------
    ComputationError
        A coordinate that was left to the closures does not stay where it is held: the rigid robot cannot move so.
    """
    slack = (system.held & ~system.enforced_mask)[:, system.ports]
    gap = np.where(slack, recording.q[..., system.ports] - table[..., 0], 0.0)
    if np.abs(gap).max() > MISFIT:
        k, leg, port = np.argwhere(np.abs(gap) > MISFIT)[0]
        names = [name for name, size in system.kernel.shapes.layout for _ in range(size)]
        raise ComputationError(
            f"rigid legs do not fit at t = {recording.time[k]:.6g} s: the coordinate {names[system.ports[port]]} of "
            f"leg {leg + 1} misses what holds it by {gap[k, leg, port]:.2g}",
            next_step="Give a fidelity whose legs can yield, axial_modes above 0, or check axes and lengths of legs.",
        )
    x = RestStates(q=recording.q, pose=recording.pose, lam=recording.lam, drive=recording.drive)
    found = least_energy(system, x, matrices_at_rest(system, x, np.zeros(6)))
    return replace(recording, lam=found.lam, drive=found.drive)
