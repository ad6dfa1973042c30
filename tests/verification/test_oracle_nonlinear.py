"""The oracle of the spatial leg: its rates, its closed-form limits, and the sliding planar beam inside it."""

import numpy as np
import pytest
from tests.oracles import nonlinear, sliding
from tests.oracles.ritz import clamped_free, clamped_free_shapes, gauss

pytestmark = pytest.mark.literature

PARAMS = {
    "rhoA": 4.466,
    "EI": 5217.4,
    "EA": 1.1451e8,
    "Lp": 0.75,
    "mouth": 0.315,
    "cyl_mass": 3.0,
    "cyl_com": 0.1575,
    "cyl_inertia": 0.0248,
    "cyl_axial": 0.002,
    "piston_axial": 0.0004,
    "gravity": np.array([1.0, -2.0, -9.4]),
}
K, N = 3, 2
PHI = clamped_free_shapes(K)


def sample(seed: int, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Return coordinates and rates with amplitudes and amplitude rates of the given size."""
    rng = np.random.default_rng(seed)
    rigid = np.array([0.2, -0.3, 0.9])
    q = np.concatenate([rigid, size * rng.normal(size=N + 2 * K)])
    return q, np.concatenate([[0.7, 0.5, -0.3], size * rng.normal(size=N + 2 * K)])


@pytest.mark.parametrize("i", [1, 5, 12])
def test_clamped_free_keeps_its_digits(i):
    phi = clamped_free(i)
    x, w = gauss(60)
    assert phi(x, 0) ** 2 @ w == pytest.approx(1, abs=1e-13)
    assert phi(np.array([1.0]), 0)[0] == pytest.approx(-2 * (-1) ** i, abs=1e-13)
    lam = (phi(x, 4) @ phi(x, 0) / (phi(x, 0) @ phi(x, 0))) ** 0.25
    np.testing.assert_allclose(phi(x, 4), lam**4 * phi(x, 0), atol=1e-12 * lam**4)
    ends = [phi(np.array([0.0]), 0)[0], phi(np.array([0.0]), 1)[0] / lam]
    ends += [phi(np.array([1.0]), 2)[0] / lam**2, phi(np.array([1.0]), 3)[0] / lam**3]
    np.testing.assert_allclose(ends, 0, atol=1e-13)


def test_rates_are_those_of_a_material_point():
    # T from the chain rule against velocities by complex step of every point's place
    q, v = sample(1, 0.02)
    s = q[2] - PARAMS["mouth"]
    total = 0.0
    for low, high in ((0.0, s), (s, PARAMS["Lp"])):
        for xi, w in zip(*gauss(24, low, high), strict=True):
            speed = nonlinear.position(q + 1e-30j * v, xi, PARAMS, PHI).imag / 1e-30
            total += 0.5 * PARAMS["rhoA"] * w * speed @ speed
    bare = PARAMS | {"cyl_mass": 0.0, "cyl_inertia": 0.0, "cyl_axial": 0.0, "piston_axial": 0.0}
    assert nonlinear.energies(q, v, bare, PHI)[0] == pytest.approx(total, rel=1e-12)


def test_kinetic_energy_is_quadratic_and_positive():
    q, v = sample(2, 0.02)
    T = nonlinear.energies(q, v, PARAMS, PHI)[0]
    assert T > 0
    assert nonlinear.energies(q, -3 * v, PARAMS, PHI)[0] == pytest.approx(9 * T, rel=1e-13)


def test_straight_leg_is_two_rigid_bodies():
    q, v = sample(3, 0.0)
    alpha, beta, length = q[:3]
    omega = np.array([v[0] * np.cos(beta), v[1], v[0] * np.sin(beta)])
    across = omega[0] ** 2 + omega[1] ** 2
    Lp, mass = PARAMS["Lp"], PARAMS["rhoA"] * PARAMS["Lp"]
    centre = length - Lp / 2
    inertia = mass * Lp**2 / 12 + mass * centre**2
    inertia += PARAMS["cyl_inertia"] + PARAMS["cyl_mass"] * PARAMS["cyl_com"] ** 2
    T = 0.5 * inertia * across + 0.5 * mass * v[2] ** 2 + 0.5 * (0.002 + 0.0004) * omega[2] ** 2
    axis = np.array([np.sin(beta), -np.sin(alpha) * np.cos(beta), np.cos(alpha) * np.cos(beta)])
    V = -(mass * centre + PARAMS["cyl_mass"] * PARAMS["cyl_com"]) * axis @ PARAMS["gravity"]
    np.testing.assert_allclose(nonlinear.energies(q, v, PARAMS, PHI), [T, V, 0], rtol=1e-13)


def test_strain_energy_of_pure_shapes():
    q = np.zeros(3 + N + 2 * K)
    q[2], s = 0.9, 0.9 - PARAMS["mouth"]
    q[3], q[4], q[3 + N + 1] = 1e-4, 2e-5, 3e-3
    lam = 4.694091132974
    expected = 0.5 * PARAMS["EA"] / PARAMS["Lp"] * (1e-8 + np.pi**2 / 2 * 4e-10)
    expected += 0.5 * PARAMS["EI"] * lam**4 / s**3 * 9e-6
    assert nonlinear.energies(q, 0 * q, PARAMS, PHI)[2] == pytest.approx(expected, rel=1e-11)


def test_tip_sits_at_the_foreshortened_length():
    q = np.zeros(3 + N + 2 * K)
    q[2], q[3], s = 0.9, 1e-4, 0.9 - PARAMS["mouth"]
    q[3 + N], q[3 + N + K] = 0.01, -0.02
    tip = nonlinear.position(q, 0.0, PARAMS, PHI)
    # int phi_1'^2 = 4.6477783
    np.testing.assert_allclose(tip, [0.02, -0.04, 0.9 + 1e-4 - 4.6477783 * 5e-4 / (2 * s)], atol=1e-9)


def test_planar_turn_is_the_sliding_beam_to_second_order():
    # beta turns z towards x, so v, beta, l are u, th, L; the Lagrangian of the report drops cubes of the amplitude
    rho, EI, Lt, g = 4.02, 756.65, 3.66, 9.81
    lagrangian = sliding.Lagrangian(k=K, rho=rho, EI=EI, Lt=Lt, g=g)
    bare = dict.fromkeys(["mouth", "cyl_mass", "cyl_com", "cyl_inertia", "cyl_axial", "piston_axial"], 0.0)
    # th is measured from the horizontal: gravity pulls towards -e2 at th = 0
    params = bare | {"rhoA": rho, "EI": EI, "EA": 1.0, "Lp": Lt, "gravity": np.array([-g, 0.0, 0.0])}
    L, L_dot, th, th_dot = 1.9, 0.4, 0.6, 0.9
    shape, rate = np.random.default_rng(4).normal(size=(2, K))

    def gap(size: float) -> float:
        a, a_dot, root = size * shape, size * rate, np.sqrt(rho * L)
        x = np.concatenate([a * root, [th, L]])
        v = np.concatenate([(a_dot + L_dot / (2 * L) * a) * root, [th_dot, L_dot]])
        zero = np.zeros(K)
        q3 = np.concatenate([[0.0, th, L], a, zero])
        v3 = np.concatenate([[0.0, th_dot, L_dot], a_dot, zero])
        T, gravity, strain = nonlinear.energies(q3, v3, params, PHI)
        return abs(T - gravity - strain - lagrangian(x, v))

    # cubes and fourth powers remain: 1e-8 J of 40 J at 1e-3, where the cubes rule; rounding is 1e-14 J
    assert gap(1e-3) < 1e-7
    assert np.log10(gap(1e-3) / gap(1e-4)) == pytest.approx(3, abs=0.1)
