"""A single planar actuator in time: the same leg without payload, Eqs. (T9.1)-(T9.4)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from flexapod import rigid
from flexapod.bases.eigen import finite
from flexapod.errors import ComputationError
from flexapod.integration import GeneralizedAlpha
from flexapod.model import Actuator, ActuatorStudy, Simulation
from flexapod.solve.kernel import kernel
from flexapod.solve.march import Chunk, Problem, initial_step, march
from flexapod.solve.parameters import actuator_parameters
from flexapod.solve.plant import TABLE, Counters, Flow, Plant, Recording
from flexapod.solve.shapes import beam_shapes
from flexapod.solve.stops import Stops
from flexapod.typing import Array

Law = Callable[[Array], tuple[Array, Array]]

SHORT = 0.1  # of the beam: its frequencies are then a hundred times those of the whole


class _NotInHub(ComputationError):
    """The beam has slid wholly into its hub or out of it."""


@dataclass(frozen=True, kw_only=True)
class ActuatorMarch:
    """A prepared time integration of an actuator study; coordinates (beta, l, a_1..a_k), l from the pivot."""

    plant: Plant
    start: Flow
    step: float
    chunks: Iterator[Chunk]
    counters: Counters = field(default_factory=Counters)


def actuator_plant(
    actuator: Actuator, simulation: Simulation, *, rotation: bool = True, extension: bool = True
) -> Plant:
    """Plant of the planar actuator; ``rotation`` and ``extension`` say whether they are prescribed."""
    return Plant(
        kernel=kernel(beam_shapes(actuator, simulation), 0, planar=True),
        leg_p=actuator_parameters(actuator),
        payload_p=np.zeros(0),
        held_l=np.array([extension]),
        held_beta=np.array([rotation]),
    )


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
    plant = actuator_plant(
        study.actuator,
        simulation,
        rotation=study.motion.rotation is not None,
        extension=study.motion.extension is not None,
    )
    law = _tables(study)
    h = initial_step(simulation.step, simulation.output_step)
    output_step, outputs = simulation.stored_step, simulation.outputs(study.duration)
    start, counters = _start(study, plant, law, method, h, amplitudes, rates), Counters()
    problem = Problem(
        plant=plant,
        method=method,
        tables=law,
        output_step=output_step,
        outputs=outputs,
        measure=lambda recording: _measure(plant, recording),
        restart=lambda flow, t, h: _after_impact(plant, law, method, flow, t, h),
        stops=Stops.of(rigid.actuator_breaks(study), output_step, simulation.step, outputs),
        check=lambda recording: _check(study.actuator, recording),
        tolerance=simulation.tolerance,
    )
    chunks = march(problem, start, h, counters)
    if study.motion.extension is None:
        chunks = _retracting(study.actuator, chunks)
    return ActuatorMarch(plant=plant, start=start, step=h, chunks=chunks, counters=counters)


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


def static_shape(plant: Plant, displacement: float) -> Array:
    """Amplitudes (k,) of the static shape under a tip force, scaled to a tip displacement [m], Eq. (T9.3)."""
    basis = plant.kernel.shapes.a
    if not basis.count:
        return np.zeros(0)
    shape = np.linalg.solve(basis.stiffness, basis.tip)
    return displacement * shape / (basis.tip @ shape)


def _tables(study: ActuatorStudy) -> Law:
    """Rows (l, l', l'', force, beta, beta', beta'', torque) of the one leg at instants, and no wrench."""
    actuator, motion, load = study.actuator, study.motion, study.load

    def law(t: Array) -> tuple[Array, Array]:
        table = np.zeros((len(t), TABLE))
        if motion.extension is not None:
            x = rigid.motion_law(motion.extension, t)
            table[:, 0], table[:, 1], table[:, 2] = x.position, x.rate, x.acceleration
            table[:, 0] += actuator.hub_radius + actuator.free_length
        if motion.rotation is not None:
            x = rigid.motion_law(motion.rotation, t)
            table[:, 4], table[:, 5], table[:, 6] = x.position + actuator.angle, x.rate, x.acceleration
        if load.force is not None:
            table[:, 3] = rigid.load_law(load.force, t)
        if load.torque is not None:
            table[:, 7] = rigid.load_law(load.torque, t)
        return table, np.zeros((len(t), 6))

    return law


def _start(
    study: ActuatorStudy,
    plant: Plant,
    law: Law,
    method: GeneralizedAlpha,
    h: float,
    amplitudes: Array | None,
    rates: Array | None,
) -> Flow:
    """Static tip shape at rest in x/L(t), given rates, accelerations from the equation of motion, a_0 (T6.13)."""
    q, v = np.zeros((1, plant.n)), np.zeros(plant.n)
    q[0, :2] = study.actuator.angle, study.actuator.hub_radius + study.actuator.free_length
    v[:2] = study.initial.angle_rate, study.initial.length_rate
    row = law(np.zeros(1))[0][0]
    if plant.held_beta[0]:
        q[0, 0], v[0] = row[4], row[5]
    if plant.held_l[0]:
        q[0, 1], v[1] = row[0], row[1]
    q[0, 2:] = static_shape(plant, study.initial.tip_displacement) if amplitudes is None else amplitudes
    v[2:] = 0.0 if rates is None else rates
    zero = np.zeros(plant.n)
    flow = Flow(q=q, v=v, v_dot=zero, a=zero, lam=np.zeros((1, 3)), drive=np.zeros((1, 2)), pose=np.zeros(7))
    return _prepared(plant, law, method, flow, 0.0, h)


def _prepared(plant: Plant, law: Law, method: GeneralizedAlpha, flow: Flow, now: float, h: float) -> Flow:
    """Flow with accelerations, drive forces and the integrator's a for the step h, Eq. (T6.13)."""
    flow = _accelerated(plant, flow, law(np.array([now]))[0][0])
    t = min(1e-3 * h, 1e-6)
    ahead = replace(flow, q=flow.q + t * flow.v + 0.5 * t**2 * flow.v_dot, v=flow.v + t * flow.v_dot)
    jerk = (_accelerated(plant, ahead, law(np.array([now + t]))[0][0]).v_dot - flow.v_dot) / t
    a = np.where(plant.held, flow.v_dot, flow.v_dot + method.delta * h * jerk)
    return replace(flow, a=a)


def _after_impact(plant: Plant, law: Law, method: GeneralizedAlpha, flow: Flow, now: float, h: float) -> Flow:
    """Flow after a jump in a prescribed rate: free rates change by the impulse balance, Eq. (T6.10)."""
    row, p, held = law(np.array([now]))[0][0], plant.leg_p[0], plant.held
    M = plant.kernel.leg_matrices(flow.q[0], np.zeros(3), p)[0]
    finite(M)
    v = flow.v.copy()
    v[:2] = np.where(held[:2], [row[5], row[1]], v[:2])
    v[~held] -= np.linalg.solve(M[np.ix_(~held, ~held)], M[np.ix_(~held, held)] @ (v - flow.v)[held])
    work = 0.5 * (v @ M @ v - flow.v @ M @ flow.v)
    moved = replace(flow, v=v, sums=flow.sums + np.array([0.0, work, 0.0]))
    return _prepared(plant, law, method, moved, now, h)


def _accelerated(plant: Plant, x: Flow, row: Array) -> Flow:
    """Accelerations of the free coordinates and drive force and torque of the held ones, Eq. (T9.4)."""
    v_dot = np.zeros(plant.n)
    if plant.held_beta[0]:
        v_dot[0] = row[6]
    if plant.held_l[0]:
        v_dot[1] = row[2]
    command = np.array([row[0], row[1], row[3], row[7]])
    p, free = plant.leg_p[0], ~plant.held
    r = plant.kernel.leg_residual(x.q[0], x.v, v_dot, np.zeros(3), command, p)[0]
    M = plant.kernel.leg_matrices(x.q[0], np.zeros(3), p)[0]
    finite(M, r)
    v_dot[free] = np.linalg.solve(M[np.ix_(free, free)], -r[free])
    r = plant.kernel.leg_residual(x.q[0], x.v, v_dot, np.zeros(3), command, p)[0]
    drive = np.array([[r[1] if plant.held_l[0] else 0.0, r[0] if plant.held_beta[0] else 0.0]])
    return replace(x, v_dot=v_dot, drive=drive)


def _measure(plant: Plant, recording: Recording) -> list[Array]:
    """Tip deflection, and angle and length where they are free."""
    groups = [recording.q[:, 0, 2:] @ plant.kernel.shapes.a.tip]
    groups += [recording.q[:, 0, j] for j, held in ((0, plant.held_beta[0]), (1, plant.held_l[0])) if not held]
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
