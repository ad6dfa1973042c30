"""The oracle of the sliding beam: constants, closed equation, field equation and the tip table agree."""

import numpy as np
import pytest
from tests.oracles import sliding
from tests.oracles.ritz import clamped_free, clamped_free_shapes, polynomial_shapes

from flexapod.verification.cases.sliding import TIP_MM

pytestmark = pytest.mark.literature

RHO, EI = 4.02, 756.65
STATE = {"L": 1.9, "L_dot": 0.4, "L_ddot": -0.3, "th": 0.6, "th_dot": 0.9, "th_ddot": 1.1}
MOTION = sliding.uniform_motion(1.83, 0.1, 0.785)


def test_constants():
    z = sliding.constants(3)
    digits = {
        "B": [(0, 1, -0.6549513), (0, 2, -0.2286957), (1, 2, -1.637405)],
        "C": [(0, 0, 0.5050836), (0, 1, 0.5270698), (0, 2, -0.5594112), (1, 1, 4.0878357), (1, 2, 3.4412936)],
        "G1": [(0, 0, 1.1933364), (0, 1, -0.6858553), (0, 2, -0.7923792), (1, 1, 6.4782249), (1, 2, 0.1694079)],
        "G0": [(0, 0, 1.5708782), (0, 1, -0.4223204), (0, 2, -1.0720848), (1, 1, 8.6471427), (1, 2, 1.8900547)],
        "Gt": [(0, 0, 4.6477783), (0, 1, -7.3798753), (0, 2, 3.9415155), (1, 1, 32.417399), (1, 2, -22.3524444)],
    }
    last = {"C": 13.9351869, "G1": 17.8595199, "G0": 24.9521133, "Gt": 77.2988908}
    np.testing.assert_allclose(z.e, [0.78299176, 0.4339359, 0.2544253], atol=6e-8)
    np.testing.assert_allclose(z.f, [0.56882574, 0.09076679, 0.03241637], atol=6e-9)
    for name, entries in digits.items():
        for i, j, value in entries:
            assert getattr(z, name)[i, j] == pytest.approx(value, abs=6e-7 if name == "B" else 7e-8)
    for name, value in last.items():
        assert getattr(z, name)[2, 2] == pytest.approx(value, abs=7e-8)
    twelve = sliding.constants(12)
    np.testing.assert_allclose(twelve.B, -twelve.B.T, atol=1e-12)  # exact property of the moving modes


@pytest.mark.parametrize("k", [1, 3, 6])
@pytest.mark.parametrize("m_e", [0.0, 1.3])
def test_closed_equation_is_the_lagrangian_differentiated(k, m_e):
    lagrangian = sliding.Lagrangian(k=k, rho=RHO, EI=EI, Lt=3.66, m_e=m_e, J_h=0.7, g=9.81)
    q, q_dot, q_ddot = np.random.default_rng(k).normal(size=(3, k))
    M, C, K, rhs = sliding.q_equation(**STATE, g=9.81, m_e=m_e, rho=RHO, EI=EI, k=k)
    x = np.concatenate([q, [STATE["th"], STATE["L"]]])
    v = np.concatenate([q_dot, [STATE["th_dot"], STATE["L_dot"]]])
    a = np.concatenate([q_ddot, [STATE["th_ddot"], STATE["L_ddot"]]])
    residual = lagrangian.residual(x, v, a)[:k]
    np.testing.assert_allclose(residual, M @ q_ddot + C @ q_dot + K @ q - rhs, atol=1e-12 * np.abs(K @ q).max())


@pytest.mark.parametrize("m_e", [0.0, 1.3])
def test_rigid_limits_of_torque_and_feed_force(m_e):
    J_h, g, Lt, k = 0.7, 9.81, 3.66, 3
    lagrangian = sliding.Lagrangian(k=k, rho=RHO, EI=EI, Lt=Lt, m_e=m_e, J_h=J_h, g=g)
    L, L_dot, L_ddot, th, th_dot, th_ddot = STATE.values()
    pair = [np.concatenate([np.zeros(k), y]) for y in ([th, L], [th_dot, L_dot], [th_ddot, L_ddot])]
    inertia = J_h + RHO * (L**3 - (L - Lt) ** 3) / 3 + m_e * L**2
    coriolis = (RHO * (2 * L * Lt - Lt**2) + 2 * m_e * L) * L_dot * th_dot
    weight = g * np.cos(th) * (RHO * (L * Lt - Lt**2 / 2) + m_e * L)
    torque = inertia * th_ddot + coriolis + weight
    force = (RHO * Lt + m_e) * (L_ddot + g * np.sin(th)) - (RHO * (2 * L * Lt - Lt**2) / 2 + m_e * L) * th_dot**2
    np.testing.assert_allclose(lagrangian.residual(*pair)[k:], [torque, force], rtol=1e-13)


@pytest.mark.parametrize("m_e", [0.0, 1.3])
def test_field_equation_projected_on_moving_modes_is_the_closed_equation(m_e):
    k = 6
    L, L_dot, L_ddot, *_ = STATE.values()
    r = L_dot / L
    r_dot = L_ddot / L - r**2
    loads = {"g": 9.81, "m_e": m_e, "rho": RHO, "EI": EI}
    M, C, K, rhs = sliding.pde_equation(tuple(STATE.values()), shapes=clamped_free_shapes(k), **loads)
    # a = q / sqrt(rho L): a' = (q' - r/2 q) / sqrt(rho L), a'' = (q'' - r q' + (r^2/4 - r'/2) q) / sqrt(rho L)
    root = np.sqrt(RHO * L)
    moved = (M, C - r * M, K - r / 2 * C + (r**2 / 4 - r_dot / 2) * M)
    closed = sliding.q_equation(**STATE, k=k, **loads)
    for ours, theirs in zip(moved, closed[:3], strict=True):
        # projection on phi, not phi / root: one factor rho L; rounding relative to the largest entry
        np.testing.assert_allclose(ours / root**2, theirs, atol=1e-12 * np.abs(theirs).max())
    np.testing.assert_allclose(rhs / root, closed[3], atol=1e-12 * np.abs(closed[3]).max())


@pytest.mark.parametrize(("k", "tolerance"), [(6, 1e-5), (3, 4e-3)])
def test_tip_table(k, tolerance):
    q0 = np.eye(k)[0] * 5e-3 * np.sqrt(RHO * 1.83) / 2
    tip = sliding.tip_history(np.arange(11.0), MOTION, q0, rho=RHO, EI=EI, m_e=0.0)
    np.testing.assert_allclose(1e3 * tip, TIP_MM, rtol=0, atol=tolerance)  # printed digits; k = 3 as the table says


def test_field_equation_in_polynomials_gives_the_same_motion():
    # shapes that know no eigenfunction, an accelerating feed and turn, gravity
    def motion(t):
        return 1.2 + 0.3 * t + 0.2 * t**2, 0.3 + 0.4 * t, 0.4, 0.5 * t - 0.3 * t**2, 0.5 - 0.6 * t, -0.6

    t, phi, k = np.array([0.0, 0.5, 1.0]), clamped_free(1), 6
    loads = {"rho": RHO, "EI": EI, "m_e": 0.0, "g": 3.0}
    field = sliding.tip_history_pde(t, motion, lambda x: 2.5e-3 * phi(x), shapes=polynomial_shapes(8), **loads)
    closed = sliding.tip_history(t, motion, np.eye(k)[0] * 5e-3 * np.sqrt(RHO * 1.2) / 2, **loads)
    # 19 mm of motion; the highest two modes of either set carry about 1e-6 m after the start from rest
    np.testing.assert_allclose(field, closed, rtol=0, atol=3e-6)
