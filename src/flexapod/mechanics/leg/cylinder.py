"""The cylinder: a rigid body that turns about the base joint, Eqs. (T3.12) and (T13.5)."""

from __future__ import annotations

from types import SimpleNamespace

from flexapod.mechanics.elements.frames import Energies, Frame
from flexapod.mechanics.symbolic.vocabulary import dot, vertcat


def cylinder(frame: Frame, p: SimpleNamespace, vs: SimpleNamespace) -> Energies:
    """Energies of a body whose CoM lies on the leg's axis; under a cylindrical joint it does not spin along."""
    m, d, w, u = p.cylinder_mass, p.cylinder_com, frame.omega, frame.velocity
    spin = w[2] - (1 - p.cylinder_spins) * vs.spin if hasattr(vs, "spin") else w[2]
    transverse = p.cylinder_inertia + m * d**2
    turning = transverse * (w[0] ** 2 + w[1] ** 2) + p.cylinder_axial_inertia * spin**2  # (T3.12)
    carried = m * (0.5 * dot(u, u) + d * (u[0] * w[1] - u[1] * w[0]))  # (T13.5)
    return Energies(kinetic=0.5 * turning + carried, gravity=frame.weight(p.gravity, m, vertcat(0, 0, m * d)))
