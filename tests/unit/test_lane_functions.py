"""Functions of vectors that the generated code calls, against the C library's."""

import numpy as np
import pytest

from flexapod.symbolic import compiler
from flexapod.symbolic.compiler import CompiledFunction, compiled_library
from flexapod.symbolic.functions import NamedFunction
from flexapod.symbolic.vocabulary import cos, exp, sin, symbol

pytestmark = pytest.mark.skipif(compiler.compiler() is None, reason="there is no C compiler")

ANGLES = np.concatenate(
    [
        np.linspace(-20.0, 20.0, 400),
        np.arange(-9, 10) * np.pi / 4,  # where the quadrant changes
        np.random.default_rng(1).uniform(-1e5, 1e5, 200),
        [0.0, -0.0, 1e-300, 1e-9, 1e5, -2e5, 1e22],
    ]
)


@pytest.fixture(scope="module")
def turn():
    x = symbol("x", len(ANGLES))
    functions = [NamedFunction("turn", [("x", x)], [("sine", sin(x)), ("cosine", cos(x))])]
    library, signatures = compiled_library(["turn"], lambda: functions, (), compiler.compiler())
    return CompiledFunction(library, "turn", signatures["turn"])


def test_sine_and_cosine_are_those_of_the_library(turn):
    sine, cosine = turn(ANGLES)
    # Taylor's series end below round-off; reduction, sum and last product round once each, a unit in the last place of
    # one at most, 2.2e-16; the library's value is half of that off.
    for found, expected in ((sine, np.sin(ANGLES)), (cosine, np.cos(ANGLES))):
        np.testing.assert_allclose(found, expected, rtol=0, atol=4e-16)
    small = np.abs(ANGLES) < 1e-3
    np.testing.assert_allclose(sine[small], np.sin(ANGLES[small]), rtol=4e-16)


def test_what_is_no_number_stays_none(turn):
    for bad in (np.inf, -np.inf, np.nan):
        assert np.isnan(turn(np.where(ANGLES == 1e22, bad, ANGLES))).any(axis=1).all()
        assert np.isnan(turn(np.where(ANGLES == 1e22, bad, ANGLES))).sum() == 2


def test_the_exponential_is_that_of_the_library():
    x = np.concatenate(
        [np.linspace(-720, 720, 2001), np.linspace(-2, 2, 400), [0.0, 1e-300, -800.0, 800.0, np.inf, -np.inf]]
    )
    argument = symbol("x", len(x))
    functions = [NamedFunction("power", [("x", argument)], [("y", exp(argument))])]
    library, signatures = compiled_library(["power"], lambda: functions, (), compiler.compiler())
    # Reduction, sum and product round once each, and the library: less than four units in the last place.
    with np.errstate(over="ignore"):
        expected = np.exp(x)
    (found,) = CompiledFunction(library, "power", signatures["power"])(x)
    np.testing.assert_allclose(found, expected, rtol=9e-16, atol=0)
