"""What the paper asks for next, on its own robot: numbers by hand and by a payload on massless springs."""

import numpy as np
import pytest
from scipy.linalg import eigh
from tests.helpers.paper_parts import part

from flexapod import model
from flexapod.verification.paper import outlook

pytestmark = [pytest.mark.unit, pytest.mark.xdist_group("claims")]  # one process computes the parts
ROBOT = model.preset("paper-robot").robot
STIFFNESS = 2e11 * np.pi / 4 * 0.027**2 / 0.75  # of a piston [N/m]
MASS, INERTIA, ARM, ROLL = 100.0, 17.88, 0.373, np.deg2rad(26.6)


def rows(roll):
    """Of the rolled robot: lengths of its legs by motions (6,) of the centre of mass, and these lengths."""
    c, s = np.cos(roll), np.sin(roll)
    arms = ROBOT.platform_joints @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T
    legs = arms + np.array([0, 0, 0.9]) - ROBOT.base_joints
    n = legs / np.linalg.norm(legs, axis=1)[:, None]
    return np.hstack([n, np.cross(arms - ARM * np.array([0, c, s]), n)]), legs, n


def quintic(t):
    """Share of the way, rate and acceleration at a share of the time."""
    return 10 * t**3 - 15 * t**4 + 6 * t**5, 30 * t**2 * (1 - t) ** 2, 60 * t - 180 * t**2 + 120 * t**3


@pytest.mark.parametrize("instant", [0.2, 0.35, 0.75])
def test_weight_alone_leaves_what_inertia_does_to_springs(instant):
    """J^T k J x = -M a. Pistons and cylinders, 38 kg beside 100 kg but near their joints, are left out: a fifth."""
    share, rate, acceleration = quintic(instant)
    roll, rate, acceleration = (ROLL * x for x in (share, rate, acceleration))
    J, *_ = rows(roll)
    c, s = np.cos(roll), np.sin(roll)
    a = ARM * np.array([0, -s * acceleration - c * rate**2, c * acceleration - s * rate**2])
    wrench = -np.concatenate([MASS * a, [INERTIA * acceleration, 0, 0]])
    moved = np.linalg.solve(STIFFNESS * J.T @ J, wrench)[:3]
    miss = part("ahead").miss.sel(command="weight").sel(time=instant, method="nearest").values
    np.testing.assert_allclose(miss, moved, rtol=0, atol=0.2 * np.linalg.norm(moved))


def test_commands_make_up_for_more_and_more():
    """19.3 um, 22 nm, 5 nm in z, as commands know the weight, the inertia of the path and the modes."""
    z = part("ahead").miss_peak.sel(axis="z").values
    np.testing.assert_allclose(z[[0, 2, 3]], [19.3e-6, 22e-9, 4.5e-9], rtol=0.03)
    assert np.all(z[1:] < 0.3 * z[:-1])


def test_a_shaped_roll_takes_half_a_period_of_each_mode_more():
    """ZV waits half a period of each mode; the first on springs without mass is 6 % quicker than with it."""
    longer, found = part("shaped").longer.values, part("modes").frequency.values
    J, *_ = rows(0.5 * ROLL)
    M = np.diag([MASS] * 3 + [INERTIA] * 3)
    first = np.sqrt(eigh(STIFFNESS * J.T @ J, M, eigvals_only=True)[0]) / (2 * np.pi)
    assert longer[1] == pytest.approx(0.5 / first, rel=0.07)
    # Modes at the middle of the way and at its end differ by some per cent.
    assert longer[2] == pytest.approx(np.sum(0.5 / found[:6]), rel=0.03)
    after = part("shaped").payload_vibration.values
    assert after[2] < 0.2 * after[0]


def test_force_feedback_damps_by_the_share_of_energy_in_the_drives():
    """zeta = zeta_0 + nu g / 2 omega (Preumont), nu = k / (k + k) = 1/2 of a payload on springs: to second order, 1 %.

    The second and the third mode, of 39 and 50 Hz, bend legs of 62 Hz as well: (f / 62 Hz)^2 bounds what that takes.
    """
    loops = part("feedback")
    before, after = loops.damping_ratio.values
    by_hand = before + 0.5 * outlook.GAIN / (2 * 2 * np.pi * loops.mode_frequency.values[0])
    assert after[0] == pytest.approx(by_hand[0], rel=0.015)
    assert np.all(after[1:] < by_hand[1:])
    assert np.all(after[1:] > (1 - (loops.mode_frequency.values[0, 1:] / 62) ** 2) * by_hand[1:])


def test_the_march_rings_as_the_linear_model_says():
    """After a blow the payload's motion falls as its first modes do; the loop is quiet where the open robot rings."""
    z = part("feedback").ringing.sel(axis="z")
    late = z.sel(time=slice(0.4, None))
    size = (late.max("time") - late.min("time")).values
    assert size[1] < 0.15 * size[0]


def test_joints_that_rub_lose_their_moment_times_their_turn():
    """mu d / 2 |F| times the angles of both joints, F of the drives, without presliding and weights of legs, 3 %."""
    t = np.linspace(0, 1, 401)
    share, rate, _ = quintic(t)
    turn, lost = np.array([1.0, 0, 0]), np.zeros(2)
    force = np.abs(part("robot-rigid").actuator_force_rigid.values)
    force = np.stack([np.interp(t, part("robot-rigid").time, column) for column in force.T], axis=1)
    arm = 0.5 * outlook.FRICTION["mu"] * outlook.FRICTION["diameter"]
    for i in range(len(t)):
        _, legs, n = rows(ROLL * share[i])
        omega = ROLL * rate[i] * turn
        tips = np.cross(omega, legs + ROBOT.base_joints - [0, 0, 0.9])
        across = np.cross(n, tips) / np.linalg.norm(legs, axis=1)[:, None]  # rate of the leg's direction
        ball = np.linalg.norm(omega - across, axis=1)
        base = np.linalg.norm(across, axis=1)
        for k, least in enumerate((1.0, np.sqrt(2))):  # two axes of a cross: between the size and sqrt 2 of it
            lost[k] += arm * np.sum(force[i] * (least * base + ball)) * (t[1] - t[0])
    found = float(part("friction").lost[1])
    assert 0.95 * lost[0] < found < 1.05 * lost[1] * np.sqrt(1.2)


def test_spread_by_hand():
    """Errors of joints along the legs and of lengths, all as lengths of sqrt(20^2 + 20^2 + 10^2) um."""
    J, *_ = rows(0.0)
    inverse = np.linalg.inv(J)
    by_hand = 30e-6 * np.sqrt(np.sum(inverse**2, axis=1))
    found = part("tolerances").pose_sigma.values
    np.testing.assert_allclose(found[:3], by_hand[:3], rtol=1e-4)  # pistons add 3e-5 in squares
