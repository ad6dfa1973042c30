"""Cogging and ripple of a motor: a torque that returns with its turns, as a potential of the rotor, Eq. (T23.21)."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from flexapod.common.errors import InputError
from flexapod.common.tables.base import Key, Quantity, Series, array_of
from flexapod.common.tables.table import Table
from flexapod.mechanics.elements.element import Contribution, LegContext, Named, Physics
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.symbolic.vocabulary import cos, dot, vertcat

if TYPE_CHECKING:
    from flexapod.common.arrays import Array
    from flexapod.model import Leg, ScrewDrive

HARMONICS = 4  # at most


class Ripple(Physics, Table):
    """Change of a motor's torque as it turns, cogging and ripple: `torque` [N m] times `harmonics`.

    `per_turn`: how often the first of these returns in a turn of the motor; `harmonics`: sizes of the first one and of
    its multiples, up to four.
    """

    torque: Annotated[float, Quantity("torque", above=0, why="amplitude, times harmonics")]
    per_turn: Annotated[
        int, Field(strict=True, ge=1, le=1000), Key("how often the first harmonic returns in a turn of the motor")
    ]
    harmonics: Annotated[Series, Quantity("number", why="sizes of the first one and its multiples, at most four")] = (
        array_of((None,))([1.0])
    )

    #: Angle of the first harmonic by the nut's travel [rad/m], and the energies of all [J].
    parameters: ClassVar[Named] = (("ripple_wave", 1), ("ripple", HARMONICS))

    @model_validator(mode="after")
    def _few(self) -> Self:
        if not 1 <= len(self.harmonics) <= HARMONICS:
            raise InputError(
                "has too many or none", key="harmonics", value=len(self.harmonics), allowed=f"1 to {HARMONICS} numbers"
            )
        return self

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Ripple of the motor of a leg's screw; None without a screw or without ripple."""
        return None if leg.screw is None else leg.screw.motor.ripple  # type: ignore[return-value]

    def amplitudes(self, screw: ScrewDrive) -> Array:
        """Amplitudes of the force's harmonics by the nut's travel, (4,) [N], Eq. (T23.21)."""
        found = np.zeros(HARMONICS)
        found[: len(self.harmonics)] = self.torque * self.harmonics * screw.rotor.ratio / screw.per_turn
        return found

    def spread(self, screw: ScrewDrive) -> float:
        """Standard deviation of the rotor's travel at rest [m]: none where that is held, Eq. (T23.22)."""
        if screw.rests or not screw.loop_spring[0]:
            return 0.0
        return float(np.sqrt(0.5 * (self.amplitudes(screw) ** 2).sum()) / screw.loop_spring[0])

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Angle of the first harmonic by the nut's travel, and the energies of all harmonics."""
        screw: Any = leg.screw
        wave = self.per_turn * screw.rotor.ratio / screw.per_turn
        return {"ripple_wave": wave, "ripple": self.amplitudes(screw) / (wave * np.arange(1, HARMONICS + 1))}

    @classmethod
    def energy(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Energies:
        """Energy of the harmonics of the torque, of mean 0."""
        angle = p.ripple_wave * q.r
        return Energies(strain=dot(p.ripple, vertcat(*(1 - cos(k * angle) for k in range(1, HARMONICS + 1)))))

    def without_ripple(self, leg: Leg) -> Leg:
        """Leg whose motor has no ripple."""
        screw: Any = leg.screw
        return leg.replace(drive=screw.replace(motor=screw.motor.replace(ripple=None)))

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        """Random displacement of the rotor by ripple at rest, against the spring of its loop."""
        spread = self.spread(leg.screw)  # type: ignore[arg-type]
        how = "standard deviation over a period, against the loop's stiffness, legs independent"
        return (Contribution("ripple", "random", spread, how, stands=True),) if spread else ()
