"""Sampled controller around the time integration: channels by name, and their form for `native/loop.c`."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable, Sequence
from ctypes import Structure, c_double, c_long, c_void_p
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import expm

from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.kinematics.robot import robot_limbs
from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Leg, Robot
from flexapod.solve.linear.channels import Geophone, PlantChannel, plant_channels
from flexapod.solve.statics.static_loads import force_ports, push_ports
from flexapod.solve.system import Flow, System
from flexapod.solve.time.command_tables import Law
from flexapod.solve.time.radau import SHORTEST

NEAR_SAMPLE = 1e-6  # of a period: instants that are no farther from a sample are its own
PROOF = 5  # numbers that a geophone remembers, as in loop.c
BLOCK = 1024  # samples whose noise is drawn together
FORCE, VALUE = 3, 0  # columns of a port in a table
COORDINATE, PORT_FORCE, CLOSURE, JOINT, PLACE, TURN, ACCELERATION, GEOPHONE = range(8)  # what is read, as in loop.c

#: Of an instant [s] and readings (p,): outputs (m,).
Asked = Callable[[float, Array], object]
_ASKED = ctypes.CFUNCTYPE(ctypes.c_int, c_double, ctypes.POINTER(c_double), ctypes.POINTER(c_double))


@dataclass(frozen=True, kw_only=True)
class SampledController:
    """A controller from sample to sample: x_next = A x + B y, u = C x + D y, Eq. (T26.1); or a function in its place.

    Parameters
    ----------
    readings, outputs : tuples of str
        Channels that it reads, as ``stroke:1`` and ``tool:z``, and that it moves, as ``drive:3``.
    period : float
        Time between samples [s].
    A, B, C, D : ndarray, shapes (n, n), (n, p), (m, n), (m, p)
        None of a function.
    function : Asked, optional
        Called once a sample, in their order; after a step that fails some come again.
    delay_samples : int
        Samples from a reading to what is made of it.
    quantum : ndarray, shape (p,)
        Steps of the readings, in their units; 0 of those without.
    most : ndarray, shape (m,)
        Largest magnitude of the outputs; infinite where there is none.
    sigma : ndarray, shape (p,)
        Standard deviation of the noise of a reading.
    seed : int
        Of the noise.
    key : str
        Where the period is given.
    """

    readings: tuple[str, ...]
    outputs: tuple[str, ...]
    period: float
    A: Array = field(default_factory=lambda: np.zeros((0, 0)))
    B: Array = field(default_factory=lambda: np.zeros((0, 0)))
    C: Array = field(default_factory=lambda: np.zeros((0, 0)))
    D: Array = field(default_factory=lambda: np.zeros((0, 0)))
    function: Asked | None = None
    delay_samples: int = 0
    quantum: Array
    most: Array
    sigma: Array
    seed: int = 0
    key: str = "sample"

    def noise(self, first: int, count: int) -> Array:
        """Noise of samples from `first` on, (count, readings): the same whatever is asked for at once, Eq. (T26.4)."""
        if not self.sigma.any():
            return np.zeros((count, self.sigma.size))
        blocks = range(first // BLOCK, (first + count - 1) // BLOCK + 1)
        drawn = [np.random.default_rng([self.seed, b]).standard_normal((BLOCK, self.sigma.size)) for b in blocks]
        start = first - BLOCK * blocks[0]
        return np.concatenate(drawn)[start : start + count] * self.sigma


class _Reading(Structure):
    _fields_ = [
        *[(name, c_long) for name in ("of", "leg", "port", "axis")],
        ("arm", c_double * 3),
        ("along", c_double * 3),
        *[(name, c_double * 4) for name in ("step", "begin", "end")],
        ("gain", c_double),
    ]


class _Action(Structure):
    _fields_ = [*[(name, c_long) for name in ("leg", "port", "column")], ("gain", c_double)]


class _Loop(Structure):
    _fields_ = [
        *[(name, c_long) for name in ("readings", "actions", "states", "delay", "first", "given")],
        *[(name, c_double) for name in ("begin", "period")],
        ("gravity", c_double * 3),
        *[(name, c_void_p) for name in ("reading", "action", "A", "B", "C", "D")],
        *[(name, c_void_p) for name in ("quantum", "most", "noise", "path")],
        ("asked", _ASKED),
        *[(name, c_void_p) for name in ("memory", "record")],
    ]


class SampledLoop:
    """A controller and the robot that it reads and moves.

    Parameters
    ----------
    sampled : SampledController
    system : System
    robot : Robot
    path : callable
        Centre of mass (T, 3) and attitude (T, 3, 3) on the rigid path at instants (T,).

    Raises
    ------
    InputError
        No such channel; an output that moves what is held.
    """

    sampled: SampledController
    system: System

    def __init__(
        self, sampled: SampledController, system: System, robot: Robot, path: Callable[[Array], tuple[Array, Array]]
    ) -> None:
        self.sampled, self.system, self._path = sampled, system, path
        start = path(np.zeros(1))[1][0]
        self._reading = _structures(
            _Reading, [_reading(name, system, robot, start, sampled.period) for name in sampled.readings]
        )
        self._action = _structures(_Action, [_action(name, system, robot) for name in sampled.outputs])
        self._at = [(a.leg, a.port, a.column) for a in self._action[: len(sampled.outputs)]]
        self._gravity = (c_double * 3)(*robot.gravity)
        self._seen = any(r.of >= PLACE for r in self._reading[: len(sampled.readings)])
        given = (sampled.A, sampled.B, sampled.C, sampled.D, sampled.quantum, sampled.most)
        self._arrays = tuple(np.ascontiguousarray(x, dtype=float) for x in given)
        self._asked = _ASKED(self._ask) if sampled.function else _ASKED()
        self.fault: BaseException | None = None  # of the function, as C cannot pass it on

    @property
    def width(self) -> int:
        """Numbers in a row of its record: readings, outputs, work."""
        return len(self.sampled.readings) + len(self.sampled.outputs) + 1

    def start(self) -> Array:
        """Memory before the first sample, laid out as `split` of loop.c has it."""
        readings, states = len(self.sampled.readings), len(self.sampled.A)
        return np.zeros(
            3 + 2 * states + len(self.sampled.outputs) + (3 + PROOF + self.sampled.delay_samples) * readings
        )

    def held_outputs(self, flow: Flow) -> Array:
        """Outputs that are held, (m,)."""
        first = 3 + len(self.sampled.A)
        return flow.loop[first : first + len(self.sampled.outputs)]

    def add_held_outputs(self, law: Law, flow: Flow) -> Law:
        """A law with what is held on top."""

        def with_held(t: Array) -> tuple[Array, Array]:
            table, load = law(t)
            table = table.copy()
            for (leg, port, column), value in zip(self._at, self.held_outputs(flow), strict=True):
                table[:, leg, port, column] += value
            return table, load

        return with_held

    def instants(self, first: float, last: float, known: Sequence[float]) -> list[float]:
        """Instants of samples between two others, neither of these nor those that are `known` anyway."""
        period = self.sampled.period
        numbers = range(int(np.floor(first / period)), int(np.ceil(last / period)) + 1)
        near = NEAR_SAMPLE * period
        found = [k * period for k in numbers if first + near < k * period < last - near]
        return [t for t in found if all(abs(t - x) > near for x in known)]

    def refuse_off(self, step: float, file: str | None) -> None:
        """Raise InputError if the period is no multiple of a fixed step [s]; of steps of their own it is 0.

        ``file``: that of the study.
        """
        if not step and self.sampled.period < SHORTEST:
            raise InputError(
                "is shorter than steps within a tolerance can be",
                file=file,
                key=self.sampled.key,
                value=f"{self.sampled.period:.6g} s",
                allowed=f"at least {SHORTEST:g} s, or fixed steps",
            )
        many = self.sampled.period / step if step else 1.0
        if abs(many - round(many)) > NEAR_SAMPLE * max(many, 1.0) or round(many) < 1:
            raise InputError(
                "is no multiple of the fixed step",
                file=file,
                key=self.sampled.key,
                value=f"{self.sampled.period:.6g} s",
                allowed=f"multiples of {step:.6g} s; the nearest is {max(1, round(many)) * step:.6g} s",
                next_step=f"Give the nearest, step = {self.sampled.period / max(1, np.ceil(many)):.6g}, or a tolerance",
            )

    def call(self, flow: Flow, begin: float, end: float, rows: Array) -> tuple[_Loop, tuple[Array, ...]]:
        """Structure that a call in C reads, from `begin` to `end` [s], and the arrays to which it points.

        ``rows``: its record, (outputs, width).
        """
        first = int(flow.loop[0])
        count = max(1, int(np.ceil(end / self.sampled.period)) + 2 - first)
        path = np.zeros((count, 7))
        if self._seen:
            place, rotation = self._path(np.asarray(self.sampled.period * np.arange(first, first + count), dtype=float))
            path = np.concatenate([place, quaternion(rotation)], axis=1)
        kept = (self.sampled.noise(first, count), path)
        loop = _Loop(
            len(self.sampled.readings), len(self.sampled.outputs), len(self.sampled.A), self.sampled.delay_samples,
            first, count, begin, self.sampled.period, self._gravity,
            *[ctypes.addressof(x) for x in (self._reading, self._action)],
            *[x.ctypes.data for x in (*self._arrays, *kept)],
            self._asked, flow.loop.ctypes.data, rows.ctypes.data,
        )  # fmt: skip
        return loop, (*kept, flow.loop, rows)

    def _ask(self, t: float, readings: object, outputs: object) -> int:
        """Call the function in place of the matrices; 1 where it fails."""
        p, m = len(self.sampled.readings), len(self.sampled.outputs)
        try:
            y = np.ctypeslib.as_array(readings, (p,)).copy()  # type: ignore[arg-type]
            given = self.sampled.function(t, y)  # type: ignore[misc]
            try:
                found = floats(given)
            except ValueError:
                found = np.full(0, np.nan)
            if found.shape != (m,) or not np.isfinite(found).all():
                shown = found.tolist() if found.size else repr(given)
                raise InputError(f"returns {shown} at t = {t:.6g} s", key="controller", allowed=f"{m} finite numbers")
            np.ctypeslib.as_array(outputs, (m,))[:] = found  # type: ignore[arg-type]
        except BaseException as error:  # a Ctrl-C as well: C knows no exceptions
            self.fault = error
            return 1
        return 0


def _structures(kind: type[Structure], items: Sequence[Structure]) -> ctypes.Array:
    return (kind * max(len(items), 1))(*items)


def _reading(name: str, system: System, robot: Robot, start: Array, period: float) -> _Reading:
    """Reading of a channel every `period` [s]; ``start``, (3, 3): attitude of the platform at the start."""
    channel = _single(name, robot, "outputs")
    leg, group = max(channel.leg, 0), channel.group
    none = (c_double * 3)()
    if group in ("tool", "com") and robot.base_motion is None:
        arm = robot.tool - robot.com if group == "tool" else np.zeros(3)
        return _Reading(TURN if channel.axis > 2 else PLACE, 0, 0, channel.axis % 3, (c_double * 3)(*arm), none)
    if group == "accelerometer" and channel.at is not None:
        along = start[channel.axis]  # axes that turn with the platform, the world's at the start
        return _Reading(ACCELERATION, 0, 0, 0, (c_double * 3)(*channel.at), (c_double * 3)(*along))
    if channel.geophone is not None and channel.at is not None:
        matrices = [(c_double * 4)(*matrix.ravel()) for matrix in _proof_mass(channel.geophone, period)]
        where = (c_double * 3)(*channel.at), (c_double * 3)(*start[channel.axis])
        return _Reading(GEOPHONE, 0, 0, 0, *where, *matrices, channel.geophone.sensitivity)
    if group == "joint-force":
        return _Reading(CLOSURE, leg, 0, channel.axis, none, none)
    if group == "force-sensor:platform" and not _moving_base(robot):
        limbs = robot_limbs(robot)
        return _Reading(JOINT, leg, 0, 0, (c_double * 3)(*system.joint_p[leg]), (c_double * 3)(*limbs.base[leg]))
    one, rotor = robot.legs[leg], robot.legs[leg].gives
    moved = push_ports(system, robot)[leg] if group == "encoder" and one.measured == "rotor" else _moved(system, one)
    if group in ("stroke", "encoder") and not (group == "encoder" and one.closed_about == "joint-to-joint"):
        return _Reading(COORDINATE, leg, _port(system, moved), moved, none, none)
    if group in ("drive-force", "force-sensor:drive") and not rotor:
        return _Reading(PORT_FORCE, leg, _port(system, moved), moved, none, none)
    raise InputError(
        "is not read in time" + (f" of leg {leg + 1}, whose drive has a rotor" if rotor else ""),
        key="controller.inputs",
        value=name,
        allowed="tool and com where the base stands still, stroke, encoder, drive-force, force-sensor:drive of drives "
        "without a rotor, joint-force, force-sensor:platform where base joints stand still, accelerometer:POINT, "
        "geophone:POINT",
    )


def _proof_mass(sensor: Geophone, period: float) -> tuple[Array, Array, Array]:
    """A proof mass over a `period` [s], by its states and by what moves it at its begin and end, Eq. (T26.10)."""
    w, rate = 2 * np.pi * sensor.f0, 4 * np.pi * sensor.damping * sensor.f0
    whole = np.zeros((6, 6))  # what moves it is straight between samples
    whole[:2] = [[0, 1, 1, 0, 0, 0], [-(w**2), -rate, -rate, 1, 0, 0]]
    whole[2:4, 4:] = np.eye(2) / period
    whole = np.asarray(expm(whole * period), dtype=float)[:2]
    return whole[:, :2], whole[:, 2:4] - whole[:, 4:], whole[:, 4:]


def _single(name: str, robot: Robot, key: str) -> PlantChannel:
    found = plant_channels(name, robot, key)
    if len(found) != 1 or found[0].name != re.sub(r"\s*\[.*\]", "", name):
        raise InputError(
            "is not one channel",
            key=f"controller.{'inputs' if key == 'outputs' else 'outputs'}",
            value=name,
            allowed=f"a single one as {found[0].name}",
        )
    return found[0]


def _moving_base(robot: Robot) -> bool:
    """Test whether base joints move, or legs close the attitude too."""
    return bool(robot.base_mount or robot.base_motion or robot.platform_mount or robot_limbs(robot).carriage)


def _moved(system: System, leg: Leg) -> int:
    """Coordinate that the drive of a leg moves, of a passive one its stroke."""
    shapes = system.kernel.shapes
    return shapes.index("chi") if leg.driven == "carriage" else shapes.l_index


def _port(system: System, coordinate: int) -> int:
    return int(np.flatnonzero(system.ports == coordinate)[0])


def _action(name: str, system: System, robot: Robot) -> _Action:
    channel, shapes = _single(name, robot, "inputs"), system.kernel.shapes
    if channel.group not in ("drive", "command"):
        raise InputError(
            "is not moved in time",
            key="controller.outputs",
            value=name,
            allowed="drive, command; a single one as drive:1",
        )
    leg = channel.leg
    at = push_ports(system, robot)[leg]
    if system.enforced_mask[leg, at]:
        raise InputError(
            f"moves leg {leg + 1}, whose drive keeps its command whatever the force",
            key="controller.outputs",
            value=name,
            allowed="legs whose drives are servos or forces",
            next_step='Give drive.type = "servo" with a stiffness, or "force"',
        )
    if channel.group == "drive":
        return _Action(leg, _port(system, force_ports(system, robot)[leg]), FORCE, 1.0)
    called = {shapes.index(name): f"{words}_stiffness" for name, words in shapes.drives}
    stiffness = float(system.leg_p[leg, columns(leg_parameters(shapes), called[at])].sum())
    if not stiffness:
        raise InputError(
            f"commands leg {leg + 1}, whose drive has no stiffness of its own to its command",
            key="controller.outputs",
            value=name,
            allowed="legs whose drives are servos, or forces with a feedback stiffness",
            next_step=f"Move its force: 'drive:{leg + 1}'",
        )
    return _Action(leg, _port(system, at), VALUE, stiffness)
