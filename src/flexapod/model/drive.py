"""What moves a piston: prescribed stroke, servo, force."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from flexapod.errors import InputError
from flexapod.model.friction import StrokeFriction
from flexapod.model.motion import check_times
from flexapod.schema.base import Frozen, Measure, NonNegative, Number, Positive, Series


class PrescribedDrive(Frozen):
    """The stroke follows the command exactly; its force is a result.

    `backlash`: free travel [m], of a crank [rad]. `friction` of the stroke. Of every drive: `holds`, whether it keeps
    its command, whatever the force; `pushes`, whether it is a force that keeps no position.
    """

    holds: ClassVar[bool] = True
    pushes: ClassVar[bool] = False
    type: Literal["prescribed"] = "prescribed"
    backlash: Annotated[NonNegative, Measure("length", "angle")] | None = None
    friction: StrokeFriction | None = None


class ServoDrive(Frozen):
    """A spring [N/m] and a damper [N s/m] between command and stroke; of a crank [N m/rad, N m s/rad].

    `backlash`: free travel [m], of a crank [rad]. `friction` of the stroke.
    """

    holds: ClassVar[bool] = False
    pushes: ClassVar[bool] = False
    type: Literal["servo"] = "servo"
    stiffness: Annotated[Positive, Measure("stiffness", "rotational stiffness")]
    damping: Annotated[NonNegative, Measure("damping", "rotational damping")] = 0.0
    backlash: Annotated[NonNegative, Measure("length", "angle")] | None = None
    friction: StrokeFriction | None = None


class Feedback(Frozen):
    """Correction of a force drive: gain on stroke [N/m] and on stroke rate [N s/m]."""

    stiffness: Annotated[NonNegative, Measure("stiffness", "rotational stiffness")]
    damping: Annotated[NonNegative, Measure("damping", "rotational damping")] = 0.0


class ForceDrive(Frozen):
    """A force along the leg, of a crank a torque; the stroke is a result.

    ``law = "rigid"`` replays the force that the rigid robot needs, ``law = "constant"`` is `value` [N, N m],
    ``law = "csv"`` takes `force` [N] at the
    instants `time` [s], from 0, read from `file`: linear between the rows, with a jump where two rows stand at one
    instant. `friction` of the stroke.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "force")
    holds: ClassVar[bool] = False
    type: Literal["force"] = "force"
    law: Literal["rigid", "constant", "csv"] = "rigid"
    file: str | None = None
    time: Annotated[Series, Measure("time")] | None = None
    force: Annotated[Series, Measure("force", "torque")] | None = None
    value: Annotated[Number, Measure("force", "torque")] | None = None
    feedback: Feedback | None = None
    friction: StrokeFriction | None = None

    @property
    def pushes(self) -> bool:
        """Whether it is a force that keeps no position."""
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
