"""Sampled controllers of a robot's drives, as a study file has them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, PlainSerializer, PlainValidator, model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import FileKey, Key, Quantity, Vec6, array_of
from flexapod.common.tables.named_files import Content
from flexapod.common.tables.table import Place, Table

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section
    from flexapod.model.motion import Motion
    from flexapod.model.study.robot import Robot

Matrix = Annotated[
    Array, PlainValidator(array_of((None, None))), PlainSerializer(lambda rows: rows.tolist()), Quantity("number")
]
NONE = (0.0,) * 6
Count = Annotated[int, Field(strict=True, ge=0, le=1000)]
Seed = Annotated[int, Field(strict=True, ge=0, le=2**31 - 1)]
LowPass = Annotated[
    float | None,
    Quantity("frequency", above=0, why="above it rates count less", usual="differences from sample to sample"),
]
StepOfStroke = Annotated[
    float | None, Quantity("length", least=0, why="step of the readings, as of an encoder", usual="none")
]
NoiseOfStroke = Annotated[
    float | None, Quantity("length", least=0, why="standard deviation of a reading", usual="none")
]


class _Sampled(Table):
    """Base of all: `sample` [s] from one reading to the next, `delay_samples`, limits, noise of the readings.

    ``reads``: the channels that it reads.
    """

    reads: ClassVar[str]
    sample: Annotated[float, Quantity("time", above=0, why="time between samples; of fixed steps a multiple")]
    delay_samples: Annotated[Count, Key("samples from a reading to the force that is made of it")] = 0
    saturate: Annotated[float | None, Quantity("force", above=0, why="largest force of a drive", usual="no limit")] = (
        None
    )
    seed: Annotated[Seed, Key("of the noise: the same seed gives the same bits")] = 0


class ForceControl(_Sampled):
    """Integral force feedback at each drive: `gain` [1/s], `high_pass` [Hz], `parallel_stiffness` [N/m].

    Numbers of readings of forces in N; strokes are read as they are.
    """

    reads: ClassVar[str] = "force-sensor:drive"
    law: Annotated[Literal["iff"], Key("what is fed back")] = "iff"
    gain: Annotated[
        float, Quantity("number", above=0, why="force of the drive per integral of the force that it feels [1/s]")
    ]
    high_pass: Annotated[
        float, Quantity("frequency", least=0, why="below it the integral fades, and static stiffness stays")
    ] = 0.0
    parallel_stiffness: Annotated[
        float, Quantity("stiffness", least=0, why="force per stroke that is added to the readings, and stays at rest")
    ] = 0.0
    quantise: Annotated[float | None, Quantity("force", least=0, why="step of the readings", usual="none")] = None
    noise: Annotated[float | None, Quantity("force", least=0, why="standard deviation of a reading", usual="none")] = (
        None
    )


class DampedControl(_Sampled):
    """Feedback of the rate of each stroke: `gain` [N s/m], `low_pass` [Hz]; numbers of readings in m."""

    reads: ClassVar[str] = "stroke"
    law: Annotated[Literal["dvf"], Key("what is fed back")] = "dvf"
    gain: Annotated[float, Quantity("damping", above=0, why="force of the drive against the rate of its stroke")]
    low_pass: LowPass = None
    quantise: StepOfStroke = None
    noise: NoiseOfStroke = None


class StrokeControl(_Sampled):
    """Proportional, integral and rate feedback of each stroke: `proportional` [N/m], `integral` [N/(m s)].

    `derivative` [N s/m], its `low_pass` [Hz]; numbers of readings in m.
    """

    reads: ClassVar[str] = "stroke"
    law: Annotated[Literal["pid"], Key("what is fed back")] = "pid"
    proportional: Annotated[float, Quantity("stiffness", least=0, why="force of the drive against its stroke")] = 0.0
    integral: Annotated[
        float, Quantity("integral stiffness", least=0, why="force of the drive against the integral of its stroke")
    ] = 0.0
    derivative: Annotated[
        float, Quantity("damping", least=0, why="force of the drive against the rate of its stroke")
    ] = 0.0
    low_pass: LowPass = None
    quantise: StepOfStroke = None
    noise: NoiseOfStroke = None

    @model_validator(mode="after")
    def _something(self) -> StrokeControl:
        _refuse_nothing(self)
        return self


class ToolControl(_Sampled):
    """The same of the six motions of the tool beside its path, each by gains of its own, decoupled by the drives.

    Six numbers along and about the world's axes: `proportional` [N/m, N m/rad], `integral` [N/(m s), N m/(rad s)],
    `derivative` [N s/m, N m s/rad], `quantise` and `noise` [m, rad].
    """

    reads: ClassVar[str] = "tool"
    law: Annotated[Literal["tool-pid"], Key("what is fed back")] = "tool-pid"
    proportional: Annotated[
        Vec6,
        Quantity("stiffness", "rotational stiffness", why="force and moment at the tool against x, y, z, rx, ry, rz"),
    ] = Field(default=NONE, validate_default=True)
    integral: Annotated[
        Vec6, Quantity("integral stiffness", "integral gain", why="the same against their integrals")
    ] = Field(default=NONE, validate_default=True)
    derivative: Annotated[Vec6, Quantity("damping", "rotational damping", why="the same against their rates")] = Field(
        default=NONE, validate_default=True
    )
    low_pass: LowPass = None
    quantise: Annotated[Vec6 | None, Quantity("length", "angle", why="steps of the readings", usual="none")] = None
    noise: Annotated[
        Vec6 | None, Quantity("length", "angle", why="standard deviations of the readings", usual="none")
    ] = None

    @model_validator(mode="after")
    def _something(self) -> ToolControl:
        for name in ("proportional", "integral", "derivative", "quantise", "noise"):
            given = getattr(self, name)
            if given is not None and (given < 0).any():
                at = int(np.argmax(given < 0)) + 1
                raise InputError("is below 0", key=f"{name}[{at}]", value=float(given[at - 1]), allowed="0 or more")
        _refuse_nothing(self)
        return self

    def check(self, robot: Robot, motion: Motion) -> None:
        """Refuse a robot whose drives do not move the tool in six ways, or whose base does not stand still."""
        fewer = sum(bool(leg.driven) for leg in robot.legs) < 6 or motion.independent is not None
        if fewer or robot.platform_fixed or robot.base_motion is not None:
            raise InputError(
                "moves the tool in six ways, and reads it against a base that stands still",
                key="control.law",
                value=self.law,
                allowed="robots with six drives or more and six motions, without robot.base_motion",
                next_step='Feed back the strokes: law = "pid"',
            )


def _refuse_nothing(table: StrokeControl | ToolControl) -> None:
    if not any(np.any(x) for x in (table.proportional, table.integral, table.derivative)):
        raise InputError(
            "is 0, and so are integral and derivative: nothing is fed back", key="proportional", allowed="one above 0"
        )


class FileControl(_Sampled):
    """A law of one's own: a state space from readings to outputs, its matrices and channels in a `file`.

    From `inputs` (m), the sensors, to `outputs` (p), the actuators, with n states: A (n, n), B (n, m), C (p, n),
    D (p, m); `own`: its time between samples [s], None of a law in continuous time.
    """

    derived: ClassVar[tuple[str, ...]] = ("A", "B", "C", "D", "inputs", "outputs", "own")
    law: Annotated[Literal["file"], Key("what is fed back")] = "file"
    file: Annotated[
        str | None, FileKey("state space as `StateSpace.save` writes it: .json, .npz, .mat, relative to this file")
    ] = None
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    own: Annotated[float | None, Quantity("time", above=0)] = None

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Matrices and channels."""
        found = section.linear_system()
        return found | {"own": found.pop("sample")}

    def file_content(self, place: Place) -> Content:
        """Matrices and channels."""
        parts = {name: getattr(self, name) for name in ("A", "B", "C", "D", "inputs", "outputs")}
        return {name: ("", value) for name, value in (parts | {"sample": self.own}).items()}

    @model_validator(mode="after")
    def _samples(self) -> FileControl:
        if self.own is not None and abs(self.own - self.sample) > 1e-9 * self.sample:
            raise InputError(
                "is not the time between samples of the law in the file",
                key="sample",
                value=self.sample,
                allowed=f"{self.own:.9g} s; a law in continuous time takes any",
            )
        return self


Control = ForceControl | DampedControl | StrokeControl | ToolControl | FileControl
