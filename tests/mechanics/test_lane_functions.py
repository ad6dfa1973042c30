"""Functions of vectors that the generated code calls, against the C library's."""

import numpy as np
import pytest

from flexapod.mechanics.symbolic import c_source, compiler
from flexapod.mechanics.symbolic.compiler import CompiledFunction, compiled_library
from flexapod.mechanics.symbolic.functions import NamedFunction
from flexapod.mechanics.symbolic.vocabulary import SX, cos, dot, exp, sin, sqrt, symbol, vertcat

pytestmark = [
    pytest.mark.unit,
    pytest.mark.optimised,
    pytest.mark.skipif(compiler.compiler() is None, reason="there is no C compiler"),
]

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
    library, signatures = compiled_library(["turn"], lambda: functions, compiler.compiler())
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
    library, signatures = compiled_library(["power"], lambda: functions, compiler.compiler())
    # Reduction, sum and product round once each, and the library: less than four units in the last place.
    with np.errstate(over="ignore"):
        expected = np.exp(x)
    (found,) = CompiledFunction(library, "power", signatures["power"])(x)
    np.testing.assert_allclose(found, expected, rtol=9e-16, atol=0)


def _chain() -> NamedFunction:
    x = symbol("x", 3)
    y = [sin(x[0]) + sqrt(x[1]), cos(x[0]) * x[2]]
    for k in range(40):
        y.append(y[-1] * y[-2] + y[k // 2] / (k + 1.5))
    return NamedFunction("chain", [("x", x)], [("y", vertcat(*y)), ("yy", dot(SX(vertcat(*y)), vertcat(*y)))])


def test_a_function_in_parts_gives_the_same_bits(monkeypatch):
    x, found = np.array([0.3, 0.7, -0.2]), []
    for most in (5000, 7):
        monkeypatch.setattr(c_source, "LONGEST", most)
        monkeypatch.setattr(c_source, "WHOLE", most)
        library, signatures = compiled_library(["chain", most], lambda: [_chain()], compiler.compiler())
        found.append(CompiledFunction(library, "chain", signatures["chain"])(x))
        assert ("chain_lanes_1" in c_source.c_source(_chain())) == (most == 7)
    for whole, parts in zip(*found, strict=True):
        np.testing.assert_array_equal(parts, whole)


def _of_every_kind() -> NamedFunction:
    """Sums and products of any length, in any order, with all other operations between them."""
    rng, x = np.random.default_rng(8), symbol("x", 6)
    y = [x[k] for k in range(6)]
    y += [-x[0], 2 * x[1], 1 / x[2], x[3] / x[4], sqrt(x[1]), exp(x[2]), sin(x[3]), cos(x[3]), sin(x[5]), 0 - x[0]]
    for _ in range(60):
        a, b, c, d = (y[k] for k in rng.integers(0, len(y), 4))
        y += [a * b + c * d, (a - b * c) * 0.3, dot(vertcat(*y[-5:]), vertcat(*y[2:7])) / (2 + a * a), a - b + 2 * d]
    many = sum((rng.normal() * y[k % len(y)] * y[3 * k % len(y)] for k in range(150)), x[0])
    return NamedFunction("kinds", [("x", x)], [("y", vertcat(*y, 7.0, x[5])), ("many", many)])


def test_a_function_as_a_table_gives_the_same_bits(monkeypatch):
    x = np.random.default_rng(9).uniform(0.1, 1.0, (19, 6))
    x[3], x[7, 0], x[8, 3] = np.inf, -0.0, 1e7
    found = []
    for most in (10**6, 0):
        monkeypatch.setattr(c_source, "TABLED", most)
        library, signatures = compiled_library(["kinds", most], lambda: [_of_every_kind()], compiler.compiler())
        kinds = CompiledFunction(library, "kinds", signatures["kinds"])
        found.append(kinds.each(19, [x], [(258,), (1,)]))
        assert ("RowInput" in c_source.c_source(_of_every_kind())) == (most == 0)
    for statements, table in zip(*found, strict=True):
        bits = np.isnan(statements), np.nan_to_num(statements).tobytes()  # of what is no number the sign is any
        assert (np.isnan(table) == bits[0]).all() and np.nan_to_num(table).tobytes() == bits[1]


@pytest.mark.parametrize(
    ("rows", "shapes"),
    [
        ([np.ones((2, 2))], [(42,), (1,)]),  # an argument that is too short
        ([np.ones((2, 3))], [(41,), (1,)]),  # room for too few numbers
        ([np.ones((2, 3))], [(42,)]),
        ([np.ones((2, 3)), np.ones((1, 1))], [(42,), (1,)]),
        ([np.ones((0, 3))], [(42,), (1,)]),
    ],
)
def test_wrong_sizes_are_refused_before_c_sees_them(rows, shapes):
    library, signatures = compiled_library(["chain", 5000], lambda: [_chain()], compiler.compiler())
    chain = CompiledFunction(library, "chain", signatures["chain"])
    assert [x.shape for x in chain.each(2, [np.ones((1, 3))], [(42,), (1,)])] == [(2, 42), (2, 1)]
    with pytest.raises(ValueError, match="expected sizes of inputs and outputs"):
        chain.each(2, rows, shapes)
