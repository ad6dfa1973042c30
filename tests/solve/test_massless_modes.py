"""Coordinates without mass, with dampers and without: closed forms, counts of poles, passive machines."""

import numpy as np
import pytest
from tests.helpers.machines import HEAVY, LIGHT, MOUNT, PLATE, SCREW, SERVO, TUBE, machine, study

import flexapod as fx
from flexapod.model import Feedback, Motor, preset_text
from flexapod.solve.modal.eigenproblem import damping_ratios, damping_ratios_of, natural_modes, poles

pytestmark = pytest.mark.analytic


def modal(mass, stiffness, damping):
    """Undamped modes of diagonal masses: frequencies [rad/s] and damping in coordinates of unit stiffness."""
    omega, z, _ = natural_modes(np.diag(np.sqrt(mass))[None], np.array(stiffness)[None], shapes=True)
    return omega[0], z[0].T @ damping @ z[0]


@pytest.mark.parametrize("c", [0.03, 2.0, 60.0, 4e3, 1e7])
def test_a_mass_behind_a_damper_without_mass(c):
    # m on k1 to a point without mass, on which k2 and c act: m s^2 (k1 + k2 + c s) + k1 (k2 + c s) = 0, a cubic.
    # Two poles of the mass, one of the damper.
    m, k1, k2 = 3.0, 700.0, 200.0
    omega, D = modal([m, 0.0], [[k1, -k1], [-k1, k1 + k2]], np.diag([0.0, c]))
    assert np.isfinite(omega).tolist() == [True, False]
    expected = np.sort_complex(np.roots([m * c, m * (k1 + k2), k1 * c, k1 * k2]))
    np.testing.assert_allclose(np.sort_complex(poles(omega, D)), expected, rtol=1e-8)
    pair = expected[expected.imag > 0]
    ratio = damping_ratios(omega, D)
    # Rounding is 1e-16 of the largest rate, c / k over that of the mass: 1e5 where the damper all but holds the point.
    assert ratio[0] == pytest.approx(-pair[0].real / abs(pair[0]), rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("loss", [0.0, 0.01, 0.1, 0.5, 3.0])
def test_the_ratio_of_one_mode_is_that_among_all(loss: float) -> None:
    """Light and heavy dampers, a pair of equal frequencies, modes without mass."""
    seed = np.random.default_rng(7)
    omega = np.sort(seed.uniform(1.0, 30.0, size=(4, 9)), axis=1)
    omega[1, 1], omega[2, 7:], omega[3, 4:] = omega[1, 0], np.inf, np.inf
    A = seed.normal(size=(4, 9, 9))
    D = loss * 0.1 * A @ A.swapaxes(1, 2) / 9
    D[1] *= np.eye(9)
    whole = np.array([damping_ratios(w, d) for w, d in zip(omega, D, strict=True)])
    for mode in range(9):
        np.testing.assert_allclose(damping_ratios_of(mode, omega, D), whole[:, mode], rtol=1e-11, atol=1e-14)


def test_what_has_neither_mass_nor_damper_has_no_pole():
    # A mass, a point on a damper, a point on springs alone: 2 + 1 poles, those of the cubic with the springs in series.
    m, k, c = 2.0, 50.0, 9.0
    K = [[k, -k, 0.0], [-k, 2 * k, -k], [0.0, -k, 2 * k]]
    omega, D = modal([m, 0.0, 0.0], K, np.diag([0.0, 0.0, c]))
    expected = np.roots([m * c, 1.5 * m * k, k / 2 * c, k / 2 * k])  # k/2 to the damper, which k holds to the ground
    np.testing.assert_allclose(np.sort_complex(poles(omega, D)), np.sort_complex(expected), rtol=1e-8)


def test_no_mass_at_all():
    # Two points on springs, one with a damper: it comes back as exp(-k t / c) with what the other leaves of k.
    omega, D = modal([0.0, 0.0], [[3.0, -1.0], [-1.0, 2.0]], np.diag([0.5, 0.0]))
    np.testing.assert_allclose(poles(omega, D), [-(3.0 - 0.5) / 0.5], rtol=1e-12)
    assert not damping_ratios(omega, D).any()


@pytest.mark.parametrize("seed", range(12))
def test_passive_springs_lose_energy_whatever_is_heavy_or_damped(seed):
    # Masses over 16 decades and none, dampers over 12 and none. Poles have real parts of rounding at most: of the
    # largest entry of the matrix, some 1e-16 of the fastest decay over the slowest rate.
    rng = np.random.default_rng(seed)
    n = 12
    mass = np.where(rng.random(n) < 0.4, 0.0, 10.0 ** rng.uniform(-12, 4, n))
    mass[0] = 10.0
    A, B = rng.normal(size=(2, n, n))
    given = 10.0 ** rng.uniform(-8, 4, n) * (rng.random(n) < 0.5)
    omega, D = modal(mass, A @ A.T + np.eye(n), B @ np.diag(given) @ B.T)
    assert np.isfinite(omega).sum() == (mass > 0).sum()
    ratio = damping_ratios(omega, D)
    assert ratio.min() > -1e-6 and not ratio[~np.isfinite(omega)].any()
    massless = np.flatnonzero(mass == 0)
    count = 2 * (mass > 0).sum() + min(len(massless), (given > 0).sum())
    assert len(poles(omega, D)) == count


POSES = (None, {"heave": 0.05, "roll": 0.1}, {"surge": 0.05, "pitch": -0.08, "yaw": 0.1})
LOOPS = ((500.0, 6.0), (5e3, 20.0), (500.0, 60.0), (5e4, 6.0), (5e3, 0.5))


@pytest.mark.parametrize("rhoA", [0.0, 1e-9, 1e-3, 12.3])
def test_no_passive_machine_has_negative_damping(rhoA):
    """Pistons without mass gave 1/mu = 1e-17, whose imaginary part was taken for an oscillation: -93 % at 236 Hz."""
    # Whatever loops, masses and poses: rounding of the eigenvalues is 1e-16 of rates 1e5 apart.
    piston = TUBE.replace(rhoA=rhoA, axial_inertia=0.0 if rhoA < 1 else TUBE.axial_inertia)
    for stiffness, damping in LOOPS:
        loop = SCREW.replace(command="servo", loop=Feedback(stiffness=stiffness, damping=damping))
        one = study(machine(drive=loop, piston=piston))
        for pose in POSES:
            assert fx.modes(one, pose).damping_ratio.values.min() > -1e-10


def test_no_mass_is_the_limit_of_little_mass():
    # 1e-6 kg of piston in a robot of a ton: frequencies and ratios of what has mass change by 1e-9 and by the decays
    # that the dampers of the pistons add, 1e-6.
    loop = SCREW.replace(command="servo", loop=Feedback(stiffness=5e3, damping=20.0))
    pistons = (TUBE.replace(rhoA=rhoA, axial_inertia=0.0) for rhoA in (0.0, 1e-6))
    none, little = (fx.modes(study(machine(drive=loop, piston=x)), POSES[2]) for x in pistons)
    count = none.sizes["mode"]
    np.testing.assert_allclose(little.frequency[:count], none.frequency, rtol=1e-6)
    np.testing.assert_allclose(little.damping_ratio[:count], none.damping_ratio, rtol=1e-3, atol=2e-6)


def test_motors_that_lag_by_nothing_leave_modes_without_mass_alone():
    # Loops that lag are solved as equations of their own, (T23.59). A nanosecond at 240 Hz is 2e-6 rad.
    loop = SCREW.replace(command="servo", loop=Feedback(stiffness=500.0, damping=0.6))
    late = loop.replace(motor=Motor(bandwidth=1 / (2 * np.pi * 1e-9)))
    piston = TUBE.replace(rhoA=0.0, axial_inertia=0.0)
    at_once, lagging = (fx.modes(study(machine(drive=x, piston=piston)), POSES[1]) for x in (loop, late))
    assert lagging.damping_ratio.values.min() > -1e-10
    found = lagging.damping_ratio.values[np.isfinite(lagging.frequency.values)]
    ratios = at_once.damping_ratio.values[at_once.damping_ratio.values < 1]
    assert len(found) == len(ratios) == 24
    np.testing.assert_allclose(np.sort(found), np.sort(ratios), rtol=1e-4)


@pytest.mark.parametrize(("robot", "count"), [
    (machine(piston=LIGHT), 18),  # the payload, and two turns of each cylinder as its piston bends
    (machine(piston=LIGHT, drive=SERVO), 24),  # ... and six rotors
    (machine(piston=LIGHT).replace(base_mount=MOUNT), 24),  # ... the feet of the cylinders move with the base
    (machine(piston=LIGHT).replace(base_mount=HEAVY), 24),
    (machine(piston=LIGHT).replace(platform_mount=PLATE), 18),  # a plate without mass, on springs
    (machine(piston=LIGHT).replace(platform_mount=PLATE, base_mount=MOUNT), 24),
], ids=["pistons", "rotors", "base", "heavy base", "platform", "both"])  # fmt: skip
@pytest.mark.parametrize("pose", [None, {"surge": 0.05, "heave": 0.05, "roll": 0.1}], ids=["home", "away"])
def test_as_many_modes_as_the_mass_matrix_has_ranks(robot, count, pose):
    found = fx.modes(study(robot), pose)
    assert len(found.frequency) == count
    assert found.frequency.values.max() < 1e4  # what has mass is a piston's spring and 28 kg at most


def test_a_mount_without_mass_adds_the_spins_of_the_legs():
    """Three ghosts at 1.6e10 to 3.1e10 Hz, with 5e8 % of damping, were listed as modes of the payload."""
    # Joints give way in three directions, so that feet move by themselves already; the base's three turns are the first
    # that turn cylinders about their own axes. Its own three displacements move nothing that is not moved.
    one = fx.loads(preset_text("machine-hexapod"))
    alone, mounted = (fx.modes(one.replace(robot=one.robot.replace(base_mount=x))) for x in (None, MOUNT))
    assert len(mounted.frequency) == len(alone.frequency) + 3
    assert mounted.frequency.values.max() < 1.1 * 16281
    assert mounted.damping_ratio.values.max() < 10
