"""Among equals the number decides, whatever their last bits."""

import numpy as np
import pytest

from flexapod.common.ranking import EQUALS, descending_order, first_largest, first_least, is_largest, largest_item

pytestmark = pytest.mark.unit

VALUES = np.array([1.0, 3.0, 2.0, 3.0, np.nan, 1.0, 3.0, -4.0, -4.0])


def noisy(seed):
    return VALUES + 3e-10 * np.random.default_rng(seed).uniform(-1, 1, size=VALUES.size)


@pytest.mark.parametrize("seed", range(20))
def test_the_first_of_those_alike(seed):
    values = noisy(seed)
    assert first_largest(values, EQUALS) == 1 and first_least(values, EQUALS) == 7
    assert first_largest(VALUES + 1e-3 * (values - VALUES)) == 1
    assert first_largest(values.reshape(3, 3), EQUALS) == 1
    known = np.delete(values, 4)
    assert descending_order(known).tolist() == [1, 3, 5, 2, 0, 4, 6, 7]
    assert largest_item(enumerate(known), key=lambda item: item[1])[0] == 1
    rows = np.stack([known, known[::-1], -known])
    assert is_largest(rows, axis=1, same=EQUALS).argmax(axis=1).tolist() == [1, 2, 6]


def test_what_is_really_larger_and_what_is_no_number():
    assert first_largest(np.array([1.0, 1.0 + 1e-11])) == 1
    assert first_largest(np.array([np.inf, 1.0, np.inf])) == 0
    assert first_least(np.array([np.inf, np.inf])) == 0
    assert descending_order(np.array([-np.inf, 2.0, -np.inf, 2.0])).tolist() == [1, 3, 0, 2]
    assert first_largest(np.zeros(3)) == 0
