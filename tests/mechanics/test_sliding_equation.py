"""The residual of the planar leg is the published equation of a sliding beam, corrected, to rounding.

The paper's coordinates are q of unit-mass modes, a = q / sqrt(rho L); theirs angle and length are ours. The rows of
the amplitudes, divided by sqrt(rho L), must be the closed q-equation; those of angle and length the Lagrangian's.
"""

import numpy as np
import pytest
from tests.helpers.runs import leg_vector, uncompiled
from tests.oracles import sliding

from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import Actuator
from flexapod.solve.parameters import PLANE, actuator_parameters

pytestmark = pytest.mark.consistency

RHO, EI, LT, HUB = 4.02, 756.65, 3.66, 0.7
L, L_DOT, L_DDOT, TH, TH_DOT, TH_DDOT = 1.9, 0.4, -0.3, 0.6, 0.9, 1.1
FORWARD, BACKWARD = (L_DOT, L_DDOT, TH_DOT, TH_DDOT), (-0.7, 0.5, -1.3, -0.4)

loads = pytest.mark.parametrize(("m_e", "g"), [(0.0, 0.0), (1.3, 0.0), (0.0, 9.81), (1.3, 9.81)])
counts = pytest.mark.parametrize("k", [1, 3, 6])


def leg_residual(k, x, v, a, m_e, g):
    """Residual of (theta, L, a_1..a_k) without drives, from (theta, L, a..) and its rates."""
    beam = Actuator(length=LT, rhoA=RHO, EI=EI, free_length=L, tip_mass=m_e, hub_inertia=HUB, gravity=g)
    functions = uncompiled("clamped-free", k, 0, planar=True)
    return functions.leg_residual(x, v, a, np.zeros(0), np.zeros(2), actuator_parameters(beam, functions.shapes)[0])[0]


def substituted(q, q_dot, q_ddot, rates):
    """(theta, L, a), rates and accelerations of a = q / sqrt(rho L)."""
    L_dot, L_ddot, th_dot, th_ddot = rates
    r = L_dot / L
    r_dot = L_ddot / L - r**2
    root = np.sqrt(RHO * L)
    return (
        np.concatenate([[TH, L], q / root]),
        np.concatenate([[th_dot, L_dot], (q_dot - r / 2 * q) / root]),
        np.concatenate([[th_ddot, L_ddot], (q_ddot - r * q_dot + (r**2 / 4 - r_dot / 2) * q) / root]),
    )


@loads
@counts
@pytest.mark.parametrize("rates", [FORWARD, BACKWARD], ids=["out", "in"])
def test_amplitude_rows_are_the_closed_equation(k, m_e, g, rates):
    q, q_dot, q_ddot = np.random.default_rng(k).normal(size=(3, k))
    L_dot, L_ddot, th_dot, th_ddot = rates
    M, C, K, rhs = sliding.q_equation(L, L_dot, L_ddot, TH, th_dot, th_ddot, g=g, m_e=m_e, rho=RHO, EI=EI, k=k)
    published = M @ q_ddot + C @ q_dot + K @ q - rhs
    ours = leg_residual(k, *substituted(q, q_dot, q_ddot, rates), m_e, g)[2:] / np.sqrt(RHO * L)
    np.testing.assert_allclose(ours, published, rtol=0, atol=1e-12 * np.abs(K @ q).max())


@loads
@counts
def test_rows_of_angle_and_length_are_the_lagrangian_differentiated(k, m_e, g):
    # Torque and feed force do not care which coordinates describe the deflection at the same motion.
    q, q_dot, q_ddot = 0.1 * np.random.default_rng(10 + k).normal(size=(3, k))
    lagrangian = sliding.Lagrangian(k=k, rho=RHO, EI=EI, Lt=LT, m_e=m_e, J_h=HUB, g=g)
    states = (np.concatenate([x, y]) for x, y in ((q, [TH, L]), (q_dot, [TH_DOT, L_DOT]), (q_ddot, [TH_DDOT, L_DDOT])))
    Q = lagrangian.residual(*states)
    ours = leg_residual(k, *substituted(q, q_dot, q_ddot, FORWARD), m_e, g)
    # u = u(q, L): the generalised force of L holds q in theirs, a in ours; they differ by (da/dL) . (row of a).
    slide = -q / np.sqrt(RHO * L) / (2 * L)
    theirs = np.array([Q[-2], Q[-1] - slide @ ours[2:]])
    size = EI / L**4 * np.abs(q @ sliding.constants(k).E4 @ q) + np.abs(Q[-2:]).max()
    np.testing.assert_allclose(ours[:2], theirs, rtol=0, atol=1e-12 * size)


@loads
def test_rigid_limits_of_torque_and_feed_force(m_e, g):
    ours = leg_residual(0, *substituted(np.zeros(0), np.zeros(0), np.zeros(0), FORWARD), m_e, g)
    inertia = HUB + RHO * (L**3 - (L - LT) ** 3) / 3 + m_e * L**2
    coriolis = (RHO * (2 * L * LT - LT**2) + 2 * m_e * L) * L_DOT * TH_DOT
    torque = inertia * TH_DDOT + coriolis + g * np.cos(TH) * (RHO * (L * LT - LT**2 / 2) + m_e * L)
    push = (RHO * LT + m_e) * (L_DDOT + g * np.sin(TH)) - (RHO * (2 * L * LT - LT**2) / 2 + m_e * L) * TH_DOT**2
    np.testing.assert_allclose(ours, [torque, push], rtol=1e-13)


def test_constants_of_the_basis():
    # The package's closed integrals hold the published constants: a_i = (1 - xi) phi_i' - phi_i / 2.
    k = 6
    b, z = lateral_basis("clamped-free", k), sliding.constants(k)
    both, slide = b.mass[:k, k:], b.mass[k:, k:]
    close = {"rtol": 0, "atol": 1e-10}  # entries up to 400
    np.testing.assert_allclose(b.first[:k], z.e, **close)
    np.testing.assert_allclose(b.moment[:k], z.f, **close)
    np.testing.assert_allclose(both - b.mass[:k, :k] / 2, z.B, **close)
    np.testing.assert_allclose(slide - (both + both.T) / 2 + b.mass[:k, :k] / 4, z.C, **close)
    # by parts: int (1 - xi) phi' = e, and int xi a = 3 f / 2 - e
    np.testing.assert_allclose(b.first[k:], z.e, **close)
    np.testing.assert_allclose(b.moment[k:] - b.moment[:k] / 2, 1.5 * z.f - z.e, **close)
    for ours, theirs in ((b.slope_first, z.G0), (b.slope_moment, z.G1), (b.slope_tip, z.Gt), (b.stiffness, z.E4)):
        np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-10)


def test_spatial_leg_held_in_a_plane_is_the_planar_one():
    k = 3
    q, q_dot, q_ddot = 0.01 * np.random.default_rng(5).normal(size=(3, k))
    flat = substituted(q, q_dot, q_ddot, FORWARD)
    plane = leg_residual(k, *flat, 0.0, 9.81)
    space = uncompiled("clamped-free", k, 0)
    p = leg_vector(
        rhoA=RHO, EI=EI, EA=1.0, Lp=LT, cylinder_inertia=HUB, gravity=[0.0, -9.81, 0.0],
        R0=PLANE.T.ravel(),
    )  # fmt: skip
    spread = (np.concatenate([[0.0], x, np.zeros(k)]) for x in flat)
    ours = space.leg_residual(*spread, np.zeros(3), np.zeros(2), p)[0]
    np.testing.assert_allclose(ours[1 : 3 + k], plane, rtol=1e-12, atol=1e-12 * np.abs(plane).max())
    np.testing.assert_allclose(ours[[0, *range(3 + k, 3 + 2 * k)]], 0, atol=1e-12 * np.abs(plane).max())
