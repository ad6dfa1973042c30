"""Parts that turn a screw: rotor, motor, brake, encoder, loop, and what these are made for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import model_validator

from flexapod.common.errors import InputError
from flexapod.common.quantities import number
from flexapod.common.tables.base import Key, Quantity
from flexapod.common.tables.table import Table
from flexapod.mechanics.elements.ripple import Ripple
from flexapod.model.leg.drive import Feedback

if TYPE_CHECKING:
    from flexapod.common.tables.section import Section


class Rotor(Table):
    """Rotor of the motor: `inertia` [kg m^2] at the motor, which turns `ratio` times as fast as the screw."""

    inertia: Annotated[float, Quantity("inertia", least=0, why="at the motor, with brake and coupling")] = 0.0
    ratio: Annotated[float, Quantity("number", above=0, why="turns of the motor in a turn of the screw")] = 1.0


class Motor(Table):
    """The motor: its `torque_constant` [N m/A], the `bandwidth` [Hz] of its current's loop, and its `ripple`."""

    torque_constant: Annotated[float | None, Quantity("torque constant", above=0, why="torque by current")] = None
    bandwidth: Annotated[
        float | None,
        Quantity("frequency", above=0, why="of the current's loop: the torque is that of a lag of first order"),
    ] = None
    ripple: Annotated[Ripple | None, Key("table: a torque that returns with its turns")] = None


class Limits(Table):
    """Limits of what the drive is made for.

    `force` [N] on the screw; `speed` [rad/s], `torque` and `rms_torque` [N m] of the motor.
    """

    force: Annotated[float | None, Quantity("force", above=0, why="thrust on screw and bearing")] = None
    speed: Annotated[float | None, Quantity("angular rate", above=0, why="of the motor")] = None
    torque: Annotated[float | None, Quantity("torque", above=0, why="of the motor, for a moment")] = None
    rms_torque: Annotated[
        float | None,
        Quantity("torque", above=0, why="of the motor, without end: root mean square over the study's duration"),
    ] = None

    @model_validator(mode="after")
    def _ordered(self) -> Limits:
        if self.torque is not None and self.rms_torque is not None and self.rms_torque > self.torque:
            raise InputError(
                "is above the largest torque",
                key="rms_torque",
                value=self.rms_torque,
                allowed=f"at most torque = {number(self.torque)} N m",
                next_step="rms_torque is what the motor bears without end, torque what it gives for a moment",
            )
        return self


class Brake(Table):
    """A brake at the motor: the `torque` [N m] that it holds."""

    torque: Annotated[float, Quantity("torque", above=0, why="that it holds")]


class Encoder(Table):
    """Measurement of the position: the motor's angle, the stroke, or the distance of both joints of the leg.

    `resolution`: what it tells apart [m], of the motor's angle [rad]. `rate` "rotor": a loop about another place takes
    the rate, which its damping acts on, from the motor's angle.
    """

    at: Annotated[Literal["rotor", "stroke", "joint-to-joint"], Key("where")] = "rotor"
    resolution: Annotated[
        float | None,
        Quantity("length", "angle", above=0, why="what it tells apart: a length, at the rotor an angle of the motor"),
    ] = None
    rate: Annotated[
        Literal["same", "rotor"],
        Key("what the damping of a loop about another place acts on: the rate there, or the rotor's"),
    ] = "same"

    @classmethod
    def measuring(cls, section: Section, among: tuple[str, ...]) -> tuple[str, ...]:
        """Angles at the rotor, lengths elsewhere."""
        return ("angle",) if section.data.get("at", "rotor") == "rotor" else ("length",)


class Loop(Feedback):
    """A loop about what the encoder measures, that also sums its error: gain of the `integral` [N m/(rad s)]."""

    integral: Annotated[float, Quantity("integral gain", least=0, why="torque by the error summed over time")] = 0.0


def summing(loop: object) -> object:
    """A loop out of a correction that sums nothing."""
    plain = isinstance(loop, Feedback) and not isinstance(loop, Loop)
    return Loop(stiffness=loop.stiffness, damping=loop.damping) if plain else loop  # type: ignore[union-attr]
