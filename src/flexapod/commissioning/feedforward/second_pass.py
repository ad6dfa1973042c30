"""Error of the linear model along a path, by its residual in the nonlinear equations, Eqs. (T22.26)-(T22.28)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod import kinematics
from flexapod.commissioning.feedforward.modal_path import (
    LinearPath,
    PathVibration,
    inertial_loads,
    loads_on_motions,
    step_instants,
    tool_at_rest,
)
from flexapod.common.arrays import Array
from flexapod.kinematics import RigidPoses
from flexapod.kinematics.rotations import cross, displace_pose, exponential, product, rotation_vector
from flexapod.model import Study
from flexapod.solve.batch import Rates, RestStates, residual
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.statics.lost_motion import places_with_friction
from flexapod.solve.statics.static_loads import feed_forward, force_ports, rest_commands
from flexapod.solve.time.modal_march import STAGES, cubic_pieces, modal_march

FINE = 8  # instants in a period of the third mode at which the residual is taken
CORRECTIONS = 3  # of places and forces of closures: each leaves the share by which Jacobians change between poses
DECIDES = 0.05  # error over the largest motion, up to which the linear model decides


def error_sentence(study: Study, error: float) -> str:
    """Words on the error of the linear model over the largest motion, and whether the model decides."""
    told = f"the linear model errs by {100 * error:.2g} % of the largest distance, by a second pass"
    if places_with_friction(study.robot):
        return f"{told} that knows no friction either: with friction it does not decide, fx.simulate does"
    return f"{told}: it does not decide, fx.simulate does" if not error <= DECIDES else told


def linear_error(study: Study, found: PathVibration) -> float:
    """Error of the vibration of the tool along a study's path over its largest distance, Eq. (T22.28).

    The residual of the linear motion in the nonlinear equations goes through the same steps again.
    """
    from scipy.interpolate import CubicSpline

    at, moving = found.model, float(found.model.time[-1])
    t = step_instants(at, moving, fine=FINE)
    z, v = np.moveaxis(CubicSpline(found.time[: len(found.motion)], found.motion)(t), 1, 0)
    path = kinematics.poses(study.robot, study.motion, t)
    lacks = _residual_on_motions(at, t, path, z, v)
    lacks -= loads_on_motions(at, t, inertial_loads(at, path)[..., None])[
        ..., 0
    ]  # (T22.27)  M z'' of the linear motion
    lacks += _along(at.time, at.K, t, z)[0] + _along(at.time, at.D, t, v)[0]
    force = CubicSpline(t, lacks)(np.add.outer(t[:-1], t[1] * STAGES))[..., None]
    x = modal_march(at.locked.system.kernel, at.time, (at.M, at.D, at.K), force)[..., 0]
    tool = np.einsum("txd,td->tx", CubicSpline(at.time, at.tool)(t), x[:, 0])
    later = tool_at_rest(at, x[-1], float(found.time[-1]) - moving)[1]
    error = float(np.linalg.norm(np.concatenate([tool, later]), axis=1).max())
    return error / found.largest if found.largest else error


def _along(time: Array, values: Array, t: Array, x: Array) -> tuple[Array, Array, Array]:
    """Products A x, A' x, A'' x (T, a) at rising instants of splines through values (P, a, b) with vectors (T, b)."""
    found = np.zeros((3, len(t), values.shape[1]))
    edges = np.searchsorted(t, time[1:-1])
    none = np.zeros(len(t))
    for begin, piece, rows in zip(time, cubic_pieces(time, values), np.split(np.arange(len(t)), edges), strict=False):
        s, one = t[rows] - begin, none[rows] + 1.0
        by_power = (x[rows] @ np.concatenate(piece, axis=0).T).reshape(len(rows), 4, -1)
        powers = np.array([[s**3, s**2, s, one], [3 * s**2, 2 * s, one, 0 * s], [6 * s, 2 * one, 0 * s, 0 * s]])
        found[:, rows] = np.einsum("kpt,tpa->kta", powers, by_power)
    return found[0], found[1], found[2]


def _residual_on_motions(at: LinearPath, t: Array, path: kinematics.Poses, z: Array, v: Array) -> Array:
    """Minus the balance of the nonlinear robot, M z'' left out, on the independent motions (T, d), Eq. (T22.26)."""
    locked, system = at.locked, at.locked.system
    rigid, rates = rigid_motion(system, RigidPoses(locked.robot, path))
    states, moving = _displaced(at, t, (rigid, rates), z, v)
    command, wrench = rest_commands(system, locked.robot, rigid.q), np.broadcast_to(locked.acts.wrench, (len(t), 6))
    pushed = feed_forward(RigidPoses(locked.robot, path), np.zeros(len(t)), wrench)
    given = pushed[:, :, None] * (system.ports == force_ports(system, locked.robot)[:, None])
    near = np.clip(np.rint(t / at.time[-1] * (len(at.time) - 1)).astype(int), 0, len(at.time) - 1)
    back = _closing(at)[near]

    def balance(x: RestStates) -> tuple[Array, Array, Array]:
        r, payload, g = residual(system, x, command, rates.v[..., system.ports], wrench, moving)
        r[..., system.ports] -= given
        return r, payload, g

    for _ in range(CORRECTIONS):
        r, _, g = balance(states)
        q, lam = (back @ g[..., None])[..., 0], (back.swapaxes(-1, -2) @ r[..., None])[..., 0]
        states = replace(states, q=states.q - q, lam=states.lam - lam)
    r, payload, _ = balance(states)
    left = np.concatenate([r.reshape(len(t), -1), payload], axis=1)
    return loads_on_motions(at, t, left[..., None])[..., 0]


def _displaced(
    at: LinearPath, t: Array, rigid: tuple[RestStates, Rates], z: Array, v: Array
) -> tuple[RestStates, Rates]:
    """States of the path's equilibria with the linear motion on them, and their rates without M's accelerations."""
    from scipy.interpolate import CubicSpline

    (states, rates), start, rest = rigid, at.locked.start, at.locked.equilibria.states
    turn = rotation_vector(product(start.pose[:, 3:] * np.array([1.0, -1.0, -1.0, -1.0]), rest.pose[:, 3:]))
    sag = np.concatenate(
        [(rest.q - start.q).reshape(len(at.time), -1), rest.pose[:, :3] - start.pose[:, :3], turn], axis=1
    )
    of_rest = CubicSpline(at.time, sag, bc_type="clamped")
    place, fast, bend = _along(at.time, at.flat, t, z)
    rate, twist, _ = _along(at.time, at.flat, t, v)
    place, fast, bend = of_rest(t) + place, of_rest(t, 1) + fast + rate, of_rest(t, 2) + bend + 2 * twist
    size = states.q[0].size
    back = exponential(-place[:, size + 3 :])
    spin = (back @ rates.u[:, 3:, None])[..., 0]
    drag = np.stack(cross(spin.T, fast[:, size + 3 :].T), axis=-1)
    u, u_dot = rates.u + fast[:, size:], rates.u_dot + bend[:, size:]
    u[:, 3:] = spin + fast[:, size + 3 :]
    u_dot[:, 3:] = (back @ rates.u_dot[:, 3:, None])[..., 0] + drag + bend[:, size + 3 :]
    moved = RestStates(
        q=states.q + place[:, :size].reshape(states.q.shape), pose=displace_pose(states.pose, place[:, size:]),
        lam=CubicSpline(at.time, rest.lam)(t), drive=np.zeros_like(states.drive),
    )  # fmt: skip
    legs = [x[:, :size].reshape(states.q.shape) for x in (fast, bend)]
    return moved, Rates(v=rates.v + legs[0], v_dot=rates.v_dot + legs[1], u=u, u_dot=u_dot)


def _closing(at: LinearPath) -> Array:
    """Smallest motions (P, legs, n, rows) of legs, the payload and what is held at rest, by gaps of their closures."""
    system = at.locked.system
    free = np.ones(system.held.shape) * ~system.held
    free[:, system.shared_coordinates] = 0.0
    return np.asarray(np.linalg.pinv(at.locked.m.J * free[:, None]), dtype=np.float64)
