"""Margins of gain where a loop is a real number, and of drawn systems against poles of the closed loop."""

import numpy as np
import pytest

import flexapod.control as fc

pytestmark = pytest.mark.analytic


def system(A, B, C, D, inputs="u", outputs="y", sample=None):
    """A state space whose channels are numbered."""
    A, B, C, D = (np.array(x, dtype=float) for x in (A, B, C, D))
    return fc.StateSpace(
        A=A,
        B=B,
        C=C,
        D=D,
        inputs=tuple(f"{inputs}{i}" for i in range(D.shape[1])),
        outputs=tuple(f"{outputs}{i}" for i in range(D.shape[0])),
        states=tuple(f"{inputs} x{i}" for i in range(len(A))),
        units={},
        sample=sample,
    )


def number(value, sample=None):
    """A controller u = value y."""
    return system(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((1, 0)), [[value]], "y", "u", sample)


def limits(data):
    return data.gain_margin.values[0].tolist(), data.gain_margin_frequency.values[0].tolist()


def test_a_limit_at_half_of_the_samples():
    """x_next = a x - k x: the pole a - k reaches -1 with k = 1 + a."""
    data = fc.margins(system([[0.5]], [[1.0]], [[1.0]], [[0.0]], sample=0.01), number(-0.5, 0.01))
    (below, above), (_, hertz) = limits(data)
    assert below == 0 and above == pytest.approx(3.0, rel=1e-12) and hertz == pytest.approx(50.0)
    assert data.modulus_margin.item() == pytest.approx(1 - 0.5 / 1.5, rel=1e-9)


@pytest.mark.parametrize("sample", [None, 0.01])
def test_a_limit_at_rest(sample):
    """x' = -x + k x, x_next = x / 2 + k x / 2: both poles leave at rest with k = 1."""
    plant = ([[-1.0]], [[1.0]]) if sample is None else ([[0.5]], [[0.5]])
    data = fc.margins(system(*plant, [[1.0]], [[0.0]], sample=sample), number(0.5, sample))
    (below, above), (_, hertz) = limits(data)
    assert below == 0 and hertz == 0
    assert above == pytest.approx(2.0, rel=1e-9)  # read beside rest: 1e-5 squared is off
    assert data.modulus_margin.item() == pytest.approx(0.5, rel=1e-9)


def test_a_limit_below_of_what_falls_by_itself():
    """x' = x - 4 x: a quarter of the gain is needed."""
    (below, above), (hertz, _) = limits(fc.margins(system([[1.0]], [[1.0]], [[1.0]], [[0.0]]), number(-4.0)))
    assert below == pytest.approx(0.25, rel=1e-9) and hertz == 0 and np.isinf(above)


def test_a_limit_at_no_end_of_frequencies():
    """y = u / 2 - x / 4, x' = -x + u; u = k y: the pole -1 - k / 4 / (1 - k / 2) has no end with k = 2."""
    data = fc.margins(system([[-1.0]], [[1.0]], [[-0.25]], [[0.5]]), number(0.5))
    (below, above), (_, hertz) = limits(data)
    assert below == 0 and above == pytest.approx(4.0, rel=1e-9) and np.isinf(hertz)


def test_a_loop_with_poles_near_the_fastest_frequencies_that_are_taken():
    """x' = -w x - w k x with w of 10 MHz: a lag alone has no limit."""
    w = 2 * np.pi * 1e7
    (below, above), _ = limits(fc.margins(system([[-w]], [[w]], [[1.0]], [[0.0]]), number(-1.0)))
    assert below == 0 and np.isinf(above)


def growing(plant, law, factors, sampled):
    """Poles that grow of u = diag(factors) K y, by the matrix of the closed loop."""
    A, B, C, D = plant
    KA, KB, KC, KD = law
    KC, KD = factors[:, None] * KC, factors[:, None] * KD
    asked = np.linalg.solve(np.eye(len(D)) - KD @ D, np.hstack([KD @ C, KC]))
    read = np.hstack([C, np.zeros((len(C), len(KA)))]) + D @ asked
    own = np.block([[A, np.zeros((len(A), len(KA)))], [np.zeros((len(KA), len(A))), KA]])
    poles = np.linalg.eigvals(own + np.vstack([B @ asked, KB @ read]))
    return int((np.abs(poles) > 1).sum() if sampled else (poles.real > 0).sum())


def drawn(rng, n, m, sampled):
    """Matrices of a system, some of whose poles may grow."""
    A = rng.normal(size=(n, n))
    if n and sampled:
        A *= rng.uniform(0.3, 1.1) / np.abs(np.linalg.eigvals(A)).max()
    elif n:
        A -= (np.linalg.eigvals(A).real.max() + rng.uniform(-0.3, 1.0)) * np.eye(n)
    return A, rng.normal(size=(n, m)), rng.normal(size=(m, n))


@pytest.mark.parametrize("sample", [None, 0.01])
def test_as_many_poles_grow_between_the_limits_of_gain_and_others_beyond(sample):
    """The count of growing poles is the same from limit to limit of each loop, another a thousandth beyond."""
    rng, sampled = np.random.default_rng(5), sample is not None
    for _ in range(60):
        m = int(rng.integers(1, 3))
        plant = *drawn(rng, rng.integers(1, 6), m, sampled), 0.3 * rng.normal(size=(m, m)) * rng.integers(0, 2)
        law = *drawn(rng, rng.integers(0, 3), m, sampled), rng.normal(size=(m, m)) * 10 ** rng.uniform(-2, 0.5)
        data = fc.margins(system(*plant, sample=sample), system(*law, "y", "u", sample))
        assert data.attrs["unstable_poles"] == growing(plant, law, np.ones(m), sampled)
        for k in range(m):
            count = lambda factor: growing(plant, law, np.where(np.arange(m) == k, factor, 1.0), sampled)  # noqa: B023, E731
            below, above = data.gain_margin.values[k]
            between = np.geomspace(max(below * (1 + 1e-5), 1e-4), min(above * (1 - 1e-5), 1e4), 50)
            assert {count(factor) for factor in between} == {data.attrs["unstable_poles"]}
            for factor in (below * (1 - 1e-3), above * (1 + 1e-3)):
                assert not 0 < factor < np.inf or count(factor) != data.attrs["unstable_poles"]
