"""Stepped, hollow and strip-like pistons against the exact beam of their sections, by transfer matrices."""

import numpy as np
import pytest
from tests.stepped import leg_of, misfit, root_near, section, squared_frequencies

from flexapod.study.before.estimates import buckling_load

TWO = [section(0.3, 0.04), section(0.45, 0.03)]
HOLLOW = [section(0.25, 0.04), section(0.5, 0.04, inner_diameter=0.03)]
THREE = [section(0.2, 0.05), section(0.25, 0.04, inner_diameter=0.03), section(0.3, 0.03)]


def frequencies(leg, free, count, **others):
    """Computed and exact ones of the plane in which the leg bends first."""
    found = np.sqrt(squared_frequencies(leg, free, **others)[::2][:count])
    return found, np.array([root_near(lambda w: misfit(leg, free, w), x) for x in found])


@pytest.mark.parametrize(("sections", "free"), [
    (TWO, 0.6),  # a cut outside
    (TWO, 0.4),  # a cut inside: its mass counts, its stiffness does not
    (HOLLOW, 0.55),
])  # fmt: skip
def test_six_shapes_give_the_first_frequencies(sections, free):
    # (T1.19): loads miss the jump of the deflection's curvature by k^(-5/2), frequencies by k^-9
    found, exact = frequencies(leg_of(sections), free, 2)
    assert 0 <= found[0] / exact[0] - 1 + 1e-9 < 1e-6
    assert 0 <= found[1] / exact[1] - 1 < 1e-5


def test_three_shapes_give_the_first_frequency_to_what_the_documents_say():
    found, exact = frequencies(leg_of(TWO), 0.6, 1, modes=3)
    assert 0 < found[0] / exact[0] - 1 < 1e-4


def test_a_strut_of_two_sections_is_a_stepped_column():
    # Roark, table 15.1, case 1a: EI 1.5 to 1 (2 to 1), the stiff part 1/6 .. 5/6 of the length; recomputed to 6 digits,
    # the third of the first row is printed as 1.180. Six shapes give the buckling load to 1e-4.
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
    below, above = (squared_frequencies(leg, 0.6, thrust=x * euler)[0] for x in (1 - 1e-4, 1 + 1e-4))
    assert below > 0 > above


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
