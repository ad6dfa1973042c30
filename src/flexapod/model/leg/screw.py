"""A ball or roller screw: shaft, nut, thrust bearing, rotor; catalogue laws, Eqs. (T15.5)-(T15.10)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Field, model_validator

from flexapod.common.errors import InputError
from flexapod.common.quantities import number
from flexapod.common.tables.base import FileKey, Key, Loss, Quantity, Series
from flexapod.common.tables.named_files import Content
from flexapod.common.tables.table import Place, Table
from flexapod.model.leg.drive import ForceDrive, PrescribedDrive, ServoDrive, drive_columns, read_columns
from flexapod.model.leg.friction import ScrewFriction
from flexapod.model.leg.hydraulic import HydraulicDrive
from flexapod.model.leg.material import MadeOf, Material, read_material
from flexapod.model.leg.motor import Brake, Encoder, Limits, Loop, Motor, Rotor, summing
from flexapod.model.leg.spring import check_lossy
from flexapod.model.motion import check_times

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section

UNLOADS = 2 * math.sqrt(2)  # thrust over preload beyond which one half of a preloaded nut carries nothing
HIGHEST = 0.1  # preload over dynamic load rating of a double nut, at most (HIWIN 3.6)
TURNING = ("rotational stiffness", "rotational damping", "torque", "angle")
UM = 1e6  # N/m of an N/um


class Nut(Table):
    """The nut: its `stiffness` [N/m], or the catalogue's.

    `rigidity` [N/m] at a preload of a tenth of the `dynamic_load` [N], and the `preload` [N]. `dynamic_load` and
    `static_load` [N]: load ratings, for life and safety. `backlash`: free travel [m].
    """

    stiffness: Annotated[float | None, Quantity("stiffness", above=0, why="along the screw")] = None
    rigidity: Annotated[
        float | None, Quantity("stiffness", above=0, why="of the catalogue, at a preload of a tenth of dynamic_load")
    ] = None
    preload: Annotated[float | None, Quantity("force", above=0, why="of the nut, at most a tenth of dynamic_load")] = (
        None
    )
    dynamic_load: Annotated[
        float | None, Quantity("force", above=0, why="dynamic load rating: for life, and for the law of the rigidity")
    ] = None
    static_load: Annotated[float | None, Quantity("force", above=0, why="static load rating: for safety")] = None
    damping: Annotated[float | None, Quantity("damping", least=0, why="damper beside it")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of damping")] = None
    backlash: Annotated[
        float | None,
        Quantity("length", least=0, why="free travel of the nut, from one end to the other: for `flexapod.accuracy`"),
    ] = None

    @model_validator(mode="after")
    def _one_law(self) -> Nut:
        check_lossy(self)
        if self.backlash and self.preload is not None:
            raise InputError(
                "is none in a preloaded nut", key="backlash", value=self.backlash, allowed="0, or no preload"
            )
        law = ("rigidity", "preload") if self.stiffness is not None else ("rigidity", "preload", "dynamic_load")
        _one_of(self, "stiffness", law)
        if None not in (self.dynamic_load, self.static_load) and self.static_load < self.dynamic_load:  # type: ignore[operator]
            raise InputError(
                "is less than dynamic_load",
                key="static_load",
                value=self.static_load,
                allowed=f"at least {number(self.dynamic_load or 0.0)} N, as of all ball screws",
                next_step="See the catalogue: the two may have changed places",
            )
        if self.preload is not None and self.dynamic_load is not None and self.preload > HIGHEST * self.dynamic_load:
            raise InputError(
                "is more than nuts are made for",
                key="preload",
                value=self.preload,
                allowed=f"at most a tenth of dynamic_load, {number(HIGHEST * self.dynamic_load)} N; half of it where "
                "one nut is preloaded by an offset of its lead",
                next_step="See the catalogue's preload, or give stiffness",
            )
        return self

    @property
    def k(self) -> float:
        """Stiffness [N/m]: as given, or 0.8 of the rigidity, with the cube root of the preload, Eq. (T15.8)."""
        if self.stiffness is not None:
            return self.stiffness
        return 0.8 * self.rigidity * (self.preload / (HIGHEST * self.dynamic_load)) ** (1 / 3)  # type: ignore[operator]

    @property
    def linear_to(self) -> float:
        """Thrust beyond which the nut is softer [N], Eq. (T15.9); infinite of a stiffness that is given."""
        return math.inf if self.preload is None else UNLOADS * self.preload


class Bearing(Table):
    """The thrust bearing of a screw, at `position` [m] along the cylinder from the base joint.

    Its `stiffness` [N/m], or with ``model = "angular-contact"`` that of a preloaded pair: `preload` [N], number of
    `balls`, `ball_diameter` [m], `contact_angle` [rad].
    """

    position: Annotated[float, Quantity("length", least=0, why="along the cylinder from the base joint")]
    stiffness: Annotated[float | None, Quantity("stiffness", above=0, why="along the screw")] = None
    model: Annotated[Literal["given", "angular-contact"], Key("where the stiffness comes from")] = "given"
    preload: Annotated[float | None, Quantity("force", above=0, why="of the pair")] = None
    balls: Annotated[Annotated[int, Field(strict=True, ge=3, le=1000)] | None, Key("how many in a row")] = None
    ball_diameter: Annotated[float | None, Quantity("length", above=0, why="of a ball")] = None
    contact_angle: Annotated[
        float | None,
        Quantity("angle", above=0, most=math.pi / 2, why="between the line of contact and the radial plane"),
    ] = None
    damping: Annotated[float | None, Quantity("damping", least=0, why="damper beside it")] = None
    loss: Annotated[Loss | None, Key("loss factor, in place of damping")] = None

    @model_validator(mode="after")
    def _one_law(self) -> Bearing:
        check_lossy(self)
        if self.model == "given" and self.stiffness is None:
            raise InputError("is missing", key="stiffness", next_step='Add it, or model = "angular-contact"')
        _one_of(self, "stiffness", ("preload", "balls", "ball_diameter", "contact_angle"))
        return self

    @property
    def k(self) -> float:
        """Stiffness [N/m]: as given, or 3 F_a0 / delta_a0 of a pair, Eq. (T15.10)."""
        if self.stiffness is not None:
            return self.stiffness
        preload, sine = self.preload or 0.0, math.sin(self.contact_angle or 0.0)
        ball = preload / ((self.balls or 1) * sine)  # N
        approach = 0.45 / sine * (ball**2 / (1e3 * (self.ball_diameter or 1.0))) ** (1 / 3)  # um, of balls in mm
        return 3 * preload / approach * UM


class ScrewDrive(MadeOf):
    """A screw that the motor turns in a thrust bearing in the cylinder; its nut is the piston's inner end.

    `lead` [m] a turn; the shaft between bearing and nut by its `root_diameter` [m], `length` [m] from the bearing and
    `material`; `mounting` of its far end. What the motor does to the rotor: `command` "position" holds it, "servo" has
    a `loop` (spring [N m/rad] and damper [N m s/rad] on the screw's angle, and what sums the error), "torque" pushes,
    with or without a loop: by ``law = "rigid"`` with what the rigid robot and the rotor need, "constant" with the
    motor's torque `value` [N m], "csv" with its `torque` at the instants `time` [s] read from `file`. `efficiency`:
    thrust times lead over the screw's work; it, `limits` and `brake` are for checks and remarks alone. `friction` at
    the nut.
    """

    derived: ClassVar[tuple[str, ...]] = ("time", "torque")

    type: Annotated[Literal["screw"], Key("kind of drive")] = "screw"
    lead: Annotated[float, Quantity("length", above=0, why="travel of the nut in a turn of the screw")]
    root_diameter: Annotated[float, Quantity("length", above=0, why="of the shaft, without its threads")]
    length: Annotated[float, Quantity("length", above=0, why="of the shaft, from the bearing")]
    material: Annotated[Material, Key("of the shaft")]
    efficiency: Annotated[
        float, Quantity("number", above=0, most=1, why="thrust times lead over work of the screw")
    ] = 0.9
    mounting: Annotated[
        Literal["fixed-free", "fixed-supported", "fixed-fixed"],
        Key("of the shaft's far end: with fixed-fixed both ends take the thrust"),
    ] = "fixed-free"
    bearing: Annotated[Bearing, Key("table: the thrust bearing")]
    nut: Annotated[Nut, Key("table: the nut")]
    rotor: Annotated[Rotor, Key("table: what turns with the motor")] = Rotor()
    motor: Annotated[Motor, Key("table: torque constant, bandwidth and ripple of the motor")] = Motor()
    command: Annotated[
        Literal["position", "servo", "torque"], Key("what the motor keeps: the measured place, a servo loop, a torque")
    ] = "position"
    law: Annotated[
        Literal["rigid", "constant", "csv"], Key("where the force or the torque comes from", usual="rigid")
    ] = "rigid"
    value: Annotated[
        float | None,
        Quantity("torque", why='the force or the torque, for law "constant"', usual="required by law constant"),
    ] = None
    file: Annotated[str | None, FileKey('CSV file of the forces or torques, for law "csv"')] = None
    time: Annotated[Series | None, Quantity("time")] = None
    torque: Annotated[Series | None, Quantity("torque")] = None
    loop: Annotated[Loop | None, BeforeValidator(summing), Key("table: spring and damper of the loop")] = None
    encoder: Annotated[Encoder, Key("table: where the position is measured")] = Encoder()
    limits: Annotated[Limits, Key("table: what the drive is made for")] = Limits()
    brake: Annotated[Brake | None, Key("table: a brake at the motor")] = None
    friction: Annotated[
        ScrewFriction | None, Key("table: friction of the stroke, of a screw at its nut", usual="none")
    ] = None

    @classmethod
    def measuring(cls, section: Section, among: tuple[str, ...]) -> tuple[str, ...]:
        """All its numbers are of what turns."""
        return TURNING

    @classmethod
    def fields_from_section(cls, section: Section) -> Mapping[str, object]:
        """Material, and torques over time."""
        return {"material": read_material(section), **read_columns(section, "torque")}

    def file_content(self, place: Place) -> Content:
        """Torques over time."""
        return drive_columns(place.leg, "torque", self.time, self.torque)

    @model_validator(mode="after")
    def _sensible(self) -> ScrewDrive:
        if self.command == "position" and self.loop is not None:
            raise InputError(
                "has nothing to do where the position is held",
                key="loop",
                allowed='with command = "servo" or "torque"',
            )
        if self.command == "servo" and (self.loop is None or not self.loop.stiffness > 0):
            raise InputError("is missing", key="loop", next_step="Add loop = { stiffness, damping }, N m/rad")
        for key, given in (("encoder.at", self.encoder.at), ("encoder.rate", self.encoder.rate)):
            usual = Encoder.model_fields[key.split(".")[1]].default
            if self.command == "torque" and given != usual and not any(self.loop_spring):
                raise InputError(
                    "measures what no loop asks for",
                    key=key,
                    value=given,
                    allowed=f"{usual}; or a loop beside the torque",
                    next_step="Add loop = { stiffness, damping }, N m/rad, or leave the key out",
                )
        for key, given in (("motor.bandwidth", self.motor.bandwidth), ("encoder.rate", self.encoder.rate == "rotor")):
            if self.command == "position" and given:
                raise InputError(
                    "has nothing to do where the position is held",
                    key=key,
                    allowed='with command = "servo" or "torque"',
                    next_step="Leave it out, or give a loop",
                )
        return self

    @model_validator(mode="after")
    def _steady(self) -> ScrewDrive:
        loop = self.loop  # (T23.17), (T23.57)
        left = 0.0 if loop is None else loop.stiffness * max(loop.damping - self.lag * loop.stiffness, 0.0)
        if loop is not None and loop.integral > 0 and self.inertia * loop.integral >= left:
            most = left / self.inertia
            raise InputError(
                "makes the loop unstable, whatever it drives",
                key="loop.integral",
                value=loop.integral,
                allowed=f"below stiffness * {'(damping - lag * stiffness)' if self.lag else 'damping'} / inertia "
                f"of all that turns = {number(most)} N m/(rad s)",
                next_step="With a payload a third of that leaves some margin",
            )
        return self

    @model_validator(mode="after")
    def _torque_law(self) -> ScrewDrive:
        given = [name for name in ("value", "file", "time", "torque") if getattr(self, name) is not None]
        if self.command != "torque" and (given or self.law != "rigid"):
            raise InputError("is of a torque", key=given[0] if given else "law", allowed='with command = "torque"')
        wanted = {"rigid": (), "constant": ("value",), "csv": ("file", "time", "torque")}[self.law]
        if foreign := [name for name in given if name not in wanted]:
            raise InputError(f"is not used by law {self.law!r}", key=foreign[0])
        if self.law == "constant" and self.value is None:
            raise InputError("is missing", key="value")
        if self.law == "csv" and (self.time is None or self.torque is None):
            raise InputError("is missing", key="file", next_step='Add file = "torques.csv" to the drive')
        if self.time is not None and self.torque is not None:
            if self.time.shape != self.torque.shape:
                raise InputError("has another length than time", key="torque", value=self.torque.shape)
            check_times(self.time, len(self.time), jumps=True)
        return self

    @property
    def backlash(self) -> float | None:
        """Free travel of the nut [m]."""
        return self.nut.backlash

    @property
    def area(self) -> float:
        """Area of the shaft [m^2]."""
        return math.pi / 4 * self.root_diameter**2

    @property
    def per_turn(self) -> float:
        """Travel of the nut by an angle of the screw [m/rad]."""
        return self.lead / (2 * math.pi)

    @property
    def inertia(self) -> float:
        """Inertia of everything that turns, about the screw's axis [kg m^2], Eq. (T15.12)."""
        polar = math.pi / 32 * self.root_diameter**4
        return self.material.density * self.length * polar + self.rotor.ratio**2 * self.rotor.inertia

    @property
    def loop_spring(self) -> tuple[float, float]:
        """Stiffness [N/m] and damping [N s/m] of the loop, by the nut's travel."""
        if self.loop is None:
            return 0.0, 0.0
        return self.loop.stiffness / self.per_turn**2, self.loop.damping / self.per_turn**2

    @property
    def integral(self) -> float:
        """Gain of the summed error, by the nut's travel [N/(m s)]."""
        return 0.0 if self.loop is None else self.loop.integral / self.per_turn**2

    @property
    def holds(self) -> bool:
        """Tell whether it keeps its command, whatever the force."""
        return self.command == "position"

    @property
    def rests(self) -> bool:
        """Tell whether it keeps its command at rest: a loop that sums its error leaves none."""
        return self.holds or self.integral > 0

    @property
    def pushes(self) -> bool:
        """Tell whether it is a torque that keeps no position."""
        return self.command == "torque" and not (self.loop is not None and self.loop.stiffness > 0)

    @property
    def holds_stroke(self) -> bool:
        """Tell whether the loop is closed behind the nut."""
        return self.encoder.at != "rotor"

    @property
    def lag(self) -> float:
        """Time by which the motor's torque lags behind what is asked of it [s], Eq. (T23.51)."""
        return 0.0 if self.motor.bandwidth is None else 1 / (2 * math.pi * self.motor.bandwidth)

    @property
    def closes_elsewhere(self) -> bool:
        """Tell whether its loop is closed about another place than the rotor on which the motor acts."""
        return self.holds_stroke and not self.holds

    @property
    def loops(self) -> bool:
        """Tell whether its motor is more than a spring and a damper on its rotor."""
        return self.lag > 0 or self.closes_elsewhere

    @property
    def increment(self) -> float:
        """Least length that its encoder tells apart [m], 0 where none is given, Eq. (T23.12)."""
        turns = self.per_turn / self.rotor.ratio if self.encoder.at == "rotor" else 1.0
        return (self.encoder.resolution or 0.0) * turns


Drive = Annotated[PrescribedDrive | ServoDrive | ForceDrive | ScrewDrive | HydraulicDrive, Field(discriminator="type")]


def _one_of(part: Table, given: str, law: tuple[str, ...]) -> None:
    """Raise InputError unless a part has either its stiffness or all numbers of a catalogue's law."""
    has = [name for name in law if getattr(part, name) is not None]
    if getattr(part, given) is not None and has:
        raise InputError(f"is given together with {given}", key=has[0], allowed="either of the two")
    if getattr(part, given) is None and len(has) < len(law):
        missing = next(name for name in law if name not in has)
        raise InputError(
            "is missing", key=missing if has else given, next_step=f"Add {given}, or all of {', '.join(law)}"
        )
