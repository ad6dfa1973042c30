"""Drives of a piston: prescribed stroke, servo, force."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self

from pydantic import model_validator

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.base import FileKey, Key, Quantity, Series
from flexapod.common.tables.csv_tables import force_columns
from flexapod.common.tables.named_files import Content, columns_of_table
from flexapod.common.tables.table import Place, Table
from flexapod.model.leg.friction import Rubs
from flexapod.model.motion import check_times

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section


Backlash = Annotated[
    float | None,
    Quantity(
        "length", "angle", least=0, usual="none",
        why="free travel of what it drives, from one end to the other; of a crank an angle: for `flexapod.accuracy`",
    ),
]  # fmt: skip


def read_columns(section: Section, dimension: str) -> Mapping[str, object]:
    """Instants, and the force or the torque of the leg whose drive it is, by ``law = "csv"``."""
    if section.data.get("law") != "csv" or "file" not in section:
        return {}
    number, count = section.leg
    found = section.table(force_columns(count, dimension), needed=True, jumps=True)
    return {"time": found["time"], dimension: found[f"leg {number}"]}


def drive_columns(leg: int, dimension: str, time: Array | None, values: Array | None) -> Content:
    """Columns that `read_columns` reads, of the one leg."""
    if time is None or values is None:
        return {}
    return columns_of_table({f"leg {leg}": dimension}, time, values[:, None])


class PrescribedDrive(Table):
    """The stroke follows the command exactly; its force is a result.

    `backlash`: free travel [m], of a crank [rad]. `friction` of the stroke. Of every drive: `holds`, whether it keeps
    its command, whatever the force; `pushes`, whether it is a force that keeps no position.
    """

    holds: ClassVar[bool] = True
    pushes: ClassVar[bool] = False
    type: Annotated[Literal["prescribed"], Key("kind of drive")] = "prescribed"
    backlash: Backlash = None
    friction: Rubs = None


class ServoDrive(Table):
    """A spring [N/m] and a damper [N s/m] between command and stroke; of a crank [N m/rad, N m s/rad].

    `backlash`: free travel [m], of a crank [rad]. `friction` of the stroke.
    """

    holds: ClassVar[bool] = False
    pushes: ClassVar[bool] = False
    type: Annotated[Literal["servo"], Key("kind of drive")] = "servo"
    stiffness: Annotated[float, Quantity("stiffness", "rotational stiffness", above=0, why="of the spring")]
    damping: Annotated[float, Quantity("damping", "rotational damping", least=0, why="of the damper")] = 0.0
    backlash: Backlash = None
    friction: Rubs = None


class Feedback(Table):
    """Correction of a force drive: gain on stroke [N/m] and on stroke rate [N s/m]."""

    stiffness: Annotated[float, Quantity("stiffness", "rotational stiffness", least=0)]
    damping: Annotated[float, Quantity("damping", "rotational damping", least=0)] = 0.0


class ForceDrive(Table):
    """A force along the leg, of a crank a torque; the stroke is a result.

    ``law = "rigid"`` replays the force that the rigid robot needs, ``law = "constant"`` is `value` [N, N m],
    ``law = "csv"`` takes `force` [N] at the
    instants `time` [s], from 0, read from `file`: linear between the rows, with a jump where two rows stand at one
    instant. `friction` of the stroke.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "force")
    holds: ClassVar[bool] = False
    type: Annotated[Literal["force"], Key("kind of drive")] = "force"
    law: Annotated[
        Literal["rigid", "constant", "csv"], Key("where the force or the torque comes from", usual="rigid")
    ] = "rigid"
    file: Annotated[str | None, FileKey('CSV file of the forces or torques, for law "csv"')] = None
    time: Annotated[Series | None, Quantity("time")] = None
    force: Annotated[Series | None, Quantity("force", "torque")] = None
    value: Annotated[
        float | None,
        Quantity(
            "force", "torque", why='the force or the torque, for law "constant"', usual="required by law constant"
        ),
    ] = None
    feedback: Annotated[Feedback | None, Key("table: correction by the stroke's error")] = None
    friction: Rubs = None

    @classmethod
    def from_table(cls, section: Section, among: tuple[str, ...] = ()) -> Self:
        """Drive of a table, with its table of forces, of a crank of torques."""
        dimension = "torque" if "torque" in among else "force"

        def columns(section: Section) -> Mapping[str, object]:
            found = dict(read_columns(section, dimension))
            return found | ({"force": found.pop(dimension)} if found else {})

        return section.read(cls, among=among, then=columns)

    def file_content(self, place: Place) -> Content:
        """Forces, of a crank torques."""
        return drive_columns(place.leg, place.force(place.leg), self.time, self.force)

    @property
    def pushes(self) -> bool:
        """Tell whether it is a force that keeps no position."""
        return self.feedback is None or self.feedback.stiffness == 0

    @model_validator(mode="after")
    def _complete(self) -> ForceDrive:
        given = [name for name in ("file", "time", "force") if getattr(self, name) is not None]
        if self.law != "csv" and given:
            raise InputError(
                f"is not used by law {self.law!r}", key=given[0], next_step='Remove it, or set law = "csv"'
            )
        if self.law == "constant" and self.value is None:
            raise InputError("is missing", key="value")
        if self.law != "constant" and self.value is not None:
            raise InputError(f"is not used by law {self.law!r}", key="value", value=self.value)
        if self.law == "csv" and (self.time is None or self.force is None):
            raise InputError("is missing", key="file", next_step='Add file = "forces.csv" to the drive')
        if self.time is not None and self.force is not None and self.time.shape != self.force.shape:
            raise InputError("has another length than time", key="force", value=self.force.shape)
        if self.time is not None:
            check_times(self.time, len(self.time), jumps=True)
        return self
