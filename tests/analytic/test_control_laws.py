"""Laws of one channel against their transfers, written as quotients of s; both sides differ by rounding alone.

A response is a solution of at most five equations whose numbers are within a few powers of the corner: 1e-12. What a
high-pass feeds through, 1, is taken back by its states far below its corner: 1e-14 of that.
"""

import numpy as np
import pytest

import flexapod.control as fc
from flexapod.errors import InputError

HZ = np.geomspace(0.1, 1000.0, 41)
S = 2j * np.pi * HZ
W = 2 * np.pi * 20.0

LAWS = {
    "gain": (fc.gain(-3.0), -3.0 + 0 * S),
    "rate": (fc.rate(4.0), 4.0 * S),
    "rate with a corner": (fc.rate(4.0, 20.0), 4.0 * S / (1 + S / W)),
    "integrator": (fc.integrator(5.0), 5.0 / S),
    "integrator with a corner": (fc.integrator(5.0, "20 Hz"), 5.0 / (S + W)),
    "low-pass": (fc.low_pass(20.0), W / (S + W)),
    "low-pass of order 2": (fc.low_pass(20.0, 2, 0.3), W**2 / (S**2 + 0.6 * W * S + W**2)),
    "high-pass": (fc.high_pass(20.0), S / (S + W)),
    "high-pass of order 2": (fc.high_pass(20.0, 2), S**2 / (S**2 + 2**0.5 * W * S + W**2)),
    "lead": (fc.lead(20.0, 3.0), (1 + 3 * S / W) / (3 * (1 + S / (3 * W)))),
    "notch": (fc.notch(20.0, 0.4, 0.1), (S**2 + 0.08 * W * S + W**2) / (S**2 + 0.8 * W * S + W**2)),
    "pid": (fc.pid(2.0, 3.0, 0.5, 20.0), 2.0 + 3.0 / S + 0.5 * S / (1 + S / W)),
    "positive feedback": (fc.positive_feedback(20.0, 0.2, 0.7), 0.7 * W**2 / (S**2 + 0.4 * W * S + W**2)),
}


@pytest.mark.parametrize("name", LAWS)
def test_transfer(name):
    law, exact = LAWS[name]
    np.testing.assert_allclose(law.at(HZ), exact, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("name", LAWS)
def test_products_and_sums(name):
    """Behind each other transfers multiply, beside each other they add, whichever of the two takes the rate."""
    (law, exact), other = LAWS[name], W**2 / (S**2 + 2**0.5 * W * S + W**2)
    for both in (law * fc.low_pass(20.0, 2), fc.low_pass(20.0, 2) * law):
        np.testing.assert_allclose(both.at(HZ), exact * other, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose((law + fc.low_pass(20.0, 2)).at(HZ), exact + other, rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose((-2.0 * law).at(HZ), -2.0 * exact, rtol=1e-12, atol=1e-14)


def test_two_rates_have_no_product():
    with pytest.raises(InputError, match="rate of a rate"):
        fc.rate(1.0) * fc.rate(1.0)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_complementary_filters(order):
    """Their sum is 1, and beyond the corner they fall by 10^order in a decade; the next term is w/s = 1/50 of that."""
    low, high = fc.complementary(20.0, order)
    np.testing.assert_allclose(low.at(HZ) + high.at(HZ), 1.0, rtol=1e-11)
    for law, ends in ((low, [1e4, 1e5]), (high, [0.04, 0.004])):
        size = np.abs(law.at(ends))
        assert np.log10(size[0] / size[1]) == pytest.approx(order, abs=0.02)


def test_two_sensors_of_one_motion():
    """-law (L y + H z): at a frequency far below the corner the first sensor alone, far above it the second."""
    made = fc.Fused(fc.gain(2.0), low="place", high="motion", corner=20.0, order=2, actuator="drive")
    law = made.on(["place:1", "place:2", "motion:1", "motion:2"], ["drive:1", "drive:2"])
    found = law.at(HZ)
    low, high = (part.at(HZ) for part in fc.complementary(20.0, 2))
    exact = -2.0 * np.einsum("sf,ij->isjf", np.stack([low, high]), np.eye(2)).reshape(2, 4, -1)
    assert law.inputs == ("place:1", "place:2", "motion:1", "motion:2")
    np.testing.assert_allclose(found, exact, atol=1e-11)


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda: fc.lead(20.0, 0.0), "ratio"),
        (lambda: fc.low_pass(20.0, 3), "order"),
        (lambda: fc.complementary(20.0, 4), "order"),
        (lambda: fc.notch(0.0), "frequency"),
        (lambda: fc.ControlLaw.of([1.0, 0.0, 0.0], [1.0]), "numerator"),
    ],
)
def test_laws_that_there_are_not(call, key):
    with pytest.raises(InputError) as refused:
        call()
    assert refused.value.key == key
