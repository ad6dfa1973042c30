"""The mouth between two stations: the Saint-Venant flexibility of the solid itself, Eqs. (T10.12)-(T10.14)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.solve.fem.reduction import StationModel


@dataclass(frozen=True, kw_only=True)
class Mouth:
    """How the flexibility at a station of `model` grows with its distance from the mouth.

    `bending`: 1 / EI of the solid far from its ends [1/(N m^2)]; `end_rotation`: rotation of the mouth region per
    moment [rad/(N m)], beyond that of a beam, 0 at Poisson's ratio 0; `end_deflection`: deflection per force and per
    distance, of shear and of the mouth region [1/N].
    """

    model: StationModel
    bending: float
    end_rotation: float
    end_deflection: float

    def last(self, length: float) -> int:
        """The free station nearest to the mouth at which the distance from it is half a spacing or more."""
        return int(np.floor(length / self.model.spacing - 0.5 + 1e-9))

    def flexibility(self, distance: float) -> Array:
        """(w, theta) per force and moment at a station ``distance`` from the mouth, less a constant, Eq. (T10.13)."""
        d, b, c, s = distance, self.bending, self.end_rotation, self.end_deflection
        mixed = 0.5 * b * d**2 + c * d
        return np.array([[b * d**3 / 3 + c * d**2 + s * d, mixed], [mixed, b * d]])

    def stiffness(self, length: float, last: int) -> Array:
        """Elastic stiffness of the free stations 0..last with the mouth ``length`` from the tip, Eq. (T10.14).

        At ``length = (last + 1) * spacing`` it is that of the solid held at all stations inside. Elsewhere the part
        outside rides on the change of the flexibility of the last interval.
        """
        n, H = 2 * (last + 1), self.model.spacing
        K = self.model.stiffness[:n, :n]
        ride = np.zeros((n, 2))
        ride[0::2, 0], ride[1::2, 1] = 1.0, 1.0
        ride[0::2, 1] = H * (last - np.arange(last + 1))
        force = K @ ride
        change = self.flexibility(length - last * H) - self.flexibility(H)
        inner = np.linalg.solve(np.eye(2) + change @ (ride.T @ force), change)
        return K - force @ (0.5 * (inner + inner.T)) @ force.T


def mouth_of(model: StationModel) -> Mouth:
    """Constants of Eq. (T10.13) from the solid held at two neighbouring stations, far from the one that is loaded."""
    H, at = model.spacing, model.stations // 4
    far = min(1 + int(np.ceil(3 * model.section_size / H)), model.stations - at - 2)
    two = slice(2 * at, 2 * at + 2)
    held = [np.linalg.inv(model.stiffness[: 2 * (at + j), : 2 * (at + j)])[two, two] for j in (far, far + 1)]
    change = held[1] - held[0]
    bending = change[1, 1] / H
    mixed = 0.5 * (change[0, 1] + change[1, 0])
    end_rotation = mixed / H - bending * H * (2 * far + 1) / 2
    rest = change[0, 0] / H - bending * H**2 * ((far + 1) ** 3 - far**3) / 3
    end_deflection = rest - end_rotation * H * (2 * far + 1)
    return Mouth(model=model, bending=bending, end_rotation=end_rotation, end_deflection=end_deflection)
