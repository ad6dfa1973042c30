"""Sampled controllers of a robot's drives, as a study file has them."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from flexapod.schema.base import Key, Quantity
from flexapod.schema.table import Table

__all__ = ["Control", "DampedControl", "ForceControl"]

Count = Annotated[int, Field(strict=True, ge=0, le=1000)]
Seed = Annotated[int, Field(strict=True, ge=0, le=2**31 - 1)]


class _Sampled(Table):
    """What all have: `sample` [s] from one reading to the next, `delay_samples`, limits, noise of the readings.

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
    """Integral force feedback at each drive: `gain` [1/s], `high_pass` [Hz]; numbers of readings in N."""

    reads: ClassVar[str] = "force-sensor:drive"
    law: Annotated[Literal["iff"], Key("what is fed back")] = "iff"
    gain: Annotated[
        float, Quantity("number", above=0, why="force of the drive per integral of the force that it feels [1/s]")
    ]
    high_pass: Annotated[
        float, Quantity("frequency", least=0, why="below it the integral fades, and static stiffness stays")
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
    low_pass: Annotated[
        float | None,
        Quantity("frequency", above=0, why="above it the rate counts less", usual="differences from sample to sample"),
    ] = None
    quantise: Annotated[
        float | None, Quantity("length", least=0, why="step of the readings, as of an encoder", usual="none")
    ] = None
    noise: Annotated[float | None, Quantity("length", least=0, why="standard deviation of a reading", usual="none")] = (
        None
    )


Control = ForceControl | DampedControl
