"""Functions of generated code that only elements from outside use, against NumPy's, however the code is written."""

import ctypes

import casadi
import numpy as np
import pytest
import scipy.special

from flexapod.mechanics.symbolic import c_source, compiler, elementary
from flexapod.mechanics.symbolic.c_functions import constant_text, without_text
from flexapod.mechanics.symbolic.compiler import CompiledFunction, compiled_library
from flexapod.mechanics.symbolic.functions import Interpreted, NamedFunction
from flexapod.mechanics.symbolic.vocabulary import gradient, symbol, vertcat

pytestmark = [
    pytest.mark.unit,
    pytest.mark.optimised,
    pytest.mark.skipif(compiler.compiler() is None, reason="there is no C compiler"),
]

ONE = {
    "log": np.log, "log1p": np.log1p, "expm1": np.expm1, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos,
    "atan": np.arctan, "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh, "asinh": np.arcsinh, "atanh": np.arctanh,
    "erf": scipy.special.erf, "fabs": np.abs, "sign": np.sign, "floor": np.floor, "ceil": np.ceil,
}  # fmt: skip
TWO = {
    "atan2": np.arctan2, "hypot": np.hypot, "fmin": np.minimum, "fmax": np.maximum, "fmod": np.fmod,
    "copysign": np.copysign,
}  # fmt: skip
#: x is within (-1, 1) for inverse functions; logarithms and powers see what is positive.
X = np.concatenate([np.random.default_rng(3).uniform(-0.99, 0.99, 21), [0.0, -0.0, 0.5, -1e-9]])
Y = np.concatenate([np.random.default_rng(4).uniform(-2.0, 2.0, 21), [0.0, 1.0, 0.5, 3.0]])


def expressions(x, y):
    """All of them of two symbols, or of two arrays."""
    f = elementary
    positive = 0.2 + x * x
    found = [getattr(f, name)(positive if name.startswith("log") else x) for name in ONE]
    found += [f.acosh(1.1 + x * x), *(getattr(f, name)(x, y) for name in TWO)]
    found += [positive**1.7, positive**y, f.where(x < y, x, 2 * y), f.where(f.logic_not(x <= y), x, 1.0)]
    found += [f.where(f.logic_and(x < 0.3, y > 0), 1.0, 0.0), f.where(f.logic_or(x == y, x != x), 3.0, y)]
    return [*found, f.fmax(x, 0.25), f.copysign(2.0, y), f.atan2(0.5, x), f.fmin(x, np.inf)]


def expected(x, y):
    """The same written in NumPy."""
    positive = 0.2 + x * x
    found = [of(positive if name.startswith("log") else x) for name, of in ONE.items()]
    found += [np.arccosh(1.1 + x * x), *(of(x, y) for of in TWO.values())]
    found += [positive**1.7, positive**y, np.where(x < y, x, 2 * y), np.where(x > y, x, 1.0)]
    found += [np.where((x < 0.3) & (y > 0), 1.0, 0.0), np.where(x == y, 3.0, y)]
    return np.array([*found, np.maximum(x, 0.25), np.copysign(2.0, y), np.arctan2(0.5, x), x]).T


def named():
    x = symbol("x", 2)
    return NamedFunction("functions", [("x", x)], [("y", vertcat(*expressions(x[0], x[1])))], alone=True)


def same(found, right):
    # libm's functions are off by a unit or two in the last place, and so are NumPy's; a rest over 0 is no number.
    np.testing.assert_allclose(found, right, rtol=1e-15, atol=1e-16)


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
@pytest.mark.parametrize("written", ["statements", "parts", "table"])
def test_functions_are_those_of_numpy(written, monkeypatch):
    monkeypatch.setattr(c_source, "TABLED", 0 if written == "table" else 10**6)
    for name in ("WHOLE", "LONGEST"):
        monkeypatch.setattr(c_source, name, 7 if written == "parts" else 10**6)
    library, signatures = compiled_library(["functions", written], lambda: [named()], compiler.compiler())
    text = c_source.c_source(named())
    assert ("functions_lanes_1" in text, "RowInput" in text) == (written == "parts", written == "table")
    right = expected(X, Y)
    points = np.ascontiguousarray(np.stack([X, Y], axis=1))
    (found,) = CompiledFunction(library, "functions", signatures["functions"]).each(
        len(X), [points], [(right.shape[1],)]
    )
    same(found, right)
    one, pointers = np.empty(right.shape[1]), ctypes.c_void_p * 1
    for point, row in zip(points, right, strict=True):  # the version for one body
        library.functions_double(pointers(point.ctypes.data), pointers(one.ctypes.data))
        same(one, row)


@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_numbers_and_the_interpreter_have_the_same_functions():
    right = expected(X, Y)
    same(np.stack(np.broadcast_arrays(*expressions(X, Y)), axis=-1), right)
    interpreted = Interpreted(named())
    same(np.array([interpreted(np.array(point))[0] for point in zip(X, Y, strict=True)]), right)


def test_derivatives_have_a_text_as_well():
    """Of each function of one number those of first and second order."""
    x = symbol("x")
    for name in (*ONE, "acosh"):
        slope = gradient(getattr(elementary, name)(x), x)
        function = NamedFunction("slope", [("x", x)], [("y", slope), ("yy", gradient(slope, x))])
        assert not without_text(function.build())
        assert c_source.c_source(function)


def test_numbers_that_python_writes_otherwise():
    assert [constant_text(x) for x in (np.inf, -np.inf, float("nan"), -0.0, 1e22)] == [
        "INFINITY", "-INFINITY", "NAN", "-0.0", "1e+22",
    ]  # fmt: skip


def test_what_has_no_text_is_named():
    x = symbol("x")
    function = NamedFunction("other", [("x", x)], [("y", casadi.erfinv(x))])
    assert without_text(function.build()) == ["erfinv"]
    with pytest.raises(ValueError, match="no C text"):
        c_source.c_source(function)
