"""Stepped, hollow and strip-like pistons against the exact beam of their sections, by transfer matrices."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.helpers.stepped import STEEL, leg_of, misfit, root_near, section, squared_frequencies, thrust_of_shapes

from flexapod.analysis.checks.estimates import buckling_load
from flexapod.model import Piston

pytestmark = pytest.mark.analytic

TWO = [section(0.3, 0.04), section(0.45, 0.03)]
HOLLOW = [section(0.25, 0.04), section(0.5, 0.04, inner_diameter=0.03)]


def test_sections_twist_in_series():
    # Round ones: L / G J each, G = E / 2 (1 + 0.3), J = pi (D^4 - d^4) / 32.
    given = [(0.3, 0.04, 0.0), (0.25, 0.03, 0.01), (0.2, 0.022, 0.0)]
    piston = Piston.stepped([section(L, D, inner_diameter=d or None) for L, D, d in given])
    G = STEEL["E"] / 2.6
    soft = sum(L / (G * np.pi * (D**4 - d**4) / 32) for L, D, d in given)
    assert piston.torsional_stiffness == pytest.approx(0.75 / soft, rel=1e-12)


def frequencies(leg, free, count, **others):
    """Computed and exact ones of the plane in which the leg bends first."""
    found = np.sqrt(squared_frequencies(leg, free, **others)[::2][:count])
    return found, np.array([root_near(lambda w: misfit(leg, free, w), x) for x in found])


@pytest.mark.parametrize(("sections", "free"), [
    (TWO, 0.6),  # a cut outside
    (TWO[::-1], 0.6),
    (TWO, 0.4),  # a cut inside: its mass counts, its stiffness does not
    (HOLLOW, 0.55),
])  # fmt: skip
def test_six_shapes_give_frequencies_and_the_buckling_load(sections, free):
    # Asked for: 1e-6. (T1.25)-(T1.27): loads of inertia and of thrust jump at a cut as those of the exact beam do.
    leg = leg_of(sections)
    found, exact = frequencies(leg, free, 2)
    np.testing.assert_allclose(found, exact, rtol=1e-6)
    assert (found / exact - 1 > -1e-10).all()  # from above
    load = thrust_of_shapes(leg, free)
    assert load == pytest.approx(root_near(lambda P: misfit(leg, free, thrust=P), load), rel=1e-6)


@pytest.mark.parametrize("diameters", [(0.04, 0.03), (0.03, 0.04), (0.02 * 10**0.25, 0.02)])
def test_six_shapes_of_a_stepped_strut(diameters):
    # Two half-waves want seven, as of a uniform strut: 2.3e-5 of these with six there.
    leg = leg_of([section(0.3, d) for d in diameters], 0.0, 0.0)
    (found,), (exact,) = frequencies(leg, 0.6, 1)
    assert found == pytest.approx(exact, rel=1e-8)
    load = thrust_of_shapes(leg, 0.6)
    assert load == pytest.approx(root_near(lambda P: misfit(leg, 0.6, thrust=P), load), rel=1e-6)


def test_three_shapes_give_the_first_frequency_to_what_the_documents_say():
    found, exact = frequencies(leg_of(TWO), 0.6, 1, modes=3)
    assert 0 < found[0] / exact[0] - 1 < 1e-4


def test_a_strut_of_two_sections_is_a_stepped_column():
    # Roark, table 15.1, case 1a: EI 1.5 to 1 (2 to 1), the stiff part 1/6 .. 5/6 of the length; recomputed to 6 digits,
    # the third of the first row is printed as 1.180. Six shapes give the buckling load to 1e-6.
    table = {
        1.5: [1.00946, 1.06563, 1.18827, 1.35716, 1.47785],
        2.0: [1.01407, 1.09847, 1.29847, 1.63437, 1.93955],
    }
    for ratio, row in table.items():
        for k, K1 in enumerate(row, start=1):
            diameters = 0.02 * ratio**0.25, 0.02
            leg = leg_of([section(0.6 * k / 6, diameters[0]), section(0.6 - 0.6 * k / 6, diameters[1])], 0.0, 0.0)
            euler = np.pi**2 * leg.piston.steps[1].EI[0] / 0.6**2
            exact = root_near(lambda P, leg=leg: misfit(leg, 0.6, thrust=P), K1 * euler)
            assert exact / euler == pytest.approx(K1, abs=6e-6)
            assert buckling_load(leg, np.array([0.6]))[0] == pytest.approx(exact, rel=1e-9)
    leg = leg_of([section(0.3, 0.02 * 2**0.25), section(0.3, 0.02)], 0.0, 0.0)
    euler = 1.29847 * np.pi**2 * leg.piston.steps[1].EI[0] / 0.6**2
    assert thrust_of_shapes(leg, 0.6) == pytest.approx(euler, rel=4e-6)  # six digits are given


@pytest.mark.parametrize("free", [0.6, 0.4])
@pytest.mark.parametrize("sections", [TWO, HOLLOW, TWO[::-1]])
def test_a_leg_of_sections_buckles_at_its_exact_load(sections, free):
    leg = leg_of(sections)
    load = buckling_load(leg, np.array([free]))[0]
    assert root_near(lambda P: misfit(leg, free, thrust=P), load) == pytest.approx(load, rel=1e-9)
    assert min(misfit(leg, free, thrust=share * load) for share in np.linspace(0.01, 0.99, 50)) > 0  # the least


def test_a_strip_bends_in_each_plane_with_its_own_stiffness():
    leg = leg_of([section(0.25, width=0.06, thickness=0.03), section(0.5, width=0.04, thickness=0.02)])
    found = np.sqrt(squared_frequencies(leg, 0.6, modes=5, strips=True)[:2])
    exact = [root_near(lambda w, k=k: misfit(leg, 0.6, w, direction=k), x) for k, x in zip((1, 0), found, strict=True)]
    np.testing.assert_allclose(found, exact, rtol=1e-6)


def taper_misfit(leg, free, omega=0.0, thrust=0.0):
    """As `tests.helpers.stepped.misfit`, of full round sections that taper, by integration along the leg outside."""
    mouth, sections = leg.cylinder.mouth, leg.piston.sections
    ends = mouth + free - leg.piston.length + np.cumsum([0.0, *(one.length for one in sections)])
    diameters = [one.diameter for one in sections], [one.tip_diameter or one.diameter for one in sections]

    def diameter(X, j):
        share = (X - ends[j]) / sections[j].length
        return diameters[0][j] * (1 - share) + diameters[1][j] * share

    inertia = leg.cylinder.inertia + leg.cylinder.mass * leg.cylinder.com**2
    x, w = np.polynomial.legendre.leggauss(8)
    for j, low in enumerate(ends[:-1]):
        high = min(ends[j + 1], mouth)
        X = (low + high) / 2 + (high - low) / 2 * x
        if high > low:
            inertia += (high - low) / 2 * w @ (STEEL["density"] * np.pi / 4 * diameter(X, j) ** 2 * X**2)
    state = np.zeros((4, 2))
    for k, (slope, force) in enumerate(((1.0, 0.0), (0.0, 1.0))):
        state[:, k] = mouth * slope, slope, force * mouth - (thrust * mouth + inertia * omega**2) * slope, force

    def rate(X, y, j):
        v, turn, moment, across = y.reshape(4, 2)
        d = diameter(X, j)
        load = STEEL["density"] * np.pi / 4 * d**2 * omega**2 * v
        return np.array([turn, moment / (STEEL["E"] * np.pi / 64 * d**4), across - thrust * turn, load]).ravel()

    for j, end in enumerate(ends[1:]):
        low = max(ends[j], mouth)
        if end > low:
            found = solve_ivp(rate, (low, end), state.ravel(), "DOP853", rtol=1e-10, atol=1e-12, args=(j,))
            state = found.y[:, -1].reshape(4, 2)
    return np.linalg.det(state[[0, 2]])


TAPER, CONE = section(0.35, 0.05, tip_diameter=0.03), section(0.75, 0.05, tip_diameter=0.03)


@pytest.mark.parametrize(("sections", "free", "mouth"), [
    ([section(0.6, 0.06, tip_diameter=0.02)], 0.6, 0.0),  # a strut
    ([CONE], 0.6, 0.4),
    ([TAPER, section(0.4, 0.03)], 0.6, 0.4),  # the cut outside
    ([section(0.4, 0.05), TAPER], 0.3, 0.4),  # the cut inside
])  # fmt: skip
def test_tapers_against_beams_integrated_along_them(sections, free, mouth):
    # (T1.24): each section is one piece whatever its taper. Two half-waves of a strut want seven shapes, as of a
    # uniform one. Loads of `check` come from steps, 64 a taper, one of which the mouth cuts: 1 / 64^2 of what differs.
    leg, shapes = leg_of(sections, mouth, 5.0 if mouth else 0.0), 6 if mouth else 7
    found = np.sqrt(squared_frequencies(leg, free, shapes)[::2][:2])
    exact = [root_near(lambda w: taper_misfit(leg, free, w), x) for x in found]
    np.testing.assert_allclose(found, exact, rtol=1e-6)
    load = thrust_of_shapes(leg, free, shapes)
    exact = root_near(lambda P: taper_misfit(leg, free, thrust=P), load)
    assert load == pytest.approx(exact, rel=1e-6)
    assert buckling_load(leg, np.array([free]))[0] == pytest.approx(exact, rel=1e-4)
