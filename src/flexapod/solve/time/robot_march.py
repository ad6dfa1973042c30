"""A robot in time: start, commands and error measure around the time integration."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.generalized_alpha import GeneralizedAlpha
from flexapod.kinematics.inverse import BETA_LIMIT
from flexapod.kinematics.rotations import matrix
from flexapod.mechanics.leg.layout import columns
from flexapod.model import ForceDrive, Robot, Study
from flexapod.solve.batch import RestStates
from flexapod.solve.frames import floor
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.rigid_motion import built_state, rigid_state
from flexapod.solve.robot_system import refuse_massless
from flexapod.solve.statics.assembly_mode import false_root_legs, refuse_assembly_change, refuse_false_root
from flexapod.solve.statics.equilibrium import equilibrium
from flexapod.solve.statics.locked_robot import refuse_pure_force
from flexapod.solve.statics.static_loads import rest_commands, rest_load
from flexapod.solve.system import Flow, State, System
from flexapod.solve.time.command_tables import Law, robot_law
from flexapod.solve.time.march import initial_step, march
from flexapod.solve.time.motor_lag import settle_motors
from flexapod.solve.time.overconstrained import minimum_energy_recording, release_redundant
from flexapod.solve.time.problem import OF_LOOPS, Chunk, Problem, Weight
from flexapod.solve.time.radau import is_rigid
from flexapod.solve.time.recording import Counters, Recording
from flexapod.solve.time.start import consistent_start
from flexapod.solve.time.time_events import Stops

if TYPE_CHECKING:
    from flexapod.solve.time.sampled_control import SampledController, SampledLoop

AHEAD = 2000  # outputs whose rigid places are made at once
ROUNDING = 1e-12  # of the sum of what rounding makes along the legs [m]


@dataclass(frozen=True, kw_only=True)
class RobotMarch:
    """A prepared time integration of a study; iterate over `chunks`.

    ``impact`` is the step of kinetic energy [J] where the command starts with a jump in rate.
    """

    system: System
    start: Flow
    impact: float
    step: float
    chunks: Iterator[Chunk]
    problem: Problem
    counters: Counters = field(default_factory=Counters)


def prepare(
    study: Study,
    state: State | None = None,
    sampled: "SampledController | None" = None,
    elastic: ElasticRobot | None = None,
    path: kinematics.PathSeries | None = None,
) -> RobotMarch:
    """Start and time integration of a robot study.

    Parameters
    ----------
    study : Study
    state : State, optional
        Configuration (closures satisfied) and velocities in place of the study's start.
    sampled : SampledController, optional
        A controller.
    elastic : ElasticRobot, optional
        The robot of the study in its fidelity, where it is known.
    path : PathSeries, optional
        The rigid path of the study, where it is known.

    Raises
    ------
    InputError
        Equilibrium start of a pure force drive; pistons without mass whose shapes would have none either.
    ComputationError
        There is no equilibrium at the start, or a platform joint is half a turn off.
    """
    _refuse_unfit(study)
    robot, simulation = study.robot, study.simulation
    elastic = elastic or ElasticRobot(robot, simulation, study.load)
    system, rigid = elastic.moving, _Path(study, path)
    law = robot_law(system, robot, study.load, rigid.rigid)
    method = GeneralizedAlpha(simulation.rho_inf)
    state = _begun(study, elastic, law) if state is None else state
    refuse_false_root(system, robot, RestStates.from_state(state))
    system = release_redundant(system, state)
    measure, loop = _Measure(study, system, rigid), _around(sampled, system, study, rigid)
    problem = _problem(study, system, rigid, law, method, measure, loop)
    step = initial_step(problem, simulation.step)
    start, impact = consistent_start(system, state, law, 0.0, method, step)
    if loop is not None:
        loop.refuse_off(step, study.path)
        start = replace(start, loop=loop.start())
    counters = Counters()
    chunks = _with_minimum_energy(march(problem, start, step, counters), system, law)
    return RobotMarch(
        system=system, start=start, impact=impact, step=step, chunks=chunks, problem=problem, counters=counters
    )


def _problem(
    study: Study, system: System, path: "_Path", law: Law, method: GeneralizedAlpha, measure: "_Measure",
    loop: "SampledLoop | None",
) -> Problem:  # fmt: skip
    """Problem of a study for the time loops: tables, outputs, scales, events."""
    simulation = study.simulation
    output_step, outputs = simulation.stored_step, simulation.outputs(study.duration)
    far = 0.0 if simulation.tolerance is not None and system.kernel.library else None  # steps end on every row

    def restart(flow: Flow, t: float, h: float) -> Flow:
        return after_impact(system, flow, loop.add_held_outputs(law, flow) if loop else law, t, method, h)

    return Problem(
        system=system,
        method=method,
        tables=law,
        output_step=output_step,
        outputs=outputs,
        measure=measure,
        weights=measure.weights(),
        knots=path.series.knots,
        restart=restart,
        stops=Stops.from_breaks(kinematics.robot_breaks(study, far), output_step, simulation.step, outputs),
        check=_Range(study, system, controlled=loop is not None),
        tolerance=simulation.tolerance,
        loop=loop,
    )


def _with_minimum_energy(chunks: Iterator[Chunk], system: System, law: Law) -> Iterator[Chunk]:
    """Chunks whose forces are those of least energy, where a robot is overconstrained."""
    if system.slack is None:
        return chunks
    return (
        replace(x, recording=minimum_energy_recording(system, x.recording, law(x.recording.time)[0])) for x in chunks
    )


def _refuse_unfit(study: Study) -> None:
    """Raise InputError of a study that has statics, but no motion in time."""
    refuse_massless(study)
    refuse_growing_plates(study)
    refuse_gaps(study)


def _around(sampled: "SampledController | None", system: System, study: Study, path: "_Path") -> "SampledLoop | None":
    """A controller around a robot, which compiled equations alone have."""
    if sampled is None:
        return None
    from flexapod.solve.time.sampled_control import SampledLoop

    if system.kernel.library is None:
        raise InputError(
            "needs compiled equations",
            key="controller",
            next_step="Install gcc or clang, or `pip install ziglang`",
        )
    return SampledLoop(sampled, system, study.robot, lambda t: path.exact(np.minimum(t, study.duration)))


def refuse_gaps(study: Study) -> None:
    """Raise InputError if play is to be a gap in legs without springs before their piston."""
    for i, leg in enumerate(study.robot.legs if study.simulation.play == "gap" else (), start=1):
        if leg.half_play and not (leg.gives and leg.driven == "stroke"):
            raise InputError(
                f"is a gap in the springs between drive and piston, of which leg {i} has none",
                file=study.path,
                key="simulation.play",
                value="gap",
                allowed='legs whose drive is a screw, or with springs at = "nut"',
                next_step="Give leg.springs, or leave simulation.play out: flexapod.play follows play without a motion",
            )


def refuse_growing_plates(study: Study) -> None:
    """Raise InputError if plates grow during a simulation under legs that cannot take that as a length."""
    heat, legs = study.robot.heat, study.robot.legs
    follows = kinematics.rigid_limbs(study.robot).plain and not any(isinstance(leg.drive, ForceDrive) for leg in legs)
    for plate in ("base", "platform"):
        if heat is not None and plate in heat.columns and not follows:
            raise InputError(
                f"has a column {plate!r}: joints that move by heat during a motion are known of legs UPS alone, whose "
                "drives have a position",
                file=study.path,
                key="heat.file",
                value=heat.file,
                allowed="over time the temperatures of pistons, cylinders and screws",
                next_step=f"Give heat.{plate} a number here; flexapod.accuracy follows the whole table",
            )


def _begun(study: Study, elastic: ElasticRobot, law: Law) -> State:
    """State before the impact projection, with what motors that lag ask for."""
    system, state = elastic.moving, _configuration(study, elastic)
    if not system.kernel.shapes.has("j"):
        return state
    rests = study.initial.start == "equilibrium"
    table, wrench = (part[0] for part in law(np.zeros(1)))
    table[..., 1:3] *= not rests
    return settle_motors(system, state, table, wrench, rests=rests)


def _configuration(study: Study, elastic: ElasticRobot) -> State:
    """Configuration and velocities before the impact projection, by the kind of start and what acts until then."""
    system, at = elastic.moving, kinematics.rigid_poses(study.robot, study.motion, np.zeros(1))
    built = bool(kinematics.built_parts(study.robot)) and study.initial.start != "equilibrium"
    straight = (built_state if built else rigid_state)(system, at)
    if study.initial.start == "moving":
        return straight
    at_rest = replace(straight, v=np.zeros(system.size), v_dot=np.zeros(system.size))
    if study.initial.start == "straight":
        return at_rest
    refuse_pure_force(study.robot, "the equilibrium start")
    still = system
    if system.kernel.shapes.has("w") or system.kernel.shapes.has("j"):
        still = elastic.resting
        at_rest = replace(at_rest, drive=np.zeros((still.legs, still.ports.size)))
    acts = rest_load(still, at, elastic.load)
    command = rest_commands(still, study.robot, straight.q[None])[0]
    found = equilibrium(still, at_rest, command, acts.force[0], acts.wrench)
    if not found.found:
        raise ComputationError(f"the robot cannot start at rest: {found.reason}", next_step="See `flexapod check`.")
    refuse_assembly_change(still, study.robot, RestStates.from_state(straight), RestStates.from_state(found.state))
    if system.kernel.shapes.has("j"):
        return replace(found.state, drive=np.zeros((system.legs, system.ports.size)))
    return found.state if still is system else _summed(study.robot, system, still, found.state)


def _summed(robot: Robot, system: System, still: System, state: State) -> State:
    """State at rest whose loops have the integrals that hold their rotors, Eq. (T23.16)."""
    shapes, q = system.kernel.shapes, state.q.copy()
    force = state.drive[:, still.ports == shapes.index("r")][:, 0]
    gain = np.array([leg.screw.integral if leg.screw is not None else 0.0 for leg in robot.legs])
    q[:, shapes.index("w")] = np.divide(force, gain, out=np.zeros_like(gain), where=gain > 0)
    return replace(state, q=q, drive=np.zeros((system.legs, system.ports.size)))


class _Path:
    """Rigid path, for commands and error measure: the last poses are remembered, and places of outputs."""

    def __init__(self, study: Study, series: kinematics.PathSeries | None) -> None:
        self.robot, self.motion = study.robot, study.motion
        self.series = series or kinematics.PathSeries(study.robot, study.motion, study.duration)
        self.time, self.last = np.zeros(0), None
        self.output_step, self.outputs = study.simulation.stored_step, study.simulation.outputs(study.duration)
        if series is None:
            self.series.make(self.outputs + 1)
        self.stored, self.centres = np.zeros(0), (np.zeros((0, 3)), np.zeros((0, 3, 3)))

    def rigid(self, t: Array) -> kinematics.RigidPoses:
        """The rigid robot at instants (T,), ascending."""
        if self.last is None or not np.array_equal(t, self.time):
            self.time, self.last = t, self.series.at(t)
        return self.last

    def centre(self, t: Array) -> tuple[Array, Array]:
        """Centre of mass (T, 3) and rotation (T, 3, 3) at instants (T,), ascending: many outputs are made at once."""
        if len(t) > 1 and not (len(self.stored) and self.stored[0] <= t[0] and t[-1] <= self.stored[-1]):
            first = round(t[0] / self.output_step)
            self.stored = np.arange(first, min(first + AHEAD, self.outputs) + 1) * self.output_step
            self.centres = self.exact(self.stored)
        at = np.minimum(np.searchsorted(self.stored, t), max(len(self.stored) - 1, 0))
        if not len(self.stored) or (self.stored[at] != t).any():
            return self.exact(t)
        place, rotation = self.centres
        return place[at], rotation[at]

    def exact(self, t: Array) -> tuple[Array, Array]:
        """Centre of mass and rotation as of `centre` at any instants."""
        if self.series.limbs.guides:
            path = self.series.at(t).poses
            return path.place(self.robot.com), path.rotation
        place, rotation = kinematics.places(self.robot, self.motion, t)
        return place + rotation @ self.robot.com, rotation


class _Measure:
    """Deviation of the payload (CoM, and rotation at the joints' radius) and the lateral amplitudes of a recording.

    A payload that is fixed has no deviation: there amplitudes count, those along the legs as well. Of rigid legs the
    forces of the closures count, too: nothing else of them has an error.
    """

    def __init__(self, study: Study, system: System, path: _Path) -> None:
        shapes = system.kernel.shapes
        first = shapes.index("a")
        self.system, self.robot = system, study.robot
        self.path, self.lateral = path, slice(first, first + shapes.beam.a.count + shapes.beam.b.count)
        self.along = columns(shapes.layout, "c") if shapes.beam.axial.count else slice(0)
        self.radius = np.linalg.norm(study.robot.platform_joints, axis=1).max()
        self.fixed, self.forces = bool(system.hub_held.all()), is_rigid(system)
        self.least = ROUNDING / (study.simulation.tolerance or 1.0)  # what is smaller along a leg does not count

    def weights(self) -> tuple[Weight, ...]:
        """Weights of the deviation, and of the lateral amplitudes, which may have ten times the error."""
        still, lateral = np.zeros(self.system.n), np.zeros(self.system.n)
        if self.fixed:
            along, none = still.copy(), np.zeros(6)
            lateral[self.lateral] = along[self.along] = 1.0
            found = Weight(leg=lateral, hub=none), Weight(leg=along, hub=none)
        else:
            lateral[self.lateral] = 0.1
            hub = np.array([1.0, 1.0, 1.0, self.radius, self.radius, self.radius])
            found = Weight(leg=still, hub=hub), Weight(leg=lateral, hub=np.zeros(6))
        return (*found, *[Weight(leg=np.zeros(self.system.n), hub=np.zeros(6))] * self.forces)

    def __call__(self, recording: Recording) -> list[Array]:
        return self._of_motion(recording) + [recording.lam[..., :3]] * self.forces

    def _of_motion(self, recording: Recording) -> list[Array]:
        if self.fixed:
            return [recording.q[:, :, self.lateral], np.append(recording.q[:, :, self.along], self.least)]
        com, rigid_rotation = self.path.centre(recording.time)
        place, rotation = recording.pose[:, :3], matrix(recording.pose[:, 3:])
        if self.robot.base_motion is not None:
            place, rotation = floor(self.system, self.robot, recording.q).seen(place, rotation)
        turn = rigid_rotation.swapaxes(1, 2) @ rotation
        skew = [turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]]
        shift = place - com
        return [
            np.concatenate([shift, 0.5 * self.radius * np.stack(skew, axis=1)], axis=1),
            recording.q[:, :, self.lateral],
        ]


def after_impact(system: System, flow: Flow, law: Law, now: float, method: GeneralizedAlpha, h: float) -> Flow:
    """Flow after a jump in the commanded rates; the drives do the work of the impact."""
    start, impact = consistent_start(system, flow, law, now, method, h)
    return replace(start, sums=flow.sums + np.array([0.0, impact, 0.0, 0.0]), loop=flow.loop)


class _Range:
    """Stop where the model has no meaning: a piston inside or out of its cylinder, a universal joint turned over."""

    def __init__(self, study: Study, system: System, *, controlled: bool) -> None:
        self.advice = OF_LOOPS if controlled else ""
        legs, shapes = study.robot.legs, system.kernel.shapes
        self.system, self.robot = system, study.robot
        self.mouth = np.array([leg.cylinder.mouth for leg in legs])
        self.guided = np.array([leg.piston.length if leg.cylinder.mouth > 0 else np.inf for leg in legs]) * (1 + 1e-9)
        self.l, self.beta = shapes.l_index, shapes.index("beta")
        self.tilt = shapes.index("gamma2") if shapes.has("gamma2") else None

    def __call__(self, recording: Recording) -> None:
        """Raise ComputationError at the first instant of a recording at which it has none."""
        q = recording.q
        free = q[:, :, self.l] - self.mouth
        found = [
            (free <= 0, "its piston has slid wholly into the cylinder"),
            (free > self.guided, "its piston has been pulled out of the cylinder"),
            (np.abs(q[:, :, self.beta]) > BETA_LIMIT, "its universal joint has turned over"),
        ]
        if self.tilt is not None:
            turned = false_root_legs(self.system, self.robot, q, recording.pose) | (
                np.abs(q[:, :, self.tilt]) > BETA_LIMIT
            )
            found.append((turned, "its joint at the platform has turned over"))
        for bad, words in found:
            if bad.any():
                at, leg = np.argwhere(bad)[0]
                raise ComputationError(
                    f"leg {leg + 1} left the range of the model at t = {recording.time[at]:.6g} s: {words}",
                    next_step=f"{self.advice}Check drive forces and feedback of this leg, or the start.",
                )
