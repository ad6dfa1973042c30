"""A single planar actuator in time: the same leg without payload, Eqs. (T9.1)-(T9.4)."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from flexapod import rigid
from flexapod.errors import ComputationError
from flexapod.integration import GeneralizedAlpha
from flexapod.model import Actuator, ActuatorStudy, Simulation
from flexapod.solve.kernel import kernel
from flexapod.solve.march import Chunk, Problem, initial_step, march
from flexapod.solve.parameters import actuator_parameters
from flexapod.solve.recording import Counters, Recording
from flexapod.solve.robot_march import after_impact
from flexapod.solve.shapes import beam_shapes, planar_shapes
from flexapod.solve.start import consistent_start
from flexapod.solve.stops import Stops
from flexapod.solve.system import COLUMNS, Flow, State, System
from flexapod.solve.tables import Law
from flexapod.typing import Array

SHORT = 0.1  # of the beam: its frequencies are then a hundred times those of the whole


class _NotInHub(ComputationError):
    """The beam has slid wholly into its hub or out of it."""


@dataclass(frozen=True, kw_only=True)
class ActuatorMarch:
    """A prepared time integration of an actuator study; coordinates (beta, l, a_1..a_k), l from the pivot."""

    system: System
    start: Flow
    step: float
    chunks: Iterator[Chunk]
    counters: Counters = field(default_factory=Counters)


def actuator_system(
    actuator: Actuator, simulation: Simulation, *, rotation: bool = True, extension: bool = True
) -> System:
    """Equations of the planar actuator; ``rotation`` and ``extension`` say whether they are prescribed."""
    functions = kernel(planar_shapes(beam_shapes(actuator, simulation)))
    held = np.zeros((1, functions.shapes.size), dtype=bool)
    held[0, functions.shapes.l_index], held[0, functions.shapes.index("beta")] = extension, rotation
    none = np.zeros(0)
    return System(kernel=functions, leg_p=actuator_parameters(actuator), joint_p=none[None], payload_p=none, held=held)


def prepare_actuator(
    study: ActuatorStudy, amplitudes: Array | None = None, rates: Array | None = None
) -> ActuatorMarch:
    """Start and time integration of an actuator study.

    Parameters
    ----------
    study : ActuatorStudy
    amplitudes, rates : (k,) arrays, optional
        Initial modal amplitudes [m] and rates [m/s] in place of the static shape with ``initial.tip_displacement``.

    Raises
    ------
    ComputationError
        While iterating: the beam has slid wholly into the hub or out of it.
    """
    simulation, method = study.simulation, GeneralizedAlpha(study.simulation.rho_inf)
    system = actuator_system(
        study.actuator,
        simulation,
        rotation=study.motion.rotation is not None,
        extension=study.motion.extension is not None,
    )
    law = _tables(study)
    h = initial_step(simulation.step, simulation.output_step)
    output_step, outputs = simulation.stored_step, simulation.outputs(study.duration)
    state, counters = _state(study, system, law, amplitudes, rates), Counters()
    start, _ = consistent_start(system, state, law, 0.0, method, h)
    problem = Problem(
        system=system,
        method=method,
        tables=law,
        output_step=output_step,
        outputs=outputs,
        measure=lambda recording: _measure(system, recording),
        restart=lambda flow, t, h: after_impact(system, flow, law, t, method, h),
        stops=Stops.of(rigid.actuator_breaks(study), output_step, simulation.step, outputs),
        check=lambda recording: _check(study.actuator, recording),
        tolerance=simulation.tolerance,
    )
    chunks = march(problem, start, h, counters)
    if study.motion.extension is None:
        chunks = _retracting(study.actuator, chunks)
    return ActuatorMarch(system=system, start=start, step=h, chunks=chunks, counters=counters)


def _retracting(actuator: Actuator, chunks: Iterator[Chunk]) -> Iterator[Chunk]:
    """The chunks; where they fail because next to nothing of the beam is left outside, that is what is said."""
    now, free, rate = 0.0, actuator.free_length, 0.0
    try:
        for chunk in chunks:
            last = chunk.recording
            now, free, rate = float(last.time[-1]), float(last.q[-1, 0, 1]) - actuator.hub_radius, float(last.v[-1, 1])
            yield chunk
    except _NotInHub:
        raise
    except ComputationError as error:
        if not (rate < 0 and free < SHORT * actuator.length):
            raise
        raise ComputationError(
            f"the beam has slid into its hub: {1e3 * free:.3g} mm of it are left outside at t = {now:.6g} s, and "
            f"{-rate:.3g} m/s more go in. So short a beam vibrates faster than steps can follow",
            next_step="Shorten the simulation, or check the axial force.",
        ) from error


def static_shape(system: System, displacement: float) -> Array:
    """Amplitudes (k,) of the static shape under a tip force, scaled to a tip displacement [m], Eq. (T9.3)."""
    basis = system.kernel.shapes.a
    if not basis.count:
        return np.zeros(0)
    shape = np.linalg.solve(basis.stiffness, basis.tip)
    return displacement * shape / (basis.tip @ shape)


def _tables(study: ActuatorStudy) -> Law:
    """Table of the one leg, whose ports are l and beta, and no wrench."""
    actuator, motion, load = study.actuator, study.motion, study.load
    commands = (
        (motion.extension, actuator.hub_radius + actuator.free_length, load.force),
        (motion.rotation, actuator.angle, load.torque),
    )

    def law(t: Array) -> tuple[Array, Array]:
        table = np.zeros((len(t), 1, len(commands), COLUMNS))
        for k, (path, home, push) in enumerate(commands):
            if path is not None:
                x = rigid.motion_law(path, t)
                table[:, 0, k, :3] = np.stack([x.position + home, x.rate, x.acceleration], axis=-1)
            if push is not None:
                table[:, 0, k, 3] = rigid.load_law(push, t)
        return table, np.zeros((len(t), 6))

    return law


def _state(study: ActuatorStudy, system: System, law: Law, amplitudes: Array | None, rates: Array | None) -> State:
    """Static tip shape at rest in x/L(t), given rates; what is prescribed is where its law begins."""
    q, v, initial = np.zeros((1, system.n)), np.zeros(system.n), study.initial
    q[0, :2] = study.actuator.angle, study.actuator.hub_radius + study.actuator.free_length
    v[:2] = initial.angle_rate, initial.length_rate
    table, held = law(np.zeros(1))[0][0, 0], system.held[0, system.ports]
    for k, at in enumerate(system.ports):
        if held[k]:
            q[0, at], v[at] = table[k, :2]
    q[0, 2:] = static_shape(system, initial.tip_displacement) if amplitudes is None else amplitudes
    v[2:] = 0.0 if rates is None else rates
    none = np.zeros((1, 0))
    return State(q=q, v=v, v_dot=np.zeros(system.n), lam=none, drive=np.zeros((1, 2)), pose=np.zeros(7))


def _measure(system: System, recording: Recording) -> list[Array]:
    """Tip deflection, and angle and length where they are free."""
    groups = [recording.q[:, 0, 2:] @ system.kernel.shapes.a.tip]
    groups += [recording.q[:, 0, j] for j in (0, 1) if not system.held[0, j]]
    return groups


def _check(actuator: Actuator, recording: Recording) -> None:
    free = recording.q[:, 0, 1] - actuator.hub_radius
    most = actuator.length * (1 + 1e-9)  # with a hub radius the free length is a difference
    for bad, words in ((free <= 0, "has slid wholly into the hub"), (free > most, "has left the hub")):
        if bad.any():
            raise _NotInHub(
                f"the beam {words} at t = {recording.time[np.argmax(bad)]:.6g} s",
                next_step="Shorten the simulation, or check the extension law or the axial force.",
            )
