"""A single actuator in time, in its plane or in space: the same leg without payload, Eqs. (T9.1)-(T9.4), (T9.9)."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.mechanics.leg.layout import columns
from flexapod.model import DRIVEN_BY, Actuator, ActuatorStudy, Simulation
from flexapod.solve.kernel import kernel
from flexapod.solve.parameters import SPACE, actuator_parameters
from flexapod.solve.shapes import SPACE_NAMES, actuator_shapes, amplitudes, home, lateral_signs, places
from flexapod.solve.system import COLUMNS, Flow, State, System
from flexapod.solve.time.command_tables import Law
from flexapod.solve.time.march import initial_step, march
from flexapod.solve.time.problem import Chunk, Problem, Weight
from flexapod.solve.time.recording import Counters, Recording
from flexapod.solve.time.robot_march import after_impact
from flexapod.solve.time.start import consistent_start
from flexapod.solve.time.time_events import Stops

SHORT = 0.1  # of the beam: its frequencies are then a hundred times those of the whole


class _NotInHub(ComputationError):
    """The beam has slid wholly into its hub or out of it."""


@dataclass(frozen=True, kw_only=True)
class ActuatorMarch:
    """A prepared time integration of an actuator study; coordinates as `layout.Shapes` has them, l from the pivot."""

    system: System
    start: Flow
    step: float
    chunks: Iterator[Chunk]
    counters: Counters = field(default_factory=Counters)


def actuator_system(
    actuator: Actuator, simulation: Simulation, *, rotation: bool = True, extension: bool = True, elevation: bool = True
) -> System:
    """Equations of an actuator; ``rotation``, ``extension``, ``elevation`` say whether they are prescribed."""
    functions = kernel(actuator_shapes(actuator, simulation))
    given = {"rotation": rotation, "extension": extension, "elevation": elevation}
    held = np.zeros((1, functions.shapes.size), dtype=bool)
    for name, at in places(functions.shapes).items():
        held[0, at] = given[name]
    p, none = actuator_parameters(actuator, functions.shapes), np.zeros(0)
    return System(kernel=functions, leg_p=p, joint_p=none[None], payload_p=none, held=held)


def prepare_actuator(
    study: ActuatorStudy, amplitudes: Array | None = None, rates: Array | None = None
) -> ActuatorMarch:
    """Start and time integration of an actuator study.

    Parameters
    ----------
    study : ActuatorStudy
    amplitudes, rates : arrays, optional
        Initial values [m] and rates [m/s] of all coordinates after those of `places`, in place of the static shape with
        ``initial.tip_displacement``.

    Raises
    ------
    ComputationError
        While iterating: the beam has slid wholly into the hub or out of it.
    """
    simulation, method = study.simulation, GeneralizedAlpha(study.simulation.rho_inf)
    prescribed = {name: getattr(study.motion, name) is not None for name in SPACE_NAMES}
    system = actuator_system(study.actuator, simulation, **prescribed)
    law = _tables(study)
    output_step, outputs = simulation.stored_step, simulation.outputs(study.duration)
    state, counters = _state(study, system, law, amplitudes, rates), Counters()
    far = 0.0 if simulation.tolerance is not None and system.kernel.library else None  # steps end on every row
    problem = Problem(
        system=system,
        method=method,
        tables=law,
        output_step=output_step,
        outputs=outputs,
        measure=lambda recording: _measure(system, study.actuator, recording),
        restart=lambda flow, t, h: after_impact(system, flow, law, t, method, h),
        stops=Stops.from_breaks(kinematics.actuator_breaks(study, far), output_step, simulation.step, outputs),
        check=lambda recording: _check(system, study.actuator, recording),
        tolerance=simulation.tolerance,
        weights=_weights(system, study.actuator),
        knots=np.array([0.0, outputs * output_step]),
    )
    h = initial_step(problem, simulation.step)
    start, _ = consistent_start(system, state, law, 0.0, method, h)
    chunks = march(problem, start, h, counters)
    if study.motion.extension is None:
        chunks = _retracting(system, study.actuator, chunks)
    return ActuatorMarch(system=system, start=start, step=h, chunks=chunks, counters=counters)


def _retracting(system: System, actuator: Actuator, chunks: Iterator[Chunk]) -> Iterator[Chunk]:
    """Chunks of the march; a failure with next to nothing of the beam left outside is reported as such."""
    (now, free, rate), at = (0.0, actuator.free_length, 0.0), system.kernel.shapes.l_index
    try:
        for chunk in chunks:
            last = chunk.recording
            now, free, rate = last.time[-1], last.q[-1, 0, at] - actuator.hub_radius, last.v[-1, at]
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
    basis = system.kernel.shapes.beam.a
    if not basis.count:
        return np.zeros(0)
    shape = np.linalg.solve(basis.stiffness, basis.tip)
    return displacement * shape / (basis.tip @ shape)


def _tables(study: ActuatorStudy) -> Law:
    """Table of the one leg, whose ports are the coordinates of `places`, and the load on its tip."""
    motion, load = study.motion, study.load
    commands = [
        (getattr(motion, name), begin, getattr(load, DRIVEN_BY[name])) for name, begin in home(study.actuator).items()
    ]

    def law(t: Array) -> tuple[Array, Array]:
        table = np.zeros((len(t), 1, len(commands), COLUMNS))
        for k, (path, begin, push) in enumerate(commands):
            if path is not None:
                x = kinematics.motion_law(path, t)
                table[:, 0, k, :3] = np.stack([x.position + begin, x.rate, x.acceleration], axis=-1)
            if push is not None:
                table[:, 0, k, 3] = kinematics.load_law(push, t)
        wrench, none = kinematics.wrench(load, t), np.zeros((len(t), 6))
        if load.follow:
            return table, np.hstack([none, wrench @ np.kron(np.eye(2), SPACE)])
        return table, np.hstack([wrench, none])

    return law


def _state(study: ActuatorStudy, system: System, law: Law, amplitudes: Array | None, rates: Array | None) -> State:
    """Static tip shape at rest in x/L(t), given rates; what is prescribed is where its law begins."""
    q, v, initial = np.zeros((1, system.n)), np.zeros(system.n), study.initial
    shapes, at, begin = system.kernel.shapes, places(system.kernel.shapes), home(study.actuator)
    rates_at = {"rotation": initial.angle_rate, "elevation": initial.elevation_rate, "extension": initial.length_rate}
    for name, i in at.items():
        q[0, i], v[i] = begin[name], rates_at[name]
    table, held = law(np.zeros(1))[0][0, 0], system.held[0, system.ports]
    for k, i in enumerate(system.ports):
        if held[k]:
            q[0, i], v[i] = table[k, :2]
    if amplitudes is None:
        for name, displacement in lateral_signs(shapes, initial.tip_displacement, initial.elevation_displacement):
            q[0, shapes.index(name) :][: shapes.beam.a.count] = static_shape(system, displacement)
    else:
        q[0, len(at) :] = amplitudes
    v[len(at) :] = 0.0 if rates is None else rates
    none, drive = np.zeros((1, 0)), np.zeros((1, len(at)))
    return State(q=q, v=v, v_dot=np.zeros(system.n), lam=none, drive=drive, pose=np.zeros(7))


def _measure(system: System, actuator: Actuator, recording: Recording) -> list[Array]:
    """Displacements of the tip, and angles and length where they are free.

    Stretch, and twist times the length of the beam, count as far as they do beside the deflection (T9.11).
    """
    shapes, q = system.kernel.shapes, recording.q[:, 0]
    moved = [amplitudes(shapes, q, name) @ shapes.beam.a.tip for name, _ in lateral_signs(shapes, 0, 0)]
    there = dict(shapes.layout)
    beside = [("c", 1.0), ("t", actuator.length)]
    moved += [size * q[:, shapes.index(name)] for name, size in beside if there.get(name)]
    return [np.stack(moved, axis=-1)] + [q[:, j] for j in sorted(places(shapes).values()) if not system.held[0, j]]


def _weights(system: System, actuator: Actuator) -> tuple[Weight, ...]:
    """Weights of coordinates in each group of `_measure`."""
    shapes, n = system.kernel.shapes, system.n
    there, none = dict(shapes.layout), np.zeros(6)
    tip = np.zeros(n)
    bent = np.abs(shapes.beam.a.tip)
    for name, size in (("a", bent), ("b", bent), ("c", 1.0), ("t", actuator.length)):
        if there.get(name):
            tip[columns(shapes.layout, name)] = size
    free = [j for j in sorted(places(shapes).values()) if not system.held[0, j]]
    return Weight(leg=tip, hub=none), *(Weight(leg=np.eye(n)[j], hub=none) for j in free)


def _check(system: System, actuator: Actuator, recording: Recording) -> None:
    free = recording.q[:, 0, system.kernel.shapes.l_index] - actuator.hub_radius
    most = actuator.length * (1 + 1e-9)  # with a hub radius the free length is a difference
    for bad, words in ((free <= 0, "has slid wholly into the hub"), (free > most, "has left the hub")):
        if bad.any():
            raise _NotInHub(
                f"the beam {words} at t = {recording.time[np.argmax(bad)]:.6g} s",
                next_step="Shorten the simulation, or check the extension law or the axial force.",
            )
