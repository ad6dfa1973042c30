"""Undamped and damped modes of the locked robot about its static equilibrium, Eqs. (T7.2)-(T7.5), (T7.16)-(T7.17)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, columns, leg_parameters
from flexapod.mechanics.shapes.beam_functions import check_finite
from flexapod.solve.batch import RestMatrices
from flexapod.solve.modal.eigenproblem import (
    OSCILLATES,
    count_real,
    damping_ratios,
    damping_ratios_of,
    mass_factor,
    natural_modes,
)
from flexapod.solve.modal.modal_loops import ModalLoops, growth_rate, loops_in_modes
from flexapod.solve.statics.equilibrium import Equilibrium
from flexapod.solve.statics.locked_robot import LockedPoses, single_equilibrium
from flexapod.solve.statics.reduction import Motions, hub_motion
from flexapod.solve.system import System


@dataclass(frozen=True, kw_only=True)
class RobotModes:
    """Modes about an equilibrium, ascending.

    ``frequency`` (m,) [Hz] undamped; ``shapes`` (m, N), mass-normalised, in the flat coordinates of `system.System`
    (legs, then CoM in the world frame and rotation in platform axes); ``m``: matrices at the equilibrium, of one pose;
    ``ratio``: finds their damping ratios; ``growth``: rate at which the fastest of them grows, if any does [1/s].
    """

    frequency: Array
    shapes: Array
    equilibrium: Equilibrium
    system: System
    m: RestMatrices
    ratio: Callable[[], Array]
    growth: float = 0.0

    @cached_property
    def damping_ratio(self) -> Array:
        """Damping ratios of the damped modes, (m,); from an eigenproblem of twice the size, solved on demand."""
        return self.ratio()


@dataclass(frozen=True, kw_only=True)
class ManyModes:
    """Modes about the equilibria found in `LockedPoses`, p of them, ascending; NaN where masses are not `positive`.

    ``frequency`` (p, m) [Hz], NaN last for what has no mass; ``positive`` (p,); ``shapes`` (p, m, N) as in
    `RobotModes`, empty unless asked for; ``ratio``, ``ratio_of``: find damping ratios, (m,) of the k-th equilibrium and
    (p,) of a mode, NaN without shapes;
    ``growth`` (p,): rate at which the fastest of them grows [1/s], None of robots without loops that can.
    """

    frequency: Array
    positive: Mask
    shapes: Array
    ratio: Callable[[int], Array]
    ratio_of: Callable[[int], Array]
    growth: Array | None = None

    @cached_property
    def damping_ratio(self) -> Array:
        """Damping ratios of the damped modes, (p, m)."""
        return np.array([self.ratio(k) for k in range(len(self.frequency))]).reshape(self.frequency.shape)

    def one(self, locked: LockedPoses, k: int, count: int | None = None) -> RobotModes:
        """The first modes, all if no ``count`` is given, at the k-th equilibrium; ``self`` with shapes."""
        return RobotModes(
            frequency=self.frequency[k, :count],
            shapes=self.shapes[k, :count],
            equilibrium=locked.equilibria.one(int(locked.at[k])),
            system=locked.system,
            m=locked.equilibria.m[np.array([k])],
            ratio=lambda: self.ratio(k)[:count],
            growth=0.0 if self.growth is None else float(self.growth[k]),
        )


@dataclass(frozen=True, kw_only=True)
class UnitModes:
    """Undamped modes about the equilibria found in `LockedPoses`, p of them, ascending, what has no mass last.

    ``omega`` (p, m) [rad/s], inf of what has no mass, NaN where masses are not ``positive``; ``flat`` (p, N, m): shapes
    of unit stiffness in flat coordinates, or none of them.
    """

    omega: Array
    flat: Array
    positive: Mask


def single_pose_modes(locked: LockedPoses, *, loops: bool = True) -> RobotModes:
    """Modes at a single pose; raises as `robot_modes`. ``loops``: as of `modes_of`."""
    found, m = single_equilibrium(locked), locked.m
    check_finite(m.M, m.K, m.D, m.payload_M, m.payload_K)
    modes = modes_of(locked, shapes=True, loops=loops)
    if not modes.positive[0]:
        raise no_mass(locked.system, found.state.q)
    return modes.one(locked, 0, count_real(modes.frequency))


def no_mass(system: System, q: Array) -> ComputationError:
    """Why the masses at coordinates (legs, n) are those of no body."""
    at = (columns(LEG_PARAMETERS, name) for name in ("mouth", "Lp"))
    mouth, whole = (system.leg_p[:, part][:, 0] for part in at)
    short = q[:, system.kernel.shapes.l_index] - mouth > whole * (1 + 1e-9)
    what, next_step = (
        "a leg bends so far under its load that shapes of small slopes no longer describe its motion",
        "Reduce the load or the weight across the legs, make them stiffer, or take fewer shapes (simulation.modes).",
    )
    if (light := _turns_for_nothing(system)).any():
        what = f"the cylinder of leg {int(light.argmax()) + 1} has no mass, and turns in its guide beside its piston"
        next_step = "Give leg.cylinder a mass and an inertia."
    elif short.any():
        what = f"the piston of leg {int(short.argmax()) + 1} is shorter than what the leg has outside the cylinder"
        next_step = "Give leg.piston.length at least the largest leg length less leg.cylinder.mouth."
    return ComputationError(f"the mass matrix is not positive: {what}", next_step=next_step)


def _turns_for_nothing(system: System) -> Mask:
    """Legs (n,) whose cylinder has no inertia about its joint, and a piston that only bushings take along."""
    if system.kernel.shapes.beam.guide is None:
        return np.zeros(system.legs, dtype=bool)
    layout = leg_parameters(system.kernel.shapes)
    names = ("cylinder_mass", "cylinder_com", "cylinder_inertia", "guide_stiffness")
    mass, com, inertia, guide = (system.leg_p[:, columns(layout, name)] for name in names)
    return np.asarray((guide > 0).all(axis=1) & ((inertia + mass * com**2)[:, 0] == 0))


def modes_of(locked: LockedPoses, *, shapes: bool = False, loops: bool = True) -> ManyModes:
    """Modes at all equilibria, Eq. (T7.3), on the admissible motions (T7.16), by (T7.21); ``shapes`` on demand.

    Without ``loops``, those that are not symmetric are springs and dampers on their rotors.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes: nothing can move.
    """
    if loops and locked.system.kernel.shapes.has("j"):
        return _looping(locked)
    found = unit_modes(locked, shapes=shapes)
    omega, flat = found.omega, found.flat
    frequency = np.where(np.isfinite(omega), omega / (2 * np.pi), np.nan)
    if not shapes:
        nothing, unknown = np.zeros((0, omega.shape[1])), np.full(omega.shape, np.nan)
        return ManyModes(
            frequency=frequency, positive=found.positive, shapes=nothing, ratio=unknown.__getitem__,
            ratio_of=unknown.T.__getitem__,
        )  # fmt: skip
    damping = modal_damping(locked, flat)
    check_finite(damping[found.positive])

    def ratio(k: int) -> Array:
        found = omega[k] if np.isnan(omega[k]).any() else damping_ratios(omega[k], damping[k])
        return np.where(np.isfinite(frequency[k]), found, np.nan)

    def ratio_of(mode: int) -> Array:
        whole = np.isfinite(frequency[:, mode])
        ratios = np.full(len(omega), np.nan)
        ratios[whole] = damping_ratios_of(mode, omega[whole], damping[whole])
        return ratios

    shapes_of_mass = (flat * (2 * np.pi * frequency)[:, None]).swapaxes(1, 2)
    return ManyModes(
        frequency=frequency, positive=found.positive, shapes=shapes_of_mass, ratio=ratio, ratio_of=ratio_of
    )


def _looping(locked: LockedPoses) -> ManyModes:
    """Modes of robots whose loops are not symmetric: the oscillating eigenvalues, Eq. (T23.60)."""
    found, loops = unit_modes(locked, shapes=True), loops_of(locked)
    damping, (p, r) = modal_damping(locked, found.flat), found.omega.shape
    size = 0 if not p else r + loops[0].lag.size
    frequency, ratio = np.full((2, p, size), np.nan)
    flat, rates = np.zeros((p, size, locked.system.size)), np.zeros(p)
    for k in np.flatnonzero(found.positive):
        values, z = loops[k].eigenpairs(found.omega[k], damping[k])
        rates[k] = growth_rate(values)
        chosen = np.flatnonzero(values.imag > OSCILLATES * np.abs(values))
        chosen = chosen[np.argsort(np.abs(values[chosen]))]
        values, z = values[chosen], z[:, chosen]
        n, rate = values.size, np.abs(values)
        frequency[k, :n], ratio[k, :n] = rate / (2 * np.pi), -values.real / rate
        slow = z / found.omega[k][:, None]  # as large as it is, of unit mass
        z = (z * np.exp(-0.5j * np.angle((slow**2).sum(axis=0)))).real
        mass = np.sqrt(((z / found.omega[k][:, None]) ** 2).sum(axis=0))
        flat[k, :n] = (found.flat[k] @ (z / mass)).T
    return ManyModes(
        frequency=frequency, positive=found.positive, shapes=flat, ratio=ratio.__getitem__,
        ratio_of=ratio.T.__getitem__, growth=rates,
    )  # fmt: skip


def loops_of(locked: LockedPoses) -> list[ModalLoops]:
    """Loops that are not symmetric in the modes of `unit_modes` at each equilibrium; none of them of other robots."""
    if not locked.system.kernel.shapes.has("j"):
        return []
    found = unit_modes(locked, shapes=True)
    return loops_in_modes(locked.robot, locked.vibration_model.system, locked.equilibria.states[locked.at], found.flat)


def unit_modes(locked: LockedPoses, *, shapes: bool) -> UnitModes:
    """All undamped modes of unit stiffness; raises as `modes_of`."""
    locked = locked.vibration_model
    system, m, motions = locked.system, locked.m, locked.motions
    K = motions.stiffness(system, m)
    U, positive = mass_on_motions(system, motions, m)
    if not K.shape[-1]:
        raise InputError(
            "leaves nothing that could vibrate with the drives locked",
            key="simulation.fidelity",
            value=locked.simulation.fidelity,
            allowed=("" if system.kernel.shapes.beam.axial.count else "lumped, ")
            + "finite-segment, assumed-modes, beam-fem, solid-fem",
        )
    omega, z, stable = natural_modes(U, K, shapes=shapes)
    positive = positive & stable
    omega = np.where(positive[:, None], omega, np.nan)
    flat = motions.flat(system, z) if shapes else np.zeros((len(omega), system.size, 0))
    return UnitModes(omega=omega, flat=flat, positive=positive)


def mass_on_motions(system: System, motions: Motions, m: RestMatrices) -> tuple[Array, Mask]:
    """Factor U (p, size, d) of the mass matrix on independent motions, body by body, and where it is positive."""
    p, legs, n, _ = m.M.shape
    size = motions.columns.size
    motion = motions.flat(system, np.broadcast_to(np.eye(size), (p, size, size)))
    still = (
        system.held[:, :, None] | system.held[:, None, :]
    )  # masses of what does not move: indefinite where legs bend far
    carried = system.kernel.shapes.has("f")
    of_legs, real = mass_factor(np.where(still, np.eye(n), m.M), carried=carried)
    payload, real_payload = mass_factor(m.payload_M)
    moving = (of_legs @ motion[:, : legs * n].reshape(p, legs, n, size)).reshape(p, legs * n, size)
    U = np.concatenate([moving, payload @ hub_motion(system, motion)], axis=1)
    positive = real.all(axis=1) & real_payload & ~_turns_for_nothing(system).any()
    return np.where(positive[:, None, None], U, 0.0), positive


def modal_damping(locked: LockedPoses, flat: Array) -> Array:
    """Damping matrices (p, m, m) of shapes (p, N, m)."""
    locked = locked.vibration_model
    p, legs, n, _ = locked.m.D.shape
    moving = flat[:, : legs * n].reshape(p, legs, n, flat.shape[2])
    return np.asarray((moving.swapaxes(-1, -2) @ locked.m.D @ moving).sum(axis=1))
