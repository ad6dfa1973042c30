"""Solid elements against closed forms: beams with shear and rotary inertia, locking of linear elements, sag."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq
from tests.oracles import beams

from flexapod.model import Rectangle, Tube
from flexapod.solve.fem.frequencies import frequencies
from flexapod.solve.fem.hexahedra import beam_mesh
from flexapod.solve.fem.reduction import reduced_beam
from flexapod.solve.fem.sliding import HubMotion, SlidingBeam, mouth_of

pytestmark = pytest.mark.analytic

FLAT = Rectangle(width=0.1524, height=0.0095)
EI, RHOA, LENGTH = 756.65, 4.02, 3.66
MATERIAL = {"E": EI / FLAT.second_moment, "density": RHOA / FLAT.area}
STILL = {"length_rate": 0.0, "length_acceleration": 0.0, "angle": 0.0, "angle_rate": 0.0, "angle_acceleration": 0.0}


def timoshenko(r, shear, guesses):
    """Clamped-free W = omega sqrt(rhoA L^4 / EI) for a radius of gyration r L and shear = E / (kappa G)."""

    def free_end(W):
        # (w, psi, M, Q)' with EI = rhoA = L = 1: w' = psi + shear r^2 Q, psi' = M, M' = -Q - r^2 W^2 psi, Q' = -W^2 w
        A = np.array([[0, 1, 0, shear * r**2], [0, 0, 1, 0], [0, -((r * W) ** 2), 0, -1], [-(W**2), 0, 0, 0]])
        return np.linalg.det(expm(A)[2:, 2:])

    return np.array([brentq(free_end, 0.97 * W, 1.001 * W, xtol=1e-10) for W in guesses])


def test_the_timoshenko_reference_is_the_published_one():
    exact = [3.502641, 21.469824, 58.149832]  # nu = 0.3, kappa = 5/6
    np.testing.assert_allclose(timoshenko(0.02, 2.6 * 1.2, exact), exact, rtol=2e-7)  # printed digits


def test_thick_beam_is_timoshenkos():
    # nu = 0, kappa = 5/6. The clamp also holds the warping of the section, over a length of about the depth / 4, where
    # shear takes 3 E/(kappa G) r^2 = 0.3 % of the compliance: an effect of 1e-4 at most on the first mode.
    r, length = 0.02, 1.0
    section = Rectangle(width=0.02, height=r * np.sqrt(12))
    mesh = beam_mesh(section, length, 0.02, whole=False)
    ours = frequencies(mesh, E=1.0, density=1.0, count=3) * 2 * np.pi
    unit = np.sqrt(section.second_moment / section.area)
    exact = timoshenko(r, 2.4, [3.506, 21.6, 58.9])
    assert (np.abs(ours / unit / exact - 1) < [1e-4, 4e-4, 8e-4]).all()


def test_thin_beam_is_bernoullis():
    # Shear and rotary inertia: -1.8e-5, -1.2e-4, -2.9e-4; the element: (lam / n)^4 / 720, below 1e-5 for mode 3.
    mesh = beam_mesh(FLAT, 1.83, 0.025, whole=False)
    exact = beams.frequency(beams.beam_roots("clamped", "free", 3), 1.83, EI, RHOA)
    np.testing.assert_allclose(frequencies(mesh, **MATERIAL, count=3), exact, rtol=3e-4)
    assert frequencies(mesh, **MATERIAL, count=1)[0] == pytest.approx(exact[0], rel=2e-5)


@pytest.mark.parametrize(("poisson", "low", "high"), [(0.0, -5e-4, 5e-5), (0.3, 0.0, 4.5e-3)])
def test_round_piston(poisson, low, high):
    # Table 3: r / L = 0.01125. Timoshenko with kappa = 6 (1 + nu) / (7 + 6 nu). Elements of 9 mm take 8e-4 of the area
    # by their arcs, 16e-4 of I, so 4e-4 of a frequency. At nu = 0.3 the clamp keeps the section from widening: it acts
    # like one that lies up to a tenth of the radius further out, 2 * 1.35 mm / 600 mm.
    piston, r = Tube(diameter=0.027), 0.027 / 4 / 0.6
    ours, one_plane = (
        frequencies(beam_mesh(piston, 0.6, 0.009, whole=whole), E=200e9, density=7800.0, poisson=poisson, count=count)
        for whole, count in ((True, 4), (False, 2))
    )
    exact = timoshenko(r, 2 * (1 + poisson) * (7 + 6 * poisson) / (6 * (1 + poisson)), [3.515, 21.9])
    exact *= np.sqrt(200e9 * piston.second_moment / (7800.0 * piston.area * 0.6**4)) / (2 * np.pi)
    gap = ours / np.repeat(exact, 2) - 1  # two planes
    assert (low < gap).all() and (gap < high).all()
    np.testing.assert_allclose(ours[0::2], ours[1::2], rtol=1e-6)
    np.testing.assert_allclose(one_plane, ours[0::2], rtol=1e-6)


@pytest.mark.parametrize("size", [0.05, 0.02])
def test_linear_elements_lock_as_derived(size):
    """Bending stiffness too high by 1 + (G / E) (l / h)^2: 15.3 with elements of 50 mm."""
    model = reduced_beam(FLAT, LENGTH, size, **MATERIAL, kind="hex8")
    element = model.spacing / round(model.spacing / size)
    factor = 1 + 0.5 * (element / FLAT.height) ** 2
    # Rounding: the stiffness of an interval over that of the piece from which EI is read, 1e-16 * (5 H / h)^3.
    assert 1 / mouth_of(model).bending == pytest.approx(EI * factor, rel=1e-9)


@pytest.mark.parametrize("size", [0.05, 0.00475])
def test_reduced_integration_bends_as_derived(size):
    """Too soft by 1 / n^2 with n layers; the hourglass control gives 3 r G / n^2 E of it back, Eq. (T10.28)."""
    model = reduced_beam(FLAT, LENGTH, size, **MATERIAL, kind="hex8r")
    count = [max(1, round(x / size)) for x in (model.spacing, FLAT.height, FLAT.width)]
    length, layers = model.spacing / count[0], count[1]
    width = FLAT.width / (count[2] + count[2] % 2)  # the plane of symmetry runs along edges
    held = 1.5 * 0.005 / layers**2 * length**2 * (length**-2 + (FLAT.height / layers) ** -2 + width**-2)
    assert 1 / mouth_of(model).bending == pytest.approx(EI * (1 - layers**-2 + held), rel=1e-8)


@pytest.mark.parametrize("size", [0.05, 0.01])
def test_incompatible_modes_bend_like_a_beam(size):
    # Boxes: exact whatever the mesh; rounding as for the elements that lock.
    assert 1 / mouth_of(reduced_beam(FLAT, LENGTH, size, **MATERIAL, kind="hex8i")).bending == pytest.approx(
        EI, rel=1e-8
    )


@pytest.mark.parametrize(("poisson", "tolerance"), [(0.0, 1e-8), (0.3, 1e-4)])
def test_quadratic_elements_bend_like_saint_venants_beam(poisson, tolerance):
    # Any width bends with EI once its sections may curl; at nu = 0.3 the mouth's effect has faded to exp(-pi 3) there.
    mouth = mouth_of(reduced_beam(FLAT, LENGTH, 0.05, **MATERIAL, poisson=poisson))
    assert 1 / mouth.bending == pytest.approx(EI, rel=tolerance)


def test_inertia_and_loads_of_a_rigid_motion():
    model = reduced_beam(FLAT, LENGTH, 0.05, **MATERIAL, poisson=0.3)
    xi = model.spacing * np.arange(model.stations)
    lift, turn = np.zeros((2, 2 * model.stations))
    lift[0::2], turn[0::2], turn[1::2] = 1.0, -xi, 1.0
    mass = RHOA * LENGTH
    close = {"rtol": 1e-10}
    np.testing.assert_allclose(
        [lift @ model.mass @ lift, lift @ model.mass @ turn], mass * np.array([1, -LENGTH / 2]), **close
    )
    np.testing.assert_allclose(turn @ model.mass @ turn, mass * LENGTH**2 / 3, rtol=1e-5)  # and rotary, 7e-7
    np.testing.assert_allclose(model.loads @ lift, mass * np.array([1, LENGTH / 2]), **close)
    slopes = [turn @ G @ turn for G in model.slopes]
    np.testing.assert_allclose(slopes, [LENGTH, LENGTH**2 / 2, LENGTH**3 / 3], **close)
    np.testing.assert_allclose(model.stiffness @ np.stack([lift, turn], axis=1), 0, atol=1e-3)  # of entries 2e7


def test_coriolis_sag():
    # 2 rhoA th' L' L^4 / 8 EI, without spin; the turn of 0.785 rad/s adds 0.06 %.
    beam = SlidingBeam(model=reduced_beam(FLAT, LENGTH, 0.05, **MATERIAL))
    motion = HubMotion(**(STILL | {"length": 1.83, "length_rate": 0.1, "angle_rate": 0.785}))
    exact = -2 * RHOA * 0.785 * 0.1 * 1.83**4 / (8 * EI)
    assert beam.static_deflection(motion) == pytest.approx(exact, rel=1e-3)


def test_spin_adds_the_axial_force_and_takes_the_square_of_the_rate():
    # Rotating cantilever, lag: W^2 = W_flap^2 - g^2, published flap 3.681647 and 22.181011 at g = 1.
    beam = SlidingBeam(model=reduced_beam(FLAT, LENGTH, 0.025, **MATERIAL))
    unit = np.sqrt(EI / (RHOA * 1.83**4))
    fast = beam.frequencies(HubMotion(**(STILL | {"length": 1.83, "angle_rate": unit})), 2)
    slow = beam.frequencies(HubMotion(**(STILL | {"length": 1.83})), 2)
    roots = beams.beam_roots("clamped", "free", 2) ** 2
    exact = np.sqrt(np.array([3.681647, 22.181011]) ** 2 - 1)
    # Ratios: of element and shear, 1.2e-4, only the share of the difference remains, 0.8 % and less; 7 printed digits.
    np.testing.assert_allclose(fast / slow, exact / roots, rtol=1e-6)
