"""Mechanisms of the test set for IVP solvers in the robot's compiled time integration: end values, order, structure."""

import numpy as np
import pytest

from flexapod.common.errors import ComputationError
from flexapod.verification import mechanism
from flexapod.verification.cases import slider_crank, squeezer

pytestmark = pytest.mark.literature


def test_squeezer_of_second_order():
    # 14 turns of the crank in 0.03 s; steps fine enough for the leading term, coarse enough for rounding
    errors = [np.abs(squeezer.end_state(n) / squeezer.END - 1) for n in (5000, 10000, 20000)]
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.02)
    np.testing.assert_allclose(np.log2(errors[1] / errors[2]), 2.0, atol=0.02)
    assert errors[2].max() < 1e-6


def test_the_squeezer_starts_as_the_test_set_does():
    # Printed with the problem: accelerations of beta and Theta, first two multipliers; all others are zero.
    start = squeezer.run(2000)[0]
    np.testing.assert_allclose(start.v_dot[0, -6:-4], [14222.4439199541139, -10666.8329399655854], rtol=1e-12)
    np.testing.assert_allclose(np.abs(start.lam[0, 0, :2]), [98.5668703962410896, 6.12268834425566265], rtol=1e-12)
    assert np.abs(start.v_dot[0, :-6]).max() < 1e-6
    assert np.abs(start.lam[0, 1:]).max() < 1e-9


def test_cranks_on_one_shaft_turn_alike():
    # The first is driven by its table, the others by the shaft, through multipliers.
    six = slider_crank.end_state(20_000)
    np.testing.assert_allclose(six, six[:1] + np.zeros((6, 1)), rtol=1e-7)


def test_without_a_compiler(monkeypatch):
    monkeypatch.setattr(mechanism, "compiler", lambda: None)
    with pytest.raises(ComputationError, match="no C compiler"):
        squeezer.end_state(20)
