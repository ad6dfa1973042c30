"""The linear model of a robot about its static equilibrium: what moves the tool, and how much, (T18.1)-(T18.5)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.arrays import Array
from flexapod.errors import InputError
from flexapod.solve.batch import RestStates
from flexapod.solve.linear.gravity import gravity_forces
from flexapod.solve.modal.damped import poles
from flexapod.solve.modal.modal_loops import ModalLoops, growth, unstable_words
from flexapod.solve.modal.modes import loops_of, modal_damping, no_mass, unit_modes
from flexapod.solve.statics.drive_forces import push_ports
from flexapod.solve.statics.locked import LockedPoses, the_equilibrium
from flexapod.solve.statics.stiffness import tool_motion

__all__ = ["LinearRobot", "linear_robot"]

FAR = 5.0

Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class LinearRobot:
    """A robot in r undamped modes of unit stiffness, Eq. (T18.1).

    ``omega`` (r,) [rad/s], inf of what has no mass; ``damping`` (r, r) [s]; ``tool`` (6, r): displacement and rotation
    of the tool, world axes; ``inputs``: modal forces (r, any) of unit inputs by name: ``floor`` [per m/s^2], ``wrench``
    and ``drive`` [per N, N m]; ``loops``: those that are not symmetric.
    """

    omega: Array
    damping: Array
    tool: Array
    inputs: Mapping[str, Array]
    loops: ModalLoops | None = None

    def poles(self, rate: float) -> Complex:
        """Eigenvalues [1/s] up to a `rate` [rad/s], near enough to tell where responses change, see (T18.11).

        What is `FAR` times as fast and damped little below the rate gives way as at rest: the others' damping to it
        moves a pole by less than its distance from the imaginary axis over `FAR`.
        """
        if self.loops is not None:
            return self.loops.eigen(self.omega, self.damping)[0]
        near = (self.omega <= FAR * rate) | (np.diag(self.damping) * rate >= 1.0 / FAR)
        if not near.any():
            return np.zeros(0, dtype=complex)
        return poles(self.omega[near], self.damping[np.ix_(near, near)])

    def amplitudes(self, frequency: Array, forces: Array) -> Complex:
        """Modes (f, r, any) at frequencies (f,) [Hz] under modal forces (r, any), Eq. (T18.2)."""
        s = 2j * np.pi * frequency[:, None]
        dynamic = s[..., None] * self.damping
        each = np.arange(self.omega.size)
        dynamic[:, each, each] += 1.0 + (s / self.omega) ** 2
        if self.loops is not None:
            dynamic = dynamic + self.loops.dynamic(s[:, 0])
        given = np.broadcast_to(forces.astype(complex), (len(s), *forces.shape))
        return np.asarray(np.linalg.solve(dynamic, given), dtype=np.complex128)


def linear_robot(locked: LockedPoses) -> LinearRobot:
    """The linear model at a single pose.

    Raises
    ------
    InputError
        Nothing can move, or loops are unstable.
    ComputationError
        No equilibrium at this pose, or masses that no body can have.
    """
    system, at = locked.system, the_equilibrium(locked)
    found = unit_modes(locked, shapes=True)
    if not found.positive[0]:
        raise no_mass(system, at.state.q)
    flat = found.flat[0]
    hub = flat[system.legs * system.n :]
    tool = tool_motion(locked.robot, RestStates.of(at.state).pose)[0] @ hub
    inputs = {
        "floor": flat.T @ floor_forces(locked),
        "wrench": tool.T,
        "drive": flat.T @ _drive_forces(locked),
    }
    damping, loops = modal_damping(locked, found.flat)[0], [*loops_of(locked), None]
    model = LinearRobot(omega=found.omega[0], damping=damping, tool=tool, inputs=inputs, loops=loops[0])
    if model.loops is not None and (words := unstable_words(growth(model.poles(np.inf)))):
        raise InputError(words[0], key="leg.drive.loop", allowed="loops whose deviations decay")
    return model


def floor_forces(locked: LockedPoses) -> Array:
    """Forces (N, 3) on all coordinates per unit acceleration of the base along x, y, z, Eq. (T18.4)."""
    x, command = locked.equilibria.states[locked.at], locked.command[locked.at]
    return gravity_forces(locked.system, x, command, locked.acts.wrench)[0]


def _drive_forces(locked: LockedPoses) -> Array:
    """Forces (N, legs) on all coordinates per unit force of each drive, Eq. (T18.5); of passive legs zero."""
    system = locked.system
    found = np.zeros((system.size, system.legs))
    for i, at in enumerate(push_ports(system, locked.robot)):
        if at >= 0:
            found[i * system.n + at, i] = 1.0
    return found
