"""Forces in every joint of a rigid robot along a path, whatever its legs, Eqs. (T7.24)-(T7.28)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics.rotations import blocks, matrix
from flexapod.solve.batch import Rates, RestStates, matrices_at_rest, residual
from flexapod.solve.statics.minimum_energy_forces import closure_forces, open_forces
from flexapod.solve.system import System

BLOCK = 256  # instants at a time: matrices of 16 legs with six closure rows take 75 kB each


@dataclass(frozen=True, kw_only=True)
class JointForces:
    """Forces of the rigid robot at T instants.

    Attributes
    ----------
    closure : ndarray, shape (T, legs, rows)
        Multipliers of the closures.
    joint_force, joint_moment : ndarray, shape (T, legs, 3)
        Of the legs on the platform at its joints, world axes [N], [N m].
    held : ndarray, shape (T, legs, n)
        Force or moment on each coordinate that is held or driven [N], [N m]; 0 on the others.
    hub : ndarray, shape (T, 6)
        Force (world) and moment about the CoM (platform axes) on what is held of the payload; 0 on the rest.
    open_forces : int
        How many the rigid statics leaves open: shown are those of the least strain energy of the legs.
    """

    closure: Array
    joint_force: Array
    joint_moment: Array
    held: Array
    hub: Array
    open_forces: int


def joint_forces(
    system: System, x: RestStates, rates: Rates, wrench: Array, pushed: Array | float = 0.0
) -> JointForces:
    """Forces that move a robot without shapes along a path, Eq. (T7.24).

    Parameters
    ----------
    system : System
        Of fidelity "rigid", with driven coordinates among the held ones.
    x : RestStates
        Configurations at T instants that fulfil the closures; their forces do not matter.
    rates : Rates
    wrench : ndarray, shape (T, 6) or (6,)
        At the tool.
    pushed : ndarray, shape (legs, n)
        Forces of drives on coordinates that are not held [N, N m].

    Raises
    ------
    ComputationError
        A pose is singular.
    """
    wrench = np.broadcast_to(wrench, (len(x), 6))
    parts = [_joint_forces(system, x[b], rates[b], wrench[b], pushed) for b in blocks(len(x), BLOCK)]
    found = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return JointForces(**found, open_forces=open_forces(system))


def _joint_forces(
    system: System, x: RestStates, rates: Rates, wrench: Array, pushed: Array | float
) -> dict[str, Array]:
    m, still = matrices_at_rest(system, x, np.zeros(6)), x.q[..., system.ports]
    r, payload, _ = residual(system, x, still, rates.v[..., system.ports], wrench, rates)
    r = r - pushed
    lam = closure_forces(system, x, m, r[..., None], payload[..., None])
    if not np.isfinite(lam).all():
        raise ComputationError(
            "The legs cannot carry the payload: a pose of the path is singular",
            next_step="Check the path for singular poses and change the layout or the motion",
        )
    held = np.where(system.held, r + (m.J.swapaxes(-1, -2) @ lam)[..., 0], pushed)  # (T7.24)
    on_hub = (m.P.swapaxes(-1, -2) @ lam)[..., 0]
    moment = (matrix(x.pose[:, 3:])[:, None] @ m.P[..., 3:, 3:].swapaxes(-1, -2) @ lam[..., 3:, :])[..., 0]
    hub = np.where(system.hub_held, payload - on_hub.sum(axis=1), 0.0)
    force = lam[..., :3, 0]
    return {"closure": lam[..., 0], "joint_force": force, "joint_moment": moment, "held": held, "hub": hub}


def displacement_by_error(system: System, x: RestStates) -> Array:
    """Steps of the payload for unit errors of held coordinates, to first order, (T, legs, n, 6), Eq. (T7.27).

    By virtual work: what an error does to the payload along a wrench is what holding that coordinate against the wrench
    takes. A robot that is held more often than it needs shares errors by the compliance of its legs.

    Parameters
    ----------
    system : System
        Of fidelity "rigid", with driven coordinates among the held ones.
    x : RestStates
        Configurations at T instants.

    Raises
    ------
    ComputationError
        A pose is singular.
    """
    T, (n, legs) = len(x), (system.n, system.legs)
    m = matrices_at_rest(system, x, np.zeros(6))
    unit = np.broadcast_to(np.eye(6), (T, 6, 6))
    lam = closure_forces(system, x, m, np.zeros((T, legs, n, 6)), unit)
    if not np.isfinite(lam).all():
        raise ComputationError(
            "a pose on the path is singular: lengths do not determine it", next_step="See `flexapod check`."
        )
    return np.where(system.held[..., None], m.J.swapaxes(-1, -2) @ lam, 0.0)
