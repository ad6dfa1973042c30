"""A straight way between poses with a free law: use of the drives, and vibration by it, Eqs. (T22.17)-(T22.19)."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from flexapod import kinematics
from flexapod.analysis.results.leg_results import drive_forces
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.simulation import run_simulation
from flexapod.commissioning.feedforward.command_table import axis_names
from flexapod.commissioning.feedforward.loaded_path import DriveLimits
from flexapod.commissioning.feedforward.modal_path import LinearPath, inertial_loads, integrate_modes, linear_path
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError
from flexapod.kinematics import Law
from flexapod.model import CsvMotion, Study

ROWS = 48  # of the table of the way: cubic acceleration between them
LOOKS = 4  # instants between two rows at which limits hold
POSES = 13  # along the way, at which matrices are made
SIDES = 16  # of the polygon in which the amplitude of a mode stays
ROUNDS = 4  # in which limits follow the way
WITHIN, HOPELESS = 1.002, 1.1  # of a limit
FINE = 5e-3  # of the time
LESS, MORE, FAR = 1.05, 1.5, 20.0  # how much longer a way is taken where flexible drives do not hold; given up beyond
HELD = 2e-2  # of the time in which they do
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
        """Matrix G and vector g of the drives' shares |G c + g| of their limits, linear about a way, Eq. (T22.17)."""
        now, t = self.law(c, T, self.looks), T * self.looks
        _, strong = self.shares(now, t)
        more, none = now._replace(acceleration=now.acceleration + 1 / T**2), np.zeros_like(now.rate)
        slope = self.shares(more, t)[1] - strong  # by s'', linear but for friction
        rest = strong - slope * T**2 * now.acceleration[:, None]
        fast = np.abs(self.shares(Law(now.position, none + 1 / T, none), t)[0]).max(axis=1)
        bend = self.bases[2](self.looks)
        G = [fast[:, None] * self.bases[1](self.looks), *(part[:, None] * bend for part in slope.T)]
        return np.concatenate(G), np.concatenate([none, *rest.T])

    def minimax_coefficients(
        self, T: float, c: Array, effect: tuple[Array, Array] | None = None, bound: float = 0.0
    ) -> Array:
        """Coefficients that use least of the limits, with no more vibration than the bound, Eqs. (T22.17), (T22.19)."""
        from scipy.optimize import linprog

        G, g = self.limit_rows(T, c)
        n, m = G.shape[1], 0 if effect is None else len(effect[0])
        ends = np.pad([self.bases[1](1.0), self.bases[0](1.0)], ((0, 0), (0, m + 1)))
        width = ((0, 0), (0, m))
        sides = np.concatenate([np.pad(G, width), np.pad(-G, width)])
        above = [np.column_stack([sides, -np.ones(len(sides))])]
        most = [np.append(-g, g)]
        if effect is not None:
            turn = np.exp(2j * np.pi * np.arange(SIDES) / SIDES) / np.cos(np.pi / SIDES)
            of = np.real(turn[:, None, None] * effect[0]).reshape(-1, n) / bound
            above += [np.column_stack([of, np.tile(-np.eye(m), (SIDES, 1)), np.zeros(SIDES * m)])]
            above += [np.concatenate([np.zeros(n), np.ones(m), [0.0]])[None]]
            most += [-np.real(turn[:, None] * effect[1]).ravel() / bound, np.ones(1)]
        found = linprog(
            np.append(np.zeros(n + m), 1.0), A_ub=np.concatenate(above), b_ub=np.concatenate(most), A_eq=ends,
            b_eq=[0.0, 1.0], bounds=[(None, None)] * n + [(0, None)] * (m + 1), method="highs",
        )  # fmt: skip
        if found.status != 0:
            raise ComputationError(f"the way was not found: {found.message}")
        return found.x[:n]

    def within_limits(self, T: float, c: Array) -> Array | None:
        """A way within the limits in a time, from another one; None where there is none."""
        for _ in range(ROUNDS):
            c = self.minimax_coefficients(T, c)
            if self.largest_share(T, c) <= WITHIN:
                return c
        return None

    def least_time_within_limits(self) -> tuple[float, Array]:
        """The least time and its way, whatever vibrates."""
        c = self.quintic_coefficients()
        high = 0.1
        while self.largest_share(high, c) > 1.0:
            high *= 2
            if high > 1e4:
                raise ComputationError(
                    "no time is enough: at rest on the way drives are beyond their limits already",
                    next_step="Raise the limits, or take weight off.",
                )
        low, best = 0.0, (high, c)
        while high - low > FINE * high:
            T = 0.5 * (low + high)
            found = self.within_limits(T, best[1])
            low, high = (T, high) if found is None else (low, T)
            best = best if found is None else (T, found)
        return best

    @cached_property
    def lowest_frequency(self) -> float:
        """Lowest frequency at both ends [Hz]."""
        return float(np.nanmin(self.linear_model(1.0, self.quintic_coefficients()).modes.frequency[:, 0]))

    def linear_model(self, T: float, c: Array) -> LinearPath:
        """The linear model along a way."""
        t = np.linspace(0.0, T, POSES)
        return linear_path(self.origin, t, self.poses(self.law(c, T, t / T), t))

    def residual_amplitudes(self, T: float, c: Array) -> tuple[Array, Array]:
        """Amplitudes at the tool (modes, any) [m] left by each coefficient, and by rates, at the end, Eq. (T22.19)."""
        at = self.linear_model(T, c)

        def acting(t: Array) -> Array:
            now = self.law(c, T, t / T)
            none = np.zeros_like(now.rate)
            bend = inertial_loads(at, self.poses(Law(now.position, none, none + 1.0), t))
            rate = inertial_loads(at, self.poses(Law(now.position, now.rate, none), t))
            return np.concatenate([bend[..., None] * (self.bases[2](t / T) / T**2)[:, None], rate[..., None]], axis=2)

        z, v = integrate_modes(at, acting)[1][-1]
        return _amplitudes(at, z, v)

    def least_time_within_vibration(self, low: float, c: Array, bound: float) -> tuple[float, Array]:
        """The least time and its way with at most so much vibration left."""
        best = self.within_vibration(low, c, bound)
        if best is not None:
            return low, best
        high, step = low + 0.5 / self.lowest_frequency, 0.5 / self.lowest_frequency
        while (found := self.within_vibration(high, c, bound)) is None:
            low, step = high, 1.5 * step
            high = low + step
            if high > 1e4:
                raise ComputationError("no time is enough for so little vibration", next_step="Allow more (residual).")
        best = (high, found)
        while high - low > FINE * high:
            T = 0.5 * (low + high)
            found = self.within_vibration(T, best[1], bound)
            low, high = (T, high) if found is None else (low, T)
            best = best if found is None else (T, found)
        return best

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
        best = (T, c, self.simulated_load_share(T, c))
        low, high = T, T
        while best[2] > WITHIN:
            low, high = high, high * min(MORE, max(LESS, best[2] ** 0.5))
            if high > FAR * T:
                raise ComputationError(
                    f"drives of the flexible robot use {100 * best[2]:.0f} % of their limits in {high:.3g} s as well",
                    next_step="Raise the limits, or take weight off.",
                )
            found = self.within_vibration(high, best[1], bound)
            best = best if found is None else (high, found, self.simulated_load_share(high, found))
        while high - low > HELD * high:
            between = 0.5 * (low + high)
            found = self.within_vibration(between, best[1], bound)
            used = np.inf if found is None else self.simulated_load_share(between, found)
            low, high = (low, between) if used <= WITHIN else (between, high)
            best = (between, found, used) if found is not None and used <= WITHIN else best
        return best

    def within_vibration(self, T: float, c: Array, bound: float) -> Array | None:
        """A way within limits and bound in a time; None where there is none."""
        effect = self.residual_amplitudes(T, c)
        for _ in range(ROUNDS):
            c = self.minimax_coefficients(T, c, effect, SHARE * bound)
            effect, used = self.residual_amplitudes(T, c), self.largest_share(T, c)
            if used <= WITHIN and np.abs(effect[0] @ c + effect[1]).sum() <= bound:
                return c
            if used > HOPELESS:
                break
        return None


def _amplitudes(at: LinearPath, z: Array, v: Array) -> tuple[Array, Array]:
    """Complex amplitudes at the tool of all modes at the last pose, of motions and rates (d, c); the last apart."""
    from scipy.linalg import eigh

    squares, shapes = eigh(at.K[-1], at.M[-1])
    w = np.sqrt(np.abs(squares))
    size = np.linalg.norm(at.tool[-1] @ shapes, axis=0)
    to = shapes.T @ at.M[-1]
    found = size[:, None] * (to @ z + 1j * (to @ v) / w[:, None])
    return found[:, :-1], found[:, -1]
