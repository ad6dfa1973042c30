"""What turns a screw: rotor, motor, brake, encoder, loop, and what these are made for."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from flexapod.errors import InputError
from flexapod.model.drive import Feedback
from flexapod.schema.base import Frozen, Measure, NonNegative, Positive, Series, array_of
from flexapod.words import number

__all__ = ["HARMONICS", "Brake", "Encoder", "Limits", "Loop", "Motor", "Ripple", "Rotor", "summing"]

HARMONICS = 4  # of a ripple, at most

Force = Annotated[Positive, Measure("force")] | None
Torque = Annotated[Positive, Measure("torque")] | None


class Rotor(Frozen):
    """What turns with the motor: `inertia` [kg m^2] at the motor, which turns `ratio` times as fast as the screw."""

    inertia: Annotated[NonNegative, Measure("inertia")] = 0.0
    ratio: Annotated[Positive, Measure("number")] = 1.0


class Ripple(Frozen):
    """What a motor's torque changes by as it turns: cogging and ripple, `torque` [N m] times `harmonics`.

    `per_turn`: how often the first of these returns in a turn of the motor; `harmonics`: sizes of the first one and of
    its multiples, up to four.
    """

    torque: Annotated[Positive, Measure("torque")]
    per_turn: Annotated[int, Field(strict=True, ge=1, le=1000)]
    harmonics: Annotated[Series, Measure("number")] = array_of((None,))([1.0])

    @model_validator(mode="after")
    def _few(self) -> Ripple:
        if not 1 <= len(self.harmonics) <= HARMONICS:
            raise InputError(
                "has too many or none", key="harmonics", value=len(self.harmonics), allowed=f"1 to {HARMONICS} numbers"
            )
        return self


class Motor(Frozen):
    """The motor: its `torque_constant` [N m/A], the `bandwidth` [Hz] of its current's loop, and its `ripple`."""

    torque_constant: Annotated[Positive, Measure("torque constant")] | None = None
    bandwidth: Annotated[Positive, Measure("frequency")] | None = None
    ripple: Ripple | None = None


class Limits(Frozen):
    """What the drive is made for.

    `force` [N] on the screw; `speed` [rad/s], `torque` and `rms_torque` [N m] of the motor.
    """

    force: Force = None
    speed: Annotated[Positive, Measure("angular rate")] | None = None
    torque: Torque = None
    rms_torque: Torque = None

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


class Brake(Frozen):
    """A brake at the motor: the `torque` [N m] that it holds."""

    torque: Annotated[Positive, Measure("torque")]


class Encoder(Frozen):
    """Where the position is measured: the motor's angle, the stroke, or the distance of both joints of the leg.

    `resolution`: what it tells apart [m], of the motor's angle [rad]. `rate` "rotor": a loop about another place takes
    the rate, which its damping acts on, from the motor's angle.
    """

    at: Literal["rotor", "stroke", "joint-to-joint"] = "rotor"
    resolution: Annotated[Positive, Measure("length", "angle")] | None = None
    rate: Literal["same", "rotor"] = "same"


class Loop(Feedback):
    """A loop about what the encoder measures, that also sums its error: gain of the `integral` [N m/(rad s)]."""

    integral: Annotated[NonNegative, Measure("integral gain")] = 0.0


def summing(loop: object) -> object:
    """A loop out of a correction that sums nothing."""
    plain = isinstance(loop, Feedback) and not isinstance(loop, Loop)
    return Loop(stiffness=loop.stiffness, damping=loop.damping) if plain else loop  # type: ignore[union-attr]
