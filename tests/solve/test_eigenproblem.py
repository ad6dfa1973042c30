"""Numbers that are not finite are refused in words before LAPACK sees them."""

import numpy as np
import pytest

from flexapod.common.errors import ComputationError
from flexapod.solve.modal.eigenproblem import count_real, damping_ratios, damping_ratios_of, natural_modes
from flexapod.solve.statics.stiffness import compliance

pytestmark = pytest.mark.unit

HUGE = 1e200 * np.eye(3)[None]


@pytest.mark.parametrize(
    "computed",
    [
        lambda: natural_modes(1e100 * HUGE, 1e-220 * HUGE, shapes=True),  # mass over stiffness overflows
        lambda: damping_ratios(np.ones(2), np.full((2, 2), np.inf)),
        lambda: damping_ratios_of(0, np.ones((1, 2)), np.full((1, 2, 2), np.nan)),
        lambda: compliance(np.zeros((1, 6, 6))),
        lambda: compliance(np.full((1, 6, 6), np.nan)),
    ],
)
def test_numbers_that_are_not_finite_are_refused(computed):
    with pytest.raises(ComputationError, match="not finite") as refused, np.errstate(all="ignore"):
        computed()
    assert refused.value.next_step is not None


def test_as_many_modes_are_shown_as_a_pose_has():
    none = np.inf
    assert count_real(np.array([[1.0, 2.0, none, none], [1.0, 2.0, 3.0, none]])) == 3
    assert count_real(np.array([1.0, none, np.nan])) == 1
    assert count_real(np.array([[none, none]])) == 2  # a row of none says so


def test_compliance_is_the_inverse():
    rng = np.random.default_rng(1)
    A = rng.normal(size=(4, 6, 6))
    total = A @ A.swapaxes(1, 2) + 6 * np.eye(6)
    np.testing.assert_allclose(total @ compliance(total), np.broadcast_to(np.eye(6), total.shape), atol=1e-13)
