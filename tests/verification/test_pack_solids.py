"""Timoshenko's beam, and the axial mode of a piston, in solid elements."""

import numpy as np
import pytest

from flexapod.verification.cases.solids import (
    PLANE_KAPPA,
    TABLE,
    TABLE_KAPPA,
    solid_beam_frequencies,
    timoshenko,
)

pytestmark = pytest.mark.literature


@pytest.mark.parametrize(("gyration", "ends", "waves"), TABLE)
def test_the_table_is_that_of_the_equations(gyration, ends, waves):
    np.testing.assert_allclose(timoshenko(gyration, TABLE_KAPPA, ends, waves), waves, rtol=1e-7)  # seven digits


@pytest.mark.parametrize("wave", [1, 2, 3])
def test_pinned_beams_closed_form(wave):
    # r2 s2 W^4 - [1 + (n pi)^2 (r2 + s2)] W^2 + (n pi)^4 = 0, s2 = r2 E / kappa G
    r2 = 0.05**2
    s2, n2 = r2 * 2.6 / PLANE_KAPPA, (wave * np.pi) ** 2
    exact = np.sqrt(np.roots([r2 * s2, -(1 + n2 * (r2 + s2)), n2**2]).min())
    near = TABLE[4][2][wave - 1]
    assert timoshenko(0.05, PLANE_KAPPA, "pinned-pinned", (near,))[0] == pytest.approx(exact, rel=1e-8)


def test_solids_lie_between_the_two_shear_coefficients():
    """Nearer to that of a narrow section, which holds for long waves away from the ends, than to 5/6."""
    for ends, waves in (row[1:] for row in TABLE if row[0] == 0.02):
        shift = timoshenko(0.02, PLANE_KAPPA, ends, waves) / waves - 1
        share = (solid_beam_frequencies(0.02, ends, 48) / waves - 1) / shift
        assert (share > 0.5).all() and (share < 1.0).all()
