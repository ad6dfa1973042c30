"""Vibration of a robot along a path, by its linear model with all modes, Eqs. (T22.12)-(T22.13)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.commissioning.feedforward.loaded_path import inertia_forces, refuse_missing
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.model import Study
from flexapod.solve.linear.motions import project_on_motions
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.modes import ManyModes, modes_of
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.statics.stiffness import tool_motion
from flexapod.solve.time.modal_march import STAGES, cubic_pieces, modal_march

POSES = 25  # along a path, between which matrices follow cubic splines
FINE, OF = 24, 3  # steps in a period of the third mode: the first may be far below what a path shakes
LEAST, MOST = 100, 20_000  # steps
LOOKS = 100  # in a period, once the path is over
PERIODS = 6  # of the first mode that a residual vibration is looked at, at least


@dataclass(frozen=True, kw_only=True)
class LinearPath:
    """A robot about its equilibria at P instants ``time`` (P,) of a path, in d independent motions.

    ``M``, ``D``, ``K`` (P, d, d); ``flat`` (P, N, d): these motions in all coordinates; ``tool`` (P, 3, d): of the
    tool; ``modes``: their frequencies, and shapes where these were asked for.
    """

    time: Array
    locked: LockedPoses
    M: Array
    D: Array
    K: Array
    flat: Array
    tool: Array
    modes: ManyModes


@dataclass(frozen=True, kw_only=True)
class PathVibration:
    """Motion of the tool (T, 3) [m] off its rest at each pose, at instants (T,) [s]; without friction.

    ``model``: along the path; ``motion`` (n, 2, d): its motions and rates at the first n instants, those of the path.
    """

    time: Array
    tool: Array
    model: LinearPath
    motion: Array

    def largest_after(self, instant: float) -> float:
        """Largest distance of the tool from where it comes to rest, from an instant on [m]."""
        return float(np.linalg.norm(self.tool[self.time >= instant - 1e-9], axis=1).max(initial=0.0))

    @property
    def largest(self) -> float:
        """Largest distance in the whole time [m]."""
        return self.largest_after(0.0)


def linear_path(study: Study, t: Array, path: kinematics.Poses | None = None, *, shapes: bool = False) -> LinearPath:
    """The linear model at instants (P,) of a study's path, or of another one's poses, loads as at its start.

    ``shapes``: of modes, with damping ratios.

    Raises
    ------
    ComputationError
        There is no equilibrium at an instant.
    """
    path = kinematics.poses(study.robot, study.motion, t) if path is None else path
    _refuse_loops(study)
    locked = locked_poses(study.robot, study.simulation, path, study.load)
    refuse_missing(locked, t)
    about = locked.vibration_model
    each = np.broadcast_to(np.eye(about.motions.columns.size), (len(t),) + (about.motions.columns.size,) * 2)
    flat = about.motions.flat(about.system, each)
    M, D, K = (flat.swapaxes(1, 2) @ part for part in project_on_motions(about.system, about.m, flat))
    hub = flat[:, about.system.legs * about.system.n :]
    tool = tool_motion(study.robot, locked.equilibria.states.pose)[:, :3] @ hub
    return LinearPath(time=t, locked=about, M=M, D=D, K=K, flat=flat, tool=tool, modes=modes_of(locked, shapes=shapes))


def _refuse_loops(study: Study) -> None:
    loops = [leg.screw is not None and leg.screw.loops for leg in study.robot.legs]
    if any(loops):
        raise InputError(
            "lags or is about another place than the rotor, which the linear model along a path leaves out",
            file=study.path,
            key="leg.drive.loop",
            allowed="motors that do not lag, loops about rotors; fx.linearize and fx.modes know the others at a pose",
        )


def path_vibration(study: Study, moving: float, until: float, at: LinearPath | None = None) -> PathVibration:
    """Vibration of the tool, until an instant, by the inertia of a study's path, at rest after `moving` [s].

    ``at``: the linear model along it, where there is one.

    M z'' + D z' + K z = -flat^T f, (T22.12): matrices along the path by Gauss' formula of order 4, (T22.13), afterwards
    those of its end, exactly.
    """
    from scipy.interpolate import CubicSpline

    model = at or linear_path(study, np.linspace(0.0, moving, POSES))
    edges, x = integrate_modes(
        model, lambda t: inertial_loads(model, kinematics.poses(study.robot, study.motion, t))[..., None]
    )
    tool = np.einsum("txd,td->tx", CubicSpline(model.time, model.tool)(edges), x[:, 0, :, 0])
    later, rest = tool_at_rest(model, x[-1, :, :, 0], until - moving)
    return PathVibration(
        time=np.append(edges, moving + later), tool=np.concatenate([tool, rest]), model=model, motion=x[..., 0]
    )


def integrate_modes(at: LinearPath, acting: Callable[[Array], Array], least: int = LEAST) -> tuple[Array, Array]:
    """Instants (T,) and motions with rates (T, 2, d, c) along a path under each of c loads (T, N, c), Eq. (T22.13)."""
    edges = step_instants(at, float(at.time[-1]), least)
    t = np.add.outer(edges[:-1], edges[1] * STAGES)
    force = loads_on_motions(at, t.ravel(), acting(t.ravel()))
    force = force.reshape(*t.shape, *force.shape[1:])
    return edges, modal_march(at.locked.system.kernel, at.time, (at.M, at.D, at.K), force)


def step_instants(at: LinearPath, moving: float, least: int = LEAST, fine: int = FINE) -> Array:
    """Instants of the steps in which a robot is followed that moves for so long [s]."""
    count = int(np.ceil(moving * fine * np.nanmax(at.modes.frequency[:, :OF])))
    return np.linspace(0.0, moving, min(MOST, max(count, least)) + 1)


def loads_on_motions(at: LinearPath, t: Array, loads: Array) -> Array:
    """Loads (T, N, c) at rising instants (T,) on the independent motions there, -flat^T f (T, d, c), Eq. (T22.12)."""
    pieces = cubic_pieces(at.time, at.flat)
    found = np.zeros((len(t), at.flat.shape[2], loads.shape[2]))
    edges = np.searchsorted(t, at.time[1:-1])
    for begin, flat, rows in zip(at.time, pieces, np.split(np.arange(len(t)), edges), strict=False):
        powers = (t[rows, None] - begin) ** np.arange(3, -1, -1)
        by_power = loads[rows].swapaxes(1, 2) @ np.concatenate(flat, axis=1)  # (rows, c, 4 d)
        by_power = by_power.reshape(*by_power.shape[:2], 4, -1)
        found[rows] = -np.einsum("rp,rcpd->rdc", powers, by_power)
    return found


def tool_at_rest(at: LinearPath, last: Array, until: float) -> tuple[Array, Array]:
    """Instants after the path's end and the tool (any, 3) there, from the last motions and their rates (2, d) on."""
    from scipy.linalg import expm

    M, D, K = at.M[-1], at.D[-1], at.K[-1]
    d = last.shape[1]
    h = until / max(LEAST, int(np.ceil(until * LOOKS * at.modes.frequency[-1, 0])))
    A = np.block([[np.zeros((d, d)), np.eye(d)], [-np.linalg.solve(M, K), -np.linalg.solve(M, D)]])
    count, power, x = round(until / h), expm(h * A), last.reshape(-1, 1)
    while x.shape[1] <= count:
        x, power = np.concatenate([x, power @ x], axis=1), power @ power
    return h * np.arange(1.0, count + 1), x[:d, 1 : count + 1].T @ at.tool[-1].T


def inertial_loads(at: LinearPath, path: kinematics.Poses) -> Array:
    """Inertial loads of a rigid path in all coordinates (T, N), at the undeformed robot, Eq. (T22.2)."""
    states, rates = rigid_motion(at.locked.system, kinematics.RigidPoses(at.locked.robot, path))
    legs, payload = inertia_forces(at.locked.system, states, rates, at.locked.acts.wrench)
    return np.concatenate([legs.reshape(len(path), -1), payload], axis=1)
