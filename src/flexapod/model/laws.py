"""Laws of single motions, loads over time."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from flexapod.model.motion import Profile, check_times
from flexapod.schema.base import Frozen, Measure, NonNegative, Number, Positive, Series, Series6, Vec6

_AMPLITUDE = Measure("angle", "length", "torque", "force")


class RateLaw(Frozen):
    """Constant `rate` [rad/s or m/s] from t = 0 on."""

    law: Literal["rate"] = "rate"
    rate: Annotated[Number, Measure("angular rate", "velocity")]


class ProfileLaw(Frozen):
    """From 0 to `amplitude` [rad, m, N m or N] in `duration` [s], then constant."""

    law: Profile
    amplitude: Annotated[Number, _AMPLITUDE]
    duration: Annotated[Positive, Measure("time")]


class SpinUpLaw(Frozen):
    """From rest to `rate` [rad/s or m/s] in `duration` [s] with a smooth acceleration, then constant rate."""

    law: Literal["spin-up"] = "spin-up"
    rate: Annotated[Number, Measure("angular rate", "velocity")]
    duration: Annotated[Positive, Measure("time")]


class CsvLaw(Frozen):
    """A table: `value` (n,) [rad, m, N m or N] at `time` (n,) [s], from 0, read from `file`.

    A torque or force is linear between the rows and jumps where two rows stand at one instant; a motion is smooth.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "value")
    law: Literal["csv"] = "csv"
    file: str | None = None
    time: Annotated[Series, Measure("time")]
    value: Annotated[Series, _AMPLITUDE]

    @model_validator(mode="after")
    def _table(self) -> CsvLaw:
        check_times(self.time, len(self.value), jumps=True)  # of a load; a motion refuses them
        return self


class ConstantLaw(Frozen):
    """A constant `value` [N m or N]."""

    law: Literal["constant"] = "constant"
    value: Annotated[Number, Measure("torque", "force")]


class SineLaw(Frozen):
    """amplitude [N m or N] times sin(2 pi frequency t + phase); frequency [Hz], phase [rad]."""

    law: Literal["sine"] = "sine"
    amplitude: Annotated[Number, _AMPLITUDE]
    frequency: Annotated[Positive, Measure("frequency")]
    phase: Annotated[Number, Measure("angle")] = 0.0


class StepLaw(Frozen):
    """Zero before `time` [s], `amplitude` [N m or N] from then on."""

    law: Literal["step"] = "step"
    amplitude: Annotated[Number, _AMPLITUDE]
    time: Annotated[NonNegative, Measure("time")] = 0.0


MotionLaw = Annotated[RateLaw | ProfileLaw | SpinUpLaw | CsvLaw, Field(discriminator="law")]
LoadLaw = Annotated[ConstantLaw | ProfileLaw | SineLaw | StepLaw | CsvLaw, Field(discriminator="law")]


class ConstantWrench(Frozen):
    """`value` (6,): Fx Fy Fz [N], Mx My Mz [N m], at the tool, world axes, at all times."""

    law: Literal["constant"] = "constant"
    value: Annotated[Vec6, Measure("force", "torque")]


class SineWrench(Frozen):
    """amplitude (6,) [N, N m] times sin(2 pi frequency t + phase); frequency [Hz], phase [rad]."""

    law: Literal["sine"] = "sine"
    amplitude: Annotated[Vec6, Measure("force", "torque")]
    frequency: Annotated[Positive, Measure("frequency")]
    phase: Annotated[Number, Measure("angle")] = 0.0


class StepWrench(Frozen):
    """Zero before `time` [s], `amplitude` (6,) [N, N m] from then on."""

    law: Literal["step"] = "step"
    amplitude: Annotated[Vec6, Measure("force", "torque")]
    time: Annotated[NonNegative, Measure("time")] = 0.0


class CsvWrench(Frozen):
    """A table: `time` (n,) [s], from 0, and `wrench` (n, 6) [N, N m], read from `file`.

    The wrench is linear between the rows, jumps where two rows stand at one instant and keeps its last value.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "wrench")
    law: Literal["csv"] = "csv"
    file: str | None = None
    time: Annotated[Series, Measure("time")]
    wrench: Annotated[Series6, Measure("force", "torque")]

    @model_validator(mode="after")
    def _table(self) -> CsvWrench:
        check_times(self.time, len(self.wrench), jumps=True)
        return self


Wrench = Annotated[ConstantWrench | SineWrench | StepWrench | CsvWrench, Field(discriminator="law")]


class Load(Frozen):
    """External load of a robot: `wrench` at the tool, world axes, or none."""

    wrench: Wrench | None = None
