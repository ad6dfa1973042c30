"""A straight way between poses with a free law: use of the drives, and vibration by it, Eqs. (T22.17)-(T22.19)."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics
from flexapod.analysis.results.leg_results import drive_forces
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.simulation import run_simulation
from flexapod.commissioning.feedforward.command_table import axis_names
from flexapod.commissioning.feedforward.loaded_path import DriveLimits
from flexapod.commissioning.feedforward.minimax import MORE, WITHIN, least_time_by_secants, minimax
from flexapod.commissioning.feedforward.modal_path import LinearPath, inertial_loads, linear_path, step_instants
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError
from flexapod.kinematics import Law
from flexapod.model import CsvMotion, Study
from flexapod.solve.time.modal_march import STAGES, modal_march

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

ROWS = 48  # of the table of the way: cubic acceleration between them
LOOKS = 4  # instants between two rows at which limits hold
POSES = 13  # along the way, at which matrices are made
ROUNDS = 4  # in which limits follow the way
HOPELESS = 1.1  # of a limit
FINE = 5e-3  # of the time
LONGEST, SHORTEST = 1e4, 1e-6  # s
FAR = 20.0  # how much longer than that of rigid drives a way is given up
HELD = 2e-2  # of the time in which flexible drives hold
SHARE = 0.9  # of the bound for vibration that the way is made for: linear in its places


class StraightLine:
    """A way from pose to pose: its law, drives along it, what it makes the robot do."""

    origin: Study
    limits: DriveLimits
    first_pose: Array
    change: Array

    def __init__(self, study: Study, limits: DriveLimits, first: Array, last: Array) -> None:
        from scipy.interpolate import BSpline

        self.origin, self.limits, self.first_pose, self.change = study, limits, first, last - first
        self.axes: Mask = kinematics.commanded_axes(study.robot, study.motion)
        knots = np.concatenate([[0.0] * 3, np.linspace(0.0, 1.0, ROWS + 1), [1.0] * 3])
        bend = BSpline(knots, np.eye(ROWS + 3)[:, 1:-1], 3)  # (T22.18)  accelerations are 0 at both ends
        self.bases: tuple[BSpline, BSpline, BSpline] = bend.antiderivative(2), bend.antiderivative(1), bend
        self.looks: Array = np.linspace(0.0, 1.0, LOOKS * ROWS + 1)

    def law(self, c: Array, T: float, tau: Array) -> Law:
        """Share of the way at instants tau T, with rates, (any,)."""
        s, v, a = (basis(tau) @ c for basis in self.bases)
        return Law(s, v / T, a / T**2)

    def poses(self, share: Law, t: Array) -> kinematics.Poses:
        """Poses of the rigid robot at shares of the way."""
        law = Law(*(np.multiply.outer(part, self.change) for part in share))
        law = Law(law.position + self.first_pose, law.rate, law.acceleration)
        return kinematics.poses_of_law(self.origin.robot, self.origin.motion, law, t)

    def shares(self, share: Law, t: Array) -> tuple[Array, Array]:
        """Shares of the drives' limits that a law uses, as `DriveLimits.shares` returns them."""
        return self.limits.shares(RigidPath(self.origin, t, self.poses(share, t)))

    def largest_share(self, T: float, c: Array) -> float:
        """Largest share of the limits."""
        found = self.shares(self.law(c, T, self.looks), T * self.looks)
        return float(max(np.abs(x).max() for x in found))

    def motion_study(self, T: float, c: Array) -> Study:
        """The study that goes this way."""
        time = np.linspace(0.0, T, ROWS + 1)
        pose = self.first_pose + np.multiply.outer(self.law(c, T, time / T).position, self.change)
        own = self.origin.motion
        pose = np.where(self.axes, pose, 0.0)
        motion = CsvMotion(time=time, pose=pose, hold=own.hold, pivot=own.pivot, independent=axis_names(self.axes))
        simulation = self.origin.simulation.replace(duration=None)
        return self.origin.replace(motion=motion, simulation=simulation)

    def quintic_coefficients(self) -> Array:
        """Coefficients of a quintic way, to start from."""
        tau = np.linspace(0.0, 1.0, 4 * ROWS)
        wanted = 60 * tau * (1 - tau) * (1 - 2 * tau)
        return np.linalg.lstsq(self.bases[2](tau), wanted, rcond=None)[0]

    def limit_rows(self, T: float, c: Array) -> tuple[Array, Array]:
        """G (k, T, n), g (k, T) of the drives' shares |G c + g| of their limits, linear about a way, Eq. (T22.17)."""
        now, t = self.law(c, T, self.looks), T * self.looks
        _, strong = self.shares(now, t)
        more, none = now._replace(acceleration=now.acceleration + 1 / T**2), np.zeros_like(now.rate)
        slope = self.shares(more, t)[1] - strong  # by s'', linear but for friction
        rest = strong - slope * T**2 * now.acceleration[:, None]
        fast = np.abs(self.shares(Law(now.position, none + 1 / T, none), t)[0]).max(axis=1)
        bend = self.bases[2](self.looks)
        G = [fast[:, None] * self.bases[1](self.looks), *(part[:, None] * bend for part in slope.T)]
        return np.stack(G), np.stack([none, *rest.T])

    def way_within_limits(self, T: float, c: Array) -> tuple[Array, float]:
        """Coefficients that use least of the limits in a time, from others, and the largest share that they use."""
        used = np.inf
        for _ in range(ROUNDS):
            c, expected = self._coefficients(T, c)
            used = self.largest_share(T, c)
            if used <= WITHIN * expected:
                break
        return c, used

    def _coefficients(
        self, T: float, c: Array, effect: tuple[Array, Array] | None = None, bound: float = 1.0
    ) -> tuple[Array, float]:
        ends = np.stack([self.bases[1](1.0), self.bases[0](1.0)]), np.array([0.0, 1.0])
        quiet = None if effect is None else (effect[0] / bound, effect[1] / bound)
        return minimax(*self.limit_rows(T, c), ends, c, quiet)

    def least_time_within_limits(self) -> tuple[float, Array]:
        """The least time and its way, whatever vibrates."""
        c = self.quintic_coefficients()
        if self.largest_share(LONGEST, c) > 1.0:
            raise ComputationError(
                "no time is enough: at rest on the way drives are beyond their limits already",
                next_step="Raise the limits, or take weight off.",
            )
        T = 0.1
        while (used := self.largest_share(T, c)) > MORE or used < 1 / MORE:
            T *= min(10.0, max(0.1, used**0.5))
            if T > LONGEST or T < SHORTEST:
                break
        best = least_time_by_secants(self.way_within_limits, T, c, low=0.0, fine=FINE, most=LONGEST)
        return best[:2] if best is not None else (LONGEST, c)

    @cached_property
    def model(self) -> LinearPath:
        """The linear model along the way, with shares of it in place of instants."""
        s = np.linspace(0.0, 1.0, POSES)
        return linear_path(self.origin, s, self.poses(Law(s, np.zeros(POSES), np.zeros(POSES)), s))

    @property
    def lowest_frequency(self) -> float:
        """Lowest frequency along the way [Hz]."""
        return float(np.nanmin(self.model.modes.frequency[:, 0]))

    @cached_property
    def _series(self) -> tuple[CubicSpline, CubicSpline]:
        """Matrices and inertial loads (3, d) by share: by its second derivative, its rate and the square of that."""
        from scipy.interpolate import CubicSpline

        at, none = self.model, np.zeros(POSES)

        def load(rate: float, bend: float) -> Array:
            f = inertial_loads(at, self.poses(Law(at.time, none + rate, none + bend), at.time))
            return -np.einsum("tnd,tn->td", at.flat, f)

        ahead, back = load(1.0, 0.0), load(-1.0, 0.0)
        loads = np.stack([load(0.0, 1.0), 0.5 * (ahead - back), 0.5 * (ahead + back)], axis=1)
        return CubicSpline(at.time, np.stack([at.M, at.D, at.K], axis=1)), CubicSpline(at.time, loads)

    @cached_property
    def _last_modes(self) -> tuple[Array, Array, Array]:
        """Angular frequencies, sizes at the tool and rows of motions of all modes at the last pose."""
        from scipy.linalg import eigh

        at = self.model
        squares, shapes = eigh(at.K[-1], at.M[-1])
        return np.sqrt(np.abs(squares)), np.linalg.norm(at.tool[-1] @ shapes, axis=0), shapes.T @ at.M[-1]

    def residual_amplitudes(self, T: float, c: Array) -> tuple[Array, Array]:
        """Amplitudes at the tool (modes, any) [m] left by each coefficient, and by rates, at the end, Eq. (T22.19)."""
        at, (matrices, loads) = self.model, self._series
        edges = step_instants(at, T)
        now = self.law(c, T, np.add.outer(edges[:-1], edges[1] * STAGES) / T)
        bend, rate, square = np.moveaxis(loads(now.position), 2, 0)
        by = self.bases[2](np.add.outer(edges[:-1], edges[1] * STAGES) / T) / T**2
        rest = rate * now.rate[..., None] + square * now.rate[..., None] ** 2
        force = np.concatenate([bend[..., None] * by[:, :, None], rest[..., None]], axis=3)
        t = np.linspace(0.0, T, POSES)
        M, D, K = np.moveaxis(matrices(self.law(c, T, t / T).position), 1, 0)
        z, v = modal_march(at.locked.system.kernel, t, (M, D, K), force)[-1]
        w, size, to = self._last_modes
        found = size[:, None] * (to @ z + 1j * (to @ v) / w[:, None])
        return found[:, :-1], found[:, -1]

    def way_within_vibration(self, T: float, c: Array, bound: float) -> tuple[Array, float]:
        """A way as of `way_within_limits` with so much vibration left; its share is beyond all where it leaves more."""
        effect, used, quiet = self.residual_amplitudes(T, c), np.inf, False
        for _ in range(ROUNDS):
            c, expected = self._coefficients(T, c, effect, SHARE * bound)
            effect, used = self.residual_amplitudes(T, c), self.largest_share(T, c)
            quiet = np.abs(effect[0] @ c + effect[1]).sum() <= bound
            if used > HOPELESS or (quiet and used <= WITHIN * expected):
                return c, used
        return c, used if quiet else max(used, HOPELESS)

    def least_time_within_vibration(self, low: float, c: Array, bound: float) -> tuple[float, Array]:
        """The least time and its way with at most so much vibration left."""
        best = least_time_by_secants(
            lambda T, c: self.way_within_vibration(T, c, bound), low, c, low=(1 - FINE) * low, fine=FINE, most=LONGEST
        )
        if best is None:
            raise ComputationError("no time is enough for so little vibration", next_step="Allow more (residual).")
        return best[:2]

    def simulated_load_share(self, T: float, c: Array) -> float:
        """Largest share of the limits of forces and torques in the march of the flexible robot; 0 without such."""
        robot = self.origin.robot
        if not self.limits.bounds_forces(robot):
            return 0.0
        found = run_simulation(self.motion_study(T, c))
        if found.record.failure is not None:
            raise ComputationError(f"the way cannot be marched through: {found.record.failure}")
        forces, path = drive_forces(robot, found.march.system, found.record), found.path.at(found.record.time)
        most = replace(self.limits, speed=None, acceleration=None)
        used = [most.shares(path, forces)[1]]
        for i, leg in enumerate(robot.legs):
            if leg.screw is not None and leg.gives and (torque := leg.screw.limits.torque) is not None:
                given = found.values()["drive_force"][:, [i]]  # of a rotor that has its own accelerations
                used.append(given / leg.screw.rotor.ratio / torque)
        return float(max(np.abs(x).max() for x in used))

    def least_time_of_flexible_drives(self, T: float, c: Array, bound: float) -> tuple[float, Array, float]:
        """The least time, not below another one, in which flexible drives keep limits, its way and their share."""
        shares = {T: self.simulated_load_share(T, c)}

        def evaluate(later: float, c: Array) -> tuple[Array, float]:
            if later == T:
                return c, shares[T]
            found, used = self.way_within_vibration(later, c, bound)
            shares[later] = self.simulated_load_share(later, found) if used <= WITHIN else used
            return found, max(used, shares[later])

        best = least_time_by_secants(evaluate, T, c, low=(1 - HELD) * T, fine=HELD, most=FAR * T)
        if best is None:
            raise ComputationError(
                f"drives of the flexible robot use {100 * min(shares.values()):.0f} % of their limits in "
                f"{max(shares):.3g} s as well",
                next_step="Raise the limits, or take weight off.",
            )
        return best[0], best[1], shares[best[0]]
