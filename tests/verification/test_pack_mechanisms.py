"""Mechanisms A02 and A04 of the IFToMM library in the robot's time integration: end values, order, structure."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from flexapod.verification.cases import bricard, four_bar

pytestmark = pytest.mark.literature


def orders(errors):
    return np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))


def test_four_bars_printed_end_is_that_of_one_degree_of_freedom():
    # Three uprights of m l^2 / 3 and two bars that only shift: 3 phi'' = 3.5 g sin phi.
    end = solve_ivp(
        lambda t, y: [y[1], 3.5 * 9.81 / 3 * np.sin(y[0])], (0, 10), [0, 1], "DOP853", rtol=1e-12, atol=1e-12
    )
    angle, rate = end.y[:, -1]
    exact = [np.sin(angle), np.cos(angle), rate * np.cos(angle), -rate * np.sin(angle)]
    np.testing.assert_allclose(four_bar.END, exact, rtol=0, atol=2e-9)  # printed: 12 and 9 decimals


def test_four_bars_are_of_second_order_through_singular_positions():
    # Ten passages of the horizontal, where three more motions would be possible at that instant.
    errors = np.array([four_bar.end_state(n) - four_bar.END for n in (5000, 10000, 20000)])
    np.testing.assert_allclose(orders(errors), 2.0, atol=0.02)


def test_the_bars_stay_level():
    for chunk in four_bar.run(5000):
        assert np.abs(chunk.q[:, :2, 1]).max() < 1e-12
        np.testing.assert_allclose(chunk.q[:, :2, 0], chunk.pose[:, :1] + [[0, 0]], atol=1e-11)


def bricard_rods(one, two, rates):
    """Inertia, weight's potential and hinges of the loop at alternating angles, rods followed from the first hinge."""
    angles = [one, two, one, two, one]
    turn, place, omega, velocity = np.eye(3), bricard.HINGES[0].astype(float), np.zeros(3), np.zeros(3)
    inertia, potential = 0.0, 0.0
    for i, angle in enumerate(angles):
        axis = bricard.AXES[i]
        omega = omega + turn @ axis * rates[i % 2]
        turn = turn @ Rotation.from_rotvec(angle * axis).as_matrix()
        arm = turn @ (bricard.HINGES[i + 1] - bricard.HINGES[i])
        centre, along = velocity + np.cross(omega, arm / 2), omega @ arm
        inertia += centre @ centre + (1 + 0.01) / 12 * (omega @ omega - along**2) + 0.01 / 6 * along**2
        potential += 9.81 * (place + arm / 2)[1]
        place, velocity = place + arm, velocity + np.cross(omega, arm)
    return inertia, potential, place, turn


def along_the_loop(one, two):
    """Rates of both angles that keep sin a + sin b + sin a sin b."""
    return np.array([np.cos(two) * (1 + np.sin(one)), -np.cos(one) * (1 + np.sin(two))])


def bricard_rates(t, y):
    """Of (a, b, w) with a' = w A(a, b), b' = w B(a, b): energy m(a, b) w^2 / 2, so m w' = -(V' + m' w^2 / 2)."""
    path = along_the_loop(*y[:2])

    def both(s):
        at = y[:2] + s * path
        return np.array(bricard_rods(*at, along_the_loop(*at))[:2])

    h = 1e-3  # fourth order: 1e-12
    inertia_slope, slope = (8 * (both(h) - both(-h)) - (both(2 * h) - both(-2 * h))) / (12 * h)
    return [*(path * y[2]), -(slope + 0.5 * inertia_slope * y[2] ** 2) / both(0)[0]]


def test_bricards_reference_is_that_of_one_degree_of_freedom():
    instants = [row[0] for row in bricard.TABLE]
    exact = solve_ivp(bricard_rates, (0, 9.5), [0, 0, 0], "DOP853", t_eval=instants, rtol=1e-11, atol=1e-12).y
    np.testing.assert_allclose([row[2:] for row in bricard.TABLE], exact[:2].T, rtol=0, atol=1e-9)


@pytest.mark.parametrize("one", [0.4, 1.5, 3.0])
def test_bricards_loop_closes(one):
    two = np.arcsin(-np.sin(one) / (1 + np.sin(one)))
    _, _, place, turn = bricard_rods(one, two, np.zeros(2))
    np.testing.assert_allclose(place, bricard.HINGES[5], atol=1e-14)
    np.testing.assert_allclose(turn @ bricard.AXES[5], bricard.AXES[5], atol=1e-14)


def test_bricards_loop_is_overconstrained():
    """Six hinges, six equations, rank five: Gruebler's formula leaves no motion, and there is one."""
    screws = [
        np.concatenate([axis, np.cross(hinge, axis)]) for axis, hinge in zip(bricard.AXES, bricard.HINGES, strict=True)
    ]
    sizes = np.linalg.svd(screws, compute_uv=False)
    assert sizes[5] < 1e-14
    assert sizes[4] > 0.1


def test_bricard_is_of_second_order_and_keeps_its_energy():
    runs = [bricard.motion(n) for n in (2000, 4000, 8000)]
    errors = np.array([[first[row[1], :2] - row[2:] for row in bricard.TABLE] for first, _, _ in runs])
    np.testing.assert_allclose(orders(errors), 2.0, atol=0.02)
    swings = np.array([np.ptp(energy) for _, _, energy in runs])
    np.testing.assert_allclose(orders(swings), 2.0, atol=0.02)
