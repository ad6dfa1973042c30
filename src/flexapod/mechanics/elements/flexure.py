"""Springs and dampers of a joint: on its angles, or of a flexure that is compliant along and about all axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.elements.element import Along, LegContext, Named, Physics
from flexapod.mechanics.elements.frames import Energies
from flexapod.mechanics.elements.springs import viscous
from flexapod.mechanics.symbolic.vocabulary import dot, reshape, vertcat, zeros

if TYPE_CHECKING:
    from types import SimpleNamespace

    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Joint, Leg, Robot, Simulation


class Flexures(Physics):
    """Joints at both ends, compliant along and about all axes: displacements u and e, and the joints' angles."""

    coordinates: ClassVar[Named] = tuple((f"{end}{k}", 1) for end in "ue" for k in (1, 2, 3))
    parameters: ClassVar[Named] = (  # stiffness, displacements [m] first, angles [rad] last, column by column
        ("base_flexure", 36),  # u1..3 and alpha, beta, spin less `base_home`, in the axes R0
        ("platform_flexure", 36),  # e1..3 and gamma1..3 less `gamma_home`, in the axes of the joint in the leg
        ("base_flexure_damping", 36),  # dampers beside them
        ("platform_flexure_damping", 36),
    )

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of every leg: joints that are no flexures have no stiffness here."""
        return cls()

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether a joint of some leg is a flexure."""
        return any(joint.flexes for leg in robot.legs for joint in (leg.base_joint, leg.platform_joint))

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Stiffness and damping of both joints."""
        found = {}
        for end, joint in (("base", leg.base_joint), ("platform", leg.platform_joint)):
            found[f"{end}_flexure"] = stiffness(joint, standing.axes[end])
            found[f"{end}_flexure_damping"] = damping(joint, standing.axes[end], standing.per_loss)
        return found

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> Sequence[str]:
        """Displacements in directions in which a joint has no stiffness."""
        joints = (("u", "base", leg.base_joint), ("e", "platform", leg.platform_joint))
        gives = {letter: (stiffness(joint, standing.axes[end])[:3] != 0).any(axis=-1) for letter, end, joint in joints}
        return [f"{letter}{k + 1}" for letter, ways in gives.items() for k in range(3) if not ways[k]]

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        """Energies of springs and dampers of both joints."""
        p, (q, v) = x.p, (x.q, x.v)
        base, base_rate = (vertcat(joint_displacement(y, "u"), base_angles(y)) for y in (q, v))
        end, end_rate = (vertcat(joint_displacement(y, "e"), platform_angles(y)) for y in (q, v))
        base, end = base - vertcat(zeros(3), p.base_home), end - vertcat(zeros(3), p.gamma_home)
        e = flexure(p.base_flexure, p.base_flexure_damping, base, base_rate)
        return e + flexure(p.platform_flexure, p.platform_flexure_damping, end, end_rate)


def stiffness(joint: Joint, axes: tuple[Array, Array]) -> Array:
    """Stiffness of a joint in the axes in which it is compliant, (6, 6); 0 of one that is no flexure.

    ``axes``: rotations to these from its own, which are those of base or platform, or of the leg.
    """
    return np.zeros((6, 6)) if joint.stiffness is None else _turned(joint, joint.stiffness, axes)


def damping(joint: Joint, axes: tuple[Array, Array], per_loss: float) -> Array:
    """Damping of a joint in the axes of its stiffness, (6, 6)."""
    if joint.stiffness is None:
        return np.zeros((6, 6))
    given = np.diag([joint.stiffness_damping or 0.0] * 3 + [0.0] * 3)
    return _turned(joint, viscous(joint.stiffness, given, joint.loss_of_stiffness, per_loss), axes)


def _turned(joint: Joint, given: Array, axes: tuple[Array, Array]) -> Array:
    turn = np.kron(np.eye(2), axes[joint.leg_axes])
    return turn @ given @ turn.T if joint.flexes else np.zeros((6, 6))


def joint_displacement(of: SimpleNamespace, name: str) -> SX:
    """Displacement of a joint, or its rate (3)."""
    return vertcat(*(getattr(of, f"{name}{k}") for k in (1, 2, 3)))


def base_angles(of: SimpleNamespace) -> SX:
    """Angles of the base joint, or their rates (3); of a leg that cannot spin 0."""
    return vertcat(of.alpha, of.beta, of.spin if hasattr(of, "spin") else zeros(1))


def platform_angles(of: SimpleNamespace) -> SX:
    """Angles of the platform joint, or their rates (3)."""
    return vertcat(of.gamma1, of.gamma2, of.gamma3)


def springs(stiffness: SX, damping: SX, angles: SX, rates: SX) -> Energies:
    """A spring [N m/rad] and a damper [N m s/rad] on each of some successive angles."""
    strain = 0.5 * dot(stiffness, angles**2)  # (T13.6)
    return Energies(strain=strain, dissipation=0.5 * dot(damping, rates**2))  # (T13.18)


def flexure(stiffness: SX, damping: SX, moved: SX, rates: SX) -> Energies:
    """6x6 stiffness and damping, column by column, against displacements and angles."""
    K, C = reshape(stiffness, 6, 6), reshape(damping, 6, 6)
    return Energies(strain=0.5 * dot(moved, K @ moved), dissipation=0.5 * dot(rates, C @ rates))  # (T13.17)-(T13.18)
