"""A robot's numbers for the C that marches it: start, commands, and which outputs are made of what."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.leg_results import drive_forms, leg_results
from flexapod.analysis.results.legs import screw_travel
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Record, recorded_arrays
from flexapod.analysis.results.variables import VARIABLES
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.units import quantity
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.solve.statics.static_loads import force_ports, push_ports
from flexapod.solve.system import Flow
from flexapod.solve.time.chebyshev import Series
from flexapod.solve.time.command_tables import Law
from flexapod.solve.time.march import first_record
from flexapod.solve.time.recording import record_places, unpack
from flexapod.solve.time.robot_march import RobotMarch, prepare

OF_LEGS = ("drive_position", "drive_force", "joint_force")
ENERGIES = ("energy_kinetic", "energy_potential", "energy_strain", "energy_dissipated", "work_drive", "work_external")
OF_PAYLOAD = {"com_position": 3, "tool_position": 3, "platform_quaternion": 4, "platform_angular_velocity": 3}
CHI, L = COORDINATES.index("chi"), COORDINATES.index("l")
FINEST = 1e-3  # s: of a piece of the built-in commands
ROUNDING = 1e-9  # of an output that is linear in the state


@dataclass(frozen=True, kw_only=True)
class Channel:
    """A variable of inputs or outputs: name and unit as in results, shape, where its numbers begin, start values."""

    name: str
    units: str
    words: str
    shape: tuple[int, ...]
    first: int
    start: Array

    @property
    def size(self) -> int:
        """Number of values in the channel."""
        return int(np.prod(self.shape))


@dataclass(frozen=True, kw_only=True)
class CMarch:
    """A prepared march and all that its C has to know beside the equations.

    ``row``: record of the start; ``drive_port``, ``force_port`` (legs,): ports that commands and forces of the drives
    go to, -1 for none; ``keeps``: legs whose drive keeps its command; ``turns``, ``zero``: of the drives' units;
    ``stretch``, ``shift``: what the robot as built makes of a command q, shift + stretch q, Eq. (T16.5);
    ``edges``, ``series``: of the built-in commands, if there are; ``matrix`` (outputs, row), ``offset`` (outputs,): of
    the outputs that are linear in a row.
    """

    study: model.Study
    march: RobotMarch
    law: Law
    commanded: bool
    row: Array
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    drive_port: Array
    force_port: Array
    keeps: Array
    turns: Array
    zero: Array
    stretch: Array
    shift: Array
    edges: Array
    series: Array
    matrix: Array
    offset: Array
    left_out: tuple[str, ...]

    @property
    def start(self) -> Flow:
        """State in which the march begins."""
        return self.march.start


def prepare_c_march(study: model.Study, commands: str, step: float | str | None) -> CMarch:
    """The march of a study with fixed steps, prepared for C.

    Raises
    ------
    InputError
        Unknown commands; no fixed step; commands from outside to a robot that something else moves over time.
    """
    if not isinstance(commands, str) or commands not in ("inputs", "motion"):
        raise InputError("is not known", key="commands", value=commands, allowed='"inputs" or "motion"')
    h = study.simulation.step if step is None else quantity(step, "time", key="step")
    if h is None:
        raise InputError(
            "is missing: what is written goes by fixed steps, and the study has none",
            key="step",
            allowed='a time: a number in s, or text such as "0.5 ms"',
            next_step="Take 0.5 ms to begin with, and half of it to see what that changes",
        )
    commanded = commands == "inputs"
    if commanded:
        _refuse_moving(study)
    study = model.override(study, step=h, output_step=h)
    if not study.simulation.outputs(study.duration):
        allowed = f"at most its duration of {study.duration:g} s"
        raise InputError("is longer than the study's simulation", key="step", value=h, allowed=allowed)
    march = prepare(study)
    if march.system.kernel.library is None:
        raise InputError("needs a C compiler", key="format", next_step="Install gcc or clang")
    problem = march.problem
    _, row = first_record(march.system, march.start, *problem.tables(np.zeros(1)))
    edges, series = np.zeros(1), np.zeros((0, 0, 0))
    if not commanded:
        end = problem.outputs * problem.output_step
        knots = [t for t in problem.knots.tolist() if 0 < t < end]
        edges, series = Series(problem.tables, [0.0, *knots, end], FINEST).covering_pieces(0.0, end)
    parts = _drives(march, study)
    matrix, offset, outputs = _outputs(study, march, row[0])
    return CMarch(
        study=study, march=march, law=problem.tables, commanded=commanded, row=row[0], **parts,
        inputs=_inputs(study, march, parts, commanded), outputs=outputs, edges=edges, series=series,
        matrix=matrix, offset=offset, left_out=_left_out(study, march, commanded),
    )  # fmt: skip


def _refuse_moving(study: model.Study) -> None:
    """Raise InputError if something beside the drives moves the robot over time: inputs come for any time."""
    robot = study.robot
    warms = robot.heat is not None and robot.heat.time is not None
    moving = [
        ("robot.base_motion", "a base that moves", "base_motion of [robot]", robot.base_motion is not None),
        ("heat.file", "temperatures over time", "file of [heat]", warms),
    ]
    for key, what, table, there in moving:
        if there:
            raise InputError(
                f"are to come from outside, for any time, and this robot has {what} of its own ({key})",
                file=study.path,
                key="commands",
                value="inputs",
                allowed='"motion": all is built in',
                next_step=f'Take {table} out, or choose commands "motion"',
            )


def _drives(march: RobotMarch, study: model.Study) -> dict[str, Array]:
    system, robot = march.system, study.robot
    driven, pushed = push_ports(system, robot), force_ports(system, robot)
    at = {int(coordinate): k for k, coordinate in enumerate(system.ports)}
    drive = np.array([at.get(int(x), -1) for x in driven])
    keeps = np.array([k >= 0 and bool(system.enforced_mask[i, driven[i]]) for i, k in enumerate(drive)])
    force = np.array([-1 if keeps[i] or k < 0 else at[int(pushed[i])] for i, k in enumerate(drive)])
    zero = kinematics.robot_limbs(robot).carriage_zero * (driven != system.kernel.shapes.l_index)
    stretch, shift = np.ones(len(drive)), np.zeros(len(drive))
    carried = kinematics.robot_limbs(robot).state[:, CHI] == DRIVEN
    for part in kinematics.built_parts(robot):
        size, at_drive = part.size(np.zeros(1)).position[0], (np.arange(len(drive)), np.where(carried, CHI, L))
        stretch, shift = stretch + size * part.share[at_drive], shift + size * part.fixed[at_drive]
    return {
        "drive_port": drive, "force_port": force, "keeps": keeps, "turns": screw_travel(robot),
        "zero": np.broadcast_to(zero, drive.shape).astype(float), "stretch": stretch, "shift": shift,
    }  # fmt: skip


def _inputs(study: model.Study, march: RobotMarch, parts: dict[str, Array], commanded: bool) -> tuple[Channel, ...]:
    table = march.problem.tables(np.zeros(1))[0][0]
    legs = np.arange(march.system.legs)
    given = table[legs, np.maximum(parts["drive_port"], 0), :3]
    given[:, 0] -= parts["shift"]
    given = given / (parts["stretch"] * parts["turns"])[:, None]
    units = drive_forms(study.robot).get("drive_command", VARIABLES["drive_command"]).units
    found: list[tuple[str, str, str, Array]] = []
    if commanded:
        names = {"": (units, "place"), "_rate": (f"{units} s-1", "rate"), "_acceleration": (f"{units} s-2", "change")}
        for k, (ending, (unit, words)) in enumerate(names.items()):
            start = np.where(parts["drive_port"] >= 0, given[:, k] + parts["zero"] * (k == 0), 0.0)
            found.append((f"drive_command{ending}", unit, f"commanded {words} of the drive", start))
    force = drive_forms(study.robot).get("drive_force", VARIABLES["drive_force"]).units
    words = "force of the drive beside its own; of no effect where it keeps its command"
    found.append(("control_input", force, words, np.zeros(len(legs))))
    if march.system.hub:
        words = "force [N] and moment [N m] at the tool beside the load, world axes"
        found.append(("wrench", "mixed", words, np.zeros(6)))
    channels, first = [], 0
    for name, unit, words, start in found:
        channels.append(Channel(name=name, units=unit, words=words, shape=start.shape, first=first, start=start))
        first += start.size
    return tuple(channels)


def _outputs(study: model.Study, march: RobotMarch, row: Array) -> tuple[Array, Array, tuple[Channel, ...]]:
    """Outputs that are linear in a row, and their names; those of the payload that are not have no part of it."""
    system, robot, at = march.system, study.robot, record_places(march.system)
    path = RigidPath(study, np.zeros(1))

    def of_legs(rows: Array) -> dict[str, Array]:
        record = _record(march, rows)
        made = leg_results(system, path, record)
        return {name: np.asarray(x() if callable(x := made[name]) else x) for name in OF_LEGS}

    each = np.arange(len(row))
    moved = np.concatenate([each[at[name]] for name in ("q", "lam", "drive")])
    rows = np.repeat(row[None], len(moved) + 2, axis=0)
    rows[:, moved] = 0.0
    rows[np.arange(len(moved)) + 1, moved] += 1.0
    rows[-1, moved] += np.sin(np.arange(len(moved)))
    forms = {**VARIABLES, **drive_forms(robot)}
    matrices, offsets, channels, first = [], [], [], 0

    def add(name: str, shape: tuple[int, ...], matrix: Array, offset: Array) -> None:
        nonlocal first
        start = matrix @ row + offset
        form = forms[name]
        channels.append(
            Channel(name=name, units=form.units, words=form.long_name, shape=shape, first=first, start=start)
        )
        matrices.append(matrix)
        offsets.append(offset)
        first += len(offset)

    for name, size in OF_PAYLOAD.items() if system.hub else ():
        matrix = np.zeros((size, len(row)))
        if name == "com_position":
            matrix[np.arange(3), each[at["pose"]][:3]] = 1.0
        add(name, (size,), matrix, np.zeros(size))
    for name, values in of_legs(rows).items():
        flat = values.reshape(len(rows), -1)
        matrix = np.zeros((flat.shape[1], len(row)))
        matrix[:, moved] = (flat[1:-1] - flat[0]).T
        offset = flat[0]
        if np.abs(rows[-1] @ matrix.T + offset - flat[-1]).max() < ROUNDING * max(1.0, np.abs(flat).max()):
            add(name, values.shape[1:], matrix, offset)
    whole = np.concatenate([each[at["energy"]], each[at["sums"]][:3], each[at["closure"]]])
    for k, name in enumerate([*ENERGIES, "closure_residual"]):
        matrix = np.zeros((1, len(row)))
        matrix[0, whole[k]] = 1.0
        add(name, (), matrix, np.zeros(1))
    return np.concatenate(matrices), np.concatenate(offsets), tuple(channels)


def _record(march: RobotMarch, rows: Array) -> Record:
    """Rows of numbers as a record."""
    parts = recorded_arrays(unpack(march.system, np.zeros(len(rows)), rows), ())
    return Record(
        **parts, smallest_step=0.0, largest_error=0.0, force_error=None, wall_time=0.0, failure=None, interrupted=False
    )


def _left_out(study: model.Study, march: RobotMarch, commanded: bool) -> tuple[str, ...]:
    found = ["steps within a tolerance, the rigid path and all deviations from it, figures: `flexapod run` has them"]
    if study.control is not None:
        found.append("the controller of [control]: its forces come in as control_input")
    if not commanded and (march.problem.stops.ends or march.problem.stops.inside):
        found.append("ends of steps on jumps of commands and loads: next to them forces are of first order in the step")
    return tuple(found)
