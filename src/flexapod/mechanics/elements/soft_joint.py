"""A joint held by springs along and across its leg, whose axes move with the leg, Eqs. (T15.1)-(T15.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from flexapod.mechanics.elements.element import Along, LegContext, Named, Physics
from flexapod.mechanics.elements.flexure import Flexures, joint_displacement
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.springs import Spring, series_stiffness, springs_along, viscous
from flexapod.mechanics.symbolic.vocabulary import dot, matrix33, vertcat

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Joint, Leg


@dataclass(frozen=True)
class SoftJoint(Physics):
    """Springs of a joint across the leg, and all those along it there, which are in series."""

    joint: Joint
    along: Sequence[Spring]

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of a leg with a spring along it at this end; None of others."""
        along = [spring for spring in springs_along(leg) if spring.at == cls.end]
        return cls(getattr(leg, f"{cls.end}_joint"), along) if along else None

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> Sequence[str]:
        """Displacements in directions in which it has no stiffness."""
        letter = cls.coordinates[0][0][0]
        if own is None:
            return tuple(name for name, _ in cls.coordinates)
        return () if own.joint.across_and_along is not None else (f"{letter}1", f"{letter}2")

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Stiffness and damping (across, along) [N/m, N s/m]."""
        joint, along = self.joint, series_stiffness(self.along, standing.length, standing.per_loss)
        across = 0.0 if joint.across_and_along is None else joint.across_and_along[0]
        damper = viscous(across, joint.stiffness_damping, joint.loss_of_stiffness, standing.per_loss) if across else 0.0
        return {f"{self.end}_soft": [across, along[0]], f"{self.end}_soft_damping": [damper, along[1]]}


class SoftBase(SoftJoint):
    """Compliant base joint, between the base and the cylinder."""

    end: ClassVar[Literal["base", "", "platform"]] = "base"
    coordinates: ClassVar[Named] = (("u1", 1), ("u2", 1), ("u3", 1))
    parameters: ClassVar[Named] = (("base_soft", 2), ("base_soft_damping", 2))

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of its displacement in axes of the leg; of a flexure in axes of what carries it."""
        own = vertcat(0, 0, 1)
        along = x.foot.axes.T @ x.cylinder.axes[:, 2] if x.holds(Flexures) else own
        return soft_joint(
            x.p.base_soft, x.p.base_soft_damping, joint_displacement(x.q, "u"), joint_displacement(x.v, "u"), along
        )


class SoftPlatform(SoftJoint):
    """Compliant platform joint, between the piston's tip and the platform."""

    end: ClassVar[Literal["base", "", "platform"]] = "platform"
    coordinates: ClassVar[Named] = (("e1", 1), ("e2", 1), ("e3", 1))
    parameters: ClassVar[Named] = (("platform_soft", 2), ("platform_soft_damping", 2))

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of its displacement in axes of the leg; of a flexure in axes of the joint in the leg."""
        own = vertcat(0, 0, 1)
        along = matrix33(x.p.leg_frame).T @ own if x.holds(Flexures) else own
        p, moved, rate = x.p, joint_displacement(x.q, "e"), joint_displacement(x.v, "e")
        return soft_joint(p.platform_soft, p.platform_soft_damping, moved, rate, along)


def soft_joint(stiffness: SX, damping: SX, moved: SX, rate: SX, along: SX) -> Energies:
    """Springs and dampers, each (across, along), against a displacement; ``along``: the leg's direction in its axes."""
    return Energies(
        strain=_half_square(stiffness, moved, along),  # (T15.1)
        dissipation=_half_square(damping, rate, along),  # (T15.2)
    )


def _half_square(by: SX, x: SX, along: SX) -> SX:
    axial = dot(along, x) ** 2
    return 0.5 * (by[0] * (dot(x, x) - axial) + by[1] * axial)
