"""Frictionless guides of a meshed sliding beam, and their shifts of its clamp, Eqs. (T11.5), (T11.8)-(T11.10)."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.solve.fem.beam_mesh import BeamMesh, Indices, gauss


@dataclass(frozen=True, kw_only=True)
class Springs:
    """Stiff springs between points of the beam and the guide's axis at one instant.

    `element` (P,) and `local` (P,) in [0, 1], the place; `order` (P,), 0 on the deflection, 1 on the slope;
    `stiffness` (P,) [N/m] or [N m/rad].
    """

    element: Indices
    local: Array
    order: Indices
    stiffness: Array


class GuideContact(ABC):
    """A guide from the inner end of the beam to the mouth; it pushes where the beam is farther off than `gap` [m]."""

    gap: float = 0.0

    @abstractmethod
    def springs(self, mesh: BeamMesh, inside: float) -> Springs:
        """Springs at the instant when the length ``inside`` [m] of the beam is in the guide."""

    @abstractmethod
    def clamp_shift(self, mesh: BeamMesh, outside_part: Array) -> Array:
        """Shift of the clamp [m] to which a rigid guide amounts in the first order, outwards positive, Eq. (T11.7).

        ``outside_part``: part (0 to 1) of the element at the mouth that is outside, of any shape.
        """


@dataclass(frozen=True, kw_only=True)
class ElementContact(GuideContact):
    """A slot that touches every point of an element: stiffness per length [N/m^2] and gap [m], Eq. (T11.5)."""

    stiffness: float = 1e16
    gap: float = 0.0

    def __post_init__(self) -> None:
        _positive("stiffness", self.stiffness)
        _not_negative("gap", self.gap)

    def springs(self, mesh: BeamMesh, inside: float) -> Springs:
        """Four Gauss points in each element and in the part of one that is inside."""
        last, part = _mouth(mesh, inside)
        local, weight = gauss()
        weight = self.stiffness * mesh.size * weight
        element = np.repeat(np.arange(last + 1), 4)
        return Springs(
            element=element,
            local=np.concatenate([np.tile(local, last), part * local]),
            order=np.zeros(len(element), dtype=int),
            stiffness=np.concatenate([np.tile(weight, last), part * weight]),
        )

    def clamp_shift(self, mesh: BeamMesh, outside_part: Array) -> Array:
        """Shift to the outer node of a rigid guide: a cubic that vanishes on a piece vanishes, Eq. (T11.8)."""
        return np.asarray(outside_part) * mesh.size

    def give(self, mesh: BeamMesh) -> float:
        """Length (T11.9) [m] by which springs lengthen the beam; it shows where elements are much shorter."""
        return float((4 * mesh.beam.EI / self.stiffness) ** 0.25)


@dataclass(frozen=True, kw_only=True)
class NodeContact(GuideContact):
    """A slot that touches nodes only: stiffness per node [N/m] and gap [m], Eq. (T11.5)."""

    stiffness: float = 1e14
    gap: float = 0.0

    def __post_init__(self) -> None:
        _positive("stiffness", self.stiffness)
        _not_negative("gap", self.gap)

    def springs(self, mesh: BeamMesh, inside: float) -> Springs:
        """One spring on each node inside."""
        element = np.arange(_mouth(mesh, inside)[0] + 1)
        return Springs(
            element=element,
            local=np.zeros(len(element)),
            order=np.zeros(len(element), dtype=int),
            stiffness=np.full(len(element), self.stiffness),
        )

    def clamp_shift(self, mesh: BeamMesh, outside_part: Array) -> Array:
        """Shift to the last node inside, and by compliance between supports an element apart, Eq. (T11.8)."""
        return -mesh.size * ((1 - np.asarray(outside_part)) + 1 / (2 * math.sqrt(3)))


@dataclass(frozen=True, kw_only=True)
class InterpolatedClamp(GuideContact):
    """Deflection and slope held at the mouth, inside whatever element it is; elements farther in held by their nodes.

    `stiffness` [N/m] of deflections, `turning` [N m/rad] of slopes.
    """

    stiffness: float = 1e14
    turning: float = 1e11

    def __post_init__(self) -> None:
        _positive("stiffness", self.stiffness)
        _positive("turning", self.turning)

    def springs(self, mesh: BeamMesh, inside: float) -> Springs:
        """Two springs at the mouth, two on each node inside but the one of the mouth's element."""
        last, part = _mouth(mesh, inside)
        element = np.repeat(np.append(np.arange(last), last), 2)
        local = np.zeros(len(element))
        local[-2:] = part
        order = np.tile([0, 1], last + 1)
        return Springs(
            element=element, local=local, order=order, stiffness=np.where(order == 0, self.stiffness, self.turning)
        )

    def clamp_shift(self, mesh: BeamMesh, outside_part: Array) -> Array:
        """Shift by projecting a jump of curvature on linear functions, Eq. (T11.8)."""
        parts = np.asarray(outside_part, dtype=float)
        return mesh.size * np.vectorize(_projection_loss, otypes=[float])(parts)


@dataclass(frozen=True, kw_only=True)
class Rollers(GuideContact):
    """Points fixed in the hub, ``spacing`` [m] apart from the mouth inwards, that hold the deflection: [N/m]."""

    spacing: float
    stiffness: float = 1e14

    def __post_init__(self) -> None:
        _positive("spacing", self.spacing)
        _positive("stiffness", self.stiffness)

    def springs(self, mesh: BeamMesh, inside: float) -> Springs:
        """One spring on each roller that the beam still reaches."""
        place = np.arange(inside, 0.0, -self.spacing) / mesh.size
        element = np.minimum(np.floor(place + 1e-9).astype(int), mesh.elements - 1)
        return Springs(
            element=element,
            local=np.clip(place - element, 0.0, 1.0),
            order=np.zeros(len(place), dtype=int),
            stiffness=np.full(len(place), self.stiffness),
        )

    def clamp_shift(self, mesh: BeamMesh, outside_part: Array) -> Array:
        """Shift by compliance of a beam on supports, Eq. (T11.8); a third order in element length is left out."""
        return np.full(np.shape(outside_part), -self.spacing / (2 * math.sqrt(3)))


def _projection_loss(p: float) -> float:
    """Compliance of an element under a moment lost by its part p outside, EI / h = 1: p - r^T A^-1 r, Eq. (T11.8).

    Curvature a + b x about the mouth; A holds the energies of this element and of the one behind, which is clamped at
    its inner node and carried along by the outer one, [deflection; slope] = B [a; b].
    """
    s = 1 - p
    r = np.array([p, p**2 / 2])
    own = np.array([[1, (p**2 - s**2) / 2], [(p**2 - s**2) / 2, (p**3 + s**3) / 3]])
    B = np.array([[s**2 / 2, -(s**3) / 6], [-s, s**2 / 2]])
    behind = B.T @ np.array([[12.0, -6.0], [-6.0, 4.0]]) @ B
    return float(p - r @ np.linalg.solve(own + behind, r))


def _mouth(mesh: BeamMesh, inside: float) -> tuple[int, float]:
    """Element in which the mouth is, and the part of it that is inside, [0, 1)."""
    place = inside / mesh.size
    element = math.floor(place + 1e-9)
    return element, max(place - element, 0.0)


def _positive(key: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0):
        raise InputError("is not a property of a guide", key=f"guide.{key}", value=value, allowed="above 0, finite")


def _not_negative(key: str, value: float) -> None:
    if not (math.isfinite(value) and value >= 0):
        raise InputError("is not a property of a guide", key=f"guide.{key}", value=value, allowed="0 or more, finite")
