"""Laws of single motions, loads over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from flexapod.common.tables.base import FileKey, Key, Quantity, Series, Series6, Vec6
from flexapod.common.tables.csv_tables import WRENCH, stack_columns
from flexapod.common.tables.named_files import Content, columns_of_table
from flexapod.common.tables.table import Place, Table
from flexapod.model.motion import Profile, check_times

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

_MEASURED = {  # by a law of a single actuator, under its key
    "": "number",
    "rotation": "angle",
    "elevation": "angle",
    "extension": "length",
    "torque": "torque",
    "elevation_torque": "torque",
    "force": "force",
}
_AMPLITUDE = ("angle", "length", "torque", "force")


class RateLaw(Table):
    """Constant `rate` [rad/s or m/s] from t = 0 on."""

    law: Annotated[Literal["rate"], Key("law over time", usual="rate")] = "rate"
    rate: Annotated[float, Quantity("angular rate", "velocity", why="rate")]


class ProfileLaw(Table):
    """Way from 0 to `amplitude` [rad, m, N m or N] in `duration` [s], then constant."""

    law: Annotated[Profile, Key("law over time")]
    amplitude: Annotated[float, Quantity(*_AMPLITUDE)]
    duration: Annotated[float, Quantity("time", above=0, why="time to get there")]


class SpinUpLaw(Table):
    """Start from rest to `rate` [rad/s or m/s] in `duration` [s] with a smooth acceleration, then constant rate."""

    law: Annotated[Literal["spin-up"], Key("law over time", usual="rate")] = "spin-up"
    rate: Annotated[float, Quantity("angular rate", "velocity", why="rate")]
    duration: Annotated[float, Quantity("time", above=0, why="time to get there")]


class CsvLaw(Table):
    """A table: `value` (n,) [rad, m, N m or N] at `time` (n,) [s], from 0, read from `file`.

    A torque or force is linear between the rows and jumps where two rows stand at one instant; a motion is smooth.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "value")
    law: Annotated[Literal["csv"], Key("law over time")] = "csv"
    file: Annotated[str | None, FileKey()] = None
    time: Annotated[Series, Quantity("time", why="instant of the step")]
    value: Annotated[Series, Quantity(*_AMPLITUDE)]

    def file_content(self, place: Place) -> Content:
        """Values; what they measure the key says."""
        return columns_of_table({"value": _MEASURED[place.key.rpartition(".")[2]]}, self.time, self.value[:, None])

    @model_validator(mode="after")
    def _table(self) -> CsvLaw:
        check_times(self.time, len(self.value), jumps=True)  # of a load; a motion refuses them
        return self


class ConstantLaw(Table):
    """A constant `value` [N m or N]."""

    law: Annotated[Literal["constant"], Key("law over time")] = "constant"
    value: Annotated[float, Quantity("torque", "force")]


class SineLaw(Table):
    """amplitude [N m or N] times sin(2 pi frequency t + phase); frequency [Hz], phase [rad]."""

    law: Annotated[Literal["sine"], Key("law over time")] = "sine"
    amplitude: Annotated[float, Quantity(*_AMPLITUDE)]
    frequency: Annotated[float, Quantity("frequency", above=0, why="frequency")]
    phase: Annotated[float, Quantity("angle", why="phase at t = 0")] = 0.0


class StepLaw(Table):
    """Zero before `time` [s], `amplitude` [N m or N] from then on."""

    law: Annotated[Literal["step"], Key("law over time")] = "step"
    amplitude: Annotated[float, Quantity(*_AMPLITUDE)]
    time: Annotated[float, Quantity("time", least=0, why="instant of the step")] = 0.0


MotionLaw = Annotated[RateLaw | ProfileLaw | SpinUpLaw | CsvLaw, Field(discriminator="law")]
LoadLaw = Annotated[ConstantLaw | ProfileLaw | SineLaw | StepLaw | CsvLaw, Field(discriminator="law")]


class ConstantWrench(Table):
    """`value` (6,): Fx Fy Fz [N], Mx My Mz [N m], at the tool, world axes, at all times."""

    law: Annotated[Literal["constant"], Key("law over time")] = "constant"
    value: Annotated[Vec6, Quantity("force", "torque", why="Fx, Fy, Fz, Mx, My, Mz")]


class SineWrench(Table):
    """amplitude (6,) [N, N m] times sin(2 pi frequency t + phase); frequency [Hz], phase [rad]."""

    law: Annotated[Literal["sine"], Key("law over time")] = "sine"
    amplitude: Annotated[Vec6, Quantity("force", "torque", why="Fx, Fy, Fz, Mx, My, Mz")]
    frequency: Annotated[float, Quantity("frequency", above=0, why="frequency")]
    phase: Annotated[float, Quantity("angle", why="phase at t = 0")] = 0.0


class StepWrench(Table):
    """Zero before `time` [s], `amplitude` (6,) [N, N m] from then on."""

    law: Annotated[Literal["step"], Key("law over time")] = "step"
    amplitude: Annotated[Vec6, Quantity("force", "torque", why="Fx, Fy, Fz, Mx, My, Mz")]
    time: Annotated[float, Quantity("time", least=0, why="instant of the step")] = 0.0


class CsvWrench(Table):
    """A table: `time` (n,) [s], from 0, and `wrench` (n, 6) [N, N m], read from `file`.

    The wrench is linear between the rows, jumps where two rows stand at one instant and keeps its last value.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "wrench")
    law: Annotated[Literal["csv"], Key("law over time")] = "csv"
    file: Annotated[str | None, FileKey("CSV file of the wrench")] = None
    time: Annotated[Series, Quantity("time", why="instant of the step")]
    wrench: Annotated[Series6, Quantity("force", "torque")]

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Columns of its table."""
        table = section.table(WRENCH, jumps=True)
        return {"time": table["time"], "wrench": stack_columns(table, WRENCH)}

    def file_content(self, place: Place) -> Content:
        """Forces and moments."""
        return columns_of_table(WRENCH, self.time, self.wrench)

    @model_validator(mode="after")
    def _table(self) -> CsvWrench:
        check_times(self.time, len(self.wrench), jumps=True)
        return self


Wrench = Annotated[ConstantWrench | SineWrench | StepWrench | CsvWrench, Field(discriminator="law")]


class Load(Table):
    """External load of a robot: `wrench` at the tool, world axes, or none."""

    wrench: Annotated[Wrench | None, Key("Fx, Fy, Fz, Mx, My, Mz, or a table: a law over time")] = None

    @classmethod
    def from_table(cls, section: Section, among: tuple[str, ...] = ()) -> Load:
        """Load of a table: a wrench, six numbers or a law."""
        section.check_keys("wrench")
        section.require_keys("wrench")
        return section.build(cls, wrench=read_wrench(section)).attach_source(section.source_table)


def read_wrench(section: Section) -> Wrench:
    """The key `wrench` of a table [load]: six numbers, or a law."""
    value = section.data["wrench"]
    if isinstance(value, list):
        return section.build(ConstantWrench, value=section.vector("wrench", *WRENCH.values()))
    kinds = (ConstantWrench, SineWrench, StepWrench, CsvWrench)
    return section.child(value, "wrench").one_of(kinds)
