"""Laws of one scalar over time, for the single actuator. Data only: evaluation is elsewhere."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from flexapod.model.base import Frozen, Measure, NonNegative, Number, Positive, Series
from flexapod.model.motion import Profile, check_times

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
