"""Forces and moments on the tool: constant, sine, step, table."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from flexapod.model.base import Frozen, Measure, NonNegative, Number, Positive, Series, Series6, Vec6
from flexapod.model.motion import check_times


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
