"""The linear model of a robot about its static equilibrium: what moves the tool, and how much, (T18.1)-(T18.5)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.solve.linear.channels import asked
from flexapod.solve.linear.plant import plant_at_rest
from flexapod.solve.linear.second_order import input_forces
from flexapod.solve.modal.damped import poles
from flexapod.solve.modal.modal_loops import ModalLoops, growth, unstable_words
from flexapod.solve.modal.modes import loops_of, modal_damping, no_mass, unit_modes
from flexapod.solve.statics.locked_robot import LockedPoses, the_equilibrium

__all__ = ["LinearRobot", "linear_robot"]

FAR = 5.0

Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class LinearRobot:
    """A robot in r undamped modes of unit stiffness, Eq. (T18.1); what inputs push is that of the state space.

    Spectra are shared out among modes, and their integral takes up to seven times as long by a state space.

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
    at, found = the_equilibrium(locked), unit_modes(locked, shapes=True)
    if not found.positive[0]:
        raise no_mass(locked.system, at.state.q)
    damping, loops = modal_damping(locked, found.flat)[0], [*loops_of(locked), None]
    inputs = _inputs(locked, found.flat[0])
    model = LinearRobot(omega=found.omega[0], damping=damping, tool=inputs["wrench"].T, inputs=inputs, loops=loops[0])
    if model.loops is not None and (words := unstable_words(growth(model.poles(np.inf)))):
        raise InputError(words[0], key="leg.drive.loop", allowed="loops whose deviations decay")
    return model


def _inputs(locked: LockedPoses, flat: Array) -> dict[str, Array]:
    """Modal forces of unit inputs of shapes (N, r): accelerations of the floor, wrench, forces of all drives."""
    plant, robot = plant_at_rest(locked), locked.robot
    groups = {name: asked(name, robot, "inputs") for name in ("floor", "wrench", "drive")}
    groups["floor"] = groups["floor"][:3]
    every = [channel for group in groups.values() for channel in group]
    forces = flat.T @ input_forces(plant, every, np.zeros(3))[0]
    parts = np.split(forces, np.cumsum([len(group) for group in groups.values()])[:-1], axis=1)
    found = dict(zip(groups, parts, strict=True))
    drive = np.zeros((len(forces), robot.count))  # of passive legs zero
    drive[:, [channel.leg for channel in groups["drive"]]] = found["drive"]
    return found | {"drive": drive}
