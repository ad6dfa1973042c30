"""Laws of the study file evaluated at instants."""

import numpy as np
import pytest

from flexapod.kinematics import laws
from flexapod.kinematics.laws import load_law, motion_law, wrench
from flexapod.model import (
    ConstantLaw,
    ConstantWrench,
    CsvLaw,
    CsvWrench,
    Load,
    ProfileLaw,
    RateLaw,
    SineLaw,
    SineWrench,
    SpinUpLaw,
    StepLaw,
    StepWrench,
)

pytestmark = pytest.mark.unit

T = np.array([0.0, 0.25, 0.5, 1.0, 3.0])
SIX = np.arange(1.0, 7.0)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (RateLaw(rate=0.785), laws.constant_rate(T, rate=0.785)),
        (SpinUpLaw(rate=6.0, duration=2.0), laws.spin_up(T, rate=6.0, duration=2.0)),
        (
            ProfileLaw(law="smooth", amplitude=2.0, duration=1.5),
            laws.rest_to_rest(T, profile="smooth", amplitude=2.0, duration=1.5),
        ),
        (
            CsvLaw(time=[0, 2.0], value=[1.0, 4.0]),
            laws.Law(
                *(
                    a + b
                    for a, b in zip(
                        (1, 0, 0), laws.rest_to_rest(T, profile="quintic", amplitude=3, duration=2), strict=True
                    )
                )
            ),
        ),
    ],
)
def test_motion_laws(law, expected):
    np.testing.assert_allclose(motion_law(law, T), expected, atol=1e-12)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (ConstantLaw(value=3.0), [3, 3, 3, 3, 3]),
        (SineLaw(amplitude=2.0, frequency=1.0, phase=np.pi / 2), [2, 0, -2, 2, 2]),
        (StepLaw(amplitude=5.0, time=0.5), [0, 0, 5, 5, 5]),
        (ProfileLaw(law="quintic", amplitude=4.0, duration=1.0), [0, 4 * 0.103515625, 2, 4, 4]),
        (CsvLaw(time=[0, 1, 2], value=[0, 4, -4]), [0, 1, 2, 4, -4]),
    ],
)
def test_load_laws(law, expected):
    np.testing.assert_allclose(load_law(law, T), expected, atol=1e-14)


@pytest.mark.parametrize(
    ("law", "scale"),
    [
        (None, [0, 0, 0, 0, 0]),
        (ConstantWrench(value=SIX), [1, 1, 1, 1, 1]),
        (SineWrench(amplitude=SIX, frequency=1.0), [0, 1, 0, 0, 0]),
        (StepWrench(amplitude=SIX, time=0.5), [0, 0, 1, 1, 1]),
        (CsvWrench(time=[0, 1], wrench=[0 * SIX, 2 * SIX]), [0, 0.5, 1, 2, 2]),
    ],
)
def test_wrenches(law, scale):
    np.testing.assert_allclose(wrench(Load(wrench=law), T), np.outer(scale, SIX), atol=1e-13)
